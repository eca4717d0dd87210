"""Make the run that `neuralgaits demo` shows: train it, prove it to level 3, keep what is read.

`.venv/bin/python tools/make_demo.py` replaces src/neuralgaits/demo_run; a minute or two.
With `--speed` it replaces demo_speed_run, the gait that is told its speed, which is trained only.
"""

import os
import shutil
import sys
import tempfile
from pathlib import Path

from neuralgaits._environment import prepare

ROBOT, SEED, LEVEL = "amber3m", 0, 3
NAME = "demo_run"
TOLD, SPEED = "demo_speed_run", (0.55, 0.90)
"""The run that is told its speed, in this range [m/s]."""
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


def main() -> None:
    """Train and prove in a folder of its own: paths in the run's summaries are then relative."""
    prepare()
    told = "--speed" in sys.argv[1:]
    name = TOLD if told else NAME
    target = Path(__file__).resolve().parents[1] / "src" / "neuralgaits" / name
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        run = Path(name)
        if told:
            _make_told(run)
        else:
            _make(run)
        shutil.rmtree(target, ignore_errors=True)
        for file in KEPT:
            if told and file.startswith("certificate"):
                continue
            (target / file).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(run / file, target / file)


def _make(run: Path) -> None:
    from neuralgaits.robots import load_robot
    from neuralgaits.workflows.certify import certify
    from neuralgaits.workflows.train import train

    train(load_robot(ROBOT), seed=SEED, out=run, root=Path("runs"))
    proof = certify(run, level=LEVEL)
    if proof.verdict != "proved":
        raise SystemExit(f"expected a proof to level {LEVEL}, found it {proof.verdict}")


def _make_told(run: Path) -> None:
    from neuralgaits.robots import load_robot
    from neuralgaits.workflows.train import train

    train(load_robot(ROBOT), seed=SEED, speed=SPEED, out=run, root=Path("runs"))


if __name__ == "__main__":
    main()
