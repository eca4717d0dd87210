"""Gains of a gait as the tables of `ng_schedule` in `c/controller.h`."""

import numpy as np

from neuralgaits._types import Float
from neuralgaits.control.scheduled_pd import GainSchedule
from neuralgaits.errors import SpecError
from neuralgaits.gait.scheduled_gains import MARGIN
from neuralgaits.programs.c99.constant_arrays import Tables, braces, literal

TABLES = ("fences", "torque", "inertia")
"""Fields of `ng_schedule` that point to numbers."""


def schedule_fields(schedule: GainSchedule) -> dict[str, Float[np.ndarray, "..."]]:
    """Return the numbers of a schedule by the names of their fields, each pair of terms included.

    Raises: SpecError for a tube whose fences have more terms than C has room for.
    """
    gait, gains = schedule.gait, schedule.gains
    stride = np.asarray(gait.stride, np.float64)
    fences = float(gait.tube.unit) * np.stack([gait.tube.lower, gait.tube.upper], axis=1)
    most = 32  # Largest number of terms in one direction: NG_SERIES of `c/controller.h`.
    if len(fences) > most:
        raise SpecError(
            f"scheduled-pd: expected fences of at most {most} terms, found {len(fences)}: use pd"
        )
    tables = {
        "fences": fences[:, None, :],
        "torque": np.moveaxis(np.asarray(gains.torque), 0, 2),
        "inertia": np.moveaxis(np.asarray(gains.inertia), (0, 1), (2, 3)),
    }
    return {
        "start": -np.asarray(gait.phase(np.zeros(())), np.float64) * stride,
        "stride": stride,
        "margin": MARGIN,
        "fence_terms": np.array(tables["fences"].shape[:2]),
        "torque_terms": np.array(tables["torque"].shape[:2]),
        "inertia_terms": np.array(tables["inertia"].shape[:2]),
        **{name: np.ascontiguousarray(table, np.float64) for name, table in tables.items()},
    }


def schedule_literal(schedule: GainSchedule, tables: Tables) -> str:
    """Return the initialiser of an `ng_schedule`, whose numbers go into static tables."""
    values = []
    for name, value in schedule_fields(schedule).items():
        if name in TABLES:
            values.append(f".{name} = {tables.reals(f'schedule_{name}', value.ravel())}")
        elif value.dtype.kind == "i":
            values.append(f".{name} = {{{', '.join(map(str, value.tolist()))}}}")
        else:
            values.append(f".{name} = {braces(value) if value.ndim else literal(float(value))}")
    return f"{{{', '.join(values)}}}"
