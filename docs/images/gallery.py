"""What the pages' moving pictures show: each a walk that `simulate` films."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

ROBOTS = Path(__file__).parents[2] / "examples" / "robots"
SHIPPED = "shipped"
"""The gait of AMBER-3M that comes with the package."""


@dataclass(frozen=True)
class Scene:
    """A moving picture.

    Attributes:
        name: of its file.
        robot: what walks: `SHIPPED`, a built-in robot or a robot file, trained with the defaults.
        begin, end: what is shown of the film [s].
        asked: settings of `simulate`.
        steps: that are walked; a push comes at a random moment after the fifth.
        width: of the picture [px].
        rows: of the film's picture that are shown, as shares of its height from above.
    """

    name: str
    robot: str
    begin: float = 1.0
    end: float = 3.0
    asked: dict[str, Any] = field(default_factory=dict)
    steps: int = 7
    width: int = 280
    rows: tuple[float, float] = (0.12, 1.0)


HEAD = Scene("walk", SHIPPED, 1.0, 5.0, steps=14, width=640)
"""At the head of the README."""
SCENES = (
    Scene("gallery-amber3m", SHIPPED),
    Scene("gallery-rabbit", "rabbit"),
    Scene("gallery-light", str(ROBOTS / "light-5kg.xml")),
    Scene("gallery-walker2d", str(ROBOTS / "walker2d-point-feet.xml")),
    Scene("gallery-push", SHIPPED, 2.2, 4.6, asked={"push": 32.0}, steps=14),
    Scene("gallery-uneven", SHIPPED, asked={"disturb": "floor_height=0.02"}),
    Scene("gallery-fall-push", SHIPPED, 2.0, 5.0, asked={"push": 64.0}, steps=14),
    Scene("gallery-fall-ice", SHIPPED, 0.0, 3.0, asked={"disturb": "friction=0.15"}),
)
"""Of the gallery."""
