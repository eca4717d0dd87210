"""Files that are inconsistent are rejected, files of another format refused, in one line."""

import base64
import hashlib
import json
from typing import Any

import pytest

from neuralgaits.certificate.proof_file.reader import halves, read_claims
from neuralgaits.errors import InputError
from support.small_proof import checked, write


def _flip(data: str) -> str:
    raw = bytearray(base64.b64decode(data))
    raw[-3] ^= 1
    return base64.b64encode(raw).decode()


def _change_constant(table: dict[str, Any], number: int) -> None:
    row = table["program"]["constants"][number]
    row[2] = _flip(row[2])


INCONSISTENT = {
    "weights": lambda t: _change_constant(t, 0),
    "constant": lambda t: _change_constant(t, 1),
    "operation": lambda t: t["program"]["operations"][3].__setitem__(0, "sin"),
    "hash": lambda t: t.__setitem__("program_hash", t["program_hash"][::-1]),
    "tree cut": lambda t: t["statements"][0].__setitem__("tree", t["statements"][0]["tree"][:-1]),
    "tree grown": lambda t: t["statements"][2].__setitem__(
        "tree", t["statements"][2]["tree"] + "-"
    ),
    "tree that ends in a split": lambda t: t["statements"][2].__setitem__(
        "tree", t["statements"][2]["tree"][:-1] + "0"
    ),
    "tree of one leaf and more": lambda t: t["statements"][0].__setitem__(
        "tree", "-" + t["statements"][0]["tree"][1:]
    ),
    "tree too deep": lambda t: t["statements"][2].__setitem__("tree", "0" * 60 + "-" * 61),
}


@pytest.mark.parametrize("name", INCONSISTENT)
def test_inconsistent_files_are_rejected(tmp_path, mutated, name):
    INCONSISTENT[name](mutated)
    report = checked(tmp_path, mutated)
    assert report.verdict == "rejected"
    assert report.boxes == 0
    assert ("tree" if name.startswith("tree") else "hash") in str(report.reason)


def _renamed(table: dict[str, Any], old: str, new: str) -> None:
    """An output under another name everywhere, with the hash made anew."""
    renamed = json.loads(json.dumps(table).replace(json.dumps(old), json.dumps(new)))
    renamed["program"]["outputs"].sort()
    table |= renamed
    table["program_hash"] = hashlib.sha256(
        json.dumps(table["program"], sort_keys=True, separators=(",", ":")).encode()
    ).hexdigest()


def _axes(count: int) -> list[dict[str, str]]:
    """So many more axes of a chart."""
    return [{"name": f"p{k}", "low": "-0x1p+0", "high": "0x1p+0"} for k in range(count)]


