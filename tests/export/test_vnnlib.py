"""Conditions for other provers: models against Programs, queries read again, answers, refusals."""

import json
import sys
from dataclasses import replace
from fractions import Fraction
from importlib.util import find_spec

import numpy as np
import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.barriers import Pointwise, functions
from neuralgaits.certificate.levels.level_search import LevelSets
from neuralgaits.certificate.levels.problems import condition_problems, trace_certificate
from neuralgaits.errors import InputError, MismatchError
from neuralgaits.export.condition_query import file_names
from neuralgaits.export.vnnlib_text import decimal, query_text
from neuralgaits.programs import POINT, evaluate
from neuralgaits.runs import to_json
from neuralgaits.workflows.condition_queries import queries_of
from neuralgaits.workflows.export import export_controller
from support.commanded_run import SPEED
from support.commanded_run import make as commanded_run
from support.shipped_run import SHIPPED
from support.vnnlib_reader import answers, read_query

pytestmark = pytest.mark.skipif(
    find_spec("onnx") is None or find_spec("onnxruntime") is None, reason="needs the extra onnx"
)
STATES = 108
"""Four points of each condition of the shipped run."""


@pytest.fixture(scope="module")
def shipped():
    return open_run(SHIPPED)


@pytest.fixture(scope="module")
def exported(shipped, tmp_path_factory):
    out = tmp_path_factory.mktemp("vnnlib") / "out"
    return out, export_controller(shipped, out, format="vnnlib", states=STATES).summary


@pytest.fixture(scope="module")
def problems(shipped):
    """What `certify` searches, by condition: (index of the condition, problem)."""
    program = trace_certificate(shipped.spec, shipped.robot, shipped.trained, LevelSets())
    found = condition_problems(shipped.spec, program)
    return {name: (k, p) for p in found for k, name in enumerate(p.names)}


def test_all_files_are_there_and_listed(exported, shipped):
    out, summary = exported
    names = {condition.name for condition in shipped.spec.conditions}
    rows = [line.split(",") for line in (out / "instances.csv").read_text().splitlines()]
    files = {name for row in rows for name in row[:2]} | {"instances.csv", "README.md"}
    assert {path.name for path in out.iterdir()} == files
    assert summary.files == tuple(sorted(str(out / name) for name in files))
    assert {model.condition for model in summary.models} == names
    assert [row[:2] for row in rows] == [
        [m.file, query] for m in summary.models for query in m.queries
    ]
    assert all(float(row[2]) > 0.0 for row in rows)
    told = json.loads(to_json(summary))
    assert told["format"] == "vnnlib" and told["checked"] and told["states"] == STATES
    assert max(model["difference"] for model in told["models"]) < 1e-12
    assert max(model["float_difference"] for model in told["models"]) > 1e-8


def test_a_model_alone_has_the_margins_that_certify_bounds(exported, problems):
    """By another interpreter than the exporter's, at corners and inside."""
    import onnx
    from onnx.reference import ReferenceEvaluator

    out, summary = exported
    for row in summary.models:
        index, problem = problems[row.condition]
        model = ReferenceEvaluator(onnx.load(out / row.file))
        share = np.array([[0.0, 0.0], [1.0, 1.0], [0.3, 0.8]])
        low, high = np.array(problem.low), np.array(problem.high)
        points = low + share * (high - low)
        found = np.array([model.run(["Y"], {"X": u[None]}) for u in points])[:, 0]
        expected = problem.values(points)[:, index] * problem.scales[index]
        np.testing.assert_allclose(found.min(axis=(1, 2)), expected, rtol=1e-11, atol=1e-12)


def test_queries_have_the_boxes_that_certify_searches(exported, problems):
    out, summary = exported
    for row in summary.models:
        _, problem = problems[row.condition]
        (query,) = row.queries
        bounds, cases = read_query((out / query).read_text())
        corners = zip(problem.low, problem.high, strict=True)
        expected = {
            f"X_{i}": [Fraction(low), Fraction(high)] for i, (low, high) in enumerate(corners)
        }
        assert bounds == expected
        outputs = next(o for o in problem.program.outputs if o.name == row.condition)
        size = int(np.prod(outputs.shape))
        assert cases == [[("<=", f"Y_{i}", Fraction(0))] for i in range(size)]


@pytest.mark.parametrize("number", [0.1, 1e-7, -0.05, 1e22, -3.0, 5e-324])
def test_numbers_keep_every_digit(number):
    assert Fraction(decimal(number)) == Fraction(number)


def test_a_broken_condition_answers_its_query(shipped):
    """No walker is that fast; at the same points another condition answers nothing."""
    fast = Pointwise("fast", "tube", 1.0, functions.at_least(functions.forward_rate, 50.0))
    queries = queries_of(replace(shipped, spec=shipped.spec.with_conditions(fast)))
    by_name = {query.name: query for query in queries}
    found = {}
    for name in ("fast", "knee"):
        query = by_name[name]
        text = query_text(query, query.boxes[0])
        points = np.random.default_rng(1).random((20, 1, 2))
        margins = evaluate(query.program, {"X": points}, POINT)["Y"]
        found[name] = [answers(text, x[0], y[0]) for x, y in zip(points, margins, strict=True)]
    assert all(found["fast"]) and not any(found["knee"])
    outside = answers(query_text(by_name["fast"], by_name["fast"].boxes[0]), [1.5, 0.5], [-1.0])
    assert not outside


