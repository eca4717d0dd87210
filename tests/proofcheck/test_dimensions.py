"""Programs of four, six and sixteen axes: proved, written, checked by both checkers, and forged."""

import json
from pathlib import Path
from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.certificate.chart import Axis, Chart
from neuralgaits.certificate.proof_file import statement_check
from neuralgaits.certificate.proof_file.check import check
from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.certificate.proof_file.writer import Proof, prove
from neuralgaits.certificate.search import branch_and_bound
from neuralgaits.certificate.search.problem import Problem
from neuralgaits.certificate.search.root_turns import explore
from neuralgaits.certificate.search.statement_record import StatementRecord
from neuralgaits.errors import InputError
from neuralgaits.programs.tracing.tracer import trace
from neuralgaits.records.certified import Counterexample

PARAMETERS = (
    Axis("speed before", 0.5, 0.9),
    Axis("speed after", 0.5, 0.9),
    Axis("mass", -0.02, 0.02),
    Axis("floor", -0.01, 0.01),
    *(Axis(f"error {k}", -0.01, 0.01) for k in range(10)),
)
FEW = 6
"""Axes that matter; those behind them are late."""
WEIGHTS = np.concatenate(
    [np.random.default_rng(4).normal(size=(8, FEW)), np.full((8, len(PARAMETERS) + 2 - FEW), 0.1)],
    axis=1,
)


def pendulum(u: Any) -> dict[str, Any]:
    """Something like a gait: a small network of all axes, a pendulum's energy, a quotient."""
    hidden = jnp.tanh(jnp.asarray(WEIGHTS[:, : len(u)]) @ u)
    pace = 1.0 + 0.2 * hidden[0] * u[2]
    energy = pace**2 + jnp.cos(0.4 * (u[0] - 0.5)) * (1.0 + u[-1])
    return {"pace": 0.3 + pace / (1.0 + 0.1 * u[1]), "energy": energy - 0.1 * u[3] ** 2}


def made(axes: int, least: tuple[float, float] = (0.0, 0.0)) -> tuple[Chart, Problem]:
    chart = Chart(PARAMETERS[: axes - 2])
    program = trace(pendulum, {"u": (axes,)})
    names = ("pace", "energy")
    whole = chart.whole((0.0, 0.0), (1.0, 1.0))
    return chart, Problem(
        "tube", *whole, names, (1.0, 1.0), program, least=least, weak_axes=max(axes - FEW, 0)
    )


@pytest.fixture(scope="module", params=[4, 6, 16])
def proved(request, tmp_path_factory) -> Path:
    chart, problem = made(request.param)
    (state,) = explore([problem], [None], lambda name, u: None)
    statements = tuple(prove(problem, state))
    assert {name for one in statements for name in one.conditions} == {"pace", "energy"}
    path = tmp_path_factory.mktemp("dimensions") / "proof.json"
    named = {"name": "none", "sha256": "0" * 64}
    path.write_bytes(Proof(named, named, "0" * 64, problem.program, chart, statements).content())
    return path


def claims_axes(path: Path) -> int:
    return read_claims(path).chart.size


def test_both_checkers_confirm_it(proved, proofcheck):
    report = check(read_claims(proved))
    assert report.verdict == "consistent", report.reason
    named = [line for line in report.statements if "speed after each in [0.5, 0.9]" in line]
    named += [line for line in report.statements if "speed after in [0.5, 0.9]" in line]
    assert len(named) == (1 if claims_axes(proved) > 8 else len(report.statements))
    answer = proofcheck("--program", proved)
    assert answer.returncode == 0, answer.stdout[-500:] + answer.stderr
    assert "consistent" in answer.stdout and "proved" not in answer.stdout.splitlines()[-1]
    # The checker's own formulas know no parameters.
    assert proofcheck(proved).returncode == 3


def test_bounds_hold_at_random_points(proved):
    claims, draw = read_claims(proved), np.random.default_rng(1)
    for statement in claims.statements:
        for u in draw.uniform(statement.low, statement.high, size=(300, claims.chart.size)):
            values = pendulum(jnp.asarray(u))
            for name in statement.conditions:
                assert values[name] >= statement.bounds[name]


def _raise(table: Any) -> None:
    for statement in table["statements"]:
        statement["bounds"] = {name: 1.5 * bound for name, bound in statement["bounds"].items()}


def _high(table: Any) -> list[str]:
    return table["statements"][0]["root"]["high"]


FALSE = {
    "bounds too high": _raise,
    "an axis that is not there": lambda t: t["statements"][0].update(tree=f"{len(t['chart']):x}--"),
    "a tree without end": lambda t: t["statements"][0].update(tree="3" * 200 + "-" * 201),
    "another program's hash": lambda t: t.update(program_hash="0" * 64),
}
UNREADABLE = {
    "a parameter's interval cut in a root": lambda t: _high(t).__setitem__(2, (0.7).hex()),
    "a root of fewer axes": lambda t: t["statements"][0]["root"]["low"].pop(),
    "a chart of fewer axes": lambda t: t["chart"].pop(),
    "a chart of more axes": lambda t: t["chart"].append(
        {"name": "more", "low": "0x0p+0", "high": "0x1p+0"}
    ),
}


@pytest.mark.parametrize("name", [*FALSE, *UNREADABLE])
def test_forged_ones_are_refused(proved, proofcheck, tmp_path, name):
    table = json.loads(proved.read_text())
    (FALSE | UNREADABLE)[name](table)
    forged = tmp_path / "proof.json"
    forged.write_text(json.dumps(table))
    answer = proofcheck("--program", forged)
    assert answer.returncode in (1, 2), answer.stdout[-300:]
    if name in FALSE:
        assert check(read_claims(forged)).verdict == "rejected"
    else:
        with pytest.raises(InputError, match="expected a proof file"):
            read_claims(forged)


