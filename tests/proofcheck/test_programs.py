"""The C++ checker by the Program in a file: random Programs in 2 to 16 axes, and forged proofs."""

import hashlib
import json
import re

import numpy as np
import pytest

from neuralgaits.programs import POINT, Program, evaluate
from neuralgaits.programs.tracing.tracer import trace
from support.checker_case import bounds, chart_table
from support.program_case import MORE, bowl, file_of, halved, random_program
from support.program_cases import cancelling


@pytest.fixture
def by_program(proofcheck, tmp_path):
    """Asks the checker about a table, by its Program."""

    def ask(table, *options):
        path = tmp_path / "proof.json"
        path.write_text(json.dumps(table))
        return proofcheck(*(options or ("--program",)), path)

    return ask


@pytest.mark.parametrize("axes", [2, 3, 4, 6, 8, 11, 16])
def test_values_of_random_programs_lie_within_bounds(proofcheck, tmp_path, axes):
    draw = np.random.default_rng(axes)
    bounded = total = 0
    for seed in range(3):
        program, path = random_program(axes, seed), tmp_path / f"{seed}.json"
        path.write_text(json.dumps(file_of(program, {"margin 0": 0.0})))
        size = 0.5 ** draw.uniform(0.0, 6.0, size=(8, 1)) * np.ones(axes)
        low = draw.uniform(-1.0, 1.0, size=(8, axes))
        found = bounds(proofcheck, path, low, low + size, "--program")
        for box, enclosed in enumerate(found):
            u = low[box] + size[box] * draw.uniform(size=(60, axes))
            values = evaluate(program, {"u": u}, POINT)
            for name, ranges in enclosed.items():
                total += 1
                if ranges is None:
                    continue
                bounded += 1
                value = values[name].reshape(60, -1)
                slack = 1e-12 * np.maximum(1.0, np.max(np.abs(value)))
                assert np.all(ranges[:, 0] - slack <= value.min(axis=0)), (seed, box, name)
                assert np.all(value.max(axis=0) <= ranges[:, 1] + slack), (seed, box, name)
    assert bounded > 0.7 * total


def test_remainders_that_cancel_cost_few_boxes(by_program):
    """The symbols that it chooses show in their number only: without any, 127 boxes are needed."""
    program = trace(lambda u: {"h": cancelling(u)["h"] - 0.098}, {"u": (2,)})
    answer = by_program(file_of(program, {"h": 0.0}))
    assert answer.returncode == 0, answer.stdout + answer.stderr
    (boxes,) = re.findall(r"level in \[0, 1\]; (\d+) boxes", answer.stdout)
    assert 8 < int(boxes) < 60


@pytest.mark.parametrize("axes", [2, 4, 6])
def test_bounds_are_of_third_order(proofcheck, tmp_path, axes):
    """Boxes half as wide have bounds that are wrong by an eighth, or nearly so."""
    program, path = random_program(axes, 7), tmp_path / "proof.json"
    path.write_text(json.dumps(file_of(program, {"margin 0": 0.0})))
    centre, draw = np.full((1, axes), 0.3), np.random.default_rng(1)
    excess = []
    for size in (0.02, 0.01):
        (found,) = bounds(proofcheck, path, centre - size / 2, centre + size / 2, "--program")
        u = centre + size * draw.uniform(-0.5, 0.5, size=(4000, axes))
        corners = centre + size * draw.choice([-0.5, 0.5], size=(4000, axes))
        values = evaluate(program, {"u": np.concatenate([u, corners])}, POINT)
        excess.append(
            [
                np.max(values[n].reshape(8000, -1).min(axis=0) - found[n][:, 0])
                for n in sorted(found)
            ]
        )
    assert np.all(np.array(excess[1]) <= 0.5 * np.array(excess[0]) + 1e-12)


@pytest.mark.parametrize("axes", [2, 4, 6])
def test_what_follows_is_consistent_and_says_no_more(by_program, axes):
    answer = by_program(file_of(bowl(axes, 0.1), {"margin": 0.09}))
    assert answer.returncode == 0, answer.stdout
    last = answer.stdout.splitlines()[-1]
    assert last.startswith("consistent: every statement follows from the Program in the file; ")
    assert "nothing was derived from the robot's numbers" in last
    assert "proved" not in answer.stdout


def test_without_being_asked_nothing_is_taken_from_the_program(by_program, proofcheck, tmp_path):
    table = file_of(bowl(3, 0.1), {"margin": 0.05})
    assert by_program(table).returncode == 0
    answer = proofcheck(tmp_path / "proof.json")
    assert answer.returncode == 3 and "--program" in answer.stdout


