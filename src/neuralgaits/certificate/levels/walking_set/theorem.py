"""Parameters of level 2's set, and the statements that are premises. Needs no JAX."""

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from neuralgaits.certificate.chart import Corner
from neuralgaits.certificate.premises import Boxes, Premise

STRIPS, SET = "strips", "walking set"
"""Labels of level 2's statements, in place of the region that a spec's statements have."""

OFF_THE_LINE = "set/foot-above", "set/foot-below"
"""Outputs for the distance of the swing foot from the line of footholds, before and behind it."""


@dataclass(frozen=True)
class WalkingSetConstants:
    """The set T of `walking_set` and where its premises hold.

    Attributes:
        start_strip: T begins this far before phase 0: a reset need not land on the line.
        guard_strip: T ends this far behind phase 1, and the guard lies within as much of it.
        risen: until this phase the swing foot rises.
        falling: phase from which it falls; in between it is above the ground.
        disturbance: bound on what may be added to dz (m/s, N m).
        barriers: names of the spec's barrier conditions.
        carried: the spec's conditions, by name, that hold on the strips as well.
        told: names of the gait's commands; the chart has two axes for each.
        floor: each foothold may be so much higher or lower than the line of footholds that the
            gait is meant for [m]; what is above the ground is then more than this above the line.
    """

    start_strip: float
    guard_strip: float
    risen: float
    falling: float
    disturbance: tuple[float, float]
    barriers: tuple[str, ...]
    carried: tuple[str, ...]
    told: tuple[str, ...] = ()
    floor: float = 0.0

    @property
    def start(self) -> tuple[Corner, Corner]:
        """Corners of the strip around phase 0."""
        return (-self.start_strip, 0.0), (self.start_strip, 1.0)

    @property
    def guard(self) -> tuple[Corner, Corner]:
        """Corners of the strip around phase 1."""
        return (1.0 - self.guard_strip, 0.0), (1.0 + self.guard_strip, 1.0)

    @property
    def whole(self) -> tuple[Corner, Corner]:
        """Lower and upper corner of the whole set T, strips included."""
        return (-self.start_strip, 0.0), (1.0 + self.guard_strip, 1.0)

    @property
    def ends(self) -> tuple[float, float]:
        """First and last phase of T."""
        return -self.start_strip, 1.0 + self.guard_strip


def walking_premises(constants: WalkingSetConstants) -> list[Premise]:
    """Return premises of level 2 about the set itself; for the spec's conditions see `strips`."""
    first, last = constants.ends
    before = 1.0 - constants.guard_strip
    lower, upper = ((first, 0.0), (last, 0.0)), ((first, 1.0), (last, 1.0))
    rows = [
        # C1: dphi/dt > 0 and |J.s| > 0 on T.
        Premise("set/forward", *constants.whole),
        Premise("set/inertia", *constants.whole),
        Premise("set/width", *lower),
        # C2: on both fences the flow points inward.
        Premise("set/fence-lower", *lower),
        Premise("set/fence-upper", *upper),
        # C4: the foot rises until `risen` and is above the ground until it falls.
        Premise("set/foot-rises", (first, 0.0), (constants.risen, 1.0)),
        Premise("set/foot-above", (constants.risen, 0.0), (constants.falling, 1.0)),
        # C3: it falls from `falling` on, is above at phase 1 - g and below at 1 + g.
        Premise("set/foot-falls", (constants.falling, 0.0), (last, 1.0)),
        Premise("set/foot-above", (before, 0.0), (before, 1.0)),
        Premise("set/foot-below", (last, 0.0), (last, 1.0)),
        # C5: the reset lands between the fences, within s of phase 0.
        *(_inlet(constants) if constants.told else _reset(constants)),
    ]
    for name in constants.barriers:
        # Where a step is told commands, nothing that is read behind a reset may depend on those
        # that come next: the function is asked on the strip that every reset lands in.
        # C6, after the reset: h >= 0.
        if constants.told:
            after = Premise(f"set/value {name}", *constants.start, sign="not negative")
        else:
            after = Premise(f"set/after {name}", *constants.guard, sign="not negative")
        rows.append(after)
        if any(constants.disturbance):
            rows.append(Premise(f"set/rate {name}", *constants.whole, sign="not negative"))
    return rows


