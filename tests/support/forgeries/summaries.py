"""Run folders whose summary says what no proof file there does, with all its hashes made anew."""

import json
from collections.abc import Callable
from pathlib import Path

from support.forgeries.base import Case, Table, Theme, refused
from support.forgeries.edits import NOBODY, constantly, without
from support.forgeries.runs import FULL_ORDER, PROOF, SUMMARY, renew_summary

THEME = Theme("walk")
NO_LEVEL, LEVEL_2, LEVEL_3 = (refused(f"none {words}") for words in ("", "1 2", "1 2 3"))
"""Highest levels that a page may show as proved."""
Edit = Callable[[Path], None]


def _report(what: str, edit: Edit, answer=NO_LEVEL) -> None:
    """The proof in the folder is looked at by whoever shows the run, not by a checker."""

    @THEME.forgery(what, cpp=None, alone=None, run=None, report=answer)
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


def _copied(file: str, to: str) -> Edit:
    def edit(folder: Path) -> None:
        (folder / to).write_text((folder / file).read_text())

    return edit


def _level_4(table: Table) -> None:
    table["levels"].append(
        {
            "level": 4,
            "verdict": "proved",
            "reason": None,
            "figures": {"r_bar": 0.005, "gamma": 45.0},
        }
    )
    table["level"] = 4


def _unclaimed(*levels: int) -> Callable[[Table], None]:
    def change(table: Table) -> None:
        for theorem in table["theorems"]:
            theorem["claimed"] = theorem["claimed"] and theorem["level"] not in levels

    return change


@THEME.forgery("another run's summary as it is", cpp=None, alone=None, run=None, report=NO_LEVEL)
def _(case: Case) -> None:
    from support.forgeries.other_runs import other_weights

    other_weights(case.folder())


no_files = _then(_gone(PROOF), _gone(FULL_ORDER))
_report("a summary without proof files", no_files)
_report(
    "another run's summary, which names no proof",
    _then(no_files, _json(SUMMARY, lambda t: t.update(proof=None))),
)
_report("a summary whose proof is empty", _then(_gone(FULL_ORDER), _written(PROOF, "")))
_report("a summary whose proof is an empty object", _then(_gone(FULL_ORDER), _written(PROOF, "{}")))
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
_report(
    "a summary of level 4 whose proof is not there",
    _then(_gone(FULL_ORDER), _json(SUMMARY, _level_4)),
    LEVEL_3,
)
_report(
    "a summary of level 4 whose proof claims nothing",
    _then(_json(FULL_ORDER, _unclaimed(4)), _json(SUMMARY, _level_4)),
    LEVEL_3,
)
_report(
    "a summary of level 4 whose proof is of other weights",
    _then(_json(FULL_ORDER, lambda t: t.update(weights_sha256=NOBODY)), _json(SUMMARY, _level_4)),
    LEVEL_3,
)
_report(
    "a summary of level 4 whose proof is this run's level 3",
    _then(
        _copied(PROOF, FULL_ORDER),
        _json(SUMMARY, _level_4),
    ),
    LEVEL_3,
)
_report(
    "a summary of level 4 whose proof has one statement",
    _then(
        _json(FULL_ORDER, lambda t: t.update(statements=t["statements"][:1])),
        _json(SUMMARY, _level_4),
    ),
    LEVEL_3,
)


@THEME.forgery("other weights than when it was proved", cpp=None, alone=None, report=NO_LEVEL)
def _(case: Case) -> None:
    from support.forgeries.other_runs import other_weights

    folder = case.folder()
    other_weights(folder)
    renew_summary(folder)


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


TRUSTED = refused("none 1 2 3 boast")
"""A page bounds no box and traces no Program: `check-proof --run` does, and would object."""


def _bounds(table: Table) -> None:
    for statement in table["statements"]:
        statement["bounds"] = dict.fromkeys(statement["bounds"], 99.0)


_report("bounds of 99 in the proof itself", _json(PROOF, _bounds), TRUSTED)
_report("a Program that says 1 in the proof itself", _json(PROOF, constantly), TRUSTED)
