"""Run folders whose summary says what no proof file there does, with all its hashes made anew."""

import json
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from neuralgaits.workflows.demo import FOLDER
from support.forgeries.base import About, Answer, Case, Table, Theme, refused
from support.forgeries.edits import NOBODY, constantly, without
from support.forgeries.runs import PROOF, SUMMARY, add_level_4, renew_summary

THEME = Theme("walk")
NO_LEVEL, LEVEL_2, LEVEL_3 = (refused(f"none {words}") for words in ("", "1 2", "1 2 3"))
"""Highest levels that a page may show as proved."""
OTHER_WEIGHTS = replace(NO_LEVEL, never="figures of training")
"""Nothing is proved of other weights, nor has training measured them."""
Edit = Callable[[Path], None]


def _report(
    what: str, edit: Edit, answer=NO_LEVEL, about: About = "walk", *, bounded: bool = False
) -> None:
    """The proof in the folder is looked at by whoever shows the run, not by a checker."""
    answers = {"cpp": None, "alone": None, "run": None, "report": answer}

    @THEME.forgery(what, **answers, about=about, bounded=bounded)
    def _(case: Case) -> None:
        folder = case.folder()
        edit(folder)
        renew_summary(folder)


def _json(file: str, change: Callable[[Table], object]) -> Edit:
    def edit(folder: Path) -> None:
        table = json.loads((folder / file).read_text())
        change(table)
        (folder / file).write_text(json.dumps(table))

    return edit


def _then(*edits: Edit) -> Edit:
    def edit(folder: Path) -> None:
        for one in edits:
            one(folder)

    return edit


def _gone(file: str) -> Edit:
    return lambda folder: (folder / file).unlink()


def _written(file: str, text: str) -> Edit:
    def edit(folder: Path) -> None:
        (folder / file).write_text(text)

    return edit


def _unclaimed(*levels: int) -> Callable[[Table], None]:
    def change(table: Table) -> None:
        for theorem in table["theorems"]:
            theorem["claimed"] = theorem["claimed"] and theorem["level"] not in levels

    return change


@THEME.forgery(
    "another run's summary as it is", cpp=None, alone=None, run=None, report=OTHER_WEIGHTS
)
def _(case: Case) -> None:
    from support.forgeries.other_runs import other_weights

    other_weights(case.folder())


no_file = _gone(PROOF)
_report("a summary without proof files", no_file)
_report(
    "another run's summary, which names no proof",
    _then(no_file, _json(SUMMARY, lambda t: t.update(proof=None))),
)
_report("a summary whose proof is empty", _written(PROOF, ""))
_report("a summary whose proof is an empty object", _written(PROOF, "{}"))
_report(
    "a summary whose proof is of other weights",
    _json(PROOF, lambda t: t.update(weights_sha256=NOBODY)),
)
_report(
    "a summary whose proof is of another robot",
    _json(PROOF, lambda t: t["robot"].update(sha256=NOBODY)),
)
_report(
    "a summary whose proof is of another spec",
    _json(PROOF, lambda t: t["spec"].update(sha256=NOBODY)),
)
_report(
    "a summary whose proof states one condition",
    _json(PROOF, lambda t: t.update(statements=t["statements"][:1])),
)
_report(
    "a summary whose proof leaves one condition out",
    _json(PROOF, lambda t: without(t, ["tube-width"])),
)
_report(
    "a summary whose proof has a smaller root box",
    _json(PROOF, lambda t: t["statements"][0]["root"].update(high=["0x1p-1", "0x1p0"])),
)
_report(
    "a summary whose proof states premises alone",
    _json(
        PROOF,
        lambda t: t.update(statements=[s for s in t["statements"] if "/" in s["conditions"][0]]),
    ),
)
_report("a summary whose proof claims no level", _json(PROOF, _unclaimed(2, 3)), refused("none 1"))
_report("a summary whose proof claims level 2", _json(PROOF, _unclaimed(3)), LEVEL_2)
_report(
    "a summary whose proof has no theorems",
    _json(PROOF, lambda t: t.update(theorems=[])),
    refused("none 1"),
)
_report("a summary of level 4 whose proof is of level 3", add_level_4, LEVEL_3)


def _of_level_4(what: str, change: Callable[[Table], object]) -> None:
    _report(f"a summary of level 4 whose proof {what}", _json(PROOF, change), LEVEL_3, "full")


def _only(table: Table, what: Callable[[str], bool]) -> None:
    table["statements"] = [s for s in table["statements"] if what(s["conditions"][0])]


