"""Find the one sign or zero in a file of columns with which a refused log would be accepted.

Signs and zeros are what files of columns get wrong most often. Each of them is changed alone. A
change fits if the log then passes every check and its joints follow the policy that walked, and
clearly better so than under any other such change.
"""

# pyright: reportAttributeAccessIssue=false
# SciPy's results have no types.

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from neuralgaits.control.measurement import SensedRobot
from neuralgaits.errors import InputError
from neuralgaits.gait import AbstractPolicy
from neuralgaits.logs.formats import mapped as mapped_format
from neuralgaits.logs.formats.column_file import ColumnFile, ColumnSource
from neuralgaits.logs.formats.own_sheet import numbers
from neuralgaits.logs.formats.sheet import Text
from neuralgaits.logs.row_checks import check, check_times


class _Change(NamedTuple):
    """A change of one sign or zero."""

    error: float
    """Error of the worst joint, in the median row [rad]; inf if the log is refused."""
    words: str
    columns: ColumnFile


class ColumnMending:
    """Search for the change of one sign or zero with which a log fits."""

    def __init__(self, text: Text, robot: SensedRobot, policy: AbstractPolicy | None):
        """Keep the log, and the policy that walked, for outputs that the file lacks."""
        self._text = text
        self._robot = robot
        self._policy = policy
        most_rows = 1500  # Rows of a log that are looked at, but for the checks: a few steps.
        self._short = replace(text, cells=text.cells[:most_rows])

    def words(self, columns: ColumnFile) -> str | None:
        """Return the change in words; None if none fits clearly better than all others."""
        try:
            arrays = numbers(self._text, self._robot, columns)
            check_times(arrays.t, arrays.rows, str(self._text.path), columns.sources["time"].column)
        except InputError:
            return None  # Neither signs nor zeros are at fault.
        changes = sorted(self._changes(columns), key=lambda change: change.error)
        largest = 0.05  # Error of the worst joint that follows a policy, in the median row [rad].
        good = [one for one in changes if one.error < largest and self._passes(one.columns)]
        # Least ratio of that error under the second best change to that under the best.
        clearly = 2.0
        if not good or (len(good) > 1 and good[1].error < clearly * good[0].error):
            return None
        return good[0].words

    def _changes(self, columns: ColumnFile) -> Iterator[_Change]:
        for key, source in columns.sources.items():
            if key == "pitch" or key.startswith("joints."):
                sign_changed = columns.turned(key)
                words = f"{key} fits with sign = {-source.sign:g}"
                yield _Change(self._error(sign_changed), words, sign_changed)
                yield self._best_zero(columns, source)

    def _best_zero(self, columns: ColumnFile, source: ColumnSource) -> _Change:
        """Return the best change of a zero."""
        from scipy.optimize import minimize_scalar  # Slow to import, and seldom needed.

        unit = 1.0 if source.factor is None else source.factor

        def with_zero(shift: float) -> ColumnFile:
            offset = source.offset + shift / unit
            return _replaced(columns, replace(source, offset=offset))

        # Changes of a zero that are tried, before the best one is refined [rad].
        zeros_rad = np.linspace(-0.6, 0.6, 13)
        tried = [self._error(with_zero(float(shift))) for shift in zeros_rad]
        best, step = float(zeros_rad[np.argmin(tried)]), float(zeros_rad[1] - zeros_rad[0])
        worth_refining = 0.2  # Error at a zero that is tried [rad].
        if min(tried) < worth_refining:
            optimum = minimize_scalar(
                lambda shift: min(self._error(with_zero(float(shift))), np.pi),
                bounds=(best - step, best + step),
                method="bounded",
                options={"xatol": 1e-3},
            )
            best = float(optimum.x)
        shifted = with_zero(best)
        offset = shifted.sources[source.key].offset
        way = "higher" if best > 0.0 else "lower"
        words = f"{source.key} fits with offset = {offset:.4g}, {abs(best):.2g} rad {way}"
        return _Change(self._error(shifted), words, shifted)

    def _error(self, columns: ColumnFile) -> float:
        try:
            log, _ = mapped_format.read(self._short, self._robot, columns, self._policy)
        except InputError:
            return np.inf
        return float(np.median(np.abs(log.q[:, 1:] - log.qd).max(axis=1)))

    def _passes(self, columns: ColumnFile) -> bool:
        try:
            log, labels = mapped_format.read(self._text, self._robot, columns, self._policy)
            check(log, self._robot, labels)
        except InputError:
            return False
        return bool((log.stance[1:] != log.stance[:-1]).any())


def _replaced(columns: ColumnFile, *changed: ColumnSource) -> ColumnFile:
    return replace(columns, sources={**columns.sources, **{one.key: one for one in changed}})
