"""The monitor of a live page: whether the controller's states are in the sets that are proved."""

import math
from typing import NamedTuple

import numpy as np

from neuralgaits.analysis.run import Run
from neuralgaits.analysis.state_monitor import StateMonitor
from neuralgaits.analysis.step_parameters import step_parameters
from neuralgaits.records.monitored import margin_in_words
from neuralgaits.simulation.live_tick import MeasuredTick
from neuralgaits.viewer.page_style import GOOD, TIGHT, line


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


class LiveMonitor:
    """Counts the ticks of a walk that are in each proved set.

    Ticks are collected, and evaluated together when somebody wants to know.
    """

    def __init__(self, run: Run, monitor: StateMonitor):
        """Prepare the monitor.

        Args:
            run: run that walks.
            monitor: sets that are proved of its gait.
        """
        self._run, self._monitor = run, monitor
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
        self._latest = ()

    def add(self, tick: MeasuredTick) -> None:
        """Add a tick of the walk."""
        self._pending.append(tick)

    def memberships(self) -> tuple[SetMembership, ...]:
        """Return the answer at the last tick for each set, lowest level first; () before any."""
        if not self._pending:
            return self._latest
        ticks = MeasuredTick(*map(np.stack, zip(*self._pending, strict=True)))
        self._pending = []
        self._ticks += len(ticks.q)
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
            answers.append(
                SetMembership(
                    ", ".join(map(str, one.levels)),
                    bool(inside[-1]),
                    float(member.margin[-1]),
                    one.names[member.nearest[-1]],
                    bool(admissible[-1]),
                    self._inside[place] / self._ticks,
                )
            )
        self._latest = tuple(answers)
        return self._latest


def membership_lines(memberships: tuple[SetMembership, ...]) -> str:
    """Return a line of HTML for each set; nothing without a proved set."""
    return "".join(line(_words(one), GOOD if one.inside else TIGHT) for one in memberships)


def _words(one: SetMembership) -> str:
    levels = f"level{'s' * (',' in one.levels)} {one.levels.replace(', ', ' and ')}"
    answer = f"{'yes' if one.inside else 'no'}, margin {one.margin:.2f}"
    answer += f" ({margin_in_words(one.name)})"
    if not one.admissible:
        answer = "no, it is not about this command"
    # Rounded down: not all ticks are inside unless all are.
    share = math.floor(1000.0 * one.share) / 10.0
    return f"Inside the proved set of {levels}: {answer} · {share:.1f} % of ticks so far"
