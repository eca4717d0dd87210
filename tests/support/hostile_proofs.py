"""Proof texts of up to 2 MB that ask a reader for more than they are worth, made from a true one.

A kind changes the default gait's proof as data, or its text. With most kinds goes what both readers
say of it: they refuse in one line, before the work is done.
"""

import copy
import gzip
import hashlib
import json
from collections.abc import Callable, Iterator
from functools import cache
from typing import Any, NamedTuple

from support.shipped_run import SHIPPED

LARGEST = 2_000_000
ZERO, ONE = (0.0).hex(), (1.0).hex()
Change = Callable[[dict[str, Any]], Any]


class Hostile(NamedTuple):
    """A kind: what it does to a proof, and what both readers say, if they say the same."""

    change: Change
    said: str | None


KINDS: dict[str, Hostile] = {}


def text_of(kind: str) -> bytes:
    """The text of a kind."""
    table = copy.deepcopy(_proof())
    found = KINDS[kind].change(table)
    if isinstance(found, bytes):
        return found
    return json.dumps(table if found is None else found, separators=(",", ":")).encode()


@cache
def _proof() -> dict[str, Any]:
    return json.loads((SHIPPED / "certificate" / "proof.json").read_text())


@cache
def _commanded() -> dict[str, Any]:
    """The proof of a gait with commands, with its short statements alone."""
    packed = SHIPPED.with_name("demo_speed_run") / "certificate" / "proof.json.gz"
    table = json.loads(gzip.decompress(packed.read_bytes()))
    table["statements"] = [one for one in table["statements"] if len(one["tree"]) < 100]
    _unclaimed(table)
    return table


def _kind(name: str, said: str | None = None) -> Callable[[Change], Change]:
    def keep(change: Change) -> Change:
        assert name not in KINDS
        KINDS[name] = Hostile(change, said)
        return change

    return keep


def _names(count: int) -> list[str]:
    return [f"n{number}" for number in range(count)]


def _level(table: dict[str, Any], number: int) -> dict[str, Any]:
    return next(one["parameters"] for one in table["theorems"] if one["level"] == number)


def _unclaimed(table: dict[str, Any]) -> None:
    """Nothing is concluded, so that nothing is missing for it before the boxes are looked at."""
    for theorem in table["theorems"]:
        theorem["claimed"] = False


def _hashed(table: dict[str, Any]) -> None:
    text = json.dumps(table["program"], sort_keys=True, separators=(",", ":"))
    table["program_hash"] = hashlib.sha256(text.encode()).hexdigest()


def _with(table: dict[str, Any], place: str, text: str) -> bytes:
    """The proof with a text of JSON at a place that stands for it."""
    return json.dumps(table, separators=(",", ":")).replace(json.dumps(place), text).encode()


# ------------------------------------------------------------------------------------- names


for _field in ("barriers", "carried"):

    @_kind(f"100,000 names in {_field} of level 2", f"more than 1000 {_field}")
    def _(table: dict[str, Any], field: str = _field) -> None:
        _level(table, 2)[field] = _names(100_000)

    @_kind(f"one name 200,000 times in {_field} of level 2", f"more than 1000 {_field}")
    def _(table: dict[str, Any], field: str = _field) -> None:
        _level(table, 2)[field] = ["knee"] * 200_000


@_kind("100,000 commands of level 2", "more than 1000 told")
def _(table: dict[str, Any]) -> None:
    _level(table, 2)["told"] = _names(100_000)


@_kind("100,000 conditions of a statement", "more than 1000 conditions")
def _(table: dict[str, Any]) -> None:
    table["statements"][0]["conditions"] = _names(100_000)


@_kind("30,000 conditions of a statement with scales and bounds", "more than 1000 fields in one")
def _(table: dict[str, Any]) -> None:
    names = _names(30_000)
    numbers = dict.fromkeys(names, 1.0)
    table["statements"][0] |= {"conditions": names, "scales": numbers, "bounds": numbers}


