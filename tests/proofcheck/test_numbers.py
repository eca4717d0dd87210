"""One form of numbers: what one reader of a proof takes, the other takes as the same number."""

import json
from pathlib import Path
from typing import Any

import pytest

from neuralgaits._digits import from_hex
from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.errors import InputError
from support.shipped_run import SHIPPED

PROOF = SHIPPED / "certificate" / "proof.json"
REFUSAL = "instead of a hexadecimal number"
ACCEPTED = {
    "0x0.0p+0": 0.0,
    "-0x0.0p+0": 0.0,
    "0x0p0": 0.0,
    "0x1p-1": 0.5,
    "-0x1.8p+3": -12.0,
    "0x1.999999999999ap-4": 0.1,
    "0x1.fffffffffffffp+1023": float.fromhex("0x1.fffffffffffffp+1023"),
    "0x0.0000000000001p-1022": 5e-324,
    "0x1.0p-1074": 5e-324,
}
WRONG = (
    "0.001 1 0 -1 1e5 0x 0x1 0x1p 0x1.p0 0x.8p0 0x2p0 0x1.8 1p0 0X1P0 0x1P0 0x1.Ap0 +0x1p0 --0x1p0"
    " 0x1.0p+0_0 0x1_0p0 0x1p0x 0x1p0.5 0x1p+-1 0x1p1e5 inf -inf Infinity nan NaN"
    " 0x1.00000000000000p0 0x1p1024 0x1p-1075 0x1.8p-1074"
    " 0x1.fffffffffffffp-1030 0x1p99999 0x1p9999 0x1p-9999"
).split()
REFUSED = (
    *WRONG,
    "",
    " ",
    " 0x1p0",
    "0x1p0 ",
    "0x1p0\u0660",
    "0x\u0661p0",
    "\uff10x1p0",
)

Place = tuple[str | int, ...]
PLACES: dict[str, Place] = {
    "axis": ("chart", 0, "low"),
    "root": ("statements", 0, "root", "low", 0),
    "region": ("model", "regions", "tube", 0, "low", 0),
    "parameter": ("theorems", 0, "parameters", "risen"),
    "series": ("theorems", 1, "parameters", "expansion", 0),
}


def _put(table: Any, place: Place, value: Any) -> None:
    for step in place[:-1]:
        table = table[step]
    table[place[-1]] = value


def _said(read: Any, *arguments: Any) -> str:
    """What is wrong with a file; empty if it can be read."""
    try:
        read(*arguments)
    except InputError as problem:
        return str(problem)
    return ""


@pytest.mark.parametrize("text", ACCEPTED)
def test_a_number_is_what_it_is_written_as(text):
    assert from_hex(text, "a number") == ACCEPTED[text] == float.fromhex(text)


@pytest.mark.parametrize("value", [0.0, -0.0, 1 / 3, -5e-324, 2.2e-308, 1.7e308, 12.0])
def test_what_is_written_is_read(value):
    assert from_hex(value.hex(), "a number").hex() == value.hex()


@pytest.mark.parametrize("text", [*REFUSED, 0, 1.5, True, None, [], {}], ids=ascii)
def test_everything_else_is_none(text):
    with pytest.raises(ValueError, match=REFUSAL):
        from_hex(text, "a number")


@pytest.mark.parametrize("place", PLACES)
def test_both_readers_take_the_same_texts(proofcheck, tmp_path, place):
    """In the chart, in roots, in regions, in theorems: a text is refused as a number, or not."""
    true = json.loads(PROOF.read_text())
    true["statements"] = true["statements"][:3]  # What follows from fewer is soon answered.
    path = tmp_path / "proof.json"
    for text in (*ACCEPTED, *REFUSED):
        _put(true, PLACES[place], text)
        path.write_text(json.dumps(true))
        mine, other = _said(read_claims, path), proofcheck(path).stderr
        refused = text in REFUSED
        assert (REFUSAL in mine) is refused, (text, mine)
        assert (REFUSAL in other) is refused, (text, other)


JSON_NUMBERS = {
    "degree": (("statements", 0, "degree"), "1.0 true 1e0 -0 -1 3 null 1" + "0" * 400),
    "format": (("format",), "3.0 true 3e0 null 3" + "0" * 400),
    "level": (("theorems", 0, "level"), "2.0 true 2e0 null"),
    "version": (("program", "version"), "1.0 true 1e0 null"),
    "claimed": (("theorems", 0, "claimed"), "1 0 null 1.0"),
    "scale": (("statements", 0, "scales", "knee"), "true null 1e400 1e-400 NaN 1" + "0" * 400),
    "bound": (("statements", 0, "bounds", "knee"), "true null -1e-9 1e-999 Infinity -Infinity"),
    "region": (("statements", 0, "region"), "0 1.5 true null"),
    "tree": (("statements", 0, "tree"), "0 1.5 true null"),
    "robot": (("robot", "name"), "0 1.5 true null"),
    "constant": (("program", "constants", 0, 1), "[4.0] [true] [-4] [4e0]"),
}


@pytest.mark.parametrize("what", JSON_NUMBERS)
def test_both_readers_refuse_the_same_numbers_of_json(proofcheck, tmp_path, what):
    place, literals = JSON_NUMBERS[what]
    table = json.loads(PROOF.read_text())
    _put(table, place, "@")
    path = tmp_path / "proof.json"
    for literal in (*literals.split(), '"1"' if what != "region" else "[]"):
        if what in ("tree", "robot") and literal == '"1"':
            continue  # A text, as it should be.
        path.write_text(json.dumps(table).replace('"@"', literal))
        answer = proofcheck(path)
        assert answer.returncode == 2, (literal, answer.stdout[-200:], answer.stderr)
        assert _said(read_claims, path), literal


def test_the_shipped_proof_is_read(tmp_path):
    assert _said(read_claims, Path(PROOF)) == ""
