"""The biped in three dimensions, walked by foot placement of a linear inverted pendulum.

No gait is trained: the centre of mass is to stay at one height, and at each tick the swing foot's
landing place is where the pendulum of the robot's angular momenta (ALIP) ends the step after it
with the momenta that are wanted (Gong and Grizzle 2021). The six outputs, inverse kinematics, plant
and counts of falls are those of the trained gait, whose rows stand beside it. The law is exact
linearisation of the outputs: what is compared are gaits.

    RUN=runs/... python benchmarks/space_alip.py     WALKS=5 walks fewer
"""

import os
from typing import Any, NamedTuple
from unittest.mock import patch

import jax
import jax.numpy as jnp
import numpy as np
from common import show, whole

from neuralgaits._quick_jit import quick_jit
from neuralgaits.simulation.setup.push import Push
from neuralgaits.simulation.ticks.delay_line import DelayLine
from neuralgaits.systems.family_run import FamilyRun, open_family_run
from neuralgaits.systems.walker3d.spatial_changes import TICK_S, changes_of
from neuralgaits.systems.walker3d.spatial_laws import (
    DAMPING,
    STIFFNESS,
    Measured,
    hips_of,
    measured_state,
)
from neuralgaits.systems.walker3d.spatial_motion import (
    UP,
    generalised,
    jacobians_of,
    mass_matrix,
    motion_of_rates,
)
from neuralgaits.systems.walker3d.spatial_plant import SpatialPlants
from neuralgaits.systems.walker3d.spatial_pose import (
    Outputs,
    joints_of_pose,
    links_of,
    pose_of_joints,
    pose_of_outputs,
)
from neuralgaits.systems.walker3d.spatial_system import SYSTEM
from neuralgaits.systems.walker3d.spatial_walks import WalkPlan, simulate_walks, starts_of

STEPS = 25
CASES = (
    "",
    "floor_height=0.01",
    "slope_deg=2",
    "slope_deg=-2",
    "mass_scale=1.1",
    "mass_scale=0.9",
    "torso_shift_m=0.01",
    "torso_shift_m=-0.01",
    "friction=0.4",
    "delay_ms=4",
)
CLEARANCE = 0.06
"""Height of the swing foot half-way [m]."""


class Pendulum(NamedTuple):
    """What foot placement knows of the robot and wants.

    Attributes:
        period: of a step [s].
        hips: height of the hips [m].
        impulse: mass times height of the centre of mass [kg m].
        rate: of falling [1/s].
        forward, aside: momenta (L_y, n) wanted at the end of a step [kg m^2/s].
    """

    period: float
    hips: float
    impulse: float
    rate: float
    forward: float
    aside: float


def pendulum_of(run: FamilyRun) -> Pendulum:
    """Speed, period, height and width of steps are those of the trained gait."""
    gait = run.controller
    own, period = gait.policy.pendulum, run.summary.step_s
    impulse, rate = own.mass * own.height, own.rate
    turn = 0.5 * rate * period
    forward = impulse * rate * 0.5 * run.summary.step_m / np.tanh(turn)
    middle = float(gait.start[0]) + own.half_width
    aside = impulse * rate * middle * np.tanh(turn)
    return Pendulum(period, float(gait.policy.height[0]), impulse, rate, forward, aside)


class Memory(NamedTuple):
    """Of a step: time in it, and where the swing foot was at first, from its hip. [N], [N, 3]."""

    since: Any
    first: Any


