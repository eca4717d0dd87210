"""Names that would write more than themselves on a screen."""

from support.forgeries.base import UNREADABLE, Case, Table, Theme, true
from support.forgeries.edits import rename, rename_region

THEME = Theme("small")
CHARACTERS = {
    "an ANSI escape": "\x1b[2K\x1b[1A",
    "a line feed": "\nproved: 3 claims\n",
    "a carriage return": "\rproved",
    "a null": "\x00",
    "a delete": "\x7f",
    "a C1 control": "\x9b2K",
    "a right-to-left override": "\u202e",
    "a zero-width space": "\u200b",
    "a line separator": "\u2028",
    "half a surrogate pair": "\ud83d",
}
"""What a name may not hold, by what it is."""


def _robot(table: Table, text: str) -> None:
    table["robot"]["name"] += text


def _both(table: Table, text: str) -> None:
    _robot(table, text)
    table["model"]["robot"]["name"] += text


def _model(table: Table, text: str) -> None:
    table["model"]["robot"]["name"] += text


def _spec(table: Table, text: str) -> None:
    table["spec"]["name"] += text


def _condition(table: Table, text: str) -> None:
    rename(table, "tall", f"tall{text}")


def _region(table: Table, text: str) -> None:
    rename_region(table, "ends", f"ends{text}")


def _label(table: Table, text: str) -> None:
    table["statements"][0]["region"] += text


def _weights(table: Table, text: str) -> None:
    table["weights_sha256"] += text


def _digest(table: Table, text: str) -> None:
    table["robot"]["sha256"] += text


def _field(table: Table, text: str) -> None:
    table[f"note{text}"] = 1


def _kind(table: Table, text: str) -> None:
    table["kind"] += text


def _output(table: Table, text: str) -> None:
    table["program"]["outputs"].append([f"zz{text}", [], table["program"]["outputs"][0][2]])


def _user(table: Table, text: str) -> None:
    table["model"]["conditions"]["tall"]["quantity"] = {"user": f"mine{text}"}


PLACES = {
    "the robot's name": _robot,
    "the robot's name, twice": _both,
    "the model's robot": _model,
    "the spec's name": _spec,
    "a condition's name": _condition,
    "a region's name": _region,
    "a statement's region": _label,
    "the hash of the weights": _weights,
    "the hash of the robot": _digest,
    "the name of an unknown field": _field,
    "the kind of the file": _kind,
    "an output without a statement": _output,
    "a user's quantity": _user,
}


def _kind_of(place: str, character: str) -> None:
    what, code = f"{character} in {place}", CHARACTERS[character]
    # The C++ checker writes what is not ASCII as numbers.
    escaped = true(r"\\xe2\\x80") if code[0] > "\xff" else UNREADABLE

    @THEME.forgery(what, cpp=escaped, alone=UNREADABLE)
    def _(case: Case) -> None:
        PLACES[place](case.table, code)


for _place in PLACES:
    _kind_of(_place, "an ANSI escape")
for _character in list(CHARACTERS)[1:]:
    _kind_of("a condition's name", _character)
    _kind_of("the robot's name", _character)
