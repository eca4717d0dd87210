"""Level 4 by the C++ checker: premises as their Python functions compute them, and what follows."""

import base64
import hashlib
import json
from collections.abc import Iterator
from dataclasses import fields, replace
from functools import cache

import numpy as np
import pytest

from neuralgaits.certificate.levels.full_order.conclude import conclude_full_order
from neuralgaits.certificate.levels.full_order.theorem import FullOrderConstants, premises, series
from neuralgaits.certificate.proof_file.theorem_tables import Theorems
from support.checker_case import bounds
from support.full_case import NARROW, WIDE, FullCase, in_the_ball
from support.full_order_shape import FENCE, SHAPE, TORSO

CASES = ("amber3m", "torso-2", "legs-2")
POINTS, BOXES, SAMPLES = 6, 6, 40


@cache
def of(name: str, radius: float = NARROW) -> FullCase:
    """Traced once for all tests, none of which changes it."""
    return FullCase(name, radius=radius)


@pytest.mark.parametrize("name", CASES)
def test_values_where_outputs_are_nearly_zero(proofcheck, tmp_path, name):
    """A ball of 1e-7 rad: what is left of its enclosure is slopes that the premises bound."""
    case = of(name)
    file = case.write(tmp_path / "proof.json")
    u = np.random.default_rng(1).uniform((0.0, 0.2), (1.0, 0.8), size=(POINTS, 2))
    found, expected = bounds(proofcheck, file, u, u), case.values(u)
    assert set(found[0]) == set(expected) and len(expected) > 40
    for output, values in expected.items():
        enclosed = np.stack([one[output] for one in found])
        scale = np.maximum(1.0, np.abs(values))
        middle = 0.5 * (enclosed[..., 0] + enclosed[..., 1])
        np.testing.assert_allclose(
            middle / scale, values / scale, atol=1e-5, rtol=0, err_msg=output
        )
        assert np.all(enclosed[..., 1] - enclosed[..., 0] <= 1e-3 * scale), output


@pytest.mark.parametrize("name", CASES)
def test_boxes_contain_their_points_for_all_of_the_ball(proofcheck, tmp_path, name):
    case, draw = of(name, WIDE), np.random.default_rng(2)
    file = case.write(tmp_path / "proof.json")
    size = 0.5 ** draw.uniform(5.0, 9.0, size=(BOXES, 1)) * np.ones(2)
    low = draw.uniform(size=(BOXES, 2)) * (1.0 - size)
    bounded = total = 0
    for box, enclosed in enumerate(bounds(proofcheck, file, low, low + size)):
        u = low[box] + size[box] * draw.uniform(size=(SAMPLES, 2))
        values = case.values(u, in_the_ball(draw, SAMPLES, case.full_model.size))
        for output, ranges in enclosed.items():
            total += 1
            if ranges is None:
                continue
            bounded += 1
            value = values[output]
            slack = 1e-9 * np.maximum(1.0, np.max(np.abs(value)))
            assert np.all(ranges[:, 0] - slack <= value.min(axis=0)), output
            assert np.all(value.max(axis=0) <= ranges[:, 1] + slack), output
    assert bounded > 0.8 * total


def test_both_ways_enclose_the_same(proofcheck, tmp_path):
    """By its own formulas and by the Program in the file, on one box."""
    file = of("amber3m", WIDE).write(tmp_path / "proof.json")
    low = np.array([[0.4, 0.45]])
    (own,), (programs,) = (
        bounds(proofcheck, file, low, low + 0.01, *options) for options in ((), ("--program",))
    )
    assert set(own) == set(programs)
    for output, ranges in own.items():
        other = programs[output]
        assert np.all(ranges[:, 0] <= other[:, 1]) and np.all(other[:, 0] <= ranges[:, 1]), output


def test_a_residual_and_another_size_of_xi_are_rejected(proofcheck, tmp_path):
    case = of("amber3m")
    table = json.loads(json.dumps(case.table))
    zero = {"shape": [2], "values": ["0x0p+0"] * 2}
    layer = {"shape": [2, 2], "values": ["0x0p+0"] * 4}
    arrays = {"scale": zero, "shift": zero, "bound": zero}
    arrays |= {"network.weights[0]": layer, "network.biases[0]": zero}
    table["model"]["residuals"] = {"flow": {"layers": 1, "arrays": arrays}, "reset": None}
    path = tmp_path / "proof.json"
    path.write_text(json.dumps(table))
    answer = proofcheck(path)
    assert answer.returncode == 1 and "residuals" in answer.stdout


