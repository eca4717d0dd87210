"""A gait in three dimensions beyond what tests look at: its model, its margins, its steps.

The model against MuJoCo's floating base at random states of three robots: the one that is shipped
and two with other masses, lengths and widths; the same of the forces, torques and impacts of random
states of the zero dynamics. Margins at many fresh points of each region. Steps
of the reduced hybrid dynamics, integrated, from random states on the face of the tube.

STATES=100 compares fewer states, POINTS=10000 samples fewer points, STARTS=100 fewer starts; RUN
names a run that is there.
"""

import os
from collections.abc import Callable
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
from common import ROOT, show, whole

from neuralgaits._quick_jit import quick_jit
from neuralgaits._types import Array
from neuralgaits.systems.family_run import FamilyRun, open_family_run
from neuralgaits.systems.family_training import train_family
from neuralgaits.systems.proof_model import trace_conditions
from neuralgaits.systems.walker3d.spatial_dynamics import loads
from neuralgaits.systems.walker3d.spatial_impact import impact, mirrored_rates
from neuralgaits.systems.walker3d.spatial_mjcf import SpatialRobot, read_spatial, spatial_text
from neuralgaits.systems.walker3d.spatial_motion import (
    angular_momentum,
    generalised,
    jacobians_of,
    mass_matrix,
    motion_of_rates,
)
from neuralgaits.systems.walker3d.spatial_pose import (
    Outputs,
    joints_of_pose,
    links_of,
    pose_of_joints,
)
from neuralgaits.systems.walker3d.spatial_step import step_from
from neuralgaits.systems.walker3d.spatial_system import SYSTEM
from neuralgaits.systems.walker3d.spatial_walker import SpatialWalker
from neuralgaits.systems.walker3d.tube_samples import sampled_margins
from support.spatial_base import SpatialBase

OTHERS = {
    "a heavy torso": (('mass="14"', 'mass="22"'), ('pos="0 0 0.2" mass', 'pos="0.02 0 0.26" mass')),
    "short and wide": (
        ("0 0 -0.4", "0 0 -0.33"),
        ('pos="0 -0.08 0"', 'pos="0 -0.11 0"'),
        ('pos="0 0.08 0"', 'pos="0 0.11 0"'),
        ('mass="4"', 'mass="3"'),
        ('armature="0.1"', 'armature="0.06"'),
    ),
}
"""Changes of the shipped file that make other robots."""
STEPS = 50
"""Steps from each start."""


def robots() -> dict[str, SpatialRobot]:
    """Return three robots by name."""
    text, name = spatial_text("walker3d")
    found = {name: read_spatial(text, name)}
    for other, changes in OTHERS.items():
        changed = text
        for old, new in changes:
            assert old in changed, old
            changed = changed.replace(old, new)
        found[other] = read_spatial(changed, other)
    return found


def largest_difference(robot: SpatialRobot, count: int) -> float:
    """Return the largest difference from MuJoCo of mass matrix, bias and momentum."""
    walker, base = robot.walker, SpatialBase.of(robot)

    def found(q, dq):
        def motion(angles):
            pose = pose_of_joints(walker, angles)
            links = links_of(walker, pose)
            rows = jacobians_of(links, pose)
            return motion_of_rates(walker, links, rows, dq), links, rows

        (now, links, rows), (rates, *_) = jax.jvp(motion, (q,), (dq,))
        lifted = rates.linear + jnp.array([[0.0, 0.0, walker.gravity]])
        bias = generalised(walker, rows, lifted, rates.spin)
        return mass_matrix(walker, links, rows), bias, angular_momentum(walker, links, now)

    draw = np.random.default_rng(7)
    q, dq = draw.uniform(-0.5, 0.5, (count, 8)), draw.normal(0.0, 2.0, (count, 8))
    q[:, [4, 7]] = draw.uniform(0.1, 1.2, (count, 2))
    rows = map(np.asarray, quick_jit(jax.vmap(found))(q, dq))
    largest = 0.0
    for angles, rates, mass, bias, momentum in zip(q, dq, *rows, strict=True):
        embedding = base.place(angles, rates)
        drift = np.concatenate([-base.drift(0), np.zeros(8)])
        for own, theirs in (
            (mass, embedding.T @ base.mass_matrix() @ embedding),
            (bias, embedding.T @ base.needed(drift)),
            (momentum, base.angular_momentum()),
        ):
            largest = max(largest, float(np.abs(own - theirs).max()))
    return largest


def outputs_of(robot: SpatialWalker) -> Callable[[Array], Outputs]:
    """Return outputs that depend on all of the state, of the size of a robot's steps."""
    size = robot.thigh.length + robot.shin.length
    momentum = robot.mass * size * np.sqrt(robot.gravity * size)

    def desired(z: Array) -> Outputs:
        x, y, forward, aside = z[0] / size, z[1] / size, z[2] / momentum, z[3] / momentum
        return Outputs(
            pitch=0.05 + 0.3 * x + 0.1 * forward,
            height=size * (0.89 + 0.2 * x * x + 0.05 * y),
            ahead=size * (0.9 * x + 0.1 * (forward - 0.25)),
            aside=size * (0.02 + 0.4 * y + 0.3 * aside),
            lift=size * (0.05 - 0.1 * x + 0.1 * y * y),
        )

    return desired