@_kind("1,000 conditions in each of 50 statements")
def _(table: dict[str, Any]) -> None:
    names = _names(1_000)
    numbers = dict.fromkeys(names, 1.0)
    one = table["statements"][0] | {"conditions": names, "scales": numbers, "bounds": numbers}
    table["statements"] = [one] * 50


for _place in ("file", "model", "robot"):

    @_kind(f"100,000 fields in the {_place}", "more than 1000 fields in one object")
    def _(table: dict[str, Any], place: str = _place) -> None:
        more = dict.fromkeys(_names(100_000), 0)
        (table if place == "file" else table[place]).update(more)


@_kind("one field 100,000 times")
def _(table: dict[str, Any]) -> bytes:
    return _with(table | {"kind": "@"}, "@", "0" + ',"kind":0' * 100_000)


@_kind("objects of 1,000 fields each, wherever one may stand")
def _(table: dict[str, Any]) -> None:
    table["statements"] = [dict.fromkeys(_names(1_000), 0)] * 200


@_kind("a robot with a name of 1.8 MB", "too long or has blanks|too long or with blanks")
def _(table: dict[str, Any]) -> None:
    table["robot"]["name"] = "n" * 1_800_000


@_kind("a field with a name of 1.8 MB", "unknown field")
def _(table: dict[str, Any]) -> None:
    table["n" * 1_800_000] = 0


@_kind("a condition with a name of 1.8 MB", "too long")
def _(table: dict[str, Any]) -> None:
    conditions = table["model"]["conditions"]
    conditions["n" * 1_800_000] = conditions["knee"]


@_kind("a region of a statement with a name of 1.8 MB")
def _(table: dict[str, Any]) -> None:
    table["statements"][0]["region"] = "n" * 1_800_000


# ------------------------------------------------------------------------------------- JSON


@_kind("lists in lists, 900,000 deep", "more than 60 levels of JSON")
def _(table: dict[str, Any]) -> bytes:
    return b"[" * 900_000 + b"]" * 900_000


@_kind("objects in objects, 300,000 deep", "more than 60 levels of JSON")
def _(table: dict[str, Any]) -> bytes:
    return b'{"a":' * 300_000 + b"0" + b"}" * 300_000


@_kind("a quantity of quantities, 62 deep", "more than 60 levels of JSON")
def _(table: dict[str, Any]) -> None:
    quantity = table["model"]["conditions"]["knee"]["quantity"]
    for _ in range(62):
        quantity = {"function": "at_least", "of": quantity, "bound": 0.0}
    table["model"]["conditions"]["knee"]["quantity"] = quantity


@_kind("600,000 empty lists")
def _(table: dict[str, Any]) -> None:
    table["model"]["regions"] = [[]] * 600_000


@_kind("900,000 numbers without an end")
def _(table: dict[str, Any]) -> bytes:
    return b"[" + b"1," * 900_000


@_kind("a text without an end")
def _(table: dict[str, Any]) -> bytes:
    return b'{"' + b"a" * 1_900_000


@_kind("300,000 escapes in a text")
def _(table: dict[str, Any]) -> bytes:
    return _with(table | {"weights_sha256": "@"}, "@", '"' + "\\u0041" * 300_000 + '"')


@_kind("400,000 letters of four bytes", "robot name|robot")
def _(table: dict[str, Any]) -> bytes:
    table["robot"]["name"] = "@"
    return json.dumps(table).replace('"@"', '"' + "\U0001f9bf" * 400_000 + '"').encode()


@_kind("spaces")
def _(table: dict[str, Any]) -> bytes:
    return b" " * 1_900_000


@_kind("bytes that are no UTF-8")
def _(table: dict[str, Any]) -> bytes:
    return b'{"' + b"\xff" * 1_900_000 + b'":0}'


@_kind("bytes of zero")
def _(table: dict[str, Any]) -> bytes:
    return bytes(1_900_000)


# ----------------------------------------------------------------------------------- numbers


