"""Trace a run of a family again to data that a proof of it must match, in a process of its own.

Each family's module NAME_retrace hands its own system to `answer_for`.
"""

from pathlib import Path

from neuralgaits.certificate.chart import Chart
from neuralgaits.certificate.proof_file.theorem_tables import Theorems
from neuralgaits.certificate.run_certificate.retrace import RunDescription, answer
from neuralgaits.runs import plain
from neuralgaits.systems.family_run import open_family_run
from neuralgaits.systems.proof_model import model_data, trace_conditions
from neuralgaits.systems.proved_system import ProvedSystem


def answer_for(system: ProvedSystem) -> None:
    """Answer as `certificate.run_certificate.retrace` asks the process that it starts."""

    def describe(run: Path, theorems: Theorems, chart: Chart) -> RunDescription:
        del theorems, chart  # Families have one chart, and no levels with parameters.
        return describe_family_run(system, run)

    answer(describe)


def describe_family_run(system: ProvedSystem, run: Path) -> RunDescription:
    """Describe what a proof of a run must be about, see `retrace.describe_run`."""
    opened = open_family_run(system, run)
    program = trace_conditions(opened)
    model = model_data(opened, program)
    return {
        "program_hash": program.hash,
        "model": plain(model),
        "regions": {
            name: [{"low": list(low), "high": list(high)} for low, high in boxes]
            for name, boxes in opened.table.regions.items()
        },
        "conditions": model["conditions"],
        "barriers": [],
        "carried": [],
        "told": [],
        "chart": opened.table.chart.table(),
        "full_order": [],
    }