OTHER = replace(TORSO, name="other")
FITS = replace(SHAPE, barriers=())
"""Constants from which the theorem follows, with any barriers like those above."""
FACTORS = (-1.0, 0.0, 0.8, 1.4)


def stated(case: FullCase, shape: FullOrderConstants) -> dict:
    """A file that claims level 4 with these constants, and premises with bounds that are absurd."""
    table = dict(case.table)
    rows = [list(row) for row in table["program"]["constants"]]
    program = table["program"] | {"constants": rows}
    for name, numbers in series(shape).items():
        (row,) = [row for row in rows if row[0] == f"full.{name}"]
        row[2] = base64.b64encode(np.array(numbers).tobytes()).decode()
    (theorem,) = Theorems.of(shape, claimed=(4,)).tables()
    statements = [
        table["statements"][0]
        | {
            "conditions": [p.output],
            "scales": {p.output: 1.0},
            "bounds": {p.output: 1e9},
            "root": {end: [x.hex() for x in getattr(p, end)] for end in ("low", "high")},
        }
        for p in premises(shape)
    ]
    found = {"program": program, "theorems": [theorem], "statements": statements}
    text = json.dumps(program, sort_keys=True, separators=(",", ":"))
    return table | found | {"program_hash": hashlib.sha256(text.encode()).hexdigest()}


@pytest.fixture(scope="module")
def case():
    return of("amber3m")


@pytest.fixture(scope="module")
def fits(case):
    fences = (FENCE, replace(FENCE, name="level-upper"))
    others = tuple(replace(OTHER, name=name) for name in case.full_model.names[2:])
    return replace(FITS, barriers=fences + others)


@pytest.fixture
def follows(proofcheck, tmp_path):
    """Whether the conclusion of a file is drawn; its statements are false, and looked at later."""

    def ask(table) -> bool:
        path = tmp_path / "proof.json"
        path.write_text(json.dumps(table))
        answer = proofcheck(path)
        assert answer.returncode in (1, 2), answer.stdout
        return answer.returncode == 1 and "level 4 does not follow" not in answer.stdout

    return ask


def variants(shape: FullOrderConstants) -> Iterator[FullOrderConstants]:
    """Every constant times every factor."""
    alone = [f.name for f in fields(shape) if f.name not in ("pace", "barriers", "weights")]
    for factor in FACTORS:
        for name in alone:
            yield replace(shape, **{name: factor * getattr(shape, name)})
        for k in (0, 1):
            pace = tuple(x * (factor if i == k else 1.0) for i, x in enumerate(shape.pace))
            yield replace(shape, pace=pace)
        for k in (0, 2):
            for field in fields(OTHER)[1:]:
                changed = {field.name: factor * getattr(shape.barriers[k], field.name)}
                rows = list(shape.barriers)
                rows[k] = replace(rows[k], **changed)
                yield replace(shape, barriers=tuple(rows))


def test_both_checkers_draw_the_same_conclusions(case, fits, follows):
    assert follows(stated(case, fits))
    answers = set()
    for shape in variants(fits):
        bounds = {(p.output, p.low, p.high): 0.1 for p in premises(shape)}
        expected = conclude_full_order(shape, bounds).verdict == "proved"
        in_chart = 0.0 <= shape.start_strip < 0.05 and 0.0 <= shape.guard_strip < 0.05
        if shape.pace[0] >= shape.pace[1]:
            continue  # No premise about them can be stated truly.
        if in_chart and 0.0 <= shape.crossing and 0.0 <= shape.risen < 1.0:
            answers.add(expected)
            assert follows(stated(case, shape)) == expected, shape
        else:
            assert not expected
    assert answers == {True, False}


def test_no_premise_can_be_left_out_or_stand_elsewhere(case, fits, follows):
    table = stated(case, fits)
    for k, statement in enumerate(table["statements"]):
        others = [s for i, s in enumerate(table["statements"]) if i != k]
        assert not follows(table | {"statements": others}), statement["conditions"]
        (name,) = statement["conditions"]
        weak = statement | {"bounds": {name: -1e-12}}
        assert not follows(table | {"statements": [*others, weak]}), name
        nearer = (float.fromhex(statement["root"]["high"][1]) * 0.999).hex()
        high = [statement["root"]["high"][0], nearer]
        moved = statement | {"root": {"low": statement["root"]["low"], "high": high}}
        assert not follows(table | {"statements": [*others, moved]}), name
