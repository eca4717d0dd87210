"""Refuse a log whose momentum fits the weight with other signs of pitch or joints.

Many wrong signs keep every angle in its range. The balance of momentum tells them apart: it is off
by most of itself then, and by a few percent with the right signs, with which feet also land on the
floor. One sign is tried at a time, and those of a left and a right joint together.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from neuralgaits.control.measurement import SensedRobot
from neuralgaits.errors import InputError
from neuralgaits.gait import AbstractPolicy
from neuralgaits.logs.formats import mapped as mapped_format
from neuralgaits.logs.formats.column_file import ColumnFile
from neuralgaits.logs.formats.sheet import Text
from neuralgaits.logs.momentum_balance import landing_height, momentum_misfit
from neuralgaits.logs.row_checks import check
from neuralgaits.logs.walk_table import Log


class SignCheck:
    """The search for other signs with which a log fits the weight."""

    def __init__(self, text: Text, robot: SensedRobot, policy: AbstractPolicy | None):
        """Keep the log, and the policy that walked, for outputs that the file lacks."""
        most_rows = 6000  # Rows of a log that other signs are tried on.
        self._text = replace(text, cells=text.cells[:most_rows])
        self._robot, self._policy = robot, policy

    def refuse(self, log: Log, columns: ColumnFile) -> None:
        """Refuse signs with which a log does not fit, if others fit clearly better.

        Args:
            log: log as the file of columns has it.
            columns: what the columns of the log are.

        Raises: InputError with the columns and their signs.
        """
        doubt = self._doubt(log)
        if doubt is None or doubt.size <= 1.0:
            return
        tried = [(self._doubt_with(columns.turned(*keys)), keys) for keys in self._choices()]
        best, keys = min(tried, key=lambda one: one[0].size)
        # Least ratio of what is off to that with other signs, if those are to be believed.
        clearly = 3.0
        if not (best.size <= 1.0 and clearly * best.size < doubt.size):
            return
        sources = [columns.sources[key] for key in keys]
        names = " and ".join(dict.fromkeys(one.column for one in sources))
        signs = " and ".join(f"sign = {-one.sign:g} for {one.key}" for one in sources)
        raise InputError(
            f"log {self._text.path}, column {names}: expected angles with which the momentum about "
            "the stance foot changes as the weight changes it, and feet land on the floor, found "
            f"{doubt}, and {best} with the other sign: write {signs} in {columns.path}, "
            "all else as it is"
        )

    def _choices(self) -> Iterator[tuple[str, ...]]:
        """Yield the keys whose signs are turned together, single ones first."""
        legs = self._robot.layout.leg_joints
        pairs = [tuple(dict.fromkeys(pair)) for pair in zip(*legs, strict=True)]
        yield ("pitch",)
        for name in dict.fromkeys(name for pair in pairs for name in pair):
            yield (f"joints.{name}",)
        for pair in pairs:
            if len(pair) == 2:
                yield tuple(f"joints.{name}" for name in pair)

    def _doubt_with(self, columns: ColumnFile) -> "_Doubt":
        """Return the doubt with these signs, without end for a log that cannot be read so."""
        nothing = _Doubt(np.inf, np.inf, np.inf)
        try:
            log, labels = mapped_format.read(self._text, self._robot, columns, self._policy)
            check(log, self._robot, labels)
        except InputError:
            return nothing
        return self._doubt(log) or nothing

    def _doubt(self, log: Log) -> "_Doubt | None":
        """Return the doubt about a log; None where nothing can be judged."""
        off, height = momentum_misfit(log, self._robot), landing_height(log, self._robot)
        if self._robot.feet is not None or height is None:
            return None
        # Height of a foot that lands up to which there is none, in leg lengths: zeros, uneven
        # floors.
        landing = 0.03
        lands = landing * self._robot.layout.leg_length
        usual_share = 0.3  # Of the momentum's balance.
        return _Doubt(off, height, max((off or 0.0) / usual_share, height / lands))


class _Doubt(NamedTuple):
    """Distance of a log from what its signs must give."""

    off: float | None
    """Share of the momentum's balance; None without a step to judge by."""
    height: float
    """Height of a foot that lands [m]."""
    size: float
    """The larger of both, over what is usual."""

    def __str__(self) -> str:
        balance = "" if self.off is None else f"{100.0 * self.off:.0f} % of that off and "
        return f"{balance}{1e3 * self.height:.0f} mm"
