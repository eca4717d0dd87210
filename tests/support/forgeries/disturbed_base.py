"""Proofs of level 5 that forgeries start from: both laws, on both clocks.

Of a proof that `certify` makes there are 14,000 boxes or more. Here the same theorems stand over
trees of one leaf, with bounds near zero: each statement is true, as `certify` proved it of these
very constants (`disturbed_constants.json`, of the shipped gait), but not of one leaf. Tests take
as checked what stands in the true file, and bound what a forgery adds.
"""

import json
import shutil
from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal

import numpy as np

from neuralgaits.analysis.run import Run, open_run
from neuralgaits.certificate.level import Parameters
from neuralgaits.certificate.levels.disturbed.theorem import DisturbedConstants
from neuralgaits.certificate.levels.full_order.theorem import FullOrderConstants
from neuralgaits.certificate.levels.level_search import LevelSets
from neuralgaits.certificate.levels.levels import labelled_premises
from neuralgaits.certificate.levels.problems import trace_certificate
from neuralgaits.certificate.proof_file.model_data import model_data
from neuralgaits.certificate.proof_file.theorem_tables import Theorems, from_table
from neuralgaits.gait.scheduled_gains import ScheduledGains
from neuralgaits.runs import plain
from neuralgaits.workflows.certify import certify
from neuralgaits.workflows.demo import FOLDER
from support.forgeries.base import About, Base, Table
from support.forgeries.edits import claim, root
from support.forgeries.runs import PROOF, SUMMARY, renew_summary

CONSTANTS = Path(__file__).with_name("disturbed_constants.json")
LAWS: Mapping[About, tuple[Literal["fblin", "scheduled-pd"], Literal["touchdown", "free"]]] = {
    "held": ("fblin", "touchdown"),
    "free": ("fblin", "free"),
    "law": ("scheduled-pd", "touchdown"),
    "lawfree": ("scheduled-pd", "free"),
}
"""The law and the clock of each proof."""
BOUND = 1e-300
"""Of a premise, whose sign alone counts."""


def make(scratch: Path, *, boxes: bool = False) -> Base:
    """All four proofs, each in a run folder of its own; half a minute.

    Args:
        scratch: the folder.
        boxes: whether they are searched for, so that their trees are those of a proof; a quarter
            of an hour.
    """
    runs: dict[About, Path] = {}
    for about in LAWS:
        folder = Path(shutil.copytree(FOLDER, scratch / about))
        runs[about] = folder
        if boxes:
            law, clock = LAWS[about]
            width = float.fromhex(_constants()[about]["4"]["bandwidth"])
            done = certify(folder, level=5, bandwidth=width, controller=law, clock=clock)
            assert done.verdict == "proved", done.conclusions[-1].reason
        else:
            (folder / PROOF).write_text(json.dumps(_table(open_run(folder), about)))
            _add_levels(folder)
    return Base(
        {about: json.loads((runs[about] / PROOF).read_text()) for about in runs}, runs, scratch
    )


def theorem(about: About, run: Run) -> Parameters:
    """Constants of levels 4 and 5 that `certify` proved of the shipped gait."""
    found = _constants()[about]
    full = from_table(FullOrderConstants, found["4"])
    shape = from_table(DisturbedConstants, found["5"])
    if LAWS[about][0] == "scheduled-pd":
        gains = ScheduledGains.of(run.robot, run.gait)
        shape = replace(
            shape,
            torque_gains=tuple(np.ravel(gains.torque).tolist()),
            inertia_gains=tuple(np.ravel(gains.inertia).tolist()),
        )
    return {4: full, 5: shape}


def _table(run: Run, about: About) -> Table:
    """Levels 1 to 5: the first three as they are shipped."""
    table = json.loads((run.path / PROOF).read_text())
    below = Theorems.read(table["theorems"])
    theorems = Theorems({**below.parameters, **theorem(about, run)}, (*below.claimed, 4, 5))
    program = trace_certificate(run.spec, run.robot, run.gait, LevelSets(theorems.parameters))
    above = {number: theorems.parameters[number] for number in (4, 5)}
    table["statements"] += [
        claim(name, root(low, high), region=label, bound=BOUND)
        for label, name, low, high in labelled_premises(above, [])
    ]
    model = model_data(run.robot, run.gait, run.spec, program, run.residuals)
    return table | {
        "program": json.loads(program.to_json()),
        "program_hash": program.hash,
        "theorems": [dict(row) for row in theorems.tables()],
        "model": json.loads(json.dumps(plain(model))),
    }


def _add_levels(folder: Path) -> None:
    """A summary that says what one of levels 1 to 3 does, and that levels 4 and 5 are proved."""
    summary = json.loads((folder / SUMMARY).read_text())
    for level in (4, 5):
        summary["levels"].append(
            {"level": level, "verdict": "proved", "reason": None, "figures": {"hold": 0.01}}
        )
    summary["level"] = 5
    (folder / SUMMARY).write_text(json.dumps(summary))
    renew_summary(folder)


@lru_cache(maxsize=1)
def _constants() -> Mapping[str, Any]:
    return json.loads(CONSTANTS.read_text())
