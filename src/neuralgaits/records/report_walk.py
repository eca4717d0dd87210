"""The walk that a report shows: `report/walk.json` of a run."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from neuralgaits.records.record import Count, Disturb, Pair, Record

FILE = "report/walk.json"


@dataclass(frozen=True, eq=False, kw_only=True)
class ShownWalk(Record):
    """A recorded walk. The scripts of the page read it too.

    Attributes:
        key: changes with all that the walk follows from.
        robot, plant, controller: names of the model, of what walked, and of the law.
        origin: what asked for it, in words.
        start, push_n_s, disturb, seed, steps_asked: as in `simulate`.
        steps_walked, fell, fall_reason: how it went.
        frame_s, first_s: time between frames, and of the first.
        leg_length_m, weight_n: of the plant.
        shapes, contacts: of the robot, see `report.animation`.
        poses, leg, floor_m, z: of each frame.
        force_n: on the standing foot, of each frame; None if there was a push.
        slope: of the floor.
        tube: both fences in the plane of z.
    """

    key: str = ""
    robot: str
    plant: str
    controller: str
    origin: str
    start: str = ""
    push_n_s: float | None
    disturb: Disturb | None
    seed: int = 0
    steps_asked: int = 0
    steps_walked: Count
    fell: bool
    fall_reason: str | None
    frame_s: float
    first_s: float = 0.0
    leg_length_m: float = 0.0
    weight_n: float = 0.0
    shapes: Any = ()
    contacts: Any = ()
    poses: Any = ()
    leg: Any = ()
    force_n: tuple[Pair, ...] | None
    floor_m: Any = ()
    slope: float = 0.0
    z: Any = ()
    tube: Mapping[str, Any] | None = None
