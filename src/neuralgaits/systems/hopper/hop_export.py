"""The controller in C: forces of stance and flight as one function, and a tick that chooses."""

from collections.abc import Callable
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float
from neuralgaits.systems.controller_header import ControllerHeader
from neuralgaits.systems.family_run import FamilyRun
from neuralgaits.systems.hopper import hop_episodes as episodes
from neuralgaits.systems.hopper.flight_plan import (
    SHORTEST_FLIGHT,
    FlightPlan,
    LegState,
    flight_forces,
)

ABOUT = """Forces at a state: progress of the stance and momentum about the foot, in the policy's
 * range; lean, length and their rates of the leg; share of the flight that has passed, its
 * duration, lean, length and their rates at lift-off, rate of the lean at its end. In SI units.
 * Forces: of the leg in stance and in flight [N], of the wheel in flight [N m]"""


def header_of(run: FamilyRun) -> ControllerHeader:
    """Return names and numbers of the exported controller."""
    robot, policy = run.robot, run.controller.policy
    touchdown, lift_off = (float(lean) for lean in policy.ends[:2])
    constants = {
        "FORCE_LIMIT": (robot.force_limit, "N, of the leg's motor"),
        "TORQUE_LIMIT": (robot.torque_limit, "N m, of the wheel's motor"),
        "TOUCHDOWN": (touchdown, "rad, lean at the start of a stance"),
        "LIFT_OFF": (lift_off, "rad, lean at its end"),
        "LANDING_LENGTH": (float(policy.landing_length(robot)), "m, of the leg at touchdown"),
        "UPPER_MASS": (robot.upper_mass, "kg, of hub and wheel"),
        "UPPER_OFFSET": (robot.upper_offset, "m, of their centre of mass beyond the hip"),
        "UPPER_INERTIA": (robot.upper_inertia, "kg m^2, about that centre"),
        "FOOT_MASS": (robot.foot_mass, "kg, of what slides"),
        "FOOT_OFFSET": (robot.foot_offset, "m, of its centre of mass from the foot"),
        "FOOT_INERTIA": (robot.foot_inertia, "kg m^2, about that centre"),
        "GRAVITY": (robot.gravity, "m/s^2"),
        "HOLD": (episodes.HOLD, "1/s, gain that holds the wheel in stance"),
        "LEAST_MOMENTUM": (episodes.LEAST_MOMENTUM, "kg m^2/s, that the policy is given"),
        "EARLIEST": (episodes.EARLIEST, "share of a flight before which contact is no touchdown"),
        "SHORTEST_FLIGHT": (SHORTEST_FLIGHT, "s"),
    }
    # Files beside this one that are the same for every hopper.
    tick_files = ("hopper_tick.h", "hopper_tick.c")
    return ControllerHeader(
        file="hopper",
        function="ng_hopper_forces",
        title=f"the hopper {run.config.robot}",
        about=ABOUT,
        advice="Call ng_hopper_tick of hopper_tick.h, and clamp what it returns",
        constants=constants,
        output="forces",
        unit="N or N m",
        limit=robot.force_limit,
        proved="its hybrid\n * zero dynamics, not of their control, flights' ways or sampling",
        more={
            name: Path(__file__).with_name(name).read_text(encoding="utf-8") for name in tick_files
        },
    )


def forces_of(run: FamilyRun) -> Callable[[Float[Array, "13"]], dict[str, Array]]:
    """Return the function that is written in C: smooth, so that it can be traced."""
    robot, policy = run.robot, run.controller.policy

    def forces(state: Float[Array, "13"]) -> dict[str, Array]:
        s, sigma, *leg = state[:6]
        share, duration, *start, landing = state[6:]
        lean, length = policy.ends[0], policy.landing_length(robot)
        plan = FlightPlan(duration, LegState(*start), LegState(lean, length, landing, 0.0))
        now = LegState(*leg)
        torque, force = flight_forces(robot, now, plan.at_share(share))
        stance = episodes.stance_force(robot, policy, s, now, sigma)
        return {"forces": jnp.stack([stance, force, torque])}

    return forces


def random_states(run: FamilyRun, count: int, seed: int) -> Float[np.ndarray, "count 13"]:
    """Return random states of stances between the fences, and of flights from their ends."""
    draw = np.random.default_rng(seed)
    robot = run.robot
    policy = run.controller.policy
    first, last, lift_length, _ = (float(end) for end in policy.ends)
    s, level = draw.uniform(size=(2, count))
    sigma = np.asarray(jax.vmap(run.controller.tube.momentum)(jnp.asarray(s), jnp.asarray(level)))
    lean = first + (last - first) * s
    length = draw.uniform(robot.shortest, robot.longest, count)
    rates, at_lift_off = draw.uniform(-2.0, 2.0, (2, 2, count))
    share, duration, landing = draw.uniform(
        [[0.0], [SHORTEST_FLIGHT], [-5.0]], [[1.0], [0.3], [5.0]], (3, count)
    )
    start = np.full(count, last), np.full(count, lift_length), *at_lift_off
    rows = (s, sigma, lean, length, *rates, share, duration, *start, landing)
    return np.stack(rows, axis=1)
