"""A family of gaits around the shipped one, told what moves it a little: no training."""

from pathlib import Path

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits.analysis.run import Run, open_run
from neuralgaits.barriers import specs
from neuralgaits.gait import HybridInvariantPolicy
from neuralgaits.gait.commands import Command
from neuralgaits.gait.policies.commanded import CommandedPolicy
from neuralgaits.gait.policies.commanded_gait import CommandedGait
from neuralgaits.gait.tubes import CommandedTube
from neuralgaits.records.training_config import Range, TrainingConfig
from neuralgaits.runs import RunFolder
from neuralgaits.runs.latest import finish
from neuralgaits.runs.names import ROBOT, SPEC, WEIGHTS
from support.shipped_run import SHIPPED

SPEED = Command("speed", 0.60, 0.62, 0.01)
MOVED = 0.0003
"""How far the guard moves from the middle of the range to its end [m]."""
LEANS = Command("lean", -0.012, 0.012, 0.0048)


def family_of(run: Run, *commands: Command) -> CommandedGait:
    """The run's gait, with a guard that moves with the speed; that of a lean does not.

    Without commands it takes SPEED. A speed comes first.
    """
    commands = commands or (SPEED,)
    plain = run.gait
    policy = plain.policy
    assert isinstance(policy, HybridInvariantPolicy)
    share = (policy.guard_outputs - policy.lower) / (policy.upper - policy.lower)
    family = CommandedPolicy.init(run.robot, commands, key=jax.random.key(0))
    weights = policy.network.weights
    first = np.hstack([weights[0], np.zeros((len(weights[0]), 2 * len(commands)))])
    zeros = np.zeros_like(family.guard_outputs)
    outputs, slopes, z1 = zeros.copy(), zeros.copy(), np.zeros(len(zeros))
    outputs[0], slopes[0] = np.log(share / (1.0 - share)), policy.guard_slopes
    z1[:2] = float(policy.z_guard), MOVED if commands[0] == SPEED else 0.0
    family = eqx.tree_at(
        lambda p: (p.network, p.guard_outputs, p.guard_slopes, p.guard_z1),
        family,
        (
            type(policy.network)((first, *weights[1:]), policy.network.biases, "tanh"),
            *(outputs, slopes, z1),
        ),
    )
    scales = (policy.lower, policy.upper, policy.input_scale, policy.input_shift)
    family = eqx.tree_at(lambda p: (p.lower, p.upper, p.input_scale, p.input_shift), family, scales)
    return CommandedGait(family, CommandedTube.around(plain.tube, commands))


def make(place: Path, *commands: Command) -> Run:
    """A finished run of it in a new folder."""
    shipped, commands = open_run(SHIPPED), commands or (SPEED,)
    spec = specs.commanded(shipped.robot, commands)
    asked = TrainingConfig(
        robot=shipped.robot.name,
        spec="walking",
        seed=0,
        init="posture",
        hidden=(32, 32),
        steps=1,
        described=spec.describe(),
        not_provable_because=None,
        commands={c.name: Range(c.low, c.high, c.largest_change) for c in commands},
    )
    copies = {ROBOT: shipped.robot.layout.xml, SPEC: (SHIPPED / SPEC).read_text()}
    folder = RunFolder.create(
        asked, copies, name=shipped.robot.name, seed=0, root=place.parent, out=place
    )
    gait = family_of(shipped, *commands)
    gait = jax.tree.map(lambda leaf: np.asarray(leaf, np.float64), gait)
    folder.write_tree(WEIGHTS, gait)
    finish(folder, {}, place.parent)
    return open_run(place)


def at(*numbers: float) -> jnp.ndarray:
    """A chart point."""
    return jnp.array(numbers)
