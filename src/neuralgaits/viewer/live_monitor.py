"""The monitor of a live page: whether the controller's states are in the sets that are proved."""

import math
from typing import NamedTuple

import numpy as np

from neuralgaits.analysis.run import Run
from neuralgaits.analysis.state_monitor import StateMonitor
from neuralgaits.analysis.step_parameters import step_parameters
from neuralgaits.records.level_words import WALKING_SET_LEVEL
from neuralgaits.records.monitored import margin_in_words
from neuralgaits.simulation.live_tick import MeasuredTick
from neuralgaits.simulation.setup.plant import PERIOD_S
from neuralgaits.viewer.page_style import GOOD, QUIET, TIGHT, line

_EDGES = ("level-lower", "level-upper")
"""Names of the margins in widths of the region; others have units of their own."""
NEAR_TOUCHDOWN_S = 0.005
"""Time around a touchdown in which undisturbed walks leave the sets [s], see docs/monitor.md."""


class SetMembership(NamedTuple):
    """The state at the last tick, and one proved set."""

    levels: str
    """Levels of the proof that the set is of, as in `4, 5`."""
    inside: bool
    """Whether the state is in the set, at commands that the proof is about."""
    margin: float
    """Smallest margin that counts; negative outside."""
    name: str
    """Name of that margin."""
    admissible: bool
    """Whether the proof is about the commands of the step."""
    share: float
    """Share of the ticks since the start of the walk that were inside."""
    away_s: float = 0.0
    """Time outside that is not within `NEAR_TOUCHDOWN_S` of a touchdown [s]."""


class LiveMonitor:
    """Counts the ticks of a walk that are in each proved set.

    Ticks are collected, and evaluated together when somebody wants to know.
    """

    def __init__(self, run: Run, monitor: StateMonitor, period_s: float = PERIOD_S):
        """Prepare the monitor.

        Args:
            run: run that walks.
            monitor: sets that are proved of its gait.
            period_s: duration of a control tick [s].
        """
        self._run, self._monitor, self._period_s = run, monitor, period_s
        self._near = round(NEAR_TOUCHDOWN_S / period_s)
        self._latest: tuple[SetMembership, ...] = ()
        self.restart()
        if monitor.commands:
            # Compiled now, not while the robot walks.
            middle = [0.5 * (one.low + one.high) for one in monitor.commands]
            step_parameters(run, np.array([[middle, middle]]))

    def restart(self) -> None:
        """Count from zero: another walk begins."""
        self._pending: list[MeasuredTick] = []
        self._ticks = 0
        self._inside = [0] * len(self._monitor.sets)
        self._touchdowns: list[int] = []
        # Numbers of ticks outside that are near no touchdown so far.
        self._outside = [np.zeros(0, dtype=np.int64) for _ in self._monitor.sets]
        self._away = [0] * len(self._monitor.sets)
        self._latest = ()

    def touch_down(self) -> None:
        """Take note that the tick added next is the first one of a step."""
        self._touchdowns.append(self._ticks + len(self._pending))

    def add(self, tick: MeasuredTick) -> None:
        """Add a tick of the walk."""
        self._pending.append(tick)

    def memberships(self) -> tuple[SetMembership, ...]:
        """Return the answer at the last tick for each set, lowest level first; () before any."""
        if not self._pending:
            return self._latest
        ticks = MeasuredTick(*map(np.stack, zip(*self._pending, strict=True)))
        self._pending = []
        first, self._ticks = self._ticks, self._ticks + len(ticks.q)
        before, after = ticks.commands[:, 0], ticks.commands[:, 1]
        inputs = {"q": ticks.q, "dq": ticks.dq}
        if self._monitor.commands:
            step = step_parameters(self._run, ticks.commands)
            inputs |= {"before": before, "after": after, "step": step}
        admissible = self._monitor.admissible(before, after)
        answers = []
        for place, one in enumerate(self._monitor.sets):
            member = one.membership(one.margins(**inputs))
            inside = member.inside & admissible
            self._inside[place] += int(np.count_nonzero(inside))
            self._sort_outside(place, first + np.flatnonzero(~inside))
            answers.append(
                SetMembership(
                    ", ".join(map(str, one.levels)),
                    bool(inside[-1]),
                    float(member.margin[-1]),
                    one.names[member.nearest[-1]],
                    bool(admissible[-1]),
                    self._inside[place] / self._ticks,
                    self._away[place] * self._period_s,
                )
            )
        self._latest = tuple(answers)
        return self._latest

    def _sort_outside(self, place: int, numbers: np.ndarray) -> None:
        """Count the ticks outside a set that turn out to be near no touchdown."""
        numbers = np.concatenate([self._outside[place], numbers])
        touchdowns = np.array(self._touchdowns, dtype=np.int64)
        apart = np.abs(numbers[:, None] - touchdowns)
        rest = numbers[np.min(apart, axis=1, initial=self._ticks) > self._near]
        # The next touchdown may still be near the latest ones.
        settled = rest < self._ticks - self._near
        self._away[place] += int(np.count_nonzero(settled))
        self._outside[place] = rest[~settled]


def membership_lines(memberships: tuple[SetMembership, ...], off_proof: bool = False) -> str:
    """Return a line of HTML for each set; nothing without a proved set.

    Args:
        memberships: answers of the monitor.
        off_proof: whether robot or floor are not those of the proof: then no answer is green.
    """
    return "".join(
        line(_words(one), QUIET if off_proof else GOOD if one.inside else TIGHT)
        for one in memberships
    )


def _words(one: SetMembership) -> str:
    levels = f"level{'s' * (',' in one.levels)} {one.levels.replace(', ', ' and ')}"
    margin = f"{one.margin:.2f}".replace("-", "\u2212")
    if one.name in _EDGES:
        margin += " widths of the region"
    answer = f"{'yes' if one.inside else 'no'}, margin {margin}"
    answer += f" ({margin_in_words(one.name)})"
    if not one.admissible:
        answer = "no, it is not about this command"
    # Rounded down: not all ticks are inside unless all are.
    share = math.floor(1000.0 * one.share) / 10.0
    kind = "walking set" if one.levels == str(WALKING_SET_LEVEL) else "set"
    text = f"Inside the proved {kind} of {levels}: {answer} · {share:.1f} % of ticks so far"
    if one.share == 1.0 or not one.admissible:
        return text
    if one.away_s > 0.0:
        return f"{text}; outside for {one.away_s:.2f} s away from touchdowns"
    near = 1e3 * NEAR_TOUCHDOWN_S
    why = "contact is soft here, and an impact sudden in the proof"
    return f"{text}; outside only within {near:.0f} ms of touchdowns ({why})"
