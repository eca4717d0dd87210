"""The default spec for a gait with commands: the walk of `walking`, over their whole range.

Conditions are those of the plain gait, at every pair of commands that may follow each other.
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

import equinox as eqx
import numpy as np
from jaxtyping import PRNGKeyArray

from neuralgaits.barriers.aims import AbstractAim, MeanSpeed, MiddleFollowed, MiddleReturns
from neuralgaits.barriers.conditions import FencesApart
from neuralgaits.barriers.regions import Box
from neuralgaits.barriers.spec import GaitSpec, Init, Recipe
from neuralgaits.barriers.walking import RESETS, pendulum_height, start_tube, walking
from neuralgaits.gait import walking_posture
from neuralgaits.gait.command_polynomials import factors
from neuralgaits.gait.commands import LEAN, SLOPE, Command, Commands, command_named
from neuralgaits.gait.gaits import Gait
from neuralgaits.gait.policies.commanded import CommandedPolicy
from neuralgaits.gait.policies.commanded_gait import CommandedGait
from neuralgaits.gait.reach import refuse_speed, refuse_unreachable
from neuralgaits.gait.tubes import CommandedTube, Tube
from neuralgaits.robots.mjcf.parameters import axes_of

if TYPE_CHECKING:
    from neuralgaits.robots import PlanarBiped

SPEED_CHANGE = 0.12
"""Largest change of speed a step, as a share of its range: a return map that contracts by 0.7 lets
a tube follow a change of about 0.4 of its width a step."""
START_WIDTH = 0.17
"""Half width of the first tube, in shares of the speed."""
SIDES = (-1.0, 1.0)
"""Signs of that half width on the lower and the upper fence."""
MIDDLE = Box((0.0, 0.5), (1.0, 0.5))
"""Rows at which aims are evaluated: any will do, since an aim reads the whole middle."""
SLOWEST = 0.4
"""Least rate of z1 anywhere in a tube, as a share of the lowest requested mean speed."""


class CommandTraining(NamedTuple):
    """Requirements of one command on the training.

    Attributes:
        weights: weights of conditions that give way first; for several commands, the last one's.
        effort: effort of the recipe; for several commands, the least.
        steps: gradient steps; for several commands, the most.
    """

    weights: Mapping[str, float] = MappingProxyType({})
    effort: float = 0.3
    steps: int = 5000


# Tubes that are to fit many speeds give way at a lower fence that falls to zero; those that
# are to take little torque, at all fences.
_MANY_SPEEDS = CommandTraining(
    {
        "forward": 5.0,
        "flow-above-lower-fence": 3.0,
        "flow-below-upper-fence": 2.0,
        "tube-width": 2.0,
        **dict.fromkeys(RESETS, 3.0),
    },
    effort=4.0,
    steps=6500,
)
COMMAND_TRAINING = {
    "speed": _MANY_SPEEDS,
    # A belief that is off by a centimetre is off by a tenth of the speed.
    LEAN: _MANY_SPEEDS,
    # Where any foothold may follow any, the reset gives way, and a foot that leaves the longest and
    # highest step for the shortest does not rise.
    "step_length": CommandTraining(dict.fromkeys((*RESETS, "foot-rises"), 2.0)),
}

Interval = tuple[float, float]
"""Lower and upper end of a range."""
_LARGEST_CHANGES = {"speed": SPEED_CHANGE, "slope": SPEED_CHANGE}
"""Largest changes as shares of the range; footholds may follow each other freely."""
LEAN_ERROR = 3e-3
"""How far the torso may be from the belief [m]: AMBER-3M walks 0.027 m/s faster or slower then."""


def commands_of(**ranges: Interval | None) -> Commands:
    """Create commands of this package with their usual largest changes.

    Speed and lean, in one gait, change half as fast: a tube has to follow both at once. But a lean
    crosses its range in 13 steps or fewer, since a robot whose torso moves may stall meanwhile.

    Args:
        ranges: ranges by name; those that are None are left out.
    """
    given_ranges = {name: ends for name, ends in ranges.items() if ends is not None}
    both = {"speed", LEAN} <= given_ranges.keys()
    commands = []
    for name, (low, high) in given_ranges.items():
        width = abs(high - low)
        most = _largest_change(name, width)
        if both and name == "speed":
            most = 0.5 * most
        elif both and name == LEAN:
            crossed = 0.08  # Least share of the range that a believed lean may change a step.
            most = min(most, max(0.5 * most, crossed * width))
        # Few digits: it stands, exactly, in statements that people read.
        commands.append(Command(name, low, high, float(f"{most:.6g}") or None))
    return tuple(commands)


def _largest_change(name: str, width: float) -> float:
    """Return the largest change of a command with such a range; 0 where any may follow any."""
    if name == LEAN:
        # Largest change of a believed lean a step, or half its range if that is less [m]: for
        # AMBER-3M it asks of a tube what a change of speed by 0.042 m/s does.
        lean_change = 4.8e-3
        return min(lean_change, 0.5 * width)
    return _LARGEST_CHANGES.get(name, 0.0) * width


def commanded(
    robot: "PlanarBiped",
    commands: Commands,
    *,
    z2_dependence: bool = True,
    speed: float | None = None,
    lean_error: float = LEAN_ERROR,
) -> GaitSpec:
    """Return the default specification of a gait that takes `commands`.

    One that takes a lean is for every robot whose lean is near the one that it is told, and knows
    z1 alone: z2 follows from masses that it only believes in.

    Args:
        robot: robot with knees.
        commands: commands of the family, at least one.
        z2_dependence: as in `CommandedPolicy`.
        speed: mean speed to aim at where none is commanded (m/s); None for any.
        lean_error: how far the robot's lean may be from the one that it is told (m).

    Raises: SpecError if a range has steps that the robot cannot take at all.
    """
    refuse_unreachable(robot, commands)
    if speed is not None:
        refuse_speed(robot, speed)
    leans = command_named(commands, LEAN) is not None
    z2_dependence = z2_dependence and not leans
    told = {} if speed is None else {"speed": speed}
    lowest = {command.name: command.low for command in commands} | told
    shortest = 0.9  # As a share of the shortest step requested: footholds are met exactly.
    plain = walking(
        robot,
        forward=SLOWEST * lowest["speed"] if "speed" in lowest else None,
        shortest=shortest * lowest["step_length"] if "step_length" in lowest else None,
        highest=_highest(commands),
    )
    aims = _middle_aims()
    if "speed" in lowest:
        aims = (*aims, MeanSpeed("mean-speed", "middle", 0.015, 0.015, speed))
    additions = [COMMAND_TRAINING.get(command.name, CommandTraining()) for command in commands]
    weights = {name: value for one in additions for name, value in one.weights.items()}
    if leans and command_named(commands, SLOPE) is not None:
        weights["torso-lower"] = 3.0  # With less it is violated: seeds 0, 1, 2.
    apart = 0.1  # Scale of the fences' distance from zero and from each other [unit of zeta].
    return replace(
        plain.with_conditions(FencesApart("fences-apart", "fence-lower", apart)),
        regions=dict(plain.regions) | {"middle": (MIDDLE,)},
        new_gait=partial(_new_gait, robot, commands, speed, z2_dependence=z2_dependence),
        recipe=_recipe(plain.recipe, additions),
        commands=commands,
        aims=aims,
        weights=dict(plain.weights) | weights,
        parameters=axes_of(robot, {LEAN: lean_error}) if leans else (),
    )


def _recipe(plain: Recipe, additions: list[CommandTraining]) -> Recipe:
    """Return how a family is trained, from how a single gait is, and what its commands ask for."""
    samples = {name: 2 * count for name, count in plain.samples.items()}
    # With twice the samples: a violation missed there is missed next to the start of a step, where
    # the network has no effect.
    fences = ("fence-lower", "fence-upper")
    return replace(
        plain,
        steps=max(one.steps for one in additions),
        samples=samples | {"middle": 24} | {name: 2 * samples[name] for name in fences},
        learning_rate=3e-3,
        effort=min(one.effort for one in additions),
        curriculum=0.5,
        corners=0.35,
        worst_weight=0.3,
        widened=0.1,
        faster_changes=0.3,
        largest_gradient=5.0,
    )


def _highest(commands: Commands) -> float:
    """Return the largest difference in height of two successive footholds (m)."""
    height = command_named(commands, "step_height")
    return 0.0 if height is None else max(-height.low, height.high)


def at_speed(robot: "PlanarBiped", speed: float) -> GaitSpec:
    """Return the default specification of a gait that walks at one mean speed.

    Args:
        robot: robot with knees.
        speed: mean, over a step (m/s).

    Raises: SpecError if no robot with these legs walks so fast.
    """
    refuse_speed(robot, speed)
    plain = walking(robot, forward=SLOWEST * speed)
    recipe = replace(plain.recipe, samples=dict(plain.recipe.samples) | {"middle": 1})
    return replace(
        plain,
        regions=dict(plain.regions) | {"middle": (MIDDLE,)},
        new_gait=partial(_new_gait_at, robot, speed),
        recipe=recipe,
        aims=(*_middle_aims(), MeanSpeed("mean-speed", "middle", 0.015, 0.015, speed)),
    )


def _middle_aims() -> tuple[AbstractAim, ...]:
    """Return the aims that keep the orbit, and so its speed, in the middle of its tube."""
    return (
        MiddleFollowed("middle-followed", "middle", 0.12, 0.12),
        MiddleReturns("middle-returns", "middle", 0.03, 0.03),
    )


def _new_gait_at(
    robot: "PlanarBiped",
    speed: float,
    key: PRNGKeyArray,
    init: Init,
    hidden: tuple[int, ...] | None,
) -> Gait:
    gait = walking(robot).new_gait(key, init, hidden)
    assert isinstance(gait, Gait)
    return Gait(gait.policy, _tube_at(robot, gait.tube, speed))


def _tube_at(robot: "PlanarBiped", tube: Tube, speed: float) -> Tube:
    """Return a tube around the walks of a linear inverted pendulum at a mean speed (m/s)."""
    lower, upper = np.array(tube.lower), np.array(tube.upper)
    lower[0], upper[0] = (_energy(robot, side, speed**2) for side in SIDES)
    return eqx.tree_at(lambda t: (t.lower, t.upper), tube, (lower, upper))


def _new_gait(
    robot: "PlanarBiped",
    commands: Commands,
    speed: float | None,
    key: PRNGKeyArray,
    init: Init,
    hidden: tuple[int, ...] | None,
    *,
    z2_dependence: bool,
) -> CommandedGait:
    policy = CommandedPolicy.init(
        robot, commands, key=key, hidden=hidden or (32, 32), z2_dependence=z2_dependence
    )
    if init == "random":
        full = 10.0 * policy.network.weights[-1]
        policy = eqx.tree_at(
            lambda p: p.network.weights, policy, (*policy.network.weights[:-1], full)
        )
    guard = walking_posture(robot).z_guard
    first = start_tube(robot, None, (-guard, guard))
    if speed is not None:
        first = _tube_at(robot, first, speed)
    tube = CommandedTube.around(first, commands)
    for i, command in enumerate(commands):
        if command.name == "speed":
            tube = _faster(robot, tube, i, command)
    return CommandedGait(policy, tube)


def _faster(robot: "PlanarBiped", tube: CommandedTube, i: int, command: Command) -> CommandedTube:
    """Return fences of a linear inverted pendulum whose mean speed is about the commanded one."""
    middle, half = command.middle, command.half
    terms = factors(len(tube.commands))
    series = []
    for side, fence in zip(SIDES, (tube.lower, tube.upper), strict=True):
        share, new = (1.0 + side * START_WIDTH) ** 2, np.array(fence)
        new[0, 0] = _energy(robot, side, middle**2)
        new[terms.index((i,)), 0] = share * 2.0 * middle * half
        new[terms.index((i, i)), 0] = share * half**2
        series.append(new)
    return eqx.tree_at(lambda t: (t.lower, t.upper), tube, tuple(series))


def _energy(robot: "PlanarBiped", side: float, mean_square: float) -> float:
    """Coefficient of T_0 of a fence around a walk with this mean squared speed (m^2/s^2).

    A parabola is its energy plus (g/h) z1^2: a third of that at the guard in the mean, half in T_0.
    """
    guard = walking_posture(robot).z_guard
    swung = float(robot.gravity) / pendulum_height(robot) * guard**2
    return (1.0 + side * START_WIDTH) ** 2 * mean_square - swung / 3.0 + 0.5 * swung
