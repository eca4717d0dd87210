"""A trained run as if it had been trained for a spec of its own, without training again."""

import hashlib
import json
import shutil
from pathlib import Path

from neuralgaits.analysis.run import Run, open_run
from neuralgaits.barriers import specs
from neuralgaits.runs import plain

SPEC = """
from dataclasses import replace

from neuralgaits.barriers import Box, Pointwise, functions as f, specs

HALVES = Box((0.0, 0.0), (0.5, 1.0)), Box((0.5, 0.0), (1.0, 1.0))


def mine(robot):
    spec = specs.walking(robot)
    regions = {"halves": HALVES}
    recipe = replace(spec.recipe, samples={"halves": 4})
    # z1 grows along the step: it is below its middle on the first half, and not on the second.
    ahead = Pointwise("ahead", "halves", 1.0, f.at_most(f.hip_state, BOUND))
    forward = Pointwise("forward", "halves", 1.0, f.at_least(f.momentum, 1.0))
    return replace(spec, name="mine", conditions=(ahead, forward), regions=regions,
                   recipe=recipe, weights={})
"""
HOLDS, BREAKS = 0.2, 0.05
"""Bounds on z1 [m]: beyond the guard, and within the second half of the step."""


def run_with(trained: Run, folder: Path, text: str) -> Path:
    """A copy of a run whose spec is `mine` of a file with this text."""
    shutil.copytree(trained.path, folder, ignore=shutil.ignore_patterns("certificate"))
    file = folder / "spec.py"
    file.write_text(text)
    described = plain(specs.load(f"{file}:mine", trained.robot).describe())
    config = json.loads((folder / "config.json").read_text())
    (folder / "config.json").write_text(
        json.dumps(config | {"spec": "own.py:mine", "described": described})
    )
    replace_spec(folder, text)
    return folder


def replace_spec(run: Path, text: str) -> str:
    """Another text of the spec, without running it, with its hash in the run. Returns: the hash."""
    (run / "spec.py").write_text(text)
    config = json.loads((run / "config.json").read_text())
    config["copies"]["spec.py"] = hashlib.sha256(text.encode()).hexdigest()
    (run / "config.json").write_text(json.dumps(config))
    return config["copies"]["spec.py"]


def opened(trained: Run, folder: Path, bound: float = HOLDS) -> Run:
    """The run with conditions that hold, or not on the second half."""
    return open_run(run_with(trained, folder, SPEC.replace("BOUND", repr(bound))))
