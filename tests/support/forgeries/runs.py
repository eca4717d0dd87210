"""The true proofs that forgeries start from: the shipped run, and one of two conditions."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

from neuralgaits.analysis.run import Run, open_run
from neuralgaits.certificate.levels.full_order.model import FullOrderModel
from neuralgaits.certificate.levels.full_order.theorem import (
    FENCES,
    BarrierConstants,
    labelled_premises,
)
from neuralgaits.certificate.levels.level_search import LevelSets
from neuralgaits.certificate.levels.problems import trace_certificate
from neuralgaits.certificate.proof_file.theorem_tables import Theorems
from neuralgaits.runs import plain
from neuralgaits.workflows.certify import certify
from neuralgaits.workflows.demo import FOLDER
from support.forgeries.base import About, Base, Table
from support.forgeries.edits import claim, root, sha256, spec_file
from support.full_order_shape import FENCE, SHAPE, TORSO

PROOF = "certificate/proof.json"
SUMMARY = "certificate/summary.json"
SPEC = Path(__file__).parent / "ends_spec.py"


def make(scratch: Path, *, boxes: bool = False) -> Base:
    """Everything there is to forge from, in a new folder; seconds.

    Args:
        scratch: the folder.
        boxes: whether level 4 is searched for, so that its trees are those of a proof.
    """
    walk, full = (Path(shutil.copytree(FOLDER, scratch / name)) for name in ("walk", "full"))
    small = small_run(scratch / "small")
    if boxes:
        assert certify(full, level=4).verdict == "proved"
    else:
        (full / PROOF).write_text(json.dumps(full_order_table(open_run(full))))
        add_level_4(full)
    runs: dict[About, Path] = {"walk": walk, "small": small, "full": full}
    return Base({about: _read(runs[about] / PROOF) for about in runs}, runs, scratch)


def add_level_4(folder: Path) -> None:
    """A summary that says what one of levels 1 to 3 does, and that level 4 is proved as well."""
    summary = _read(folder / SUMMARY)
    figures = {"r_bar": 0.005, "gamma": 45.0}
    summary["levels"].append({"level": 4, "verdict": "proved", "reason": None, "figures": figures})
    summary["level"] = 4
    (folder / SUMMARY).write_text(json.dumps(summary))
    renew_summary(folder)


def renew_summary(folder: Path) -> None:
    """The summary of a certificate, about whatever lies beside it now."""
    file = folder / SUMMARY
    summary = _read(file)
    for name in summary["sha256"]:
        path = folder / name
        summary["sha256"][name] = sha256(path.read_bytes()) if path.is_file() else None
    file.write_text(json.dumps(summary))


def small_run(folder: Path) -> Path:
    """The shipped gait under two conditions of its own, with a proof of level 1."""
    shutil.copytree(FOLDER, folder, ignore=shutil.ignore_patterns("certificate"))
    describe(folder, SPEC.read_text(), "ends")
    run = open_run(folder)
    assert certify(run, level=1).verdict == "proved"
    return folder


def describe(folder: Path, text: str, function: str) -> str:
    """Give a run a spec of its own, as `train --spec` would have. Returns: its sha256."""
    from neuralgaits.barriers import specs
    from neuralgaits.robots.mjcf.loader import robot_from_text

    digest = spec_file(folder, text, function)
    config = json.loads((folder / "config.json").read_text())
    robot = robot_from_text((folder / "robot.xml").read_text(), config["robot"])
    found = specs.load(f"{SPEC}:ends", robot)
    config["described"] = plain(found.describe())
    (folder / "config.json").write_text(json.dumps(config))
    return digest


def full_order_table(run: Run) -> Table:
    """Levels 1 to 4: those below as they are shipped, and level 4 with constants that fit together.

    Its premises are taken as proved: trees are one leaf. A checker that bounds boxes does not come
    to an end with them; `benchmarks/forgeries.py` has the true trees. Without the model, for the
    same reason: the C++ checker starts from it.
    """
    table = _read(run.path / PROOF)
    barriers = FullOrderModel(run.robot, run.gait, run.spec).names
    shape = replace(SHAPE, barriers=tuple(_constants(name) for name in barriers))
    below = Theorems.read(table["theorems"])
    theorems = Theorems({**below.parameters, 4: shape}, (*below.claimed, 4))
    program = trace_certificate(run.spec, run.robot, run.gait, LevelSets(theorems.parameters))
    table["statements"] += [
        claim(name, root(low, high), region=label, bound=1e-9)
        for label, name, low, high in labelled_premises(shape)
    ]
    return table | {
        "program": json.loads(program.to_json()),
        "program_hash": program.hash,
        "theorems": [dict(row) for row in theorems.tables()],
        "model": None,
    }


def _constants(barrier: str) -> BarrierConstants:
    """Of a fence or of an angle of the torso."""
    return replace(FENCE if barrier in FENCES else TORSO, name=barrier)


def _read(path: Path) -> Table:
    return json.loads(path.read_text())
