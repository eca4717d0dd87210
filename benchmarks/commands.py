"""Seconds of whole commands, as a user waits for them, with nothing compiled before and with all.

Asked: train at most 10 s cold and 6 s warm, certify 5 s to level 3 and 15 s to level 4, `make walk`
(train, simulate, certify, report) 22 s, imports 1.5 s. Ratios to a process that only imports JAX,
run beside them, travel from machine to machine. REPEATS=1 shortens.
"""

import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from pathlib import Path

from common import show

REPEATS = int(os.environ.get("REPEATS", 3))
WALK = (("train", "amber3m"), ("simulate",), ("certify",), ("report",))
"""The commands of `make walk`; all but the first are about the run that it leaves."""
ASKED = {
    "imports of train": "<= 1.5",
    "imports of simulate": "<= 1.5",
    "train, cold": "<= 10",
    "train, warm": "<= 6",
    "make walk, cold": "<= 22",
    "certify --level 3, warm": "<= 5",
    "certify --level 4, warm": "<= 15",
}


def main() -> None:
    """Print medians and their ratios to what is imported anyway."""
    taken: dict[str, list[float]] = defaultdict(list)
    for repeat in range(REPEATS):
        with tempfile.TemporaryDirectory() as scratch:
            folder = Path(scratch)
            taken["import jax"].append(seconds(folder, ["-c", "import jax"]))
            for verb in ("train", "simulate"):
                code = f"import neuralgaits.workflows.{verb}"
                taken[f"imports of {verb}"].append(seconds(folder, ["-c", code]))
            for state in ("cold", "warm"):
                run = folder / f"{state}-{repeat}"
                each = [walked(folder, run, *line) for line in WALK]
                for (verb, *_), one in zip(WALK, each, strict=True):
                    taken[f"{verb}, {state}"].append(one)
                taken[f"make walk, {state}"].append(sum(each))
            for level in "34":
                one = walked(folder, run, "certify", "--level", level)
                taken[f"certify --level {level}, warm"].append(one)
    unit = statistics.median(taken["import jax"])
    for name, times in taken.items():
        middle = statistics.median(times)
        spread = f"{min(times):.1f}-{max(times):.1f}"
        show(f"{name}: s, median of {REPEATS} ({spread})", middle, ASKED.get(name, ""))
        show(f"{name}: times `import jax`", middle / unit)


def walked(folder: Path, run: Path, verb: str, *more: str) -> float:
    """One command about a run, or the training that makes it."""
    about = [*more, "--out", str(run)] if verb == "train" else [str(run), *more]
    return seconds(folder, ["-c", "from neuralgaits.cli.main import run; run()", verb, *about])


def seconds(folder: Path, arguments: list[str]) -> float:
    """How long a Python process takes whose caches lie in a folder of its own."""
    # This process has set the first already; a child must choose its own folder.
    own = {"JAX_COMPILATION_CACHE_DIR", "XDG_CACHE_HOME"}
    environment = {name: value for name, value in os.environ.items() if name not in own}
    environment["XDG_CACHE_HOME"] = str(folder / "cache")
    start_time = time.perf_counter()
    done = subprocess.run(
        [sys.executable, *arguments], env=environment, capture_output=True, text=True
    )
    if done.returncode:
        raise RuntimeError(done.stderr)
    return time.perf_counter() - start_time


if __name__ == "__main__":
    main()
