"""Regions and conditions of the spec `periodic`, and what follows from them. Needs no JAX."""

from collections.abc import Mapping, Sequence

from neuralgaits.certificate.chart import Axis, Chart
from neuralgaits.certificate.proof_file.check import CheckResult
from neuralgaits.certificate.proof_file.reader import Claims
from neuralgaits.records.certified import Conclusion
from neuralgaits.systems.claimed_levels import Bounds, is_open, with_claimed_levels
from neuralgaits.systems.condition_table import ConditionTable

_LOW, _HIGH = (0.0, 0.0, 0.0, 0.0), (1.0, 1.0, 1.0, 1.0)
SPEED = "speed"
"""Name of the command that a gait may take, in m/s."""
RATE = 0.02
"""Exponent by which two steps come closer at least, in the tube's own metric."""


def _with_element(corner: tuple[float, ...], axis: int, value: float) -> tuple[float, ...]:
    """Return a corner with another value on one axis."""
    return (*corner[:axis], value, *corner[axis + 1 :])


STATE = tuple(Axis(name, 0.0, 1.0) for name in ("progress", "radius", "first turn", "second turn"))
"""Axes of the state: phase, and a point of the cube that covers the ball."""
_PLAIN = {
    "tube": ((_LOW, _HIGH),),
    "surface": tuple(
        (_with_element(_LOW, 1, end), _with_element(_HIGH, 1, end)) for end in (0.0, 1.0)
    ),
    "touchdown": ((_with_element(_LOW, 0, 1.0), _HIGH),),
    "middle line": (((0.0, 0.5, 0.5, 0.5), (1.0, 0.5, 0.5, 0.5)),),
}
_CONDITIONS = {
    "inward": "surface",
    "forward": "tube",
    "chart": "middle line",
    "inlet": "touchdown",
    "clearance": "middle line",
    "touchdown": "touchdown",
    "leaving": "touchdown",
    "impulse": "touchdown",
    "swing start": "touchdown",
    "normal force": "tube",
    "friction": "tube",
    "yaw": "tube",
    "torque": "tube",
    "range": "tube",
    "closer": "tube",
    "approach": "touchdown",
}


def table_with(axes: Sequence[Axis]) -> ConditionTable:
    """Return the conditions on their regions, for all values of a command.

    Args:
        axes: the command's axes, see `gait.commands.Command.axes`; none for a gait without one.
    """
    low, high = tuple(one.low for one in axes), tuple(one.high for one in axes)
    return ConditionTable(
        chart=Chart(state=(*STATE, *axes)),
        regions={
            name: tuple(((*begin, *low), (*end, *high)) for begin, end in boxes)
            for name, boxes in _PLAIN.items()
        },
        conditions=_CONDITIONS,
    )


TABLE = table_with(())
CONVERGES = ("closer", "approach")
"""Conditions of level 3; all others are premises of level 2."""
STRICT = ("inward", "closer", "approach")
"""Conditions whose bound must be above 0."""


def told_speeds(chart: Chart) -> str | None:
    """Return which speeds a gait is told, in words; "" for none.

    Returns: None for a chart that is no gait's of this family.
    """
    if chart.parameters or chart.state[: len(STATE)] != STATE:
        return None
    axes = chart.state[len(STATE) :]
    if not axes:
        return ""
    if [one.name for one in axes] != [SPEED, f"change of {SPEED}"]:
        return None
    speed, change = axes
    if not (0.0 < speed.low < speed.high and 0.0 < change.high == -change.low):
        return None
    return (
        f"told any speed from {speed.low!r} to {speed.high!r} m/s at each touchdown, at most "
        f"{change.high!r} m/s more or less than in the step before"
    )


def conclude(
    bounds: Mapping[str, float | None], level: int = 3, told: str = ""
) -> tuple[Conclusion, ...]:
    """Draw the conclusions that proved bounds of conditions on their regions allow.

    Level 2: on the surface the flow points into the tube, so that a step stays in it; the hip goes
    forward, so that it ends, at phase 1, where the swing foot meets the floor for the first time;
    the touchdown leads into the section at phase 0. Level 3: with |R^-1 d| as the length of a
    deviation d, the flow shrinks all of them at least by the exponent `RATE` a step, and a
    touchdown lengthens none. Sections are convex, so that the same holds for distances of states,
    and the map of a step is a contraction.

    Args:
        bounds: proved bound by condition; None if there is none.
        level: the highest level that is asked for.
        told: which speeds the gait is told, see `told_speeds`; "" for none. A touchdown's premises
            are then about the section of the speed that the next step begins with.
    """
    left = [
        name for name in TABLE.conditions if name not in CONVERGES and is_open(bounds, name, STRICT)
    ]
    words = (
        "every trajectory of the projected hybrid zero dynamics that starts in the tube walks for "
        f"ever, each step within the tube{told and f' of the speeds it is told, {told}'}",
        "in each step the floor bears the forces and the motors give the torques, the swing foot "
        "is above the floor between its ends, and the impulse of its touchdown is within friction",
    )
    walks = Conclusion(2, "proved", None, words)
    if left:
        walks = Conclusion(2, "undecided", f"{left[0]} is not proved")
    left += [name for name in CONVERGES if is_open(bounds, name, STRICT)]
    orbit = "there is one periodic orbit in the tube, and two trajectories"
    if told:
        orbit = (
            "for each speed that is told all the time there is one periodic orbit in its tube, and "
            "two trajectories that are told the same speeds"
        )
    words = (
        f"{orbit} of the projected hybrid zero dynamics in it come closer at least by the factor "
        f"exp(-{RATE!r}) a step, in half axes of the tube",
    )
    converges = Conclusion(3, "proved", None, words, {"rate_1_step": RATE})
    if left:
        converges = Conclusion(3, "undecided", f"{left[0]} is not proved")
    return tuple(one for one in (walks, converges) if one.level <= level)


def with_spatial_levels(report: CheckResult, claims: Claims) -> CheckResult:
    """Add levels 2 and 3 to the report of a checked proof, see `with_claimed_levels`."""
    about = "a walker's in three dimensions"
    told = told_speeds(claims.chart)
    table = TABLE if told is None else table_with(claims.chart.state[len(STATE) :])

    def concluded(bounds: Bounds) -> tuple[Conclusion, ...]:
        return conclude(bounds, told=told or "")

    return with_claimed_levels(report, claims, table, about, concluded)
