"""The loop of a live page: it takes requests, advances time at the chosen pace, and sends pictures.

One thread owns the robot. Callbacks of the page only leave requests, which are carried out
between two frames, and set single values of the playback, so nothing needs a lock.
"""

import queue
import threading
import time
from collections.abc import Callable
from typing import Any, Generic, NamedTuple, Protocol, TypeVar

from neuralgaits._environment import PLAYER
from neuralgaits.viewer.slider import Slider
from neuralgaits.viewer.walker import Margins

FRAMES_PER_S = 40.0
"""Target number of pictures a second."""
SPEED = Slider("playback ×", 0.1, 2.0, 1.0, 0.1, "speed, × real time")
"""Playback speed, simulated seconds a second."""
STEP_S = 0.02
"""Simulated time of a single step [s]."""


class PlayableRobot(Protocol):
    """Interface of a robot that a page plays; `viewer.walker.Walker` is a planar one's."""

    period_s: float
    """Duration of a control tick [s]."""

    def tick(self) -> bool:
        """Advance by one control tick. Returns: False once the robot has fallen."""
        ...

    def shown(self) -> Any:
        """Return the present moment, with `fall`, `z` and whatever the page shows."""
        ...

    def margins(self, z: Any) -> Margins | None:
        """Return margins of all conditions at a state; None if the page shows none."""
        ...

    def reset(self) -> None:
        """Put the robot back into its first state."""
        ...


Robot = TypeVar("Robot", bound=PlayableRobot)
Wish = Callable[[Robot], str | None]
"""Request to do something to the robot; an answer is shown to the visitor."""


class Picture(NamedTuple):
    """A frame as the page shows it."""

    shown: Any
    """What the robot's `shown` returned."""
    margins: Margins | None
    """Margins of the conditions; None if they are not due."""
    paused: bool
    pace: float
    """Playback speed that is reached, simulated seconds a second."""
    reset_in: float | None
    """Time to the automatic reset [s]; None if none is planned."""
    answer: str | None
    """Answer to the last request, if it had one."""


class Player(Generic[Robot]):
    """Thread that plays a robot and hands out pictures.

    Attributes:
        frames: number of pictures so far.
        paused: whether time stands still.
        speed: playback speed, simulated seconds a second.
        reset_after: time from a fall to the reset [s]; None waits for the visitor.
    """

    def __init__(self, walker: Robot, show: Callable[[Picture], None]):
        """Prepare playback; `show` gets every picture, from the player's thread."""
        self.frames = 0
        self.paused = False
        self.speed = SPEED.first
        self.reset_after: float | None = None
        self._walker, self._show = walker, show
        self._wishes: queue.SimpleQueue[Wish[Robot]] = queue.SimpleQueue()
        self._steps = 0
        self._owed = 0.0
        self._pace = 0.0
        self._fallen_at: float | None = None
        self._margins_at = 0.0
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name=PLAYER, daemon=True)
        self.failure: BaseException | None = None

    def start(self) -> None:
        """Start to play, in the player's own thread."""
        self._thread.start()

    def stop(self) -> None:
        """Stop playing, and wait until the thread has ended."""
        self._stop.set()
        if self._thread.is_alive():
            self._thread.join()

    def wait(self) -> None:
        """Wait until something fails or Ctrl-C. Raises: the failure of the player's thread."""
        while not self._stop.wait(0.2):
            pass
        if self.failure is not None:
            raise self.failure

    def fail(self, error: BaseException) -> None:
        """Stop playing, and let `wait` raise this error."""
        self.failure = error
        self._stop.set()

    def ask(self, wish: Wish[Robot]) -> None:
        """Queue a request, which is carried out before the next frame."""
        self._wishes.put(wish)

    def step(self) -> None:
        """Pause, and advance by `STEP_S` once."""

        def one_more(_: Robot) -> None:
            self._steps += 1

        self.paused = True
        self.ask(one_more)

    def _run(self) -> None:
        try:
            last = time.perf_counter()
            while not self._stop.is_set():
                now = time.perf_counter()
                self._frame(now, now - last)
                last = now
                spent = time.perf_counter() - now
                self._stop.wait(max(0.0, 1.0 / FRAMES_PER_S - spent))
        except BaseException as error:
            self.fail(error)

    def _frame(self, now: float, elapsed: float) -> None:
        """Make one picture; `elapsed` is the time since the last one (s)."""
        answer = self._grant()
        played = self._play(now, elapsed)
        share = min(1.0, 2.0 * elapsed)
        self._pace += share * (played / max(elapsed, 1e-3) - self._pace)
        shown = self._walker.shown()
        reset_in = self._after_fall(now, shown)
        margins = None
        # Bars change five times a second.
        if now - self._margins_at >= 0.2:
            self._margins_at = now
            margins = self._walker.margins(shown.z)
        self._show(Picture(shown, margins, self.paused, self._pace, reset_in, answer))
        self.frames += 1

    def _grant(self) -> str | None:
        answer = None
        while not self._wishes.empty():
            answer = self._wishes.get()(self._walker) or answer
        return answer

    def _play(self, now: float, elapsed: float) -> float:
        """Advance by the time of a frame. Returns: simulated time (s)."""
        period = self._walker.period_s
        if self.paused:
            count, self._owed = round(STEP_S / period) * self._steps, 0.0
            self._steps = 0
        else:
            # A machine that lags further behind plays in slow motion.
            self._owed = min(self._owed + self.speed * elapsed, 0.1)
            count = int(self._owed / period)
        # Ticks take no more than this share of a frame's time.
        done, until = 0, now + 0.8 / FRAMES_PER_S
        while done < count and self._walker.tick():
            done += 1
            if not self.paused and time.perf_counter() > until:
                break
        self._owed = max(0.0, self._owed - done * period) if not self.paused else 0.0
        return done * period

    def _after_fall(self, now: float, shown: Any) -> float | None:
        """Reset when it is due. Returns: time left until then (s); None if no reset is planned."""
        if shown.fall is None:
            self._fallen_at = None
            return None
        self._owed = 0.0
        if self._fallen_at is None:
            self._fallen_at = now
        if self.reset_after is None:
            return None
        left = self._fallen_at + self.reset_after - now
        if left <= 0.0:
            self._fallen_at = None
            self._walker.reset()
            return None
        return left