def outputs_at(pendulum: Pendulum, z: Any, centre: Any, time: Any, first: Any) -> Outputs:
    """Return the outputs at a time of the step, of the state and the centre of mass."""
    left = jnp.maximum(pendulum.period - time, 0.0) * pendulum.rate
    grown, swung = jnp.cosh(left), jnp.sinh(left)
    end = pendulum.impulse * pendulum.rate
    momenta = grown * z[2:] + end * swung * centre
    whole_turn = pendulum.rate * pendulum.period
    step, size = jnp.cosh(whole_turn), end * jnp.sinh(whole_turn)
    # From the centre of mass as the step ends.
    ahead = (step * momenta[0] - pendulum.forward) / size
    aside = (step * momenta[1] + pendulum.aside) / size
    share = jnp.clip(time / pendulum.period, 0.0, 1.0)
    blend = share * share * (3.0 - 2.0 * share)
    # Beyond the end of the step the foot goes on down.
    late = jnp.maximum(time - pendulum.period, 0.0)
    hop = 16.0 * share**2 * (1.0 - share) ** 2
    lift = first[2] * (1.0 - blend) + CLEARANCE * hop - 0.3 * late - 0.01 * blend * share
    # The centre of mass moves on to the end of the step, the foot with it: from the swing hip.
    hip = z[:2]
    landing = jnp.stack([ahead, aside]) + centre - hip - jnp.array([0.0, WIDTH[0]])
    place = first[:2] * (1.0 - blend) + landing * blend
    zero = jnp.zeros_like(time)
    return Outputs(zero + PITCH[0], zero + pendulum.hips, place[0], place[1], lift)


WIDTH, PITCH = [0.16], [0.0]
"""Between the hips [m], and the torso's pitch [rad]; of the robot and its gait."""


def law(run: FamilyRun, pendulum: Pendulum) -> Any:
    """Return torques of stance and swing leg for many robots, and what was measured."""
    robot = run.robot

    def equations(found: Measured, since: Any, first: Any) -> Any:
        q, dq = found.joints, found.rates
        z = measured_state(robot, found)

        def moving(angles: Any) -> Any:
            links = links_of(robot, pose_of_joints(robot, angles))
            rows = jacobians_of(links, pose_of_joints(robot, angles))
            centre = jnp.sum(robot.masses[:, None] * links.centres, axis=0) / robot.mass
            return motion_of_rates(robot, links, rows, dq), hips_of(robot, angles)[0], centre

        (_, _, centre), (drift, hip_rate, centre_rate) = jax.jvp(moving, (q,), (dq,))
        pose = pose_of_joints(robot, q)
        links = links_of(robot, pose)
        rows = jacobians_of(links, pose)
        mass = mass_matrix(robot, links, rows)
        bias = generalised(robot, rows, drift.linear + (robot.gravity * UP)[None], drift.spin)
        pulled = robot.mass * robot.gravity * centre[:2]
        rates = (jnp.concatenate([hip_rate[:2], pulled]), centre_rate[:2], jnp.ones(()))

        def desired(state: Any, middle: Any, time: Any) -> Any:
            told = outputs_at(pendulum, state, middle, time, first)
            return joints_of_pose(robot, pose_of_outputs(robot, state[:2], told))[2:]

        here = (z, centre[:2], since)
        wished, rate = jax.jvp(desired, here, rates)
        errors, slips = q[2:] - wished, dq[2:] - rate
        wanted = -2.0 * DAMPING * STIFFNESS * slips - STIFFNESS**2 * errors
        left = jnp.concatenate([mass[:2], jnp.eye(8)[2:]])
        right = jnp.concatenate([-bias[:2], wanted])
        hip = pose.hips[1]
        return left, right, mass, bias, errors, pose.feet[1] - hip + jnp.array([0.0, 0.0, 0.0])

    compiled = quick_jit(jax.vmap(equations))

    def torques(found: Measured, memory: Memory) -> Any:
        left, right, mass, bias, errors, swing = map(np.asarray, compiled(found, *memory))
        accelerations = np.linalg.solve(left, right[..., None])
        return (mass @ accelerations)[..., 2:, 0] + bias[..., 2:], errors, swing

    return torques


class Row(NamedTuple):
    """Walks that took all steps, of how many, their mean speed and cost of transport."""

    walked: int
    walks: int
    speed: float
    cost: float


