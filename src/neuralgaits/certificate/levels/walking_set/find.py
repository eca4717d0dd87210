"""Find the walking set's ends in phase, and the phases of its premises, by evaluating points.

Its fences are the gait's own, which this file only reads: they were trained with the policy.
Nothing here is trusted: a bad choice makes a premise fail, not a false one hold.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from neuralgaits._digits import at_most
from neuralgaits.barriers import Barrier, DiscreteBarrier, GaitSpec, Pointwise
from neuralgaits.certificate.level_target import Evaluator, grid
from neuralgaits.certificate.levels.walking_set.theorem import OFF_THE_LINE, WalkingSetConstants
from neuralgaits.gait.commands import all_pairs

STRIPS = (1e-9, 1e-7, 1e-5, 1e-4, 3e-4, 1e-3, 3e-3, 6e-3, 0.01, 0.02, 0.03)
"""Half widths tried around the guard, in phases. A gait that meets the ground farther from phase 1
than the last one is not supported."""
CLEAR = 1e-12
"""Height that the foot must have before and behind the guard's strip [m]; it exceeds rounding
errors."""
FEW_PHASES, FEW_LEVELS = 61, 5
"""Numbers of phases and levels that are evaluated for each of many commands or robots."""
PAIRS = 5
"""Number of values of each command axis."""
ROOM = 1.2
"""Factor from values seen at points to the bounds that enclose constants."""
SHARE = 0.5
"""Share of its vertical speed at either end of the step that the foot must keep."""


def find_set(
    spec: GaitSpec,
    evaluate: Evaluator,
    disturbance: tuple[float, float] = (0.0, 0.0),
    floor: float = 0.0,
) -> WalkingSetConstants | str:
    """Return the walking set's parameters, or a sentence with the reason why there are none.

    For a gait with commands they are those of the worst pair that is evaluated.
    """
    command_names = tuple(command.name for command in spec.commands)
    count, levels = 241, np.linspace(0.0, 1.0, 33)
    if command_names:
        evaluate = over_all(spec, evaluate)
        count, levels = FEW_PHASES, np.linspace(0.0, 1.0, FEW_LEVELS)
    elif spec.parameters:
        evaluate, levels = over_all(spec, evaluate), np.linspace(0.0, 1.0, FEW_LEVELS)
    # Half widths tried where footholds may be higher or lower than meant, up to the chart's ends.
    wide_strips = (*STRIPS, *(0.001 * k for k in range(32, 100, 2)))
    widths = wide_strips if floor else STRIPS
    # With commands more than the spread of bounds over them [m].
    clear = 5e-5 if command_names else CLEAR
    strip = _guard_strip(evaluate, levels, floor * ROOM**0.5 + clear, widths)
    if strip is None:
        ground = f"heights within {floor:g} m of the ground" if floor else "the ground"
        return (
            f"the swing foot does not go through {ground} everywhere within {widths[-1]} phases of "
            "the guard"
        )
    guard = grid(np.linspace(1.0 - strip, 1.0 + strip, 5), levels)
    quantities = evaluate(guard)
    landed = np.abs(quantities["after"][:, 0]).max()
    stride = quantities["stride"]
    # Phases that a reset may land in per phase seen: 1.5, apart from the change of lengths.
    spread = 1.5 * stride.max() / stride.min() if command_names else 2.0
    # Three digits, since a statement gives the strip before a step exactly, for people to read.
    start_strip = float(at_most((ROOM if floor else spread) * landed + 1e-9, 3))
    if not start_strip < widths[-1]:
        return f"the reset lands up to {landed:.3g} phases from the start of a step"
    phases = np.linspace(0.0, 1.0, count)
    rate = evaluate(grid(phases, levels))["foot_rate"].reshape(count, -1)
    slowest, fastest = rate.min(axis=1), rate.max(axis=1)
    if slowest[0] <= 0.0 or fastest[-1] >= 0.0:
        return "the swing foot does not rise at the start of the step, or does not fall at its end"
    rising = slowest >= SHARE * slowest[0]
    falling = fastest <= SHARE * fastest[-1]
    risen = phases[np.argmin(rising) - 1]
    fall = phases[count - np.argmin(falling[::-1])]
    barriers, carried = names_of(spec)
    return WalkingSetConstants(
        start_strip=start_strip,
        guard_strip=strip,
        risen=float(risen),
        falling=float(fall),
        disturbance=disturbance,
        barriers=barriers,
        carried=carried,
        told=command_names,
        floor=floor,
    )


def names_of(spec: GaitSpec) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return names of the spec's barrier conditions, and of those carried over to the strips."""
    carried = Pointwise | Barrier | DiscreteBarrier
    return (
        tuple(c.name for c in spec.conditions if isinstance(c, Barrier)),
        tuple(c.name for c in spec.conditions if isinstance(c, carried)),
    )