for _what, _digits in {
    "1,800,000 digits": "9" * 1_800_000,
    "1,800,000 digits behind the point": "0." + "9" * 1_800_000,
    "1,800,000 zeros behind the point": "0." + "0" * 1_800_000 + "1",
    "an exponent of 1,800,000 digits": "1e" + "9" * 1_800_000,
}.items():

    @_kind(f"a scale of {_what}", None if "digits behind" in _what else "no double is near")
    def _(table: dict[str, Any], digits: str = _digits) -> bytes:
        table["statements"][0]["scales"]["knee"] = "@"
        return _with(table, "@", digits)


for _what, _digits in {
    "1,800,000 digits": "0x1." + "8" * 1_800_000 + "p+0",
    "an exponent of 1,800,000 digits": "0x1.8p+" + "9" * 1_800_000,
}.items():

    @_kind(f"a corner in hexadecimal with {_what}", "instead of a hexadecimal number")
    def _(table: dict[str, Any], digits: str = _digits) -> None:
        table["statements"][0]["root"]["low"][0] = digits


@_kind("a format of 1,800,000 digits")
def _(table: dict[str, Any]) -> bytes:
    return _with(table | {"format": "@"}, "@", "3" * 1_800_000)


# -------------------------------------------------------------------------- chart, statements


@_kind("a chart of 100,000 axes without ends", "no list of 2 to 16 axes")
def _(table: dict[str, Any]) -> None:
    table["chart"] += [{"name": name} for name in _names(100_000)]


@_kind("a chart of 25,000 axes", "no list of 2 to 16 axes")
def _(table: dict[str, Any]) -> None:
    ends = {"low": ZERO, "high": ONE}
    table["chart"] += [{"name": name} | ends for name in _names(25_000)]


@_kind("a corner of 150,000 numbers", "a corner that is not 2 numbers")
def _(table: dict[str, Any]) -> None:
    table["statements"][0]["root"]["low"] = [ZERO] * 150_000


def _short(table: dict[str, Any]) -> dict[str, Any]:
    """A true statement of one box about one condition."""
    name = "foot-clears"
    found = next(one for one in table["statements"] if name in one["conditions"])
    numbers = {"scales": {name: found["scales"][name]}, "bounds": {name: 0.0}}
    return found | numbers | {"conditions": [name], "tree": "-"}


@_kind("7,000 times one statement", "more than 1000 statements")
def _(table: dict[str, Any]) -> None:
    table["statements"] = [_short(table)] * 7_000


@_kind("1,000 times one statement of one box")
def _(table: dict[str, Any]) -> None:
    _unclaimed(table)
    table["statements"] = [
        s for s in table["statements"] if s["conditions"] == ["orbit/foot-above"]
    ]
    table["statements"] *= 1_000


@_kind("a tree without leaves")
def _(table: dict[str, Any]) -> None:
    table["statements"][0]["tree"] = "01" * 900_000


@_kind("a tree of leaves alone")
def _(table: dict[str, Any]) -> None:
    table["statements"][0]["tree"] = "-" * 1_800_000


def _whole(depth: int, axis: int = 0) -> str:
    return "-" if depth == 0 else str(axis) + 2 * _whole(depth - 1, 1 - axis)


@_kind("a tree of 500,000 leaves under what is false")
def _(table: dict[str, Any]) -> None:
    one = next(s for s in table["statements"] if "knee" in s["conditions"])
    one["tree"], one["bounds"]["knee"] = _whole(19), 1e6


# ------------------------------------------------------------------------------ model


@_kind("20,000 boxes of a region", "more than 32 boxes of a region")
def _(table: dict[str, Any]) -> None:
    table["model"]["regions"]["tube"] *= 20_000


@_kind("32 boxes in each of 550 regions")
def _(table: dict[str, Any]) -> None:
    strips = [(k / 32, (k + 1) / 32) for k in range(32)]
    boxes = [{"low": [a.hex(), ZERO], "high": [b.hex(), ONE]} for a, b in strips]
    regions = {name: boxes for name in _names(550)}
    table["model"]["regions"] |= regions


@_kind("18,000 regions", "more than 1000 fields in one object")
def _(table: dict[str, Any]) -> None:
    tube = table["model"]["regions"]["tube"]
    table["model"]["regions"] = dict.fromkeys(_names(18_000), tube)


