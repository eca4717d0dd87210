"""The true proofs that forgeries start from: the shipped run, and one of two conditions."""

import json
import shutil
import time
from pathlib import Path

from neuralgaits.certificate.levels.full_order.of_run import certify_full_order, model_of
from neuralgaits.certificate.levels.full_order.prove import SHARES, looks_of

from neuralgaits.analysis.run import Run, open_run
from neuralgaits.certificate.levels.full_order import prove as full_order
from neuralgaits.certificate.levels.full_order.find import find_full_order
from neuralgaits.certificate.levels.full_order.margins import BANDWIDTH
from neuralgaits.certificate.levels.full_order.theorem import premises
from neuralgaits.certificate.proof_file.of_run import proof_of
from neuralgaits.certificate.proof_file.theorem_tables import Theorems
from neuralgaits.certificate.proof_file.writer import Proof
from neuralgaits.runs import plain
from neuralgaits.workflows.certify import certify
from neuralgaits.workflows.demo import FOLDER
from support.forgeries.base import Base, Table
from support.forgeries.edits import claim, root, sha256, spec_file

PROOF, FULL_ORDER = "certificate/proof.json", "certificate/full-order.json"
SUMMARY = "certificate/summary.json"
SPEC = Path(__file__).parent / "ends_spec.py"


def make(scratch: Path, *, boxes: bool = False) -> Base:
    """Everything there is to forge from, in a new folder; seconds.

    Args:
        scratch: the folder.
        boxes: whether level 4 is searched for, so that its trees are those of a proof.
    """
    walk = Path(shutil.copytree(FOLDER, scratch / "walk"))
    small = small_run(scratch / "small")
    full = proved_full_order(open_run(walk)) if boxes else full_order_table(open_run(walk))
    (walk / FULL_ORDER).write_text(json.dumps(full))
    renew_summary(walk)
    return Base(
        {"walk": _read(walk / PROOF), "small": _read(small / PROOF), "full": full},
        {"walk": walk, "small": small, "full": walk},
        scratch,
    )


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
    from neuralgaits.robots.loader import robot_from_text

    digest = spec_file(folder, text, function)
    config = json.loads((folder / "config.json").read_text())
    robot = robot_from_text((folder / "robot.xml").read_text(), config["robot"])
    found = specs.load(f"{SPEC}:ends", robot)
    config["described"] = plain(found.describe())
    (folder / "config.json").write_text(json.dumps(config))
    return digest


def proved_full_order(run: Run) -> Table:
    """Level 4 as `certify` writes it."""
    answer = certify_full_order(run, time.monotonic() + 600.0, None)
    assert answer.conclusion.verdict == "proved" and answer.file is not None
    return _read(answer.file)


def full_order_table(run: Run) -> Table:
    """Level 4 with the finder's constants, its premises taken as proved: trees are one leaf.

    A checker that bounds boxes does not come to an end with them; `benchmarks/forgeries.py`
    has the true trees.
    """
    model = model_of(run)
    shape = find_full_order(looks_of(model), model.names, BANDWIDTH, SHARES[0])
    assert not isinstance(shape, str), shape
    program = full_order.trace_full_order(model, shape)
    theorems = Theorems.of(shape, claimed=(4,))
    proof: Proof = proof_of(run, program, (), theorems, None)
    place = run.path / FULL_ORDER
    proof.write(place)
    table = _read(place)
    table["statements"] = [
        claim(name, root(low, high), region="full order", bound=1e-9)
        for name, low, high, _ in premises(shape)
    ]
    return table


def _read(path: Path) -> Table:
    return json.loads(path.read_text())
