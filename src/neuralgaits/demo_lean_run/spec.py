"""The default spec: conditions that make a gait physically walk, and provable.

Lengths scale with the leg length l, speeds with sqrt(g l), forces with m g, torques in the margins
with the robot's own limits. The numbers come from trials on AMBER-3M (leg 0.8731 m) and are that
robot's values.
"""

from functools import partial
from typing import TYPE_CHECKING, Literal, NamedTuple

import equinox as eqx
import numpy as np
from jaxtyping import PRNGKeyArray

from neuralgaits.barriers import functions as f
from neuralgaits.barriers.conditions import (
    AbstractCondition,
    Barrier,
    Equality,
    Fence,
    Inlet,
    Pointwise,
    TubeWidth,
)
from neuralgaits.barriers.quantities import Quantity
from neuralgaits.barriers.regions import Box
from neuralgaits.barriers.spec import GaitSpec, Init, Recipe
from neuralgaits.errors import SpecError
from neuralgaits.gait import HybridInvariantPolicy, MLPPolicy, walking_posture
from neuralgaits.gait.gaits import Gait
from neuralgaits.gait.posture import REFERENCE_LEG_M
from neuralgaits.gait.tubes import Tube

if TYPE_CHECKING:
    from neuralgaits.robots import PlanarBiped

LIFT_OFF, LANDING = 0.15, 0.85
"""Phases between which the swing foot must be clear of the ground."""
TORQUE_SHARE = 0.927
"""Share of the torque limit the zero dynamics may use: 38 of 41 N m on AMBER-3M."""
FLOWS = "flow-above-lower-fence", "flow-below-upper-fence"
RESETS = "reset-above-lower-fence", "reset-below-upper-fence"
"""Names of the conditions of the fences: along the flow, and across the impact."""
CLEARANCE = 0.02
"""Height of the arc that the swing foot stays above, of the reference robot [m]."""
OVER_EDGES = 0.005
"""Height above the edge of a stair, of the reference robot [m]."""
LEAST_BEND = 0.05
"""Bend of a knee away from straight that is always kept [rad]."""
START_ENERGIES = (0.23, 0.57)
"""Orbital energies of the initial fences [m^2/s^2]."""


class Units(NamedTuple):
    """Values on this robot of one unit of the reference robot."""

    length: float
    speed: float
    time: float
    energy: float
    weight_n: float
    mass_kg: float


def units(robot: "PlanarBiped") -> Units:
    """Return the ratios to the reference robot, and weight and mass (N, kg)."""
    length = robot.leg_length / REFERENCE_LEG_M
    mass, gravity = float(robot.mass), float(robot.gravity)
    pace = (length * gravity / 9.81) ** 0.5
    return Units(length, pace, length / pace, pace**2, mass * gravity, mass)


def pendulum_height(robot: "PlanarBiped") -> float:
    """Return the height h of the orbital energy: 1.03 straight legs [m]."""
    return 1.03 * robot.leg_length


def regions_of_step(lift_off: float, landing: float) -> dict[str, tuple[Box, ...]]:
    """Return the regions of the tube, in phase and level, that conditions of a step refer to.

    Args:
        lift_off: phase up to which the swing foot may be on the ground.
        landing: phase from which it may be there again.
    """
    everywhere, ends = (0.0, 1.0), ((0.0, 0.0), (1.0, 1.0))
    return {
        "tube": (_box(everywhere, everywhere),),
        "lift-off": (_box((0.0, lift_off), everywhere),),
        "swing": (_box((lift_off, landing), everywhere),),
        "landing": (_box((landing, 1.0), everywhere),),
        "fence-lower": (_box(everywhere, ends[0]),),
        "fence-upper": (_box(everywhere, ends[1]),),
        "guard": (_box(ends[1], everywhere),),
    }


def walking(
    robot: "PlanarBiped",
    policy: Literal["hybrid-invariant", "mlp"] = "hybrid-invariant",
    *,
    forward: float | None = None,
    shortest: float | None = None,
    highest: float = 0.0,
) -> GaitSpec:
    """The default gait specification for a robot.

    Args:
        robot: with knees; a biped with straight legs cannot clear the ground.
        policy: "hybrid-invariant" (default), or "mlp" for a free network, which must then
            learn to match outputs and rates through the impact.
        forward: least rate of z1 (m/s), None for one that fits the robot.
        shortest: least step length (m), None for one that fits the robot.
        highest: largest difference in height of two footholds that follow each other (m).
    """
    if policy not in ("hybrid-invariant", "mlp"):
        raise SpecError(f"walking: expected policy hybrid-invariant or mlp, found {policy!r}")
    if robot.n - (robot.torso is not None) <= 2:
        raise SpecError(
            f"spec walking: expected a robot with knees, found none in {robot.name!r}: straight "
            "legs cannot clear the ground; write a spec of your own, FILE.py:NAME"
        )
    conditions = [
        *_stance(robot, forward),
        *_swing_foot(robot, highest),
        *_tube(),
        *_guard(robot, shortest),
    ]
    free = policy == "mlp"
    if free:
        conditions += _match(robot)
    regions = regions_of_step(LIFT_OFF, LANDING)
    samples = {
        "tube": 48,
        "lift-off": 12,
        "swing": 16,
        "landing": 12,
        "fence-lower": 16,
        "fence-upper": 16,
        "guard": 12,
    }
    if free:
        samples = {name: (4 if name == "guard" else 2) * n for name, n in samples.items()}
    recipe = Recipe(
        steps=8000 if free else 1400,
        samples=samples,
        learning_rate=3e-3 if free else 5e-3,
        warmup=0.1,
        weight_decay=1e-4,
        overshoot=(0.02, 0.03),
        aim=0.06,
        worst_weight=0.1,
        logarithmic=True,
        effort=0.2,
        effort_torque=0.206 * units(robot).weight_n * robot.leg_length,
        posture_steps=500 if free else 0,
    )
    new_gait = partial(_new_mlp if free else new_hybrid_invariant, robot)
    name = "walking-mlp" if free else "walking"
    return GaitSpec(name, tuple(conditions), regions, new_gait, recipe)


