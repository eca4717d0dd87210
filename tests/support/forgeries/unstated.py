"""Level 5 on top of level 4, whose premises nobody states.

Wrong numbers of a true proof of level 5 are in tests/proofcheck/test_disturbed.py.
"""

from collections.abc import Mapping
from typing import Any

from support.forgeries.base import Case, Table, Theme, refused
from support.forgeries.edits import parameters

THEME = Theme("full")
FALLS = refused("rejected unreadable")
HOLDS = {"hold": 1e-3, "error": 0.0, "jerk": 800.0, "growth_slope": 2e5, "jerk_push": 20.0}
KICKS = {"kick": 30.0, "kick_slope": 9e3, "kick_push": 2.0, "kick_peak": 50.0, "kick_end": 0.01}
LAW = {"decay": 60.0, "rest": 0.03}
STATE = {
    "state_error": [5e-6, 2.5e-4],
    "state_axes": [1.6e-5] * 5 + [8e-4] * 5,
    "state_moves": [1e-4, 2e-3, 1e-3],
    "state_slopes": [0.9, 1e-3],
}


def _disturbed(case: Case, numbers: Mapping[str, float], **lists: list[float]) -> Table:
    """A level 5 on top, whose premises nobody states. Returns: its parameters."""
    barriers = parameters(case.table, 4)["barriers"]
    rows = [
        {"name": b["name"], **{k: (1.0).hex() for k in ("alpha", "weight", "lost")}}
        for b in barriers
    ]
    pair = [(0.5).hex(), (10.0).hex()]
    found = {"push": pair, "peak": pair, "barriers": rows}
    found |= {name: number.hex() for name, number in numbers.items()}
    found |= {name: [x.hex() for x in row] for name, row in lists.items()}
    case.table["theorems"].append({"level": 5, "claimed": True, "parameters": found})
    return found


def _held(what: str) -> Any:
    return THEME.forgery(f"level 5 on top, {what}", cpp=FALLS, alone=FALLS, run=FALLS)


@_held("of which no premise is stated")
def _(case: Case) -> None:
    _disturbed(case, HOLDS)


@_held("of a free clock, of which no premise is stated")
def _(case: Case) -> None:
    _disturbed(case, HOLDS | KICKS)


@_held("of scheduled PD, of which no premise is stated")
def _(case: Case) -> None:
    gains = {"torque_gains": [1.0] * 4 * 17 * 9, "inertia_gains": [1.0] * 16 * 11 * 4}
    _disturbed(case, HOLDS | LAW, **gains)


@_held("of a measured state, of which no premise is stated")
def _(case: Case) -> None:
    _disturbed(case, HOLDS | {"error": 1.0, "state_radius": 2e-3}, **STATE)


@_held("of a measured state that moves phase and level alone")
def _(case: Case) -> None:
    _disturbed(case, HOLDS | {"error": 1.0}, **STATE | {"state_moves": [1e-4, 2e-3]})


@_held("of a law whose coefficients are too few")
def _(case: Case) -> None:
    _disturbed(case, HOLDS | LAW, torque_gains=[1.0], inertia_gains=[1.0])


@_held("whose barriers are under each other's name")
def _(case: Case) -> None:
    found = _disturbed(case, HOLDS)
    found["barriers"] = found["barriers"][::-1]
