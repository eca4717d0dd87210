"""Solve the optimisation of a gait with IPOPT, from a rough posture."""

import time
from importlib.util import find_spec
from math import comb
from typing import Any, NamedTuple

import numpy as np

from neuralgaits._types import Float
from neuralgaits.barriers import specs
from neuralgaits.errors import ConvergenceError, InputError
from neuralgaits.gait import BezierPolicy, ZeroDynamics
from neuralgaits.gait.posture import posture_path, walking_posture
from neuralgaits.gait.stepping_robot import SteppingRobot
from neuralgaits.hzd.collocation import nodes
from neuralgaits.hzd.gait_file import GivenGait
from neuralgaits.hzd.nonlinear_program import LEAST_ZETA, NonlinearProgram, problem
from neuralgaits.hzd.transcription import transcribe

DEGREE = 5
"""Degree of the outputs' polynomials."""


class OptimisedGait(NamedTuple):
    """Optimised gait, with the solver's effort."""

    gait: GivenGait
    iterations: int
    """Number of IPOPT's iterations."""
    solve_s: float
    """Time of IPOPT's calls [s]."""


class Optimiser:
    """Optimise gaits of one robot, for one speed after another.

    Raises: InputError without CasADi, or for a robot that the spec does not support.
    """

    def __init__(self, robot: SteppingRobot, degree: int = DEGREE):
        """Build the program and its derivatives."""
        if find_spec("casadi") is None:
            raise InputError(
                "optimise needs CasADi, which is not installed: pip install 'neuralgaits[hzd]'"
            )
        import casadi  # pyright: ignore[reportMissingImports]

        self._robot, self._degree = robot, degree
        # With so many nodes zeta of such gaits has errors of 1e-8.
        self._mesh = nodes(24)
        # The gait must satisfy the conditions of this spec along its orbit.
        spec = specs.load("walking", robot)
        bare = BezierPolicy(np.zeros((robot.n - 1, degree + 1)), (0.0, 1.0))
        step = transcribe(casadi, ZeroDynamics(robot, bare), spec)
        self._unit = step.unit
        self._problem: NonlinearProgram = problem(casadi, robot, step, self._mesh, degree)
        options = {
            "print_time": False,
            "ipopt": {
                "print_level": 0,
                "sb": "yes",
                "max_iter": 500,
                "tol": 1e-6,
                # Half the iterations of the monotone strategy, at the slowest of ten speeds.
                "mu_strategy": "adaptive",
            },
        }
        self._solver: Any = casadi.nlpsol("gait", "ipopt", self._problem.symbols, options)

    def at(self, speed: float) -> OptimisedGait:
        """Return the gait of least cost of transport at a mean speed (m/s).

        Raises: ConvergenceError if IPOPT ends without one.
        """
        start_time = time.perf_counter()
        x = self._start(speed)
        count = 0
        low, high = self._problem.x_bounds
        least, most = self._problem.g_bounds
        # Powers below which |power| is rounded off [W], for one solution after the other.
        smoothing_w = (5.0, 0.3)
        for smoothing in smoothing_w:
            solution = self._solver(
                x0=x, p=[speed, smoothing], lbx=low, ubx=high, lbg=least, ubg=most
            )
            stats, x = self._solver.stats(), np.array(solution["x"]).ravel()
            count += stats["iter_count"]
            if not stats["success"]:
                raise ConvergenceError(
                    f"expected a gait of {self._robot.name} at {speed:g} m/s, found that IPOPT "
                    f"ended with {stats['return_status']} after {count} iterations: ask for "
                    "another speed, or for polynomials of another --degree"
                )
        rows = (self._robot.n - 1) * (self._degree + 1)
        start, end = x[rows : rows + 2].tolist()
        gait = GivenGait(x[:rows].reshape(-1, self._degree + 1), (start, end))
        return OptimisedGait(gait, count, time.perf_counter() - start_time)

    def _start(self, speed: float) -> Float[np.ndarray, " n"]:
        """Return a rough step by inverse kinematics, as fast as a linear inverted pendulum."""
        robot, guard = self._robot, walking_posture(self._robot).z_guard
        count = 33  # Hip positions at which inverse kinematics gives a posture to start from.
        phases = np.linspace(0.0, 1.0, count)
        path = posture_path(robot, guard * (2.0 * phases - 1.0))
        powers = range(self._degree + 1)
        basis = np.stack(
            [
                comb(self._degree, i) * phases**i * (1.0 - phases) ** (self._degree - i)
                for i in powers
            ],
            axis=1,
        )
        rows = np.linalg.lstsq(basis, path, rcond=None)[0].T
        z1 = guard * (2.0 * self._mesh.phases - 1.0)
        # The unit of zeta is (m h)^2 / 2 of a pendulum of height h.
        height = np.sqrt(2.0 * self._unit) / float(robot.mass)
        fall = float(robot.gravity) / height
        # Its mean square over the step is that of the speed.
        zeta = speed**2 + fall * (z1**2 - guard**2 / 3.0)
        zeta = np.maximum(zeta, 5.0 * LEAST_ZETA)
        return np.concatenate([rows.ravel(), [-guard, guard], zeta])
