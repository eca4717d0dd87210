"""The table of a sweep: a CSV row for each combination.

It holds no times, so the same sweep gives the same table, bit for bit, on any machine, in any
order, and however often it was stopped. Each row's `row.json` holds its times.
"""

import csv
import io
from collections.abc import Sequence
from typing import Any

from neuralgaits.records.swept import UNDISTURBED, SweepConfig, SweepRow

_FIRST = (
    "row",
    "robot",
    "spec",
    "speed[m/s]",
    "seed",
    "state",
    "reason",
    "gradient_steps",
    "loss",
    "conditions",
    "conditions_broken",
    "verdict",
    "proved_level",
    "least_margin[scale]",
    "boxes",
)
_GAIT = ("walked_speed[m/s]", "cost_of_transport", "peak_torque[N m]", "least_normal_force[N]")
"""Columns about the walks of a controller without a disturbance."""


def header(config: SweepConfig) -> list[str]:
    """Return the columns; `stays_up:DISTURBANCE` is the share of walks that stayed up under it."""
    names = [*_FIRST]
    for controller in config.controllers:
        names += [f"{controller}:{name}" for name in _GAIT]
        names += [f"{controller}:stays_up:{name}" for name in (UNDISTURBED, *config.disturbances)]
    return names


def to_csv(config: SweepConfig, rows: Sequence[SweepRow]) -> str:
    """Return the table as text; cells of parts that were not done are empty."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(header(config))
    for row in rows:
        writer.writerow([_cell(value) for value in _values(config, row)])
    return out.getvalue()


def _values(config: SweepConfig, row: SweepRow) -> list[Any]:
    values: list[Any] = [
        row.name,
        row.robot,
        row.spec,
        None if row.speed is None else ":".join(f"{v:g}" for v in row.speed),
        row.seed,
        row.failure or "done",
        row.reason,
        row.steps,
        row.loss,
        row.conditions,
        row.broken,
        row.verdict,
        row.proved_level,
        row.margin,
        row.boxes,
    ]
    for controller in config.controllers:
        own = row.under(controller, UNDISTURBED)
        gait = (None,) * len(_GAIT)
        if own is not None:
            gait = (own.speed_m_s, own.cost_of_transport, own.peak_torque_nm)
            gait += (own.min_normal_force_n,)
        values += gait
        for name in (UNDISTURBED, *config.disturbances):
            walk = row.under(controller, name)
            values.append(None if walk is None else walk.share)
    return values


def _cell(value: Any) -> str:
    """Format a float with all its digits, and None as an empty cell."""
    if value is None:
        return ""
    return repr(value) if isinstance(value, float) else str(value)
