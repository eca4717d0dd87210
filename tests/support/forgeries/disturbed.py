"""Level 5 with other numbers than those that were proved, of both laws and clocks."""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from neuralgaits.certificate.levels.disturbed.theorem import slope_output
from neuralgaits.certificate.proof_file.theorem_tables import (
    LEVELS_BY_NUMBER,
    Theorems,
)
from support.forgeries.base import (
    NO,
    UNREADABLE,
    UNTRUE,
    About,
    Answer,
    Case,
    Table,
    Theme,
    refused,
)
from support.forgeries.disturbed_base import LAWS
from support.forgeries.edits import constants, first, number, parameters, statement_of

THEME = Theme("held")
FALLS = refused("rejected unreadable")
"""Seen without a box."""
Change = Callable[[Table, Table], Any]
"""A change of the parameters of levels 4 and 5."""
ALL: tuple[About, ...] = tuple(LAWS)
TWO: tuple[About, ...] = ("held", "lawfree")
FREE: tuple[About, ...] = ("free", "lawfree")
SCHEDULED: tuple[About, ...] = ("law", "lawfree")


def in_program(table: Table) -> None:
    """The Program's constants are what the parameters of levels 4 and 5 say."""
    found = Theorems.read(table["theorems"]).parameters
    changes = {}
    for level in (4, 5):
        part = LEVELS_BY_NUMBER[level]
        for name, values in part.constants(found[level]).items():
            changes[f"{part.part}.{name}"] = lambda _, v=values: np.array(v)
    constants(table, changes)


def false_first(table: Table, name: str) -> None:
    """Move a false statement to the front, with a small first leaf, where that shows at once."""
    first(table, name)["tree"] = "01" * 6 + "-" * 13


def _changed(case: Case, change: Change) -> None:
    change(parameters(case.table, 4), parameters(case.table, 5))


def file_only(what: str, abouts: Iterable[About], change: Change, answer: Answer = FALLS) -> None:
    """Numbers of the theorem in the file alone; most are constants of the Program as well."""
    for about in abouts:

        @THEME.forgery(
            f"{what}, in the parameters only ({about})", about=about, alone=answer, run=answer
        )
        def _(case: Case) -> None:
            _changed(case, change)


def in_both(
    what: str,
    abouts: Iterable[About],
    change: Change,
    answer: Answer = FALLS,
    false: str | None = None,
) -> None:
    """The Program's constants follow.

    Args:
        what: in words.
        abouts: the true proofs.
        change: of the parameters.
        answer: what is right.
        false: the premise that is false then, where the arithmetic alone does not show it.
    """
    for about in abouts:

        @THEME.forgery(
            f"{what}, in the Program too ({about})",
            about=about,
            # It derives what the premise is about, and takes minutes where it finds no fault.
            cpp=NO if false is None else None,
            alone=answer,
            run=answer,
            bounded=false is not None,
        )
        def _(case: Case) -> None:
            _changed(case, change)
            in_program(case.table)
            if false is not None:
                false_first(case.table, false)


def _times(name: str, factor: float, place: int | None = None, level: int = 5) -> Change:
    def change(full: Table, shape: Table) -> None:
        of = full if level == 4 else shape
        if place is None:
            of[name] = number(of[name], factor)
        else:
            of[name][place] = number(of[name][place], factor)

    return change


def _is(name: str, value: float | str, level: int = 5) -> Change:
    def change(full: Table, shape: Table) -> None:
        (full if level == 4 else shape)[name] = (
            value if isinstance(value, str) else float(value).hex()
        )

    return change


def _all_times(name: str, factor: float) -> Change:
    def change(_: Table, shape: Table) -> None:
        shape[name] = [number(text, factor) for text in shape[name]]

    return change


# The hold and the error stand in no constant of the Program: the arithmetic alone decides.
file_only("a hold a fifth longer", ALL, _times("hold", 1.2))
file_only("a hold of a second", TWO, _is("hold", 1.0))
file_only("a hold of less than nothing", TWO, _times("hold", -1.0))
file_only("no hold, and its premises left", TWO, _is("hold", 0.0))
file_only("a hold without end", ("free",), _is("hold", "inf"), UNREADABLE)
file_only("a hold that is no number", ("law",), _is("hold", "nan"), UNREADABLE)
file_only("a hold in decimals", ("held",), _is("hold", "0.01"), UNREADABLE)
file_only("an error that was not proved", TWO, _is("error", 1.0))
file_only("an error of less than nothing", ("held",), _is("error", -1.0))
file_only("a larger push", TWO, _all_times("push", 2.0))
file_only("a push above the peak", ("held", "law"), lambda f, s: s.update(push=s["peak"][::-1]))
file_only("a push whose slope falls", ("free",), _times("push", -1.0, 1))
file_only("no push", ("held",), _all_times("push", 0.0))
file_only("a push of one number", ("law",), lambda f, s: s["push"].pop(), UNREADABLE)

