"""What the pages' moving pictures show: each a walk that `simulate` films."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

ROBOTS = Path(__file__).parents[2] / "examples" / "robots"
SHIPPED = "shipped"
"""The gait of AMBER-3M that comes with the package."""
SHIPPED_SPEED = "shipped-speed"
"""The shipped gait that takes a speed command."""


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
        speeds: commanded of each step [m/s], written at the top; empty for most gaits.
    """

    name: str
    robot: str
    begin: float = 1.0
    end: float = 3.0
    asked: dict[str, Any] = field(default_factory=dict)
    steps: int = 7
    width: int = 280
    rows: tuple[float, float] = (0.12, 1.0)
    speeds: tuple[float, ...] = ()


HEAD = Scene("walk", SHIPPED, 1.0, 5.0, steps=14, width=640)
"""At the head of the README."""
FASTER = Scene(
    "faster",
    SHIPPED_SPEED,
    0.8,
    8.2,
    steps=17,
    width=320,
    speeds=(0.55, 0.55, 0.55, *(round(0.55 + 0.04 * k, 2) for k in range(1, 9)), 0.90),
)
"""At the head of the page on commands: from 0.55 to 0.90 m/s in nine steps."""
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