def _box(phases: tuple[float, float], levels: tuple[float, float]) -> Box:
    return Box((phases[0], levels[0]), (phases[1], levels[1]))


def start_tube(robot: "PlanarBiped", span, start) -> Tube:
    """Return the tube that training starts from: `Tube.between_energies` of START_ENERGIES."""
    unit = units(robot)
    return Tube.between_energies(
        robot,
        (START_ENERGIES[0] * unit.energy, START_ENERGIES[1] * unit.energy),
        height=pendulum_height(robot),
        span=span,
        start=start,
        degree=6,
        trained=True,
    )


def new_hybrid_invariant(
    robot: "PlanarBiped",
    key: PRNGKeyArray,
    init: Init,
    hidden: tuple[int, ...] | None,
    *,
    z2_dependence: bool = True,
) -> Gait:
    """Untrained gait; "random" starts the network at full size instead of a tenth.

    Args:
        robot: that it is for.
        key: random key of the network.
        init: see above.
        hidden: widths of the hidden layers; None for the usual ones.
        z2_dependence: of `HybridInvariantPolicy`.
    """
    policy = HybridInvariantPolicy.init(
        robot, key=key, hidden=hidden or (32, 32), z2_dependence=z2_dependence
    )
    if init == "random":
        full = 10.0 * policy.network.weights[-1]
        policy = eqx.tree_at(
            lambda p: p.network.weights, policy, (*policy.network.weights[:-1], full)
        )
    guard = walking_posture(robot).z_guard
    return Gait(policy, start_tube(robot, None, (-guard, guard)))


def _new_mlp(
    robot: "PlanarBiped", key: PRNGKeyArray, init: Init, hidden: tuple[int, ...] | None
) -> Gait:
    del init  # The trainer's posture steps make the difference.
    policy = MLPPolicy.init(robot, key=key, hidden=hidden or (64, 64))
    guard = walking_posture(robot).z_guard
    return Gait(policy, start_tube(robot, (-guard, guard), (-guard, guard)))


HEAVY_ROTORS = 0.002
"""Inertia of a rotor in units of mass times leg length squared. AMBER-3M has 0.026 and RABBIT 0.04,
more than half of what their motors feel; the walkers of reinforcement learning have 0.0004."""


def _stance(robot: "PlanarBiped", forward: float | None) -> list[AbstractCondition]:
    """Conditions on the whole tube: torso, contact forces, torques, joint rates and knees."""
    unit = units(robot)
    # Without rotors to speak of, joints are faster after an impact, and hips slower in mid-step.
    rotor = float(np.mean(robot.armature[1:])) / (unit.mass_kg * robot.leg_length**2)
    heavy = rotor > HEAVY_ROTORS
    rate = (4.0 if heavy else 10.0) / unit.time
    if forward is None:
        # A slower tube is pushed over more easily.
        forward = (0.35 if heavy else 0.2) * unit.speed
    conditions: list[AbstractCondition] = []
    if robot.torso is not None:
        alpha, scale, lean = 10.0 / unit.time, 3.3 / unit.time, walking_posture(robot).lean
        conditions += [
            Barrier("torso-lower", "tube", scale, f.at_least(f.torso_angle, lean - 0.25), alpha),
            Barrier("torso-upper", "tube", scale, f.at_most(f.torso_angle, lean + 0.08), alpha),
        ]
    weight = unit.weight_n
    conditions += [
        Pointwise("normal-force", "tube", weight, f.at_least(f.normal_force, 0.35 * weight)),
        Pointwise("friction-forward", "tube", 0.45 * weight, f.friction_forward(0.45)),
        Pointwise("friction-backward", "tube", 0.45 * weight, f.friction_backward(0.45)),
        Pointwise("torque-lower", "tube", 1.0, f.torque_reserve("lower", TORQUE_SHARE)),
        Pointwise("torque-upper", "tube", 1.0, f.torque_reserve("upper", TORQUE_SHARE)),
        Pointwise("rate-lower", "tube", rate, f.at_least(f.joint_rates, -rate)),
        Pointwise("rate-upper", "tube", rate, f.at_most(f.joint_rates, rate)),
        Pointwise("forward", "tube", unit.speed, f.at_least(f.forward_rate, forward)),
        Pointwise(
            "transversal-inertia",
            "tube",
            _inertia(unit, 20.0),
            f.at_least(f.transversal_inertia, _inertia(unit, 5.0)),
        ),
    ]
    if len(_knees(robot)):
        conditions.append(Pointwise("knee", "tube", 0.5, _knee_bend(robot)))
    return conditions


