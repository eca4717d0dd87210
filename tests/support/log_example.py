"""The log in examples/logs, made again: twenty rows of the shipped run's walk, columns renamed.

`PYTHONPATH=src:tests python -m support.log_example` writes it.
"""

import shutil
import tempfile
from pathlib import Path

import jax
import numpy as np

from support import own_columns
from support.shipped_run import SHIPPED

FOLDER = Path(__file__).parents[2] / "examples" / "logs"
LOG, COLUMNS = FOLDER / "walk.csv", FOLDER / "columns.toml"
ROWS, EVERY = 20, 5
"""Rows of the example, and how many of the log one of them stands for."""
DIGITS = 3


def columns(folder: Path) -> dict[str, np.ndarray]:
    """Columns of the example: of a walk that is simulated in a folder. [20] each."""
    from neuralgaits import logs
    from neuralgaits.robots import load_robot
    from neuralgaits.workflows.simulate import simulate

    run = shutil.copytree(SHIPPED, folder / "run")
    simulate(run, steps=3, log=folder / "walk.csv")
    robot = load_robot("amber3m")
    log = logs.read(folder / "walk.csv", robot).log
    touchdown = int(np.flatnonzero(np.diff(log.stance))[1]) + 1
    # Half of the rows lie before the second touchdown.
    rows = touchdown + EVERY * (np.arange(ROWS) - ROWS // 2)
    found = {name: values[rows] for name, values in own_columns.values(robot, log).items()}
    return found | {"t_ms": np.rint(found["t_ms"]).astype(int)}


def main() -> None:
    """Write the example."""
    jax.config.update("jax_enable_x64", True)
    with tempfile.TemporaryDirectory() as folder:
        own_columns.write(LOG, columns(Path(folder)), digits=DIGITS)


if __name__ == "__main__":
    main()
