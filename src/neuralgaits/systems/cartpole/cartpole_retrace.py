"""Trace a cart-pole's run again to data that a proof of it must match, in a process of its own.

It has the interface of `certificate.run_certificate.retrace`'s process: theorems and chart come in,
JSON goes out.
"""

import json
import sys
from pathlib import Path
from typing import Any

from neuralgaits.errors import NeuralGaitsError
from neuralgaits.runs import plain, write_text
from neuralgaits.systems.cartpole.cartpole_certify import trace_conditions
from neuralgaits.systems.cartpole.cartpole_run import open_cartpole
from neuralgaits.systems.cartpole.proof_model import model_data
from neuralgaits.systems.cartpole.state_regions import CHART


def describe_cartpole(run: Path) -> dict[str, Any]:
    """Describe what a proof of a run must be about, see `retrace.describe_run`."""
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


def _main(run: str, file: str) -> None:
    sys.stdin.read()
    try:
        found = describe_cartpole(Path(run))
    except (NeuralGaitsError, OSError) as error:
        found = {"error": str(error)}
    write_text(Path(file), json.dumps(found))


if __name__ == "__main__":
    _main(*sys.argv[1:])
