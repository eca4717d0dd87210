"""Trace a cart-pole's run again to data that a proof of it must match, in a process of its own.

It answers as `certificate.run_certificate.retrace` asks.
"""

from pathlib import Path
from typing import Any

from neuralgaits.certificate.chart import Chart
from neuralgaits.certificate.proof_file.theorem_tables import Theorems
from neuralgaits.certificate.run_certificate.retrace import answer
from neuralgaits.runs import plain
from neuralgaits.systems.cartpole.cartpole_certify import trace_conditions
from neuralgaits.systems.cartpole.cartpole_run import open_cartpole
from neuralgaits.systems.cartpole.proof_model import model_data
from neuralgaits.systems.cartpole.state_regions import CHART


def describe_cartpole(run: Path, theorems: Theorems, chart: Chart) -> dict[str, Any]:
    """Describe what a proof of a run must be about, see `retrace.describe_run`."""
    del theorems, chart
    opened = open_cartpole(run)
    program = trace_conditions(opened)
    model = model_data(opened, program)
    return {
        "program_hash": program.hash,
        "model": plain(model),
        "regions": {
            name: [{end: _numbers(corner) for end, corner in box.items()} for box in boxes]
            for name, boxes in model["regions"].items()
        },
        "conditions": model["conditions"],
        "barriers": [],
        "carried": [],
        "told": [],
        "chart": CHART.table(),
        "full_order": [],
    }


def _numbers(corner: list[str]) -> list[float]:
    return [float.fromhex(value) for value in corner]


if __name__ == "__main__":
    answer(describe_cartpole)
