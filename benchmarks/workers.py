"""Two workers against one, and Ray against processes: a sweep, and the proof of a commanded gait.

Every command is timed as a user would see it, its start included, after one small sweep whose
compilations all others find done. Tables and proof files must be the same bit for bit.

Asked: two workers >= 1.7 times as fast as one; Ray (two cores of this machine) >= 0.9 of two
processes. `workers.py sweep` and `workers.py certificate` measure these alone. SEEDS=2 takes fewer
seeds than the 20 that are asked, STEPS=60 fewer gradient steps; WITHIN=0.7:0.702 proves a narrower
range of speeds, LEVEL=2 another level, and WORKERS=1,2,8 names the workers of the proof.
"""

import hashlib
import importlib.util
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from common import ROOT, show

import neuralgaits
from neuralgaits.records.certified import PROOF
from neuralgaits.runs import packed

SPEED_RUN = Path(neuralgaits.__file__).parent / "demo_speed_run"
ROBOTS = ("amber3m", "rabbit")
FOLDER = ROOT / "workers"


def main(parts: Sequence[str]) -> None:
    """Print the ratios."""
    shutil.rmtree(FOLDER, ignore_errors=True)
    FOLDER.mkdir(parents=True)
    for part in parts:
        {"sweep": sweeps, "certificate": certificates}[part]()


def sweeps() -> None:
    """Two processes against one, and a local Ray against both."""
    count = os.environ.get("SEEDS", "20")
    steps = os.environ.get("STEPS")
    words = ["sweep", *ROBOTS, "--certify", "2", *(["--steps", steps] if steps else [])]
    # The seed is none of those that are timed.
    command([*words, "--seeds", "1000", "--workers", "2", "--out", "first"])
    taken, tables = {}, set()
    engines = {"1": ["--workers", "1"], "2": ["--workers", "2"]}
    if importlib.util.find_spec("ray") is not None:
        engines["ray"] = ["--ray", "local", "--workers", "2"]
    for name, engine in engines.items():
        out = f"sweep-{name}"
        taken[name] = command([*words, "--seeds", f"0:{count}", *engine, "--out", out])
        tables.add((FOLDER / out / "table.csv").read_bytes())
        show(f"sweep of {2 * int(count)} rows on {name} [s]", taken[name])
    show("  tables that differ", len(tables) - 1, "0")
    show("  2 workers against 1", taken["1"] / taken["2"], ">= 1.7")
    if "ray" in taken:
        show("  Ray against 2 processes", taken["2"] / taken["ray"], ">= 0.9")


def certificates() -> None:
    """Proofs of the shipped gait that is told its speed, on more and more workers."""
    within = os.environ.get("WITHIN", "0.70:0.71")
    workers = os.environ.get("WORKERS", "1,2").split(",")
    words = ["--level", os.environ.get("LEVEL", "1"), "--within", f"speed={within}"]
    taken, proofs = {}, set()
    for count in workers:
        run = FOLDER / f"run-{count}"
        shutil.copytree(SPEED_RUN, run, ignore=shutil.ignore_patterns("certificate"))
        # A narrower range leaves the run as a whole undecided: exit code 3.
        taken[count] = command(["certify", run.name, *words, "--workers", count], (0, 3))
        proof = packed.content(run / PROOF)
        proofs.add(hashlib.sha256(proof).hexdigest())
        show(f"certificate, speed {within}, {count} workers [s]", taken[count])
    show("  proof files that differ", len(proofs) - 1, "0")
    if {"1", "2"} <= taken.keys():
        show("  2 workers against 1", taken["1"] / taken["2"], ">= 1.7")


def command(words: Sequence[str], good: Sequence[int] = (0,)) -> float:
    """Carry out a command in the folder of the benchmark. Returns: its time [s]."""
    start_time = time.perf_counter()
    program = [sys.executable, "-m", "neuralgaits", *words]
    done = subprocess.run(program, cwd=FOLDER, capture_output=True, text=True)
    if done.returncode not in good:
        raise SystemExit(f"exit {done.returncode}: {' '.join(words)}: {done.stderr[-300:]}")
    return time.perf_counter() - start_time


if __name__ == "__main__":
    main(sys.argv[1:] or ["sweep", "certificate"])
