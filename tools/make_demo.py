"""Make the run that `neuralgaits demo` shows: train it, prove it to level 3, keep what is read.

`.venv/bin/python tools/make_demo.py` replaces src/neuralgaits/demo_run; a minute or two.
"""

import os
import shutil
import tempfile
from pathlib import Path

from neuralgaits.cli.environment import prepare

ROBOT, SEED, LEVEL = "amber3m", 0, 3
NAME = "demo_run"
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
    from neuralgaits.robots import load_robot
    from neuralgaits.workflows.certify import certify
    from neuralgaits.workflows.train import train

    target = Path(__file__).resolve().parents[1] / "src" / "neuralgaits" / NAME
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        run = Path(NAME)
        train(load_robot(ROBOT), seed=SEED, out=run, root=Path("runs"))
        proof = certify(run, level=LEVEL)
        if proof.verdict != "proved":
            raise SystemExit(f"expected a proof to level {LEVEL}, found it {proof.verdict}")
        shutil.rmtree(target, ignore_errors=True)
        for file in KEPT:
            (target / file).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(run / file, target / file)


if __name__ == "__main__":
    main()