@_kind("9,000 conditions", "more than 1000 fields in one object")
def _(table: dict[str, Any]) -> None:
    knee = table["model"]["conditions"]["knee"]
    table["model"]["conditions"] = dict.fromkeys(_names(9_000), knee)


@_kind("970 conditions on 32 boxes, none of them stated")
def _(table: dict[str, Any]) -> None:
    model, program = table["model"], table["program"]
    knee, about = model["conditions"]["knee"], model["conditions"]["knee"]["region"]
    strips = [(k / 32, (k + 1) / 32) for k in range(32)]
    model["regions"]["strip"] = [
        {"low": [a.hex(), ZERO], "high": [b.hex(), ONE]} for a, b in strips
    ]
    assert about in model["regions"]
    row = next(one for one in program["outputs"] if one[0] == "knee")
    for name in _names(970):
        model["conditions"][name] = knee | {"region": "strip"}
        program["outputs"].append([name, *row[1:]])
    _unclaimed(table)
    table["statements"] = table["statements"][:3]
    _hashed(table)


@_kind("a barrier with 150,000 gains")
def _(table: dict[str, Any]) -> None:
    table["model"]["conditions"]["torso-lower"]["alpha"] = [1.5] * 150_000


@_kind("a quantity with 200,000 bounds")
def _(table: dict[str, Any]) -> None:
    table["model"]["conditions"]["torso-lower"]["quantity"]["bound"] = [-0.25] * 200_000


@_kind("a knee of 200,000 joints")
def _(table: dict[str, Any]) -> None:
    quantity = table["model"]["conditions"]["knee"]["quantity"]
    while "joints" not in quantity:
        quantity = quantity["of"]
    quantity |= {"joints": [1] * 200_000, "sides": [1.0] * 200_000}


@_kind("a leg of 5,000 links")
def _(table: dict[str, Any]) -> None:
    table["model"]["robot"]["leg"] *= 2_500


@_kind("20,000 commands of the policy", "more than 7 commands")
def _(table: dict[str, Any]) -> None:
    rows = [{"name": n, "low": ZERO, "high": ONE, "largest_change": None} for n in _names(20_000)]
    table["model"]["policy"]["commands"] = rows


@_kind("a network of 999,999,999 layers")
def _(table: dict[str, Any]) -> None:
    table["model"]["policy"]["layers"] = 999_999_999


def _numbers(table: dict[str, Any], shape: list[int], count: int) -> None:
    arrays = table["model"]["policy"]["arrays"]
    arrays["lower"] = {"shape": shape, "values": [ONE] * count}


@_kind("an array of 80,000 numbers in the model")
def _(table: dict[str, Any]) -> None:
    _numbers(table, [80_000], 80_000)


@_kind("an array of 800,000 dimensions in the model")
def _(table: dict[str, Any]) -> None:
    _numbers(table, [1] * 800_000, 1)


@_kind("900 arrays more in the model")
def _(table: dict[str, Any]) -> None:
    more = {"shape": [50], "values": [ONE] * 50}
    table["model"]["policy"]["arrays"] |= dict.fromkeys(_names(900), more)


@_kind("residuals of 80,000 numbers")
def _(table: dict[str, Any]) -> None:
    arrays = {"scale": {"shape": [80_000], "values": [ONE] * 80_000}}
    table["model"]["residuals"] = {"flow": {"arrays": arrays, "layers": 1}, "reset": None}


# ------------------------------------------------------------------------------ theorems


@_kind("35,000 theorems")
def _(table: dict[str, Any]) -> None:
    table["theorems"] = [{"level": 2, "claimed": True, "parameters": {}}] * 35_000


for _series in ("expansion", "slowest", "lower"):

    @_kind(f"{_series} of level 3 with 80,000 numbers", f"more than 1000 numbers in {_series}")
    def _(table: dict[str, Any], series: str = _series) -> None:
        _level(table, 3)[series] = [ONE] * 80_000


