"""Doubles decide most boxes, balls the rest: neither says more than is true."""

import json
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from neuralgaits.certificate.proof_file import double_bounds
from neuralgaits.certificate.proof_file.check import TRUSTED, check
from neuralgaits.certificate.proof_file.double_bounds import (
    BoxAnswers,
    DoubleBounds,
    least_margin,
)
from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.cli.main import main
from neuralgaits.programs import Constant, Operation, Output
from neuralgaits.programs.algebras import double_algebra
from neuralgaits.programs.algebras.double_algebra import DoubleAlgebra
from neuralgaits.records.checked import Arithmetic
from neuralgaits.workflows.check_proof import check_proof
from support.program_case import MORE, bowl, file_of
from support.small_proof import CENTRE, program, with_program, write


def _claims(folder, table):
    return read_claims(write(folder, table))


def test_true_statements_hold_in_either(tmp_path, proof):
    claims = _claims(tmp_path, proof)
    doubles, balls = (check(claims, arithmetic=name) for name in ("doubles", "balls"))
    assert doubles.verdict == balls.verdict == "consistent"
    assert (doubles.boxes_in_balls, balls.boxes_in_balls) == (0, balls.boxes)
    assert doubles.boxes == balls.boxes


@pytest.mark.parametrize("arithmetic", ["doubles", "balls"])
@pytest.mark.parametrize("floor", [0.125 - 1e-13, 0.0625])
def test_a_false_bound_is_refuted_and_the_true_one_holds(tmp_path, mutated, arithmetic, floor):
    """The least value of bowl is its floor, at the centre: the only box is that point."""
    table = with_program(mutated, program(floor=floor))
    (one,) = table["statements"] = mutated["statements"][:1]
    point = [x.hex() for x in CENTRE]
    one |= {"root": {"low": point, "high": point}, "tree": "-"}
    for bound, verdict in ((0.0625, "rejected"), (floor / 2.0, "consistent")):
        one["bounds"]["bowl"] = bound
        assert check(_claims(tmp_path, table), arithmetic=arithmetic).verdict == verdict


def test_a_bound_that_is_exactly_reached_is_left_to_balls(tmp_path, mutated):
    one = mutated["statements"][1]
    point = [x.hex() for x in CENTRE]
    one |= {"root": {"low": point, "high": point}, "tree": "-", "bounds": {"bowl": 0.0625}}
    report = check(_claims(tmp_path, mutated))
    assert (report.verdict, report.boxes_in_balls) == ("consistent", 1)


def test_what_doubles_cannot_decide_goes_to_balls(tmp_path, proof, monkeypatch):
    def silent(self, low, high):
        nothing = np.zeros(len(low), dtype=bool)
        return BoxAnswers(nothing, ~nothing)

    monkeypatch.setattr(DoubleBounds, "ask", silent)
    report = check(_claims(tmp_path, proof))
    assert report.verdict == "consistent"
    assert report.boxes_in_balls == report.boxes > 0


def test_a_program_too_large_for_doubles_is_bounded_in_balls(tmp_path, proof, monkeypatch):
    claims = _claims(tmp_path, proof)
    monkeypatch.setattr(double_bounds, "MOST_COEFFICIENTS", 11)
    report = check(claims)
    assert report.verdict == "consistent"
    assert report.boxes_in_balls == report.boxes
    monkeypatch.setattr(double_bounds, "MOST_COEFFICIENTS", 12)
    assert check(claims).boxes_in_balls == 0