def difference_of_forces(robot: SpatialRobot, count: int) -> tuple[float, float]:
    """Return the largest differences from MuJoCo of forces and torques, and of the impact.

    Forces are in weights of the robot, torques in weights times a leg's length, rates after the
    impact in rad/s, impulses in kg m/s for each kg.
    """
    walker, base = robot.walker, SpatialBase.of(robot)
    size = walker.thigh.length + walker.shin.length
    weight = walker.mass * walker.gravity
    momentum = walker.mass * size * np.sqrt(walker.gravity * size)
    desired, draw = outputs_of(walker), np.random.default_rng(8)
    low = np.array([-0.13 * size, -0.04 * size, 0.2 * momentum, -0.07 * momentum])
    high = np.array([0.13 * size, 0.04 * size, 0.3 * momentum, 0.07 * momentum])

    def found(z: Array) -> tuple[Array, ...]:
        now, needed = loads(walker, desired, z)
        after = impact(walker, now.pose, now.motion, now.joints)
        angles = joints_of_pose(walker, now.pose)
        own = needed.accelerations, needed.ground, needed.torques, after.rates, after.impulse
        return angles, now.joints, *own

    rows = quick_jit(jax.vmap(found))(draw.uniform(low, high, (count, 4)))
    largest, hardest, flip = 0.0, 0.0, np.array([1.0, -1.0, 1.0])
    for q, dq, changes, ground, torques, rates, impulse in zip(*map(np.asarray, rows), strict=True):
        embedding = base.place(q, dq)
        forces = base.needed(embedding @ changes - np.pad(base.drift(0), (0, 8)))
        moved = forces - base.jacobian(0).T @ forces[:3]
        off = np.abs(ground - forces[:3]).max(), np.abs(torques - moved[5:]).max() / size
        largest = max(largest, *(float(one) / weight for one in off))
        # A plastic impact of the other foot, by MuJoCo's mass matrix and Jacobian.
        mass, jacobian = base.mass_matrix(), base.jacobian(1)
        system = np.block([[mass, -jacobian.T], [jacobian, np.zeros((3, 3))]])
        after = np.linalg.solve(system, np.concatenate([mass @ base.data.qvel, np.zeros(3)]))
        turned = np.asarray(mirrored_rates(jnp.asarray(after[3:11])))
        off = np.abs(rates - turned).max(), np.abs(impulse - flip * after[11:]).max() / walker.mass
        hardest = max(hardest, *map(float, off))
    return largest, hardest


def leaves(run: FamilyRun, count: int) -> int:
    """Return how many of many walks on the zero dynamics leave the tube at a grid of phases."""
    gait = run.controller
    w = np.random.default_rng(3).standard_normal((count, 3))
    states = gait.starts(w / np.linalg.norm(w, axis=1, keepdims=True))[:, 1:]
    phases = np.linspace(0.0, 1.0, 25)
    centres, axes = gait.tube.sections(phases)

    def one(start):
        step = step_from(run.robot, gait.policy, start)
        return step.states[:, 1:], step.landed[1:]

    step, out = quick_jit(jax.vmap(one)), np.zeros(count, bool)
    for _ in range(STEPS):
        ways, states = map(np.asarray, step(states))
        inside = np.linalg.solve(axes, (ways - centres)[..., None])[..., 0]
        # Starts are on the face: they have length 1 but for rounding.
        out |= ~(np.linalg.norm(inside, axis=2).max(axis=1) <= 1.0 + 1e-9)
    return int(out.sum())


def main() -> None:
    """Print the table."""
    states, points = whole("STATES", 1000), whole("POINTS", 10**6)
    for name, robot in robots().items():
        show(f"{name}: largest difference", f"{largest_difference(robot, states):.1e}", "1e-10")
        forces, hard = difference_of_forces(robot, states)
        show(f"{name}: forces and torques, in weights", f"{forces:.1e}", "1e-10")
        show(f"{name}: impact, rates and impulse a kg", f"{hard:.1e}", "1e-10")
    folder = os.environ.get("RUN")
    if folder is None:
        folder = str(ROOT / "walker3d")
        if not os.path.isdir(folder):
            train_family(SYSTEM, "walker3d", SYSTEM.new_config(), out=Path(folder), root=ROOT)
    run = open_family_run(SYSTEM, folder)
    margins = sampled_margins(trace_conditions(run), points, seed=2**31 + 1, table=run.table)
    for name, found in margins.items():
        show(f"{name}: smallest margin of {points}", f"{found:.4g}", "above 0")
    starts = whole("STARTS", 10**4)
    show(f"of {starts} starts leave the tube in {STEPS} steps", str(leaves(run, starts)), "0")


if __name__ == "__main__":
    main()