@pytest.mark.parametrize("axes", [4, 6])
def test_planted_violations_are_never_accepted(by_program, axes):
    """The dent is a thousandth of the box or less; without it the statement holds."""
    dented = by_program(file_of(bowl(axes, 0.1, depth=1e3), {"margin": 0.05}))
    assert dented.returncode in (1, 3), dented.stdout
    tree = halved(axes, 4)
    cut = by_program(file_of(bowl(axes, 0.1, depth=1e3), {"margin": 0.05}, tree))
    assert cut.returncode in (1, 3), cut.stdout
    false = by_program(file_of(bowl(axes, 0.1), {"margin": 0.11}))
    assert false.returncode == 1 and " at phase " in false.stdout, false.stdout
    assert MORE[axes - 3][0] in false.stdout


def hashed(table):
    table["program_hash"] = Program.from_json(json.dumps(table["program"])).hash
    return table


def root(table, end: str, axis: int, value: float) -> None:
    table["statements"][0]["root"][end][axis] = value.hex()


FORGED = {
    "leaf gone": (1, lambda t: t["statements"][0].__setitem__("tree", halved(2, 3)[:-1])),
    "leaf more": (1, lambda t: t["statements"][0].__setitem__("tree", halved(2, 3) + "-")),
    "axis that is none": (1, lambda t: t["statements"][0].__setitem__("tree", "7--")),
    "too deep": (1, lambda t: t["statements"][0].__setitem__("tree", "0" * 49 + "-" * 50)),
    "sign": (2, lambda t: t["statements"][0].__setitem__("tree", "g--")),
    "bound": (1, lambda t: t["statements"][0]["bounds"].__setitem__("margin", 0.2)),
    "scale": (1, lambda t: t["statements"][0]["scales"].__setitem__("margin", 9.0)),
    "no scale": (2, lambda t: t["statements"][0]["scales"].__setitem__("margin", 0.0)),
    "root beyond the chart": (2, lambda t: root(t, "high", -1, 40.0)),
    "root upside down": (2, lambda t: root(t, "low", -1, 40.0)),
    "root of another size": (2, lambda t: t["statements"][0]["root"]["low"].append("0x0p+0")),
    "chart cut": (2, lambda t: t["chart"].pop()),
    "chart grown": (2, lambda t: t["chart"].append(chart_table(("more", 0.0, 1.0))[2])),
    "axis upside down": (2, lambda t: t["chart"][-1].update(low="0x1p+9")),
    "axis with more": (2, lambda t: t["chart"][-1].update(unit="m")),
    "hash": (1, lambda t: t.__setitem__("program_hash", t["program_hash"][::-1])),
    "operation": (1, lambda t: t["program"]["operations"][0].__setitem__(0, "mul")),
    "operation and hash": (
        1,
        lambda t: (t["program"]["operations"][11].__setitem__(0, "mul"), hashed(t)),
    ),
    "condition": (2, lambda t: t["statements"][0]["conditions"].append("other")),
    "theorem": (2, lambda t: t["theorems"].append({"level": 2, "claimed": True, "parameters": {}})),
}


@pytest.mark.parametrize("axes", [2, 4, 6])
@pytest.mark.parametrize("name", FORGED)
def test_forged_files_are_rejected(by_program, axes, name):
    expected, change = FORGED[name]
    table = file_of(bowl(axes, 0.1), {"margin": 0.09})
    change(table)
    answer = by_program(table)
    assert answer.returncode == expected, answer.stdout + answer.stderr


MALFORMED = {
    "kind": lambda rows: rows[0].__setitem__(0, "log"),
    "later operand": lambda rows: rows[0].__setitem__(1, [0, 17]),
    "no operand": lambda rows: rows[0].__setitem__(1, []),
    "size": lambda rows: rows[0].__setitem__(2, 1),
    "no size": lambda rows: rows[0].__setitem__(2, 0),
    "field": lambda rows: rows[0].append([1]),
    "move": lambda rows: rows.__setitem__(0, ["move", [0], 4, [0, 1, 2, 9]]),
    "affine of a value": lambda rows: rows.__setitem__(3, ["affine", [8, 8], 1, 1]),
    "affine without columns": lambda rows: rows.__setitem__(3, ["affine", [3, 8], 1, 0]),
}


@pytest.mark.parametrize("name", MALFORMED)
def test_malformed_programs_are_refused(by_program, name):
    """With a hash of their own: it does not help."""
    table = file_of(bowl(4, 0.1), {"margin": 0.09})
    MALFORMED[name](table["program"]["operations"])
    text = json.dumps(table["program"], sort_keys=True, separators=(",", ":"))
    table["program_hash"] = hashlib.sha256(text.encode()).hexdigest()
    answer = by_program(table)
    assert answer.returncode == 2 and answer.stderr.count("\n") == 1, answer.stdout