def _reset(constants: WalkingSetConstants) -> list[Premise]:
    """Return premises for the place where a reset lands, in the chart of the only tube."""
    return [
        Premise("set/reset-phase", *constants.guard, sign="any"),
        Premise("set/reset-level", *constants.guard),
    ]


def _inlet(constants: WalkingSetConstants) -> list[Premise]:
    """Return premises for a reset into the tube of the next step, whatever its command is.

    At phase 0 the tube depends only on the command before, which is known. A reset lands a little
    before or behind it, where the fences depend on the next command as well, as the length of a
    phase does: so its place is measured in metres, its zeta against the fences at phase 0, and the
    effect of fences and lengths is bounded over all pairs of commands.
    """
    origin = (0.0, 0.0), (0.0, 0.0)
    return [
        Premise("set/reset-place", *constants.guard, sign="any"),
        Premise("set/inlet", *constants.guard),
        Premise("set/stride", *origin),
        Premise("set/within-bounds", *origin, sign="not negative"),
        Premise(
            "set/steepness", (-constants.start_strip, 0.0), (constants.start_strip, 0.0), sign="any"
        ),
    ]


def off_the_line(constants: WalkingSetConstants) -> list[Premise]:
    """Return the premises of `walking_premises` whose bounds must exceed the floor's, and not 0."""
    return [p for p in walking_premises(constants) if p.output in OFF_THE_LINE]


def safe_premises(constants: WalkingSetConstants) -> list[Premise]:
    """Return premises by which all of T is safe; without them only its safe part is invariant."""
    # C6, on T: h >= 0.
    return [
        Premise(f"set/value {name}", *constants.whole, sign="not negative")
        for name in constants.barriers
    ]


def strips(
    constants: WalkingSetConstants, boxes: Sequence[tuple[str, Corner, Corner]]
) -> Iterator[tuple[str, Corner, Corner]]:
    """Return the boxes of the carried conditions beyond phases 0 and 1.

    Args:
        constants: parameters of the set.
        boxes: (condition, low, high) of level 1.
    """
    # C7: conditions of all of the tube hold on the strips as well.
    for name, low, high in boxes:
        if name not in constants.carried:
            continue
        if low[0] == high[0] == 1.0:
            ahead, behind = 1.0 - constants.guard_strip, 1.0 + constants.guard_strip
            yield name, (ahead, low[1]), (behind, high[1])
            continue
        if low[0] == 0.0:
            # A reset lands on either side of phase 0.
            behind = constants.start_strip if high[0] == 0.0 else 0.0
            yield name, (-constants.start_strip, low[1]), (behind, high[1])
        if high[0] == 1.0:
            yield name, (1.0, low[1]), (1.0 + constants.guard_strip, high[1])


def labelled_premises(
    constants: WalkingSetConstants, boxes: Boxes
) -> Iterator[tuple[str, str, Corner, Corner]]:
    """Return (label, output, low, high) of all premises of level 2 beside level 1.

    Args:
        constants: parameters of the set.
        boxes: (condition, low, high) of level 1.
    """
    for name, low, high in strips(constants, boxes):
        yield STRIPS, name, low, high
    for output, low, high, _ in (*walking_premises(constants), *safe_premises(constants)):
        yield SET, output, low, high


def cover_the_tube(boxes: Sequence[tuple[Corner, Corner]]) -> bool:
    """Return whether boxes together cover all of the chart, phases and levels from 0 to 1."""
    cuts = [
        sorted({0.0, 1.0, *(corner[axis] for box in boxes for corner in box)}) for axis in (0, 1)
    ]
    cells = [list(itertools.pairwise(line)) for line in cuts]
    return all(
        any(
            low[0] <= phases[0]
            and phases[1] <= high[0]
            and low[1] <= levels[0]
            and levels[1] <= high[1]
            for low, high in boxes
        )
        for phases in cells[0]
        for levels in cells[1]
    )
