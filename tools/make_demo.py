"""Make the run that `neuralgaits demo` shows: train it, prove it to level 3, keep what is read.

`.venv/bin/python tools/make_demo.py` replaces src/neuralgaits/demo_run; a minute or two.
With `--speed` it replaces demo_speed_run, the gait that is told its speed: millions of boxes, some
five minutes more, in a proof that is packed. With `--again` the weights stay: the copy of the spec
is made anew, and so is the proof.
"""

import gzip
import hashlib
import json
import os
import shutil
import sys
import tempfile
from pathlib import Path

from neuralgaits._environment import prepare
from neuralgaits.runs.packed import packed

ROBOT = "amber3m"
SEED = 0
LEVEL = 3
NAME = "demo_run"
COMMANDED = "demo_speed_run"
"""The run that takes a command for its speed."""
SPEED = (0.55, 0.90)
"""Range of its speed [m/s]."""
KEPT = (
    "config.json",
    "metrics.csv",
    "policy.safetensors",
    "robot.xml",
    "spec.py",
    "summary.json",
    "certificate/map.safetensors",
    "certificate/proof.json",
    "certificate/summary.json",
)
"""Checkpoints, boxes of the search and pictures stay behind."""
LARGEST_BYTES = 500_000
"""A proof that is larger is packed."""


def main() -> None:
    """Train and prove in a folder of its own: paths in the run's summaries are then relative."""
    prepare()
    commanded = "--speed" in sys.argv[1:]
    again = "--again" in sys.argv[1:]
    name = COMMANDED if commanded else NAME
    target = Path(__file__).resolve().parents[1] / "src" / "neuralgaits" / name
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        run = Path(name)
        if again:
            _copy(target, run)
        else:
            _train(run, SPEED if commanded else None)
        _prove(run)
        shutil.rmtree(target, ignore_errors=True)
        for file in KEPT:
            if not (run / file).is_file():
                continue
            (target / file).parent.mkdir(parents=True, exist_ok=True)
            content = (run / file).read_bytes()
            if len(content) < LARGEST_BYTES:
                (target / file).write_bytes(content)
            else:
                packed(target / file).write_bytes(gzip.compress(content, 9, mtime=0))


def _train(run: Path, speed: tuple[float, float] | None) -> None:
    from neuralgaits.robots import load_robot
    from neuralgaits.workflows.train import train

    train(load_robot(ROBOT), seed=SEED, speed=speed, out=run, root=Path("runs"))


def _copy(target: Path, run: Path) -> None:
    """Copy the run that is there, with the spec's source as it is now."""
    from neuralgaits.barriers import specs
    from neuralgaits.records.trained import measured_hashes
    from neuralgaits.runs.plain import to_json

    shutil.copytree(target, run, ignore=shutil.ignore_patterns("certificate"))
    config = json.loads((run / "config.json").read_text(encoding="utf-8"))
    source = specs.source_path(config["spec"]).read_bytes()
    (run / "spec.py").write_bytes(source)
    config["copies"]["spec.py"] = hashlib.sha256(source).hexdigest()
    (run / "config.json").write_text(to_json(config), encoding="utf-8")
    # Conditions that differ from those it was trained for are refused when the run is opened.
    summary = json.loads((run / "summary.json").read_text(encoding="utf-8"))
    summary["sha256"] |= measured_hashes(run)
    (run / "summary.json").write_text(to_json(summary), encoding="utf-8")


def _prove(run: Path) -> None:
    from neuralgaits.workflows.certify import certify

    proof = certify(run, level=LEVEL)
    if proof.verdict != "proved":
        raise SystemExit(f"expected a proof to level {LEVEL}, found it {proof.verdict}")


if __name__ == "__main__":
    main()
