"""The table of a sweep: a CSV row for each combination.

It holds no times, so the same sweep gives the same table, bit for bit, on any machine, in any
order, and however often it was stopped. Each row's `row.json` holds its times.
"""

import csv
import io
from collections.abc import Callable, Sequence
from typing import Any

from neuralgaits.records.swept import UNDISTURBED, SweepConfig, SweepRow

Column = tuple[str, Callable[[Any], Any]]
"""A column: its name, with its unit, and its value of a row or of the walks of one."""

_ROW_COLUMNS: tuple[Column, ...] = (
    ("row", lambda row: row.name),
    ("robot", lambda row: row.robot),
    ("spec", lambda row: row.spec),
    ("speed[m/s]", lambda row: row.speed and ":".join(f"{v:g}" for v in row.speed)),
    ("seed", lambda row: row.seed),
    ("state", lambda row: row.failure or "done"),
    ("reason", lambda row: row.reason),
    ("gradient_steps", lambda row: row.steps),
    ("loss", lambda row: row.loss),
    ("conditions", lambda row: row.conditions),
    ("conditions_broken", lambda row: row.broken),
    ("verdict", lambda row: row.verdict),
    ("proved_level", lambda row: row.proved_level),
    ("least_margin[scale]", lambda row: row.margin),
    ("boxes", lambda row: row.boxes),
)
_WALK_COLUMNS: tuple[Column, ...] = (
    ("walked_speed[m/s]", lambda walks: walks.speed_m_s),
    ("cost_of_transport", lambda walks: walks.cost_of_transport),
    ("peak_torque[N m]", lambda walks: walks.peak_torque_nm),
    ("least_normal_force[N]", lambda walks: walks.min_normal_force_n),
)
"""Columns about the walks of a controller without a disturbance."""


def _columns(config: SweepConfig) -> list[Column]:
    columns = list(_ROW_COLUMNS)
    for law in config.controllers:
        for name, value in _WALK_COLUMNS:
            columns.append((f"{law}:{name}", _value_of(law, UNDISTURBED, value)))
        for name in (UNDISTURBED, *config.disturbances):
            columns.append((f"{law}:stays_up:{name}", _value_of(law, name, lambda w: w.share)))
    return columns


def _value_of(law: str, disturbance: str, value: Callable[[Any], Any]) -> Callable[[Any], Any]:
    def of_row(row: SweepRow) -> Any:
        walks = row.under(law, disturbance)
        return None if walks is None else value(walks)

    return of_row


def header(config: SweepConfig) -> list[str]:
    """Return the columns; `stays_up:DISTURBANCE` is the share of walks that stayed up under it."""
    return [name for name, _ in _columns(config)]


def to_csv(config: SweepConfig, rows: Sequence[SweepRow]) -> str:
    """Return the table as text; cells of parts that were not done are empty."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    columns = _columns(config)
    writer.writerow([name for name, _ in columns])
    for row in rows:
        writer.writerow([_cell(value(row)) for _, value in columns])
    return out.getvalue()


def _cell(value: Any) -> str:
    """Format a float with all its digits, and None as an empty cell."""
    if value is None:
        return ""
    return repr(value) if isinstance(value, float) else str(value)