@_kind("a disturbance of 150,000 numbers")
def _(table: dict[str, Any]) -> None:
    _level(table, 2)["disturbance"] = [ZERO] * 150_000


@_kind("80,000 parameters of level 2", "more than 1000 fields in one object")
def _(table: dict[str, Any]) -> None:
    _level(table, 2).update(dict.fromkeys(_names(80_000), ZERO))


FULL = (
    "bandwidth radius shrink guard_radius start_strip guard_strip crossing risen inertia mismatch"
    " drift gain landing landing_slope"
).split()
OF_BARRIER = "alpha epsilon coupling reading reset reset_slope sigma".split()


@_kind("8,000 barriers of level 4", "more than 1000 barriers")
def _(table: dict[str, Any]) -> None:
    rows = [{"name": name} | dict.fromkeys(OF_BARRIER, ZERO) for name in _names(8_000)]
    parameters = dict.fromkeys(FULL, ONE) | {"pace": [ONE, ONE], "barriers": rows}
    table["theorems"].append({"level": 4, "claimed": True, "parameters": parameters})


# ------------------------------------------------------------------------------ Programs


def _operations(table: dict[str, Any], rows: Iterator[list] | list[list], size: int) -> None:
    """Operations behind those of the Program, the last of which is one more output."""
    program = table["program"]
    program["operations"] += rows
    number = len(program["inputs"]) + len(program["constants"]) + len(program["operations"]) - 1
    row = next(one for one in program["outputs"] if one[0] == "knee")
    row[1:] = [[size], number]
    table["statements"] = [s for s in table["statements"] if "knee" in s["conditions"]]
    _unclaimed(table)
    _hashed(table)


def _next(table: dict[str, Any]) -> int:
    program = table["program"]
    return sum(len(program[part]) for part in ("inputs", "constants", "operations"))


@_kind("70,000 operations, each of the one before")
def _(table: dict[str, Any]) -> None:
    first, size = _next(table) - 1, table["program"]["operations"][-1][2]
    _operations(table, [["sin", [first + k], size] for k in range(70_000)], size)


def _outer(table: dict[str, Any], size: int) -> tuple[list[list], int]:
    """A matrix of so many rows and columns out of a vector of copies of the phase."""
    first = _next(table)
    constant = 1  # Any array that does not vary: the left factor of a product must not.
    rows = [
        ["move", [0], size, [0] * size],
        ["move", [constant], size, [0] * size],
        ["affine", [first + 1, first], size * size, size],
    ]
    return rows, first + 2


@_kind("10,000 operations on 1,000,000 numbers", "more than 8388608 numbers that the Program")
def _(table: dict[str, Any]) -> None:
    rows, wide = _outer(table, 1_000)
    rows += [["sin", [wide + k], 1_000_000] for k in range(10_000)]
    rows.append(["sum", [wide + 10_000], 1])
    _operations(table, rows, 1)


@_kind("a move of 300,000 times 1,000,000 numbers", "more than 8388608 numbers that the Program")
def _(table: dict[str, Any]) -> None:
    rows, wide = _outer(table, 1_000)
    rows.append(["move", [wide] * 300_000, 1, [0]])
    _operations(table, rows, 1)


@_kind("an output of 1,000,000 numbers", "more than 1000 elements of an output of the Program")
def _(table: dict[str, Any]) -> None:
    rows, wide = _outer(table, 1_000)
    rows += [["sin", [wide], 1_000_000], ["exp", [wide + 1], 1_000_000]]
    _operations(table, rows, 1_000_000)


@_kind("a move to 800,000 places", "more than 1000 elements of an output of the Program")
def _(table: dict[str, Any]) -> None:
    _operations(table, [["move", [0], 800_000, [0] * 800_000]], 800_000)


@_kind("an operation of 800,000 operands")
def _(table: dict[str, Any]) -> None:
    _operations(table, [["move", [0] * 800_000, 1, [0]]], 1)


@_kind("100,000 operations of unknown kinds")
def _(table: dict[str, Any]) -> None:
    _operations(table, [["odd", [0], 1]] * 100_000, 1)