UNREADABLE = {
    "version": lambda t: t.__setitem__("format", 1),
    "true version": lambda t: t.__setitem__("format", True),
    "kind": lambda t: t.__setitem__("kind", "neuralgaits level 1"),
    "chart": lambda t: t.__setitem__("chart", "u = (phase, level)"),
    "chart of one axis": lambda t: t["chart"].pop(),
    "chart of nine axes": lambda t: t["chart"].extend(_axes(7)),
    "chart the other way": lambda t: t["chart"].reverse(),
    "chart with a longer phase": lambda t: t["chart"][0].update(high="0x1.2p+0"),
    "axis twice": lambda t: t["chart"].extend(_axes(1) * 2),
    "axis without width": lambda t: t["chart"].append(_axes(1)[0] | {"high": "-0x1p+0"}),
    "axis without end": lambda t: t["chart"].append(_axes(1)[0] | {"high": "inf"}),
    "axis wider than doubles": lambda t: t["chart"].append(
        {"name": "p", "low": "-0x1p+1023", "high": "0x1p+1023"}
    ),
    "constant named by a list": lambda t: t["program"]["constants"][0].__setitem__(0, []),
    "constant named by a number": lambda t: t["program"]["constants"][0].__setitem__(0, 5),
    "constants of one name": lambda t: t["program"]["constants"][1].__setitem__(
        0, t["program"]["constants"][0][0]
    ),
    "operand of false": lambda t: t["program"]["operations"][0].__setitem__(1, [False, True]),
    "size of true": lambda t: t["program"]["operations"][1].__setitem__(2, True),
    "shape below zero": lambda t: t["program"]["outputs"][0].__setitem__(1, [-1, -1]),
    "axis with a comma": lambda t: t["chart"].append(_axes(1)[0] | {"name": "a, b"}),
    "axis that the program lacks": lambda t: t["chart"].extend(_axes(1)),
    "unknown field": lambda t: t.__setitem__("note", "trust me"),
    "missing field": lambda t: t.pop("spec"),
    "unknown in a statement": lambda t: t["statements"][0].__setitem__("skip", True),
    "unknown in the Program": lambda t: t["program"].__setitem__("skip", True),
    "version of the Program": lambda t: t["program"].__setitem__("version", 2),
    "unknown output": lambda t: t["statements"][1].__setitem__("conditions", ["bow"]),
    "repeated output": lambda t: t["statements"][1].__setitem__("conditions", ["bowl", "bowl"]),
    "no statements": lambda t: t.__setitem__("statements", []),
    "no conditions": lambda t: t["statements"][0].__setitem__("conditions", []),
    "NaN": lambda t: t["statements"][0]["bounds"].__setitem__("bowl", float("nan")),
    "negative bound": lambda t: t["statements"][0]["bounds"].__setitem__("bowl", -0.1),
    "no bound": lambda t: t["statements"][0]["bounds"].pop("wave"),
    "no scale": lambda t: t["statements"][0]["scales"].__setitem__("bowl", 0.0),
    "degree": lambda t: t["statements"][0].__setitem__("degree", 3),
    "true degree": lambda t: t["statements"][0].__setitem__("degree", True),
    "root": lambda t: t["statements"][0]["root"].__setitem__("high", [(1.0).hex(), (1.5).hex()]),
    "root upside down": lambda t: t["statements"][0]["root"].__setitem__("high", ["-0x1p-1"] * 2),
    "root of decimals": lambda t: t["statements"][0]["root"].__setitem__("low", [0.0, 0.0]),
    "root outside the strips": lambda t: t["statements"][0]["root"].__setitem__(
        "low", [(-0.11).hex(), (0.0).hex()]
    ),
    "theorems": lambda t: t.__setitem__("theorems", {}),
    "theorem without a level": lambda t: t.__setitem__("theorems", [{"start": "0x0p+0"}]),
    "model": lambda t: t.__setitem__("model", []),
    "tree": lambda t: t["statements"][0].__setitem__("tree", "100g"),
    "empty tree": lambda t: t["statements"][0].__setitem__("tree", ""),
    "operand": lambda t: t["program"]["operations"][0].__setitem__(1, [0, 9]),
    "fraction": lambda t: t["program"]["operations"][0].__setitem__(2, 2.0),
    "output like a premise": lambda t: _renamed(t, "bowl", "set/inertia"),
    "output with a slash": lambda t: _renamed(t, "bowl", "bowl/high"),
    "escapes in an output": lambda t: _renamed(t, "bowl", "\x1b[32mproved\x1b[0m"),
    "escapes in the robot's name": lambda t: t["robot"].__setitem__("name", "a\rproved"),
    "text that runs backwards": lambda t: t["spec"].__setitem__("name", "a\u202eb"),
    "model without conditions": lambda t: t.__setitem__("model", {}),
    "blanks that fill a line": lambda t: t["robot"].__setitem__("name", "a" + " " * 60 + "proved"),
    "comma in an output": lambda t: _renamed(t, "bowl", "bowl, wave"),
    "width that no operand has": lambda t: t["program"]["operations"].__setitem__(
        3, ["cos", [3], 6]
    ),
    "more elements than any gait has": lambda t: t["program"]["constants"].append(
        [None, [1 << 20, 2], base64.b64encode(bytes(16 << 20)).decode()]
    ),
}


@pytest.mark.parametrize("name", UNREADABLE)
def test_what_the_format_does_not_know_is_refused(tmp_path, mutated, name):
    UNREADABLE[name](mutated)
    with pytest.raises(InputError, match="expected a proof file of format 3") as caught:
        checked(tmp_path, mutated)
    assert str(caught.value).isprintable()


@pytest.mark.parametrize("text", ["", "[]", "{}", "[" * 100_000, '{"format": 3, "format": 3}'])
def test_no_proof_file_at_all(tmp_path, text):
    with pytest.raises(InputError, match="expected a proof file"):
        read_claims(write(tmp_path, text))
    with pytest.raises(InputError, match="none to read"):
        read_claims(tmp_path / "absent.json")


@pytest.mark.parametrize(
    ("content", "found"),
    [
        (b"# Notes", "no JSON; name a run"),
        (b'{"format": 1}', "format 1; name a run that is certified, or its certificate/proof.json"),
        (b"\xa0\xff", "none to read: no text; name a run"),
        (b'{"kind": "neuralgaits certificate", "format"', "no JSON; certify its run again"),
        (b'{"kind": "neuralgaits certificate", "format": 2}', "format 2; certify its run again"),
    ],
)
def test_the_remedy_fits_the_file(tmp_path, content, found):
    file = tmp_path / "file"
    file.write_bytes(content)
    with pytest.raises(InputError, match=found):
        read_claims(file)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_halves_cover_their_box(axis):
    low, high = (0.0, 0.25, -3.0), (1.0, 0.75, 5.0)
    (first, middle), (start, last) = halves(low, high, axis)
    assert (first, last) == (low, high)
    assert middle[axis] == start[axis] == 0.5 * (low[axis] + high[axis])
    others = [k for k in range(3) if k != axis]
    assert all(middle[k] == high[k] and start[k] == low[k] for k in others)