def walked(run: FamilyRun, plan: WalkPlan) -> Row:
    """Walk by foot placement, from the starts of the trained gait."""
    pendulum = pendulum_of(run)
    WIDTH[0], PITCH[0] = run.robot.hip_width, float(run.controller.policy.pitch[0])
    control, count = law(run, pendulum), len(plan.starts)
    plants = SpatialPlants.started(run.data, run.controller, plan.starts, plan.changes, plan.seed)
    late, push = DelayLine(plan.changes.delay_ticks, count, 6), Push(0.0, plan.steps, 0, count)
    taken, fell, since = np.zeros(count, int), np.zeros(count, bool), np.zeros(count)
    first, work, now = np.zeros((count, 3)), 0.0, 0.0
    _, _, swing = control(plants.measured(), Memory(since, first))
    first = _from_floor(plants, swing)
    while (moving := ~fell & (taken < plan.steps)).any():
        touch = moving & plants.landed() & (since > 0.6 * pendulum.period)
        plants.left ^= touch
        taken += touch
        since = np.where(touch, 0.0, since + TICK_S)
        if touch.any():
            _, _, swing = control(plants.measured(), Memory(since, first))
            first = np.where(touch[:, None], _from_floor(plants, swing), first)
        moving &= taken < plan.steps
        asked, _, _ = control(plants.measured(), Memory(since, first))
        lost = ~np.isfinite(asked).all(axis=1) | (since > 3.0 * pendulum.period)
        fell |= moving & lost
        plants.advance_floors(touch, since - 0.5 * pendulum.period)
        own, force = late.due(plants.own(asked)), push.at(now, touch, taken)
        for one in map(int, np.flatnonzero(moving & ~lost)):
            plants.drive(one, own[one], force[one] * np.array([1.0, 0.0]))
            world = plants.worlds[one]
            work += TICK_S * float(np.abs(world.qfrc_actuator[5:] * world.qvel[5:]).sum())
            fell[one] = plants.fallen(one)
        now += TICK_S
    way = sum(float(world.qpos[0]) for world in plants.worlds) - float(plants.first.sum())
    cost = work / (run.robot.mass * run.robot.gravity * max(way, 1e-9))
    return Row(int(np.sum(~fell)), count, way / float(plants.times().sum()), cost)


def _from_floor(plants: SpatialPlants, swing: Any) -> Any:
    """Return the swing foot from its hip, its height above the stance foot in place of the last."""
    stance = plants.left.astype(int)
    places = [plants.foot_places(foot) for foot in (stance, 1 - stance)]
    return np.column_stack([swing[:, :2], places[1][:, 2] - places[0][:, 2]])


def trained(run: FamilyRun, plan: WalkPlan) -> Row:
    """Walk by the trained gait."""
    robot, work = run.robot, []
    drive = SpatialPlants.drive

    def measured(plants: SpatialPlants, one: int, own: Any, push: Any) -> None:
        drive(plants, one, own, push)
        world = plants.worlds[one]
        work.append(TICK_S * float(np.abs(world.qfrc_actuator[5:] * world.qvel[5:]).sum()))

    with patch.object(SpatialPlants, "drive", measured):
        done = simulate_walks(run, plan)
    way = done.speed_m_s * len(work) * TICK_S
    cost = sum(work) / (robot.mass * robot.gravity * max(way, 1e-9))
    return Row(done.walked, done.episodes, done.speed_m_s, cost)


def main() -> None:
    """Print a row of each case, foot placement beside the trained gait under `pd`."""
    run, count = open_family_run(SYSTEM, os.environ["RUN"]), whole("WALKS", 20)
    for case in CASES:
        plan = WalkPlan(
            controller="pd",
            starts=starts_of(run.controller, count, 0),
            steps=STEPS,
            step_s=run.summary.step_s,
            changes=changes_of(case or None, None),
        )
        rows = {"foot placement": walked(run, plan), "trained, pd": trained(run, plan)}
        words = (
            f"{name}: {row.walked} of {row.walks}, {row.speed:.2f} m/s, cost {row.cost:.3f}"
            for name, row in rows.items()
        )
        show(case or "undisturbed", "; ".join(words))


if __name__ == "__main__":
    main()