def _inertia(unit: Units, reference: float) -> float:
    """Return a value of |J . s| [kg m], scaled from the reference robot's (21.56 kg)."""
    return reference * unit.mass_kg * unit.length / 21.5562


def _knees(robot: "PlanarBiped") -> np.ndarray:
    """Return the indices of the knees: actuated joints whose range excludes one side."""
    one_sided = (robot.joint_lower >= -0.1) | (robot.joint_upper <= 0.1)
    return np.flatnonzero(one_sided)


def _knee_bend(robot: "PlanarBiped") -> Quantity:
    """Build the quantity by which each knee is bent beyond LEAST_BEND [rad]."""
    knees = _knees(robot)
    forward = robot.joint_upper[knees] > -robot.joint_lower[knees]
    sides = np.where(forward, 1.0, -1.0)
    return f.knee_bend(tuple(knees.tolist()), tuple(sides.tolist()), LEAST_BEND)


def _swing_foot(robot: "PlanarBiped", highest: float) -> list[AbstractCondition]:
    """Conditions of the swing foot: rise, clear, fall; it touches the ground only at the guard."""
    unit = units(robot)
    # Without rotor inertia no gait was found that lifts off faster.
    rise = (0.1 if np.any(robot.armature > 0) else 0.05) * unit.speed
    ceiling, clearance = 0.12 * unit.length, _clearance(unit, highest)
    speed = 0.5 * unit.speed
    velocity = f.foot_vertical_velocity
    return [
        Pointwise("foot-ceiling", "tube", ceiling, f.at_most(f.foot_height, ceiling)),
        Pointwise("foot-rises", "lift-off", speed, f.at_least(velocity, rise)),
        Pointwise("foot-clears", "swing", 0.05 * unit.length, f.foot_above_arc(clearance)),
        Pointwise("foot-falls", "landing", speed, f.at_most(velocity, -0.1 * unit.speed)),
    ]


def _clearance(unit: Units, highest: float) -> float:
    """Return the height over the line of footholds of an arc that clears edges of stairs [m].

    An edge is half a rise above that line, and half-way between two stairs: met at about three
    quarters of a step, where the arc has three quarters of its height.
    """
    return max(CLEARANCE * unit.length, (0.5 * highest + OVER_EDGES * unit.length) / 0.75)


def _tube() -> list[AbstractCondition]:
    """Conditions of the tube: flow and reset stay between the fences, and the tube is wide."""
    return [
        Fence("flow-above-lower-fence", "fence-lower", 1.0, "lower"),
        Fence("flow-below-upper-fence", "fence-upper", 1.0, "upper"),
        TubeWidth("tube-width", "fence-lower", 0.32, 0.32),
        Inlet("reset-above-lower-fence", "guard", 1.0, "lower"),
        Inlet("reset-below-upper-fence", "guard", 1.0, "upper"),
    ]


def _guard(robot: "PlanarBiped", shortest: float | None) -> list[AbstractCondition]:
    """Conditions of a clean impact: step length, a foot that lands, one that leaves, no slip."""
    unit = units(robot)
    push = unit.mass_kg * unit.speed / 21.5562
    step, speed = 0.3 * unit.length, 0.1 * unit.speed
    least = step if shortest is None else shortest
    return [
        Pointwise("step-length", "guard", step, f.at_least(f.foot_forward, least)),
        Pointwise("impulse", "guard", 5.0 * push, f.at_least(f.normal_impulse, 0.2 * push)),
        Pointwise("impulse-forward", "guard", 0.5 * 5.0 * push, f.impulse_cone_forward(0.5)),
        Pointwise("impulse-backward", "guard", 0.5 * 5.0 * push, f.impulse_cone_backward(0.5)),
        Pointwise("old-foot-leaves", "guard", 2 * speed, f.at_least(f.old_foot_lift, 0.2 * speed)),
        Pointwise(
            "guard-transversal", "guard", 5 * speed, f.at_most(f.foot_vertical_velocity, -speed)
        ),
    ]


def _match(robot: "PlanarBiped") -> list[AbstractCondition]:
    """Return conditions of a free policy: match outputs, rates and position through the impact."""
    unit = units(robot)
    length = unit.length
    guard = walking_posture(robot).z_guard
    return [
        Equality("foot-on-guard", "guard", 0.02 * length, f.foot_height, 5e-4 * length),
        Equality("output-match", "guard", 0.02, f.output_mismatch, 1e-3),
        Equality("rate-match", "guard", 0.4 / unit.time, f.rate_mismatch, 0.02 / unit.time),
        Equality(
            "reset-hip", "guard", 0.02 * length, f.at_least(f.reset_hip, -guard), 1e-3 * length
        ),
    ]
