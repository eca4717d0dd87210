"""The loop of a live page: wishes in, time forward at the pace asked for, pictures out.

One thread owns the robot. Callbacks of the page only leave wishes, which are carried out
between two frames, and set how to play: single values, so nothing needs a lock.
"""

import queue
import threading
import time
from collections.abc import Callable
from typing import NamedTuple

from neuralgaits.viewer.walker import Margins, Shown, SliderReach, Walker

FRAMES_PER_S = 40.0
"""Pictures a second that are aimed at."""
MARGINS_PER_S = 5.0
"""Bars a second."""
SPEED = SliderReach(0.1, 2.0, 1.0)
"""Playback, simulated seconds a second."""
STEP_S = 0.02
"""Simulated time of a single step."""
_LONGEST_FRAME_S = 0.1
"""What is owed beyond this is forgotten: a slow machine plays in slow motion."""
_SHARE = 0.8
"""Of a frame's time that may go into ticks."""

Wish = Callable[[Walker], str | None]
"""Something to do to the robot; an answer is shown to the visitor."""


class Picture(NamedTuple):
    """What the page shows of a frame."""

    shown: Shown
    margins: Margins | None
    """None if they are not due."""
    paused: bool
    pace: float
    """Simulated seconds a second that are reached."""
    reset_in: float | None
    """Time to the automatic reset [s]."""
    answer: str | None
    """To the last wish, if it had one."""


class Player:
    """Plays a walker.

    Attributes:
        frames: pictures so far.
        paused: whether time stands still.
        speed: playback.
        reset_after: from a fall to the reset [s]; None waits for the visitor.
    """

    def __init__(self, walker: Walker, show: Callable[[Picture], None]):
        """`show` gets every picture, from the player's thread."""
        self.frames = 0
        self.paused = False
        self.speed = SPEED.first
        self.reset_after: float | None = None
        self._walker, self._show = walker, show
        self._wishes: queue.SimpleQueue[Wish] = queue.SimpleQueue()
        self._steps = 0
        self._owed = 0.0
        self._pace = 0.0
        self._fallen_at: float | None = None
        self._margins_at = 0.0
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="player", daemon=True)
        self.failure: BaseException | None = None

    def start(self) -> None:
        """Begin to play."""
        self._thread.start()

    def stop(self) -> None:
        """Stop playing, and wait until nothing moves."""
        self._stop.set()
        if self._thread.is_alive():
            self._thread.join()

    def wait(self) -> None:
        """Until something fails or Ctrl-C. Raises: what failed in the player's thread."""
        while not self._stop.wait(0.2):
            pass
        if self.failure is not None:
            raise self.failure

    def fail(self, error: BaseException) -> None:
        """Stop, and let `wait` raise this."""
        self.failure = error
        self._stop.set()

    def ask(self, wish: Wish) -> None:
        """Have something done to the robot before the next frame."""
        self._wishes.put(wish)

    def step(self) -> None:
        """Stand still, and go on by `STEP_S`."""

        def one_more(_: Walker) -> None:
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
        """One picture: `elapsed` is the time since the last (s)."""
        answer = self._grant()
        played = self._play(now, elapsed)
        share = min(1.0, 2.0 * elapsed)
        self._pace += share * (played / max(elapsed, 1e-3) - self._pace)
        shown = self._walker.shown()
        reset_in = self._after_fall(now, shown)
        margins = None
        if now - self._margins_at >= 1.0 / MARGINS_PER_S:
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
        """Let the time of a frame pass. Returns: simulated time (s)."""
        period = self._walker.period_s
        if self.paused:
            count, self._owed = round(STEP_S / period) * self._steps, 0.0
            self._steps = 0
        else:
            self._owed = min(self._owed + self.speed * elapsed, _LONGEST_FRAME_S)
            count = int(self._owed / period)
        done, until = 0, now + _SHARE / FRAMES_PER_S
        while done < count and self._walker.tick():
            done += 1
            if not self.paused and time.perf_counter() > until:
                break
        self._owed = max(0.0, self._owed - done * period) if not self.paused else 0.0
        return done * period

    def _after_fall(self, now: float, shown: Shown) -> float | None:
        """Reset when it is time. Returns: time that is left (s); None if nothing is planned."""
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
