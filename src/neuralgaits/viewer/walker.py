"""The interface of a walking robot for the page: its only access to the simulation."""

from typing import NamedTuple, Protocol

import numpy as np

from neuralgaits._types import Bool, Float
from neuralgaits.simulation.live_tick import StepSpeeds
from neuralgaits.viewer.believed_lean import LeanMarks
from neuralgaits.viewer.live_monitor import SetMembership


class WalkFrame(NamedTuple):
    """State of the walk at one moment."""

    time: float
    """Simulated time [s]."""
    walked: float
    """Simulated time since the last start [s]."""
    qpos: Float[np.ndarray, " q"]
    """Generalised coordinates of MuJoCo."""
    hip: Float[np.ndarray, "2"]
    """Pitch axis of the root, (x, z) [m]."""
    slope: float
    """Rise of the floor per metre forward."""
    ground: float
    """Height of the floor, or of the line between footholds, under the hip [m]."""
    z: Float[np.ndarray, "2"]
    """Measured state of the zero dynamics (m, kg m^2/s)."""
    trail: Float[np.ndarray, "K 2"]
    """States of the last steps (m, kg m^2/s), NaN between two of them. [K, 2]"""
    steps: int
    """Touchdowns since the last start."""
    speed: float
    """Mean forward speed over the last whole step; the hip's own before there is one [m/s]."""
    force: Float[np.ndarray, "2"]
    """Push under way, along x and z [N]."""
    fall: str | None
    """Reason why the robot fell or stopped; None while it walks."""
    upright: bool = False
    """Whether the robot stands upright although its walk has ended."""
    tops: Float[np.ndarray, "K 4"] | None = None
    """Tops of the blocks that it walks on, back ends (x, z) and front ends [m]; None on a floor.
    The array is a new object whenever the blocks change."""
    laps: tuple[int, ...] = ()
    """Touchdowns at each time that the robot reached the end of its ground and was put back to
    the start."""
    speeds: StepSpeeds | None = None
    """Speeds of the last whole step; None before one, or without a commanded speed."""
    lean: LeanMarks | None = None
    """Lean that the robot believes in, beside the true one; None if the gait takes none."""
    memberships: tuple[SetMembership, ...] = ()
    """Answers of the monitor for each proved set; () if none is proved."""
    off_proof: str = ""
    """How robot and floor differ from those that the proof is about, in words; empty if they do
    not, or if nothing is proved."""
    changed: bool = False
    """Whether robot or floor differ from those that margins are about."""


class Margins(NamedTuple):
    """Margins of every condition at one state."""

    values: Float[np.ndarray, " c"]
    """Margins in scales of the conditions; NaN if there is no number."""
    inside: Bool[np.ndarray, " c"]
    """Whether the state is in each condition's region; otherwise the margin is of the nearest
    state."""
    why_none: str = ""
    """Reason why there are no numbers; empty if there are."""


class Walker(Protocol):
    """Interface of a robot that walks and responds to a visitor."""

    period_s: float
    """Duration of a control tick [s]."""

    def tick(self) -> bool:
        """Advance by one control tick. Returns: False once the robot has fallen."""
        ...

    def shown(self) -> WalkFrame:
        """Return the present moment of the walk."""
        ...

    def margins(self, z: Float[np.ndarray, "2"]) -> Margins:
        """Return margins of all conditions at a state."""
        ...

    def push(self, impulse: Float[np.ndarray, "2"]) -> None:
        """Push along x and z (N s)."""
        ...

    def disturb(self, name: str, value: float) -> None:
        """Change a setting of the plant by name."""
        ...

    def tell(self, name: str, value: float) -> None:
        """Request a command, which takes effect at the next touchdown."""
        ...

    def adapt(self, active: bool) -> None:
        """Adapt speed, lean and slope, as far as they are commands, from now on, or no longer."""
        ...

    def resize(self, name: str, size: float) -> None:
        """Change a size of the blocks ahead (m)."""
        ...

    def jump(self, z: Float[np.ndarray, "2"]) -> str | None:
        """Put the robot into a state. Returns: the reason if that fails; None on success."""
        ...

    def reset(self) -> None:
        """Put the robot back into its first state."""
        ...
