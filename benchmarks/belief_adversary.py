"""The worst admissible belief at every touchdown: walks of the rigid model under an adversary.

The adversary knows the robot and its state. At each touchdown it looks one step ahead at the ends
of what it may tell next, of every command: within the gait's range and its largest change, and for
the lean within the trained distance of the robot's own. It tells whatever leaves the state nearest
to a fence. Walks are of the projected zero dynamics (rigid links, outputs zero) from random states
of the tube, by fourth-order steps of the phase. They are simulations, whatever is proved.

Then robots of the same leans walk in MuJoCo, told what the adversary told them in the rigid model:
the first IN_MUJOCO of the walks, from random states of the region, under each of LAWS.

Asked: of 1000 walks of 50 steps none leaves the tube. RUN is a run of a gait that takes a lean;
WALKS and STEPS choose other numbers.
"""

import itertools
import os
import time
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from common import show, whole

from neuralgaits._types import Array, Bool, Float, Scalar
from neuralgaits.analysis.run import Run, open_run
from neuralgaits.barriers import GaitSpec
from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.believed_robot import robot_of_step
from neuralgaits.gait.commands import LEAN, CommandLimits, Pair, place_of
from neuralgaits.gait.policies.commanded_gait import CommandedGait
from neuralgaits.gait.runge_kutta import RK4, step
from neuralgaits.robots.mjcf.parameters import model_of, nominal_robot
from neuralgaits.simulation.setup.command_schedule import CommandSchedule
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.simulation.trained_walks import TrainedWalks, at_first, walk_engine_for

WALKS, STEPS = whole("WALKS", 1000), whole("STEPS", 50)
IN_MUJOCO, LAWS = whole("IN_MUJOCO", 1000), os.environ.get("LAWS", "pd,fblin").split(",")
NODES = 16
"""Fourth-order steps in a step: levels are then right to 1e-6."""


class Walkers(NamedTuple):
    """Robots between two steps. [N] each."""

    z2: Float[Array, " N"]
    """Momentum after the last touchdown [kg m^2/s]."""
    told: Float[Array, "N p"]
    """Commands of the step that ended."""
    true: Float[Array, " N"]
    """The robot's own lean [m]."""
    least: Float[Array, " N"]
    """Least distance from a fence so far, in tube widths; negative once it has left the tube."""


def stride_of(run: Run, gait: CommandedGait):
    """Return a function of (z2, before, after, lean) to z2 and level after the step, and least."""
    model = model_of(run.robot, run.spec.parameters)
    place = place_of(gait.commands, LEAN)

    def stride(z2, before, after, true):
        one = gait.of_pair(nominal_robot(model), Pair(before, after), run.residuals.reset)
        error = jnp.stack([true - after[place]])
        zd = ZeroDynamics(robot_of_step(model, one, error), one.policy, *run.residuals)
        start, guard = one.span

        def z_at(phase: Scalar, momentum: Scalar):
            return jnp.stack([start + phase * (guard - start), momentum])

        def rate(y):
            dz = zd.point(z_at(*y)).dz
            return jnp.stack([jnp.ones(()), dz[1] * (guard - start) / dz[0]])

        def node(y, _):
            after_node = step(RK4, rate, y, jnp.asarray(1.0 / NODES))
            level = one.level(z_at(*after_node))
            return after_node, jnp.minimum(level, 1.0 - level)

        ended, rooms = jax.lax.scan(node, jnp.stack([jnp.zeros(()), z2]), None, length=NODES)
        z_after = zd.point(z_at(*ended)).z_after
        level = one.steady_next.level(z_after)
        room = jnp.minimum(level, 1.0 - level)
        # What turns to NaN has left, too.
        least = jnp.nan_to_num(jnp.minimum(rooms.min(), room), nan=-jnp.inf)
        return z_after[1], room, least

    return stride