@pytest.mark.parametrize("axes", [2, 8, 16])
def test_a_corner_that_breaks_a_bound_is_found_in_any_number_of_axes(tmp_path, axes):
    """The centre does not break it, so doubles see a box that could be halved."""
    about = bowl(axes, 1.0)
    ends = np.array([(0.0, 1.0), (0.0, 1.0), *((low, high) for _, low, high in MORE)])[:axes]
    centre = 0.3 * ends[:, 0] + 0.7 * ends[:, 1]
    # The squared distance is largest at the lower corner: turned round, that has the least.
    least = 1.0 + np.sum((ends[:, 0] - centre) ** 2)
    turned = replace(
        about,
        constants=(
            Constant(None, centre),
            *about.constants[1:],
            Constant(None, np.array([least - 1e-6])),
        ),
        operations=(
            *(_moved(operation, 6) for operation in about.operations),
            Operation("sub", (6, 18), 1),
        ),
        outputs=(Output("margin", (), 19),),
    )
    report = check(_claims(tmp_path, file_of(turned, {"margin": 0.0})))
    assert report.verdict == "rejected"
    assert "less than 0" in str(report.reason)


def _moved(operation: Operation, first: int) -> Operation:
    """The operation behind one more constant."""
    operands = tuple(k + (k >= first) for k in operation.operands)
    return replace(operation, operands=operands)


def test_boxes_are_halved_in_doubles_before_balls_are_asked(tmp_path, mutated):
    mutated["statements"][0]["tree"] = "-"
    report = check(_claims(tmp_path, mutated))
    assert report.verdict == "consistent"
    assert report.boxes_in_balls == 0 < report.boxes


@pytest.mark.parametrize("rule", ["add", "mul"])
def test_a_defect_of_doubles_proves_nothing(tmp_path, mutated, monkeypatch, rule):
    """An addition or product that is one too large would prove a false statement."""
    right = getattr(DoubleAlgebra, rule)

    def wrong(self, a, b):
        model = right(self, a, b)
        terms = model.terms.copy()
        terms[0] += 1.0
        return replace(model, terms=terms)

    monkeypatch.setattr(DoubleAlgebra, rule, wrong)
    monkeypatch.setitem(mutated["statements"][1]["bounds"], "bowl", 0.3)
    mutated["statements"] = mutated["statements"][1:2]
    claims = _claims(tmp_path, mutated)
    monkeypatch.setitem(double_algebra._ARITHMETIC, rule, wrong)
    report = check(claims)
    assert (report.verdict, report.holds) == ("undecided", False)
    assert "--arithmetic balls" in str(report.reason)
    assert check(claims, arithmetic="balls").verdict == "rejected"


def test_thresholds_are_rounded_up(tmp_path, proof):
    (one, *_) = _claims(tmp_path, proof).statements
    draw = np.random.default_rng(0)
    pairs = [*draw.normal(size=(50, 2)).tolist(), (1e300, 1e300), (5e-324, 0.3), (0.0, 1.0)]
    for bound, scale in pairs:
        claim = replace(one, bounds={"bowl": bound}, scales={"bowl": abs(scale)})
        least = least_margin(claim, "bowl")
        exact = Fraction(bound) * Fraction(abs(scale))
        assert least == np.inf or Fraction(least) >= exact
        assert least == np.inf or Fraction(least) <= exact + abs(exact) / 2**50 + Fraction(
            1, 10**300
        )


def test_answers_say_which_arithmetic_was_used(tmp_path, capfd, proof):
    path = write(tmp_path, proof)
    both: tuple[tuple[Arithmetic, int], ...] = (("doubles", 0), ("balls", 1))
    for name, in_balls in both:
        result = check_proof(path, arithmetic=name)
        assert (result.arithmetic, result.boxes_in_balls) == (name, in_balls * result.boxes)
        assert result.assumptions[-1] == TRUSTED[name]
    assert main(["check-proof", str(path), "--arithmetic", "balls", "--json"]) == 0
    assert json.loads(capfd.readouterr().out)["arithmetic"] == "balls"
    assert main(["check-proof", str(path), "--arithmetic", "balls"]) == 0
    assert "all in balls" in capfd.readouterr().out
    assert main(["check-proof", str(path)]) == 0
    assert "s, in doubles\n" in capfd.readouterr().out
    assert main(["check-proof", str(path), "--arithmetic", "halves"]) == 2
