"""Many seeds in one command against a command for each: how long, and whether weights are equal.

Single trainings run as many at a time as there are cores; a quarter of them is timed one after
the other, too, as a loop of a shell does it. Everything is timed as a user would see it, whole
commands, after one training whose compilations all others find done.

Asked: at least 4 times the throughput, the same gaits to 1e-6. SEEDS=8 takes fewer than 32.
"""

import os
import resource
import shutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor

import jax
import numpy as np
from common import ROOT, show

from neuralgaits._environment import cores
from neuralgaits.analysis.run import open_run

SEEDS = int(os.environ.get("SEEDS", "32"))
QUARTER = max(1, SEEDS // 4)
FOLDER = ROOT / "many-seeds"


def command(*words: str) -> None:
    """Carry out a command in the folder of the benchmark."""
    program = [sys.executable, "-m", "neuralgaits", "train", "amber3m", *words]
    done = subprocess.run(program, cwd=FOLDER, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"exit {done.returncode}: {' '.join(words)}: {done.stderr[-300:]}")


def spent() -> tuple[float, float]:
    """Time of the clock, and of processors by commands that ended [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.perf_counter(), used.ru_utime + used.ru_stime


def main() -> None:
    """Print times, their ratio and the largest difference."""
    shutil.rmtree(FOLDER, ignore_errors=True)
    FOLDER.mkdir(parents=True)
    command("--seed", "1000", "--out", "first")
    start_time = spent()
    command("--seeds", f"0:{SEEDS}", "--out", "together")
    between = spent()
    with ThreadPoolExecutor(cores()) as beside:
        list(beside.map(lambda n: command("--seed", str(n), "--out", f"alone-{n}"), range(SEEDS)))
    ended = spent()
    for number in range(QUARTER):
        command("--seed", str(number), "--out", f"again-{number}")
    loop = (spent()[0] - ended[0]) * SEEDS / QUARTER
    together, alone = (np.subtract(b, a) for a, b in ((start_time, between), (between, ended)))
    show(f"{SEEDS} seeds in one command [s], of processors [s]", f"{together.round(1)}")
    show(f"{SEEDS} commands, {cores()} at a time [s], of processors [s]", f"{alone.round(1)}")
    show("  throughput of one command against that", alone[0] / together[0], ">= 4")
    show("  against commands one after the other", loop / together[0], ">= 4")
    show("  the same by processors", alone[1] / together[1])
    show("  largest difference of a weight", max(map(difference, range(SEEDS))), "<= 1e-6")


def difference(seed: int) -> float:
    """Largest difference of trained weights of a seed."""
    gaits = [open_run(FOLDER / name).trained for name in (f"together/{seed}", f"alone-{seed}")]
    leaves = zip(*(jax.tree.leaves(gait) for gait in gaits), strict=True)
    return max(float(np.max(np.abs(a - b), initial=0.0)) for a, b in leaves)


if __name__ == "__main__":
    main()
