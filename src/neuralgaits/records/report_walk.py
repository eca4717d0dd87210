"""The walk that a report shows: `report/walk.json` of a run."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from neuralgaits.records.record import Count, Disturb, Pair, Record

FILE = "report/walk.json"


@dataclass(frozen=True, eq=False, kw_only=True)
class ShownWalk(Record):
    """A recorded walk. The page's scripts read it, too.

    Attributes:
        key: hash of everything that determines the walk.
        content: hash of all other fields.
        robot, plant, controller: names of the model, of the robot that walked, and of the law.
        origin: why this walk is shown, in words.
        start, push_n_s, disturb, seed, steps_asked: as in `simulate`.
        steps_walked, fell, fall_reason: outcome of the walk.
        frame_s, first_s: time between frames, and time of the first frame.
        leg_length_m, weight_n: leg length and weight of the plant.
        shapes, contacts: shapes of the robot and its feet, see `report.animation`.
        poses, leg, floor_m, z: poses, stance leg, floor height and state z in each frame.
        force_n: force on the stance foot in each frame; None if there was a push.
        slope: slope of the floor.
        tube: both fences in the plane of z.
    """

    key: str = ""
    content: str = ""
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
