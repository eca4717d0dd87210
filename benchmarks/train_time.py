"""Seconds of the whole process `neuralgaits train amber3m`, with and without compiled programs.

Asked: at most 20 s from a cold start, at most 8 s with a warm compilation cache.
REPEATS=1 shortens.
"""

import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

from common import show

REPEATS = int(os.environ.get("REPEATS", 3))


class Cost(NamedTuple):
    """What one process cost."""

    wall_s: float
    cpu_s: float


def main() -> None:
    """Print the medians, their ratio, and what the process costs before it trains."""
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        importing = [imported(folder) for _ in range(REPEATS)]
        cold = [trained(folder, f"cold-{i}", f"cache-{i}") for i in range(REPEATS)]
        warm = [trained(folder, f"warm-{i}", "cache-0") for i in range(REPEATS)]
    rows = (
        ("interpreter and imports", importing, ""),
        ("train amber3m, cold", cold, "<= 20"),
        ("train amber3m, warm cache", warm, "<= 8"),
    )
    for name, costs, asked in rows:
        wall, cpu = (sorted(figure) for figure in zip(*costs, strict=True))
        show(f"{name}: seconds, median of {REPEATS}", statistics.median(wall), asked)
        show(f"{name}: seconds, least and most", f"{wall[0]:.1f}-{wall[-1]:.1f}")
        # Other work on the machine stretches the first figure far more than this one.
        show(f"{name}: CPU seconds, median", statistics.median(cpu))
    first, second = (statistics.median(c.wall_s for c in costs) for costs in (cold, warm))
    show("cold / warm", first / second)


def imported(folder: Path) -> Cost:
    """A process that imports what training needs and ends."""
    return cost(folder, "cache-import", ["-c", "import neuralgaits.workflows.train"])


def trained(folder: Path, run: str, cache: str) -> Cost:
    """One training with its own run folder."""
    program = "from neuralgaits.cli.main import run; run()"
    command = ["-c", program, "train", "amber3m", "--out", str(folder / run)]
    return cost(folder, cache, command)


def cost(folder: Path, cache: str, arguments: list[str]) -> Cost:
    """What a Python process with a compilation cache of its own costs."""
    environment = {
        # This process has set it already; a child must choose its own folder.
        name: value
        for name, value in os.environ.items()
        if name != "JAX_COMPILATION_CACHE_DIR"
    }
    environment["XDG_CACHE_HOME"] = str(folder / cache)
    began, spent = time.perf_counter(), children_cpu_s()
    done = subprocess.run(
        [sys.executable, *arguments], env=environment, capture_output=True, text=True
    )
    if done.returncode:
        raise RuntimeError(done.stderr)
    return Cost(time.perf_counter() - began, children_cpu_s() - spent)


def children_cpu_s() -> float:
    """CPU seconds of all finished child processes."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


if __name__ == "__main__":
    main()
