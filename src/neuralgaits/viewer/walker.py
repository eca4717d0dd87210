"""What the page needs of a walking robot: the only view that this room has of the simulation."""

from typing import NamedTuple, Protocol

import numpy as np

from neuralgaits._types import Bool, Float


class Shown(NamedTuple):
    """One moment of the walk."""

    time: float
    """Simulated [s]."""
    qpos: Float[np.ndarray, " q"]
    """Of MuJoCo."""
    hip: Float[np.ndarray, "2"]
    """Pitch axis of the root, (x, z) [m]."""
    slope: float
    """Rise of the floor per metre forward."""
    ground: float
    """Height below the hip of the floor, or of the line between footholds [m]."""
    z: Float[np.ndarray, "2"]
    """Measured state of the zero dynamics (m, kg m^2/s)."""
    steps: int
    """Touchdowns since the last start."""
    speed: float
    """Forward speed of the hip [m/s]."""
    force: Float[np.ndarray, "2"]
    """Push under way, along x and z [N]."""
    fall: str | None
    """Why the robot fell or stopped; None while it walks."""
    upright: bool = False
    """Whether it stands, though its walk has ended."""
    tops: Float[np.ndarray, "K 4"] | None = None
    """Of the blocks that it walks on, back ends (x, z) and front ends [m]; None on a floor. The
    array is another one where they have changed."""
    laps: tuple[int, ...] = ()
    """Touchdowns of each time that it came to the end of its ground, and was put back to the
    beginning."""


class Margins(NamedTuple):
    """How much is left of every condition at one state."""

    values: Float[np.ndarray, " c"]
    """In scales of the conditions; NaN where there is no number."""
    inside: Bool[np.ndarray, " c"]
    """Whether the state is in the condition's region; else the nearest state of it was read."""


class SliderReach(NamedTuple):
    """Reach of a slider, and where it stands at first."""

    low: float
    high: float
    first: float

    def clip(self, value: object) -> float | None:
        """A number from the page inside the limits; None if it is none."""
        if isinstance(value, bool) or not isinstance(value, int | float):
            return None
        number = float(value)
        return min(max(number, self.low), self.high) if np.isfinite(number) else None


class SliderRange(NamedTuple):
    """A command that a visitor may give."""

    limits: SliderReach
    """Its range, and the value at first."""
    unit: str
    """Of its values."""


class Walker(Protocol):
    """A robot that walks and bears what a visitor does to it."""

    period_s: float
    """Time that passes in a tick [s]."""

    def tick(self) -> bool:
        """Let one control tick pass. Returns: False once the robot has fallen."""
        ...

    def shown(self) -> Shown:
        """The present moment."""
        ...

    def margins(self, z: Float[np.ndarray, "2"]) -> Margins:
        """Margins of all conditions at a state."""
        ...

    def push(self, impulse: Float[np.ndarray, "2"]) -> None:
        """Push along x and z (N s)."""
        ...

    def disturb(self, name: str, value: float) -> None:
        """Change the plant."""
        ...

    def tell(self, name: str, value: float) -> None:
        """Wish for a command from the next touchdown on."""
        ...

    def resize(self, name: str, size: float) -> None:
        """Change a size of the blocks ahead (m)."""
        ...

    def jump(self, z: Float[np.ndarray, "2"]) -> str | None:
        """Put the robot into a state. Returns: why not; None if it is there."""
        ...

    def reset(self) -> None:
        """Back to the first state."""
        ...