def least_of_inlet(
    spec: GaitSpec, evaluate: Evaluator, constants: WalkingSetConstants
) -> Mapping[str, float]:
    """Return by output the least that its lower bound must be, so that the constants hold."""
    if not constants.told:
        return {
            "set/reset-phase": -constants.start_strip,
            **dict.fromkeys(OFF_THE_LINE, constants.floor),
        }
    over = over_all(spec, evaluate)
    quantities = over(
        grid(np.array([-constants.start_strip, 0.0, constants.start_strip]), np.zeros(1))
    )
    phases, levels = np.linspace(0.0, 1.0, FEW_PHASES), np.linspace(0.0, 1.0, FEW_LEVELS)
    pace = float(over(grid(phases, levels))["pace"].min())
    steep, stride = (
        ROOM * float(np.abs(quantities["steepness"]).max()),
        float(quantities["stride"].min()),
    )
    return {
        "set/forward": SHARE * pace,
        "set/stride": stride / ROOM**0.5,
        "set/reset-place": -constants.start_strip * stride / ROOM,
        "set/steepness": -steep,
        "set/inlet": ROOM * constants.start_strip * steep,
    }


def over_all(spec: GaitSpec, evaluate: Evaluator) -> Evaluator:
    """Return a function to evaluate (phase, level) for many commands and some robots of the box.

    The robots are the nominal one and some corners, each with all pairs of commands.
    """
    pairs, robots = all_pairs(spec.commands, PAIRS), np.zeros((1, len(spec.parameters)))
    if spec.parameters:
        halves = np.array([axis.half for axis in spec.parameters])
        most_corners = 8  # Number of corners of a box of robots that are evaluated.
        signs = np.random.default_rng(0).choice([-1.0, 1.0], (most_corners, len(halves)))
        # With few parameters many of them are one robot.
        robots = np.concatenate([robots, halves * np.unique(signs, axis=0)])
    both = np.hstack([np.repeat(pairs, len(robots), axis=0), np.tile(robots, (len(pairs), 1))])
    return _with_each(both, evaluate)


def _with_each(values: np.ndarray, evaluate: Evaluator) -> Evaluator:
    """Return a function to evaluate (phase, level) with each row of values of other axes [V, k]."""

    def over(u: np.ndarray) -> Mapping[str, np.ndarray]:
        rows = np.repeat(u, len(values), axis=0)
        rows = np.hstack([rows, np.tile(values, (len(u), 1))])
        at_once = 4096  # Points that are evaluated at once.
        parts = [evaluate(rows[i : i + at_once]) for i in range(0, len(rows), at_once)]
        return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}

    return over


def _guard_strip(
    evaluate: Evaluator, levels: np.ndarray, clear: float, widths: Sequence[float]
) -> float | None:
    """Return a strip around phase 1 with the foot above ground before it and below behind."""
    for number, width in enumerate(widths):
        above = evaluate(grid(np.array([1.0 - width]), levels))["foot"]
        below = evaluate(grid(np.array([1.0 + width]), levels))["foot"]
        if above.min() > clear and below.max() < -clear:
            # Before and behind: the next wider one has more room.
            return widths[min(number + 1, len(widths) - 1)]
    return None
