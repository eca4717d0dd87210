"""Robot files of strangers, from the file to a proof of level 3 and 200 steps, without a hand.

    python benchmarks/door.py [SEED] [FILE ...]

Each file of `tests/support/door_robots.py` goes through `train --feet`, `certify` and `simulate
--steps 200`, at one seed and with default settings: on flat feet where the file has some, else on
points. A row says how far it came; a line below it, what stopped it.
"""

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import common  # noqa: F401 - tests/support is found by it

from support import door_robots

STEPS = 200


def call(folder: Path, *words: str) -> tuple[int, dict, str]:
    """Run a command. Returns: its exit code, its JSON, and the last line of its stderr."""
    done = subprocess.run(
        [sys.executable, "-m", "neuralgaits", *words, "--json"],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    said = done.stderr.strip().splitlines() or [""]
    return done.returncode, json.loads(done.stdout) if done.stdout.strip() else {}, said[-1]


def trained(folder: Path, name: str, seed: int) -> tuple[str, int, str]:
    """Train a changed copy of a file. Returns: its feet, its changes, and what stopped it."""
    said = ""
    for feet in ("flat", "point"):
        words = ("--feet", feet, "--seed", str(seed), "--out", "run")
        code, found, said = call(folder, "train", name, *words)
        if code == 0:
            text = (folder / "run" / "robot.xml").read_text(encoding="utf-8")
            comment = text.partition("<!--")[2].partition("-->")[0]
            return feet, len(comment.strip().splitlines()) - 1, ""
        if found:
            return feet, 0, f"training failed: {found.get('broken', code)}"
    return "", 0, said


def row(name: str, text: str, seed: int) -> tuple[list[str], str]:
    """Take one file as far as it goes. Returns: cells of its row, and what stopped it."""
    with tempfile.TemporaryDirectory() as place:
        folder, start = Path(place), time.perf_counter()
        (folder / name).write_text(text, encoding="utf-8")
        feet, changes, stopped = trained(folder, name, seed)
        if stopped:
            return [name, "-", "-", "-", "-", "-"], stopped
        code, proof, said = call(folder, "certify", "run")
        level = str(proof.get("level", "-")) if code == 0 else "-"
        if code != 0:
            stopped = stopped or said or f"certify: {proof.get('verdict', code)}"
        code, walk, said = call(folder, "simulate", "run", "--steps", str(STEPS))
        steps = str(min(walk.get("steps_walked", [0])))
        if code != 0:
            stopped = stopped or said or "it fell"
        took = f"{time.perf_counter() - start:.0f} s"
        return [name, feet, str(changes), level, steps, took], stopped


def main() -> None:
    """Print a row for each file."""
    seed = int(sys.argv[1]) if len(sys.argv) > 1 else 0
    chosen = sys.argv[2:] or list(door_robots.files())
    print(f"{'file':24s} {'feet':6s} {'changes':8s} {'level':6s} {'steps':6s} time, seed {seed}")
    for name in chosen:
        cells, stopped = row(name, door_robots.files()[name], seed)
        widths = (24, 6, 8, 6, 6, 6)
        line = " ".join(f"{cell:{width}s}" for cell, width in zip(cells, widths, strict=True))
        print(line, flush=True)
        if stopped:
            print(f"    {stopped[:300]}", flush=True)


if __name__ == "__main__":
    main()
