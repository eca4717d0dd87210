"""Margins of the conditions at random points of the tube, and what the motion takes there.

Samples, no proof. The Program that is proved is evaluated, so that no function is compiled.
"""

from collections.abc import Iterator, Mapping
from types import MappingProxyType

import numpy as np

from neuralgaits._types import Array, Float
from neuralgaits.programs import POINT, Program, evaluate, fold
from neuralgaits.programs.prune import prune
from neuralgaits.programs.tracing.tracer import trace
from neuralgaits.systems.condition_table import ConditionTable
from neuralgaits.systems.walker3d.spatial_dynamics import loads
from neuralgaits.systems.walker3d.spatial_gait import AbstractSpatialGait
from neuralgaits.systems.walker3d.spatial_impact import reset
from neuralgaits.systems.walker3d.spatial_walker import SpatialWalker


def sampled_margins(
    program: Program,
    count: int,
    seed: int,
    table: ConditionTable,
    names: Mapping[str, str] | None = None,
) -> dict[str, float]:
    """Return the smallest value of each output at random points of its region.

    Args:
        program: outputs of a point of the chart.
        count: points of each region; its boxes share them.
        seed: seed of the draw.
        table: regions, and conditions.
        names: outputs, with the region of each; the conditions if None.

    Returns: NaN for an output without a value somewhere.
    """
    names = table.conditions if names is None else names
    draw = np.random.default_rng(seed)
    least = dict.fromkeys(names, np.inf)
    for region, boxes in table.regions.items():
        here = [name for name, place in names.items() if place == region]
        if not here:
            continue
        own = prune(program, here)
        for low, high in boxes:
            points = _points(draw, np.array(low), np.array(high), -(-count // len(boxes)))
            values = _values(own, points)
            for name in here:
                # A NaN stays one: `min` of NumPy keeps it.
                least[name] = float(np.minimum(least[name], values[name].min()))
    return least


def searched_margins(
    program: Program,
    count: int,
    seed: int,
    table: ConditionTable,
    given: Mapping[str, np.ndarray] = MappingProxyType({}),
) -> dict[str, float]:
    """Return the smallest value of each condition that a search from random points finds.

    The lowest points of a draw are moved at random, ever less, and the lowest of these are kept:
    corners of a region have lower values than draws of many more points show.

    Args:
        program: conditions at a point of the chart.
        count: points of each box that are drawn.
        seed: seed of the draw.
        table: conditions and their regions.
        given: values of the Program's other inputs, the same at all points.

    Returns: NaN for a condition without a value somewhere.
    """
    return dict(_searched(program, count, seed, table, given))


def all_above(
    limit: float,
    program: Program,
    count: int,
    seed: int,
    table: ConditionTable,
    given: Mapping[str, np.ndarray],
) -> bool:
    """Return whether all `searched_margins` are above a limit.

    The search ends at the first one that is not. One without a value somewhere is not above.
    """
    return all(margin > limit for _, margin in _searched(program, count, seed, table, given))


def _searched(
    program: Program,
    count: int,
    seed: int,
    table: ConditionTable,
    given: Mapping[str, np.ndarray],
) -> Iterator[tuple[str, float]]:
    """Yield the margins of `searched_margins` one after the other, with their names."""
    draw = np.random.default_rng(seed)
    kept, neighbours = 16, 32
    for name, region in table.conditions.items():
        own = prune(program, [name])
        least = np.inf
        for ends in table.regions[region]:
            low, high = map(np.array, ends)
            points = _points(draw, low, high, count)
            values = _values(own, points, given)[name]
            least = float(np.minimum(least, values.min()))
            for width in (0.1, 0.03, 0.01):
                lowest = points[np.argsort(values)[:kept]]
                steps = width * (high - low) * draw.standard_normal((neighbours, *lowest.shape))
                points = np.clip(lowest + steps, low, high).reshape(-1, len(low))
                values = _values(own, points, given)[name]
                # A NaN stays one.
                least = float(np.minimum(least, values.min()))
        yield name, least


def _values(
    program: Program,
    points: Float[np.ndarray, "N n"],
    given: Mapping[str, np.ndarray] = MappingProxyType({}),
) -> dict[str, np.ndarray]:
    """Return the smallest element of each output at some points, by name. [N]."""
    parts = []
    together = 1024
    with np.errstate(all="ignore"):
        constants = fold(program, POINT)
        for first in range(0, len(points), together):
            inputs = {"u": points[first : first + together], **given}
            parts.append(evaluate(program, inputs, POINT, constants))
    rows = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    return {name: row.reshape(len(points), -1).min(axis=1) for name, row in rows.items()}


def needs_in_tube(
    robot: SpatialWalker,
    gait: AbstractSpatialGait,
    table: ConditionTable,
    count: int,
    seed: int,
) -> dict[str, float]:
    """Return the largest friction, torque, moment of the yaw and miss of the swing foot.

    Returns: fields of `SpatialTrained`.
    """

    def needs(u: Array) -> dict[str, Array]:
        step, following = gait.told(u[4:])
        z = step.state_at(u)
        now, needed = loads(robot, step.policy, z)
        landed = reset(robot, now.pose, now.links, now.motion)
        ahead, aside, normal = needed.ground
        # Squares below 0, of which the smallest is found; Programs have no magnitudes.
        return {
            "friction": -(ahead * ahead + aside * aside) / (normal * normal),
            "peak_torque_nm": -needed.torques * needed.torques,
            "yaw_nm": -needed.yaw * needed.yaw,
            "missed_m": -((following.aside @ step.policy.inputs(landed) - z[1]) ** 2),
        }

    places = {"friction": "tube", "peak_torque_nm": "tube", "yaw_nm": "tube"}
    program = trace(needs, {"u": (table.chart.size,)}, parameters=gait)
    places["missed_m"] = "touchdown"
    squares = sampled_margins(program, count, seed, table, places)
    return {name: float(np.sqrt(-square)) for name, square in squares.items()}


def _points(
    draw: np.random.Generator,
    low: Float[np.ndarray, " n"],
    high: Float[np.ndarray, " n"],
    count: int,
) -> Float[np.ndarray, "count n"]:
    """Return random points of a box, many of them on its faces."""
    # Share of its width by which a draw goes beyond a box before it is cut: ends count more.
    beyond = 0.05
    share = draw.uniform(-beyond, 1.0 + beyond, (count, len(low)))
    return low + np.clip(share, 0.0, 1.0) * (high - low)