def test_commands_that_change_too_much_answer_no_query(tmp_path):
    """Their margins may be anything: no walk has them."""
    run = commanded_run(tmp_path / "family")
    fast = Pointwise("fast", "tube", 1.0, functions.at_least(functions.forward_rate, 50.0))
    query = queries_of(replace(run, spec=run.spec.with_conditions(fast)))[-1]
    assert [axis.name for axis in query.axes] == ["phase", "level", "speed before", "speed after"]
    assert query.boxes[0].low[2:] == (SPEED.low, SPEED.low)
    assert (query.margins, query.outputs) == (1, 3)
    text = query_text(query, query.boxes[0])
    for before, after, near in [
        (SPEED.low, SPEED.low, True),
        (SPEED.low, SPEED.low + 0.009, True),
        (SPEED.high, SPEED.low, False),
        (SPEED.low, SPEED.high, False),
    ]:
        x = np.array([[0.5, 0.5, before, after]])
        y = evaluate(query.program, {"X": x}, POINT)["Y"][0]
        assert y[0] < 0.0
        assert answers(text, x[0], y) is near


def test_a_spoilt_model_is_found(shipped, tmp_path, monkeypatch):
    """A margin is off by a millionth of the condition's scale: nothing is written."""
    from neuralgaits.export import query_models

    real = query_models.model_answers
    monkeypatch.setattr(query_models, "model_answers", lambda *given: real(*given) + 1e-6)
    match = r"condition torso-lower: ONNX Runtime and Python disagree: expected margins within"
    with pytest.raises(MismatchError, match=match):
        export_controller(shipped, tmp_path / "out", format="vnnlib", states=STATES)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_with_other_queries_is_refused(shipped, tmp_path):
    """`--force` replaces an export of these conditions, and mixes it with no other."""
    spec = shipped.spec.without(*[c.name for c in shipped.spec.conditions if c.name != "knee"])
    few = replace(shipped, spec=spec)
    out = tmp_path / "out"
    export_controller(few, out, format="vnnlib", states=1)
    before = {path.name: path.read_bytes() for path in out.iterdir()}
    assert sorted(before) == ["README.md", "instances.csv", "knee-0.vnnlib", "knee.onnx"]
    with pytest.raises(InputError, match="expected an empty folder"):
        export_controller(few, out, format="vnnlib", states=1)
    (out / "knee.onnx").write_bytes(b"")
    export_controller(few, out, format="vnnlib", states=1, force=True)
    assert {path.name: path.read_bytes() for path in out.iterdir()} == before
    (out / "stranger-0.vnnlib").write_text("")
    (out / "README.md").write_text("mine")
    with pytest.raises(InputError, match=r"found stranger-0\.vnnlib of another: name another"):
        export_controller(few, out, format="vnnlib", states=1, force=True)
    assert (out / "README.md").read_text() == "mine"


@pytest.mark.parametrize("package", ["onnx", "onnxruntime"])
def test_without_the_extra_it_says_what_to_install(shipped, tmp_path, monkeypatch, package):
    for name in ("onnx_model", "query_models"):
        monkeypatch.delitem(sys.modules, f"neuralgaits.export.{name}", raising=False)
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(InputError, match=rf"--format vnnlib, found no {package}: pip install"):
        export_controller(shipped, tmp_path / "out", format="vnnlib", states=STATES)
    assert list(tmp_path.iterdir()) == []


def test_file_names_differ_on_any_disk():
    names = [
        "Knee",
        "knee",
        "hip",
        "Hip",
        "über allem",
        "*?<>",
        "con",
        "a" * 150,
        "a" * 150 + "b",
        "NUL",
    ]
    files = file_names(names)
    assert list(files) == names
    assert len({file.lower() for file in files.values()}) == len(names)
    for file in files.values():
        assert file.isascii() and 0 < len(file) <= 75 and set(file) & set(".:/\\*?<> ") == set()
    assert files["Knee"] == "Knee" and files["knee"] == "knee_2" and files["Hip"] == "Hip_2"
    assert {files["con"], files["NUL"]} == {"condition-con", "condition-NUL"}


def test_what_a_person_reads(exported, capsys):
    from neuralgaits.cli.export_screen import show_export

    out, summary = exported
    show_export(summary)
    shown = " ".join(capsys.readouterr().out.split())
    assert "27 conditions, 27 queries" in shown and f"{STATES} states" in shown
    page = (out / "README.md").read_text()
    for row in summary.models:
        line = next(line for line in page.splitlines() if line.startswith(f"| {row.condition} |"))
        assert f"`{row.file}`" in line and f"{row.float_difference:.1e}" in line
    for words in ("`unsat`", "level 1", "| `X_0` | phase |", "off by up to"):
        assert words in page