for _name in ("jerk", "growth_slope", "jerk_push"):
    file_only(f"{_name} a third", TWO, _times(_name, 1 / 3))
    for _about in TWO:
        _premise = f"disturbed/{_name.replace('_', '-')}"
        if _name == "growth_slope":
            _premise = slope_output(exact=LAWS[_about][0] == "fblin")
        in_both(f"{_name} a tenth", (_about,), _times(_name, 0.1), UNTRUE, _premise)
    in_both(f"{_name} three times", TWO, _times(_name, 30.0))
for _name in ("kick", "kick_slope", "kick_push"):
    file_only(f"{_name} a third", ("free",), _times(_name, 1 / 3))
    in_both(f"{_name} ten times", ("lawfree",), _times(_name, 10.0))
# Of the slopes of a kick a false premise takes minutes to be seen.
in_both("kick of nothing", FREE, _is("kick", 0.0), UNTRUE, "disturbed/kick")
file_only("kick_peak halved", ("free",), _times("kick_peak", 0.5))
in_both("kick_peak halved", FREE, _times("kick_peak", 0.5))
in_both("kick_peak ten times", ("free",), _times("kick_peak", 10.0))
in_both("kick_peak negative", ("lawfree",), _times("kick_peak", -1.0))
file_only(
    "kick_end by one last place",
    FREE,
    lambda f, s: s.update(kick_end=number(s["kick_end"], ulps=1)),
)
file_only("peak halved", TWO, _all_times("peak", 0.5))
in_both("peak halved", TWO, _all_times("peak", 0.5))
in_both("peak twenty times", ("held",), _all_times("peak", 20.0), UNTRUE, "disturbed/contact")
in_both("peak twenty times", FREE, _all_times("peak", 20.0))

file_only("decay a third more", SCHEDULED, _times("decay", 4 / 3))
in_both("decay a third", SCHEDULED, _times("decay", 1 / 3))
in_both("decay of growth", ("law",), _times("decay", -1.0))
file_only("rest a hundredth", SCHEDULED, _times("rest", 0.01))
in_both("rest a hundred times", SCHEDULED, _times("rest", 100.0))

_OVER = 1.01


def _floor_over(full: Table, _: Table) -> None:
    full["least_radius"] = number(full["radius"], _OVER)


file_only("least radius above R_0", TWO, _floor_over)
in_both("least radius above R_0", TWO, _floor_over)
file_only("no least radius", TWO, _is("least_radius", 0.0, 4))
in_both("least radius negative", ("held",), _times("least_radius", -1.0, None, 4))
in_both("least radius a tenth", TWO, _times("least_radius", 0.1, None, 4))
file_only("R_0 half as much again", TWO, _times("radius", 1.5, None, 4))
file_only("a bandwidth of 55 for another", TWO, _is("bandwidth", 54.0, 4))


def _weights(full: Table, _: Table) -> None:
    full["weights"] = [number(text, 0.1) for text in full["weights"]]


file_only("a norm a tenth as large", TWO, _weights)
file_only("no norm", ("free",), lambda full, _: full.pop("weights"))


def _of_barrier(place: int, name: str, factor: float) -> Change:
    def change(_: Table, shape: Table) -> None:
        shape["barriers"][place][name] = number(shape["barriers"][place][name], factor)

    return change


def _barriers(change: Callable[[list[Table]], list[Table]]) -> Change:
    def changed(_: Table, shape: Table) -> None:
        shape["barriers"] = change(shape["barriers"])

    return changed


in_both("lost a tenth", TWO, _of_barrier(0, "lost", 0.1))
in_both("alpha ten times", ("held", "law"), _of_barrier(1, "alpha", 10.0))
in_both("weight a hundredth", ("free",), _of_barrier(2, "weight", 0.01))
file_only("barriers in another order", ("held",), _barriers(lambda b: b[::-1]))
in_both("barriers in another order", ("law",), _barriers(lambda b: b[::-1]))
file_only("barriers less the last", ("free",), _barriers(lambda b: b[:-1]))
file_only("a barrier twice", ("held",), _barriers(lambda b: [*b, b[-1]]))
file_only(
    "a barrier under another name", ("lawfree",),
    _barriers(lambda b: [*b[:-1], b[-1] | {"name": "safe"}]),
)  # fmt: skip


def _end(what: str, factor: float) -> None:
    """Where the clock's first tick after a touchdown lies at the latest, with the premise's box."""
    for about in FREE:

        @THEME.forgery(f"{what}, and the box of its premise ({about})", about=about, alone=FALLS)
        def _(case: Case) -> None:
            shape = parameters(case.table, 5)
            shape["kick_end"] = number(shape["kick_end"], factor)
            statement_of(case.table, "disturbed/kick-contact")["root"]["high"][0] = shape[
                "kick_end"
            ]


_end("kick_end half as far", 0.5)
_end("kick_end behind the step", 1e3)