@_kind("60,000 constants")
def _(table: dict[str, Any]) -> None:
    table["program"]["constants"] += [[None, [1], "AAAAAAAAAAA="]] * 60_000
    _hashed(table)


@_kind("a constant of 168,000 numbers")
def _(table: dict[str, Any]) -> None:
    table["program"]["constants"].append([None, [168_000], "A" * 1_792_000])
    _hashed(table)


@_kind("a constant of 800,000 dimensions", "more than 8 dimensions of an array")
def _(table: dict[str, Any]) -> None:
    table["program"]["constants"].append([None, [1] * 800_000, "AAAAAAAAAAA="])
    _hashed(table)


@_kind("100,000 outputs", "more than 4000 outputs of the Program")
def _(table: dict[str, Any]) -> None:
    table["program"]["outputs"] += [[name, [], 0] for name in _names(100_000)]
    _hashed(table)


@_kind("3,900 outputs about barriers of theorems")
def _(table: dict[str, Any]) -> None:
    row = next(one for one in table["program"]["outputs"] if one[0] == "set/after torso-lower")
    for name in _names(3_900):
        table["program"]["outputs"].append([f"set/after {name}", *row[1:]])
    _hashed(table)


@_kind("100,000 inputs")
def _(table: dict[str, Any]) -> None:
    table["program"]["inputs"] += [[name, [1]] for name in _names(100_000)]
    _hashed(table)


@_kind("an input of 800,000 dimensions", "more than 8 dimensions of an array")
def _(table: dict[str, Any]) -> None:
    table["program"]["inputs"][0][1] = [1] * 800_000
    _hashed(table)


@_kind("xi of 1,000,000 elements")
def _(table: dict[str, Any]) -> None:
    table["program"]["inputs"].append(["xi", [1_000_000]])
    _hashed(table)


# --------------------------------------------------------------------- work that is still allowed


@_kind("900 conditions that are true")
def _(table: dict[str, Any]) -> None:
    model, program = table["model"], table["program"]
    short = _short(table)
    (own,) = short["conditions"]
    row = next(one for one in program["outputs"] if one[0] == own)
    names = _names(900)
    for name in names:
        program["outputs"].append([name, *row[1:]])
        model["conditions"][name] = model["conditions"][own]
    numbers = {what: dict.fromkeys(names, short[what][own]) for what in ("scales", "bounds")}
    table["statements"] = [short | numbers | {"conditions": names}]
    _unclaimed(table)
    _hashed(table)


def _network(table: dict[str, Any], width: int, inputs: int = 2) -> None:
    """Two hidden layers of so many units in the policy, with weights of zero."""
    constants = table["program"]["constants"]
    arrays = table["model"]["policy"]["arrays"]
    sizes = {
        "network.weights[0]": [width, inputs],
        "network.biases[0]": [width],
        "network.weights[1]": [width, width],
        "network.biases[1]": [width],
        "network.weights[2]": [4, width],
    }
    for name, shape in sizes.items():
        count = shape[0] * (shape[1] if len(shape) > 1 else 1)
        data = "AAAAAAAAAAAAAAAA" * (count // 3 * 2 + 2)
        length = 4 * ((8 * count + 2) // 3)
        pad = (3 - 8 * count % 3) % 3
        text = data[: length - pad] + "=" * pad
        constants[:] = [one for one in constants if one[0] != f"policy.{name}"]
        constants.append([f"policy.{name}", shape, text])
        arrays[name] = {"constant": f"policy.{name}"}
    table["model"]["policy"]["layers"] = 3
    _unclaimed(table)
    _hashed(table)


@_kind("a network of 380 units in each of two layers")
def _(table: dict[str, Any]) -> None:
    _network(table, 380)
    table["statements"] = [s for s in table["statements"] if "knee" in s["conditions"]][:1]
    table["statements"][0]["tree"] = "-"


@_kind("a network of 380 units of a gait with commands")
def _(table: dict[str, Any]) -> dict[str, Any]:
    told = copy.deepcopy(_commanded())
    _network(told, 380, 4)
    told["statements"] = told["statements"][:1]
    return told