def admissible(
    spec: GaitSpec, told: Float[np.ndarray, "N p"], true: Float[np.ndarray, " N"]
) -> Float[np.ndarray, "C N p"]:
    """Return the ends of what may be told next, in all combinations."""
    limits, near = CommandLimits.of(spec.commands), spec.parameters[0].half
    low = np.maximum(limits.low, told - limits.change)
    high = np.minimum(limits.high, told + limits.change)
    place = place_of(spec.commands, LEAN)
    low[:, place] = np.maximum(low[:, place], true - near)
    high[:, place] = np.minimum(high[:, place], true + near)
    ways = itertools.product(*([(low, high)] * told.shape[1]))
    return np.stack([np.stack([end[:, k] for k, end in enumerate(ends)], 1) for ends in ways])


def start(run: Run, gait: CommandedGait, draw: np.random.Generator) -> Walkers:
    """Return robots with random leans, commands and states at the start of a step."""
    commands, near = gait.commands, run.spec.parameters[0].half
    limits, place = CommandLimits.of(commands), place_of(commands, LEAN)
    told = draw.uniform(limits.low, limits.high, (WALKS, len(commands)))
    true = told[:, place] + draw.uniform(-near, near, WALKS)
    levels = draw.uniform(0.0, 1.0, WALKS)

    def at_start(command, level):
        one = gait.of_pair(run.robot, Pair(command, command))
        return one.z(jnp.stack([jnp.zeros(()), level]))[1]

    z2 = jax.jit(jax.vmap(at_start))(told, levels)
    return Walkers(z2, told, true, np.full(WALKS, np.inf))


def main() -> None:
    """Walk, and print what came of it."""
    run = open_run(os.environ["RUN"])
    gait = run.trained
    assert isinstance(gait, CommandedGait)
    stride = jax.jit(jax.vmap(jax.vmap(stride_of(run, gait)), (None, None, 0, None)))
    walkers = start(run, gait, np.random.default_rng(0))
    begun, worst, told = time.process_time(), [], [walkers.told]
    for _ in range(STEPS):
        options = admissible(run.spec, np.asarray(walkers.told), np.asarray(walkers.true))
        z2, room, least = (np.asarray(one) for one in stride(*walkers[:2], options, walkers.true))
        chosen: Bool[np.ndarray, " N"] = np.argmin(np.minimum(room, least), axis=0)
        rows = chosen, np.arange(WALKS)
        worst.append(float(least[rows].min()))
        walkers = Walkers(
            z2[rows], options[rows], walkers.true, np.minimum(walkers.least, least[rows])
        )
        told.append(walkers.told)
    left = int(np.count_nonzero(~(np.asarray(walkers.least) >= 0.0)))
    show(f"walks of {STEPS} steps under the worst belief that leave the tube", left, "0")
    show("of walks", WALKS)
    show("least distance from a fence, in tube widths", float(np.min(walkers.least)), ">= 0")
    show("the same in the last ten steps", min(worst[-10:]))
    show("processor time [s]", time.process_time() - begun)
    sequences = np.stack(told, axis=1)[:IN_MUJOCO]
    for law in LAWS:
        fell = falls_in_mujoco(run, law, sequences, np.asarray(walkers.true))
        show(f"the same under {law} in MuJoCo: falls of {len(sequences)}", fell)


def falls_in_mujoco(
    run: Run, law: str, sequences: Float[np.ndarray, "M k p"], true: Float[np.ndarray, " N"]
) -> int:
    """Walk robots with these leans (m) in MuJoCo, told these commands; return how many fell."""
    library, fell = walk_engine_for(run, law, None).library, 0
    for number, (told, lean) in enumerate(zip(sequences, true, strict=False)):
        walked = TrainedWalks(
            run=at_first(run, told[0]),
            library=library,
            plant=None,
            controller=law,
            steps=STEPS,
            start="region",
            push=0.0,
            disturbance=PlantChanges(torso_shift_m=float(lean)),
            seed=0,
            schedule=CommandSchedule(run.trained.commands, told[0], told[1:]),
            threads=1,
        ).walk(number, 1)
        fell += sum(ending.fell for ending in walked.episodes.endings)
    return fell


if __name__ == "__main__":
    main()
