"""Make the run that `neuralgaits demo` shows: train it, prove it to level 3, keep what is read.

`.venv/bin/python tools/make_demo.py` replaces src/neuralgaits/demo_run; a minute or two.
With `--speed` it replaces demo_speed_run, the gait that is told its speed, with `--lean`
demo_lean_run, the gait that learns the torso's lean; a large proof is packed. With `--again` the
weights stay: the copy of the spec is made anew, and so is the proof.
"""

import gzip
import hashlib
import json
import os
import shutil
import sys
import tempfile
from pathlib import Path
from typing import Any

from neuralgaits._environment import prepare
from neuralgaits.runs.packed import packed

ROBOT = "amber3m"
SEED = 0
LEVEL = 3
RUNS: dict[str, tuple[str, dict[str, Any]]] = {
    "": ("demo_run", {}),
    "--speed": ("demo_speed_run", {"speed": (0.55, 0.90)}),
    "--lean": ("demo_lean_run", {"speed": 0.7, "lean": (-0.03, 0.03)}),
}
"""Name of each run and its ranges [m/s, m], by option."""
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
    again = "--again" in sys.argv[1:]
    name, ranges = RUNS[next((one for one in sys.argv[1:] if one != "--again"), "")]
    target = Path(__file__).resolve().parents[1] / "src" / "neuralgaits" / name
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        run = Path(name)
        if again:
            _copy(target, run)
        else:
            _train(run, ranges)
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


def _train(run: Path, ranges: dict[str, Any]) -> None:
    from neuralgaits.robots import load_robot
    from neuralgaits.workflows.train import train

    train(load_robot(ROBOT), seed=SEED, **ranges, out=run, root=Path("runs"))


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