@pytest.mark.parametrize("axes", [4, 6])
def test_what_fails_somewhere_is_refuted_there(axes, monkeypatch):
    # How fine the map around a refutation is: in six axes millions of boxes as a user has it.
    monkeypatch.setattr(branch_and_bound, "MAP_DEPTH", 2)
    _, problem = made(axes, least=(1.35, 0.0))

    def confirm(name: str, u: np.ndarray) -> Counterexample | None:
        margin = float(np.min(pendulum(jnp.asarray(u))[name])) - 1.35
        point = tuple(u.tolist())
        return Counterexample(point, point, margin) if margin < 0.0 else None

    (state,) = explore([problem], [None], confirm)
    point = state.refuted["pace"].u
    assert all(a <= x <= b for a, x, b in zip(problem.low, point, problem.high, strict=True))
    assert pendulum(jnp.asarray(point))["pace"] < 1.35
    assert "pace" not in {name for one in prove(problem, state) for name in one.conditions}


def _written(folder: Path, function: Any, axes: int) -> Path:
    """A file that says in one leaf that a function is not negative."""
    chart = Chart(tuple(Axis(f"p{k}", 0.0, 1.0) for k in range(axes - 2)))
    program = trace(function, {"u": (axes,)})
    whole = chart.whole((0.0, 0.0), (1.0, 1.0))
    one = StatementRecord(("f",), "tube", {"f": 1.0}, {"f": 0.0}, 2, *whole, "-")
    named = {"name": "none", "sha256": "0" * 64}
    (folder / "proof.json").write_bytes(
        Proof(named, named, "0" * 64, program, chart, (one,)).content()
    )
    return folder / "proof.json"


def test_a_parabola_whose_bend_leaves_the_doubles_is_not_confirmed(proofcheck, tmp_path):
    """Its least value is -0.306, at a place that is not zero by 1e-154."""

    def steep(u: Any) -> dict[str, Any]:
        e = 2.0 * u[1] - 1.0
        return {"f": 2.0**1022 * e * e + 1e154 * e + 0.25}

    file = _written(tmp_path, steep, 2)
    assert proofcheck("--program", file).returncode in (1, 3)
    assert check(read_claims(file)).verdict in ("rejected", "undecided")


def test_a_bound_out_of_reach_in_eight_axes_comes_to_an_end(proofcheck, tmp_path, monkeypatch):
    """sin^2 + cos^2 of every axis: bounds lose what hangs together, and halving is no help."""
    most = 2**9
    monkeypatch.setattr(statement_check, "MOST_MORE", most)

    def circles(u: Any) -> dict[str, Any]:
        return {"f": jnp.sum(jnp.sin(9.0 * u) ** 2 + jnp.cos(9.0 * u) ** 2) - 7.9999}

    file = _written(tmp_path, circles, 8)
    assert proofcheck("--program", file).returncode == 3
    report = check(read_claims(file))
    assert report.verdict == "undecided"
    assert most <= report.boxes <= 2 * most


CHANGE = 0.1


def near_the_diagonal(u: Any) -> dict[str, Any]:
    """Above 0.01 where both speeds are at most CHANGE apart, below 0 from 0.15 on."""
    apart = u[2] - u[3]
    return {"near": 0.0225 + 0.002 * jnp.sin(u[0]) * u[1] - apart * apart}


@pytest.fixture(scope="module")
def of_near_speeds(tmp_path_factory) -> Path:
    """Proved of pairs that may follow each other."""
    chart = Chart((PARAMETERS[0], Axis("speed after", 0.5, 0.9, CHANGE)))
    program = trace(near_the_diagonal, {"u": (4,)})
    whole = chart.whole((0.0, 0.0), (1.0, 1.0))
    problem = Problem(
        "tube", *whole, ("near",), (1.0,), program, least=(0.0,), coupled_axes=chart.coupled_axes
    )
    (state,) = explore([problem], [None], lambda name, u: None)
    statements = tuple(prove(problem, state))
    assert {name for one in statements for name in one.conditions} == {"near"}
    path = tmp_path_factory.mktemp("near") / "proof.json"
    named = {"name": "none", "sha256": "0" * 64}
    path.write_bytes(Proof(named, named, "0" * 64, program, chart, statements).content())
    return path


def test_what_is_true_of_near_speeds_is_confirmed_of_them(of_near_speeds, proofcheck):
    assert check(read_claims(of_near_speeds)).verdict == "consistent"
    answer = proofcheck("--program", of_near_speeds)
    assert answer.returncode == 0, answer.stdout
    assert "speed after in [0.5, 0.9], at most 0.1 from the one before" in answer.stdout


@pytest.mark.parametrize("change", [0.2, None])
def test_what_is_true_of_near_speeds_is_not_confirmed_of_others(
    of_near_speeds, proofcheck, tmp_path, change
):
    table = json.loads(of_near_speeds.read_text())
    if change is None:
        del table["chart"][3]["change"]
    else:
        table["chart"][3]["change"] = change.hex()
    forged = tmp_path / "proof.json"
    forged.write_text(json.dumps(table))
    answer = proofcheck("--program", forged)
    assert answer.returncode == 1 and "speed after" in answer.stdout.splitlines()[-1]
    assert check(read_claims(forged)).verdict == "rejected"
