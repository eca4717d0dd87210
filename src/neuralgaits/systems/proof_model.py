"""The object "model" of the proof file of a family beside walkers, and its Program."""

from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from neuralgaits.certificate.proof_file.array_tables import array_table
from neuralgaits.programs import Program
from neuralgaits.programs.tracing.tracer import trace
from neuralgaits.systems.family_run import FamilyRun


def trace_conditions(run: FamilyRun) -> Program:
    """Return the margins of a run's conditions as a Program of the chart's point."""
    system = run.system
    return trace(
        lambda u: system.margins(run, u),
        {"u": (run.table.chart.size,)},
        parameters=run.controller,
    )


def model_data(run: FamilyRun, program: Program) -> dict[str, Any]:
    """Return the object "model" of a proof: the numbers of file and run, nothing derived."""
    arrays = {
        owner: array_table(owner, own, program.parameters)
        for owner, own in arrays_of(run.controller)
    }
    numbers = run.system.spec_numbers(run.config)
    return {
        "family": run.config.family,
        "robot": {name: x.hex() for name, x in run.data.numbers().items()},
        **{owner.rpartition(".")[2]: own for owner, own in arrays.items()},
        **{name: x.hex() for name, x in numbers.items()},
        **run.table.model_entries(),
    }


def arrays_of(controller: Any, owner: str = "") -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Yield the arrays of each module of a controller, by name, after the module's own path.

    Programs call them OWNER.NAME.
    """
    inside = {one.name: getattr(controller, one.name) for one in fields(controller)}
    arrays = {name: value for name, value in inside.items() if isinstance(value, np.ndarray)}
    if arrays:
        yield owner, arrays
    for name, value in inside.items():
        if is_dataclass(value):
            yield from arrays_of(value, f"{owner}.{name}" if owner else name)
