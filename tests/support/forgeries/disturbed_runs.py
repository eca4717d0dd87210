"""Run folders whose summary, header of exported C or monitor would say more than level 5 proves.

A row changes the proof in the folder and the summary beside it, with all hashes made anew, as who
forges it would. Asked are the page and the export: what `gait.h` says of each law.
"""

import copy
import json
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from support.forgeries.base import About, Answer, Case, Table, Theme, refused, true
from support.forgeries.disturbed_laws import KICK, KICK_PREMISES, LAW, OTHER_CLOCK, OTHER_LAW
from support.forgeries.edits import (
    number,
    parameters,
    without,
)
from support.forgeries.runs import PROOF, SUMMARY, renew_summary

THEME = Theme("lawfree")
NO_LAW = refused("none")
"""No law is said to be proved."""
BELOW_5 = refused("none 1 2 3 4")
"""Highest levels that a page may show as proved."""
NO_LEVEL = refused("none")
FIVE = refused("5")
ALL: tuple[About, ...] = ("held", "free", "law", "lawfree")
TWO: tuple[About, ...] = ("held", "lawfree")


def _kind(
    what: str,
    *abouts: About,
    report: Answer | None = NO_LEVEL,
    header: Answer | None = NO_LAW,
    bounded: bool = False,
) -> Callable[[Callable[[Table, Table, Case], object]], None]:
    """Register a change of the proof and the summary in the folder."""

    def register(change: Callable[[Table, Table, Case], object]) -> None:
        for about in abouts or (THEME.about,):
            answers: dict[str, Any] = {"cpp": None, "alone": None, "run": None}
            answers |= {"report": report, "header": header}

            @THEME.forgery(f"{what} ({about})", about=about, bounded=bounded, **answers)
            def _(case: Case) -> None:
                folder = case.folder()
                summary = json.loads((folder / SUMMARY).read_text())
                change(case.table, summary, case)
                (folder / PROOF).write_text(json.dumps(case.table))
                (folder / SUMMARY).write_text(json.dumps(summary))
                renew_summary(folder)

    return register


def _fifth(summary: Table) -> Table:
    return next(one for one in summary["levels"] if one["level"] == 5)


@_kind("a longer hold in proof and summary", *ALL)
def _(proof: Table, summary: Table, _: Case) -> None:
    shape = parameters(proof, 5)
    shape["hold"] = number(shape["hold"], 1.5)
    _fifth(summary)["figures"]["hold"] = float.fromhex(shape["hold"])


SAYS_ITS_OWN = replace(true(r"proved for ticks at most [0-3]\.\d+ ms"), never=r"1[05](\.0*)? ms")


@_kind("a longer hold in the summary alone", *TWO, report=FIVE, header=SAYS_ITS_OWN)
def _(proof: Table, summary: Table, _: Case) -> None:
    """The proof is true, and what is said is what it says."""
    _fifth(summary)["figures"] = {"hold": 0.015}
    _fifth(summary)["words"] = ["whatever ticks there are at most 0.015 s apart"]
    proof["note"] = proof.pop("note", None)
    del proof["note"]


@_kind(
    "a free clock in the summary alone",
    "held",
    "law",
    report=FIVE,
    header=replace(true("one of them at each touchdown"), never="wherever touchdowns lie"),
)
def _(_: Table, summary: Table, __: Case) -> None:
    _fifth(summary)["words"] = ["whatever ticks there are, wherever touchdowns lie between them"]
    _fifth(summary)["figures"] = {"kick": 1.0, "kick_peak": 2.0}


@_kind(
    "another law in the summary alone",
    *TWO,
    report=FIVE,
    header=replace(true("proved for ticks"), never="(^| )pd( at [0-9]+ rad/s)?: proved"),
)
def _(_: Table, summary: Table, __: Case) -> None:
    _fifth(summary)["words"] = ["under the law pd, whatever its gains"]


@_kind("ticks at touchdowns stated as a free clock", "held", "law")
def _(proof: Table, _: Table, case: Case) -> None:
    other = parameters(case.base.proofs[OTHER_CLOCK[case.about]], 5)
    parameters(proof, 5).update({name: other[name] for name in (*KICK, "kick_end")})


@_kind("a free clock stated as ticks at touchdowns", "free", "lawfree")
def _(proof: Table, _: Table, __: Case) -> None:
    for name in (*KICK, "kick_end"):
        parameters(proof, 5).pop(name)
    without(proof, [f"disturbed/{name}" for name in KICK_PREMISES])


@_kind("the theorems of the other clock", "free")
def _(proof: Table, _: Table, case: Case) -> None:
    other = case.base.proofs[OTHER_CLOCK[case.about]]
    proof["theorems"] = copy.deepcopy(other["theorems"])


@_kind("the theorems of the other law", "law")
def _(proof: Table, _: Table, case: Case) -> None:
    other = case.base.proofs[OTHER_LAW[case.about]]
    proof["theorems"] = copy.deepcopy(other["theorems"])


@_kind("scheduled-pd stated as fblin", "law")
def _(proof: Table, _: Table, __: Case) -> None:
    for name in LAW:
        parameters(proof, 5).pop(name)
    without(proof, ["disturbed/decay", "disturbed/rest"])


@_kind("a proof of another law than the summary's words", *TWO, report=FIVE, header=true("proved"))
def _(proof: Table, summary: Table, case: Case) -> None:
    """The folder holds a true proof of the other law: that is what is said."""
    proof |= copy.deepcopy(case.base.proofs[OTHER_LAW[case.about]])


@_kind("a bandwidth of 60 in the theorem", *TWO)
def _(proof: Table, _: Table, __: Case) -> None:
    parameters(proof, 4)["bandwidth"] = (60.0).hex()
