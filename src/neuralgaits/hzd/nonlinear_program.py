"""Optimisation of a gait as a nonlinear program.

The unknowns are the control points of the outputs, z1 at both ends of the step, and zeta = z2^2 / 2
at the nodes. The objective is the mechanical cost of transport. Equations: zeta follows the zero
dynamics at every node; the foot is on the ground at the end; the plastic impact with exchanged legs
leaves outputs and their rates on the curves, z1 and zeta where the step began; and the mean speed
is the requested one. Inequalities are the conditions of a spec, on their regions. Source of the
method: Westervelt et al. (2007), chapter 6; Hereid et al. (2018).
"""

from typing import Any, NamedTuple

import numpy as np

from neuralgaits._types import Float
from neuralgaits.hzd.collocation import Nodes
from neuralgaits.hzd.transcription import StepFunctions
from neuralgaits.robots.robot_file import RobotFile

LEAST_ZETA, MOST_ZETA = 1e-2, 10.0
"""Bounds of zeta, in its unit."""


class NonlinearProgram(NamedTuple):
    """A nonlinear program: unknowns x, parameters (speed [m/s], smoothing [W]), bounds.

    Attributes:
        symbols: input of CasADi's solver.
        x_bounds, g_bounds: lower and upper, of unknowns and of constraints.
    """

    symbols: dict[str, Any]
    x_bounds: tuple[Float[np.ndarray, " n"], Float[np.ndarray, " n"]]
    g_bounds: tuple[Float[np.ndarray, " k"], Float[np.ndarray, " k"]]


def problem(
    casadi: Any, robot: RobotFile, step: StepFunctions, mesh: Nodes, degree: int
) -> NonlinearProgram:
    """Build the nonlinear program.

    Args:
        casadi: the module.
        robot: the biped.
        step: formulas of its step.
        mesh: nodes of the collocation.
        degree: degree of the polynomials.
    """
    m, count = len(robot.joint_names) - 1, len(mesh.phases)
    rows, ends = casadi.SX.sym("rows", m * (degree + 1)), casadi.SX.sym("ends", 2)
    zeta, targets = casadi.SX.sym("zeta", count), casadi.SX.sym("told", 2)
    speed, smoothing = targets[0], targets[1]
    equal, constraints = [], []
    slopes, paces, powers = [], [], []
    for k, phase in enumerate(mesh.phases):
        quantities = step.along(rows, ends, phase, zeta[k])
        slopes.append(quantities["slope"])
        paces.append(quantities["pace"])
        # |x| has no slope at 0, and most optima have powers there.
        smooth = casadi.sqrt(quantities["power"] ** 2 + smoothing**2) - smoothing
        powers.append(casadi.sum1(smooth))
        constraints += [
            quantities[name] for name, (a, b) in step.margin_ranges.items() if a <= phase <= b
        ]
    slope, pace, power = (casadi.vertcat(*each) for each in (slopes, paces, powers))
    followed = zeta - zeta[0] - casadi.DM(mesh.integrals) @ slope
    equal.append(followed[1:])
    weights = casadi.DM(mesh.weights)
    end = step.end(rows, ends, 1.0, zeta[count - 1])
    end_equations = ("foot", "z1", "zeta", "outputs", "rates")
    constraints += [value for name, value in end.items() if name not in end_equations]
    # Largest share of zeta that an impact may leave: on outputs of z1 alone that is the slope of
    # the Poincare map, which must be below one for an attracting orbit.
    constraints.append(0.95 - end["zeta"] / zeta[count - 1])
    length, height = end["foot"][0], end["foot"][1]
    # Sizes of the foot's height [m] and of rates [rad/s] in the equations, so that all are alike.
    equal += [
        height / 0.1,
        end["z1"] - ends[0],
        end["zeta"] - zeta[0],
        end["outputs"],
        end["rates"] / 10.0,
        length - speed * casadi.dot(weights, pace),
    ]
    weight = float(robot.mass * robot.gravity)
    cost = casadi.dot(weights, pace * power) / (weight * length)
    equations, margins = (casadi.vertcat(*map(casadi.vec, each)) for each in (equal, constraints))
    symbols = {
        "x": casadi.vertcat(rows, ends, zeta),
        "p": targets,
        "f": cost,
        "g": casadi.vertcat(equations, margins),
    }
    g_bounds = _equations_and_margins(equations.shape[0], margins.shape[0])
    return NonlinearProgram(symbols, _bounds(robot, count, degree), g_bounds)


def _equations_and_margins(
    equations: int, margins: int
) -> tuple[Float[np.ndarray, " g"], Float[np.ndarray, " g"]]:
    """Return bounds on both: equations are 0, margins as large as is asked for, or larger."""
    none = np.zeros(equations)
    # In scales, at the nodes, so that each condition holds between them, too.
    least = 0.02
    return (
        np.concatenate([none, np.full(margins, least)]),
        np.concatenate([none, np.full(margins, np.inf)]),
    )


def _bounds(
    robot: RobotFile, count: int, degree: int
) -> tuple[Float[np.ndarray, " n"], Float[np.ndarray, " n"]]:
    """Return bounds on control points: a curve stays in their hull, so in the joints' ranges."""
    leg, ranges = robot.layout.leg_length, (robot.joint_lower, robot.joint_upper)
    # Shortest and longest distance of z1 at either end of the step from the middle, in leg lengths.
    shortest = 0.05
    longest = 0.45
    ends = ([-longest * leg, shortest * leg], [-shortest * leg, longest * leg])
    zetas = (np.full(count, LEAST_ZETA), np.full(count, MOST_ZETA))
    low, high = (
        np.concatenate([np.repeat(np.asarray(joint), degree + 1), end, zeta])
        for joint, end, zeta in zip(ranges, ends, zetas, strict=True)
    )
    return low, high
