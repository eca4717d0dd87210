"""Walks of the zero dynamics that are told the same sequence of commands.

A command that repeats after p steps makes a walk that repeats after p steps: where any two walks
under the same commands converge, p steps are a contraction, and it has one fixed point.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Float
from neuralgaits.analysis.flow import FlowQuantities, Mesh, Quantity, swing
from neuralgaits.analysis.point_evaluator import PlaneChart
from neuralgaits.analysis.run import Run
from neuralgaits.errors import InputError
from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.commands import CommandLimits, Commands, Pair
from neuralgaits.gait.policies.commanded_gait import CommandedGait
from neuralgaits.gait.zero_coordinates import momenta_of
from neuralgaits.programs import POINT, evaluate, fold
from neuralgaits.programs.prune import prune
from neuralgaits.programs.tracing.tracer import trace

FlowByCommands = Callable[[Float[np.ndarray, " 2p"]], FlowQuantities]
"""Function from the commands of a step, those before and those after, to its flow."""


class CommandWalks(NamedTuple):
    """Walks that start between the fences and get the same commands. S steps, N walks."""

    commands: Float[np.ndarray, "S p"]
    """Commands of each step, in their units."""
    z2: Float[np.ndarray, "S+1 N"]
    """Momentum as each step begins, and as the step after the last would; NaN after a fall
    [kg m^2/s]."""
    paths: tuple[Float[np.ndarray, "T N 2"], ...]
    """States of each step from landing to landing (m, kg m^2/s)."""


def walks_under(run: Run, *sequences: Float[np.ndarray, "S p"]) -> tuple[CommandWalks, ...]:
    """Walk the zero dynamics from both fences of the tube.

    The step before the first has the commands of the first.

    Args:
        run: run of a gait that takes commands.
        sequences: commands of each step, in the commands' units.

    Returns: `CommandWalks` of each sequence.
    Raises: InputError for a gait without commands, or commands that it may not get.
    """
    family = run.trained
    if not isinstance(family, CommandedGait):
        raise InputError("expected a gait that takes commands, found one that takes none")
    for sequence in sequences:
        _refuse(CommandLimits.of(family.commands), sequence)
    flow_of = _flow_by_commands(run, family)
    return tuple(_walk_under(run, flow_of, sequence) for sequence in sequences)


def _walk_under(
    run: Run, flow_of: FlowByCommands, sequence: Float[np.ndarray, "S p"]
) -> CommandWalks:
    names = [command.name for command in run.trained.commands]
    first = run.at(**dict(zip(names, map(float, sequence[0]), strict=True)))
    chart = PlaneChart(first.gait, run.spec)
    nodes = 16  # Steps of the flow over a step of the robot: errors near 1e-8 of z2.
    mesh = Mesh.of_gait(chart.start, chart.guard, nodes)
    z, before = chart.z(np.zeros(2), np.array([0.0, 1.0])), sequence[0]
    momenta, paths = [momenta_of(z)], []
    with np.errstate(all="ignore"):
        for after in sequence:
            motion = flow_of(np.concatenate([before, after]))
            path = swing(motion, z, mesh).z
            z, before = motion.z_after(path[-1]), after
            momenta.append(momenta_of(z))
            paths.append(path)
    return CommandWalks(sequence, np.stack(momenta), tuple(paths))


def alternating(commands: Commands, steps: int) -> Float[np.ndarray, "S p"]:
    """Return two values of the first command in turn, as far apart as they may follow each other.

    They lie around the middle of its range; other commands stay in the middle of theirs.
    """
    limits = CommandLimits.of(commands)
    sequence = np.tile(limits.middle, (steps, 1))
    sequence[:, 0] += 0.5 * limits.change[0] * np.resize((-1.0, 1.0), steps)
    return sequence


def drawn(commands: Commands, steps: int, seed: int = 0) -> Float[np.ndarray, "S p"]:
    """Return a random value of the first command for each step, other commands as they are above.

    Each is drawn evenly from what may follow the one before.
    """
    limits, draws = CommandLimits.of(commands), np.random.default_rng(seed)
    sequence = np.tile(limits.middle, (steps, 1))
    low, high, change = limits.low[0], limits.high[0], limits.change[0]
    for row in range(1, steps):
        last = sequence[row - 1, 0]
        sequence[row, 0] = draws.uniform(max(low, last - change), min(high, last + change))
    return sequence


def _refuse(limits: CommandLimits, sequence: Float[np.ndarray, "S p"]) -> None:
    """Refuse commands out of their ranges, or that change too fast. Raises: InputError."""
    inside = np.all((sequence >= limits.low) & (sequence <= limits.high))
    # A change as large as allowed is no larger for being rounded.
    slow = np.all(np.abs(np.diff(sequence, axis=0)) <= limits.change * (1.0 + 1e-9))
    if (
        sequence.ndim != 2
        or sequence.shape[1] != len(limits.low)
        or not len(sequence)
        or not (inside and slow)
    ):
        raise InputError(
            f"commands: expected rows of {len(limits.low)} between {limits.low} and {limits.high} "
            f"that change by at most {limits.change} a step, found others"
        )


def _flow_by_commands(run: Run, family: CommandedGait) -> FlowByCommands:
    """Trace the flow once, with the commands of a step as its inputs."""
    count = len(family.commands)

    def named(z: Any, pair: Any) -> dict[str, Any]:
        commands = Pair(pair[:count], pair[count:])
        # As a proof has it: both ends of the step are within bounds, the foot on its foothold.
        policy = family.policy.at(
            run.robot, commands, run.residuals.reset, exact=True, bounded=True
        )
        point = ZeroDynamics(run.robot, policy, *run.residuals).point(z)
        foot = jnp.stack([point.foot[0], point.foot_above_ground])
        return {"dz": point.dz, "foot": foot, "z_after": point.z_after}

    whole = trace(named, {"z": (2,), "pair": (2 * count,)})
    programs = {name: prune(whole, [name]) for name in FlowQuantities._fields}
    folded = {name: fold(program, POINT) for name, program in programs.items()}

    def of_step(pair: np.ndarray) -> FlowQuantities:
        def function(name: str) -> Quantity:
            def values(z: np.ndarray) -> np.ndarray:
                inputs = {"z": z, "pair": np.broadcast_to(pair, (len(z), len(pair)))}
                return evaluate(programs[name], inputs, POINT, folded[name])[name]

            return values

        return FlowQuantities(*map(function, FlowQuantities._fields))

    return of_step
