"""The log in examples/logs, made again: twenty rows of the shipped run's walk, columns renamed.

`PYTHONPATH=src:tests python -m support.log_example` writes it.
"""

import shutil
import tempfile
from pathlib import Path

import jax
import numpy as np

from neuralgaits import logs
from neuralgaits.logs import Log
from neuralgaits.robots import load_robot
from neuralgaits.workflows.simulate import simulate
from support import own_columns
from support.shipped_run import SHIPPED

FOLDER = Path(__file__).parents[2] / "examples" / "logs"
LOG, COLUMNS = FOLDER / "walk.csv", FOLDER / "columns.toml"
ROWS, EVERY = 20, 5
"""Rows of the example, and how many of the log one of them stands for."""
DIGITS = 3


def simulated(folder: Path) -> Log:
    """Five steps of the shipped run, whose copy and log are left in the folder."""
    run = shutil.copytree(SHIPPED, folder / "run")
    simulate(run, steps=5, log=folder / "si.csv")
    return logs.read(folder / "si.csv", load_robot("amber3m")).log


def columns(log: Log) -> dict[str, np.ndarray]:
    """Columns of the example, of that walk. [20] each."""
    touchdown = int(np.flatnonzero(np.diff(log.stance))[1]) + 1
    # Half of the rows lie before the second touchdown.
    rows = touchdown + EVERY * (np.arange(ROWS) - ROWS // 2)
    found = own_columns.values(load_robot("amber3m"), log)
    return {
        name: np.rint(values[rows]).astype(int) if name == "t_ms" else values[rows]
        for name, values in found.items()
    }


def main() -> None:
    """Write the example."""
    jax.config.update("jax_enable_x64", True)
    with tempfile.TemporaryDirectory() as folder:
        own_columns.write(LOG, columns(simulated(Path(folder))), digits=DIGITS)


if __name__ == "__main__":
    main()