_of_level_4("does not claim it", _unclaimed(4))
_of_level_4("is of other weights", lambda t: t.update(weights_sha256=NOBODY))
_of_level_4("states none of its premises", lambda t: _only(t, lambda n: "full/" not in n))
_of_level_4("leaves one premise out", lambda t: _only(t, lambda n: n != "full/impulse"))
_of_level_4("states nothing else", lambda t: _only(t, lambda n: "full/" in n))
_of_level_4("has one statement", lambda t: t.update(statements=t["statements"][:1]))
_of_level_4("has no theorem of it", lambda t: t["theorems"].pop())


def _earlier(folder: Path) -> None:
    """Level 4 in a file of its own, which the summary names."""
    file = folder / "certificate/full-order.json"
    file.write_text((folder / PROOF).read_text())
    shutil.copyfile(FOLDER / PROOF, folder / PROOF)
    summary = json.loads((folder / SUMMARY).read_text())
    summary["sha256"]["certificate/full-order.json"] = None
    (folder / SUMMARY).write_text(json.dumps(summary))


_report("a summary of level 4 that has a file of its own", _earlier, LEVEL_3, "full")


@THEME.forgery("other weights than when it was proved", cpp=None, alone=None, report=OTHER_WEIGHTS)
def _(case: Case) -> None:
    from support.forgeries.other_runs import other_weights

    folder = case.folder()
    other_weights(folder)
    renew_summary(folder)


def _of_training(what: str, edit: Edit, answer: Answer) -> None:
    """The figures of a training, beside weights that they are not of, and without any proof."""

    @THEME.forgery(what, cpp=None, alone=None, run=None, report=answer)
    def _(case: Case) -> None:
        from support.forgeries.other_runs import other_weights

        folder = case.folder()
        shutil.rmtree(folder / "certificate")
        other_weights(folder)
        edit(folder)


_of_training("other weights than the training's figures are of", lambda folder: None, OTHER_WEIGHTS)
_of_training(
    "other weights, and figures with hashes of other files alone",
    _json("summary.json", lambda t: t["sha256"].pop("policy.safetensors")),
    OTHER_WEIGHTS,
)
_of_training(
    "other weights, and figures without a hash",
    _json("summary.json", lambda t: t.pop("sha256")),
    replace(NO_LEVEL, never="figures of training$"),
)


def _margin(change: Edit) -> None:
    @THEME.forgery(
        "a summary with larger margins than the proof's",
        cpp=None,
        alone=None,
        run=None,
        report=refused("none 1 2 3"),
    )
    def _(case: Case) -> None:
        folder = case.folder()
        change(folder)
        renew_summary(folder)


def _larger(table: Table) -> None:
    for row in table["conditions"].values():
        row["margin"] = 99.0


_margin(_json(SUMMARY, _larger))


@THEME.forgery(
    "a summary with a better multiplier than the proof's",
    cpp=None,
    alone=None,
    run=None,
    report=refused("none 1 2 3"),
)
def _(case: Case) -> None:
    def better(table: Table) -> None:
        for level in table["levels"]:
            if level["level"] == 3:
                level["figures"] |= {"multiplier_at_least": 0.0099, "multiplier_at_most": 0.0099}

    folder = case.folder()
    _json(SUMMARY, better)(folder)
    renew_summary(folder)


def _refuting(table: Table) -> None:
    point = {"u": [0.5, 0.5], "z": [1e300, -1.0], "margin": -99.0}
    table["conditions"]["knee"] |= {"verdict": "refuted", "counterexample": point, "boxes": 10**9}
    table["verdict"] = "refuted"


_report(
    "a summary that refutes what its proof states",
    _json(SUMMARY, _refuting),
    replace(NO_LEVEL, never="refuted"),
)
_report(
    "a summary that proves a condition on 77 times its region",
    _json(SUMMARY, lambda t: t["conditions"]["knee"].update(proved_fraction=77)),
)
_report("a summary of another robot", _json(SUMMARY, lambda t: t.update(robot="atlas")))


@THEME.forgery(
    "a robot called otherwise in config, proof and summary", cpp=None, alone=None, report=NO_LEVEL
)
def _(case: Case) -> None:
    folder = case.folder()
    case.table["robot"]["name"] = "atlas"
    (folder / PROOF).write_text(json.dumps(case.table))
    for file in (SUMMARY, "config.json"):
        _json(file, lambda t: t.update(robot="atlas"))(folder)
    renew_summary(folder)


def _bounds(table: Table) -> None:
    for statement in table["statements"]:
        statement["bounds"] = dict.fromkeys(statement["bounds"], 99.0)


_report("bounds of 99 in the proof itself", _json(PROOF, _bounds), bounded=True)
_report("a Program that says 1 in the proof itself", _json(PROOF, constantly))
