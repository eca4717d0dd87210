"""The benchmark for other provers: files that tools can read, and a competition's results."""

import csv
import importlib.util
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from support.shipped_run import SHIPPED
from support.vnnlib_reader import read_query

pytest.importorskip("onnx", reason="needs the extra onnx")
pytest.importorskip("onnxruntime", reason="needs the extra onnx")

FILE = Path(__file__).parents[2] / "benchmarks" / "walking" / "walking_queries.py"
CONDITIONS = ("tube-width", "knee")


@pytest.fixture(scope="module")
def benchmark():
    spec = importlib.util.spec_from_file_location("walking_queries", FILE)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def folder(benchmark, tmp_path_factory):
    out = tmp_path_factory.mktemp("walking") / "out"
    queries = {"gait": (SHIPPED, CONDITIONS)}
    benchmark.make(out, queries, states=27)
    benchmark.solve(out, queries)
    return out


def rows(path: Path) -> list[list[str]]:
    with path.open(newline="") as file:
        return list(csv.reader(file))


@pytest.mark.slow
def test_every_instance_has_a_model_and_a_query_that_fit(folder):
    import onnx

    instances = rows(folder / "instances.csv")
    assert sorted(row[0] for row in instances) == sorted(f"gait-{n}.onnx" for n in CONDITIONS)
    named = {name for row in instances for name in row[:2]} | {"instances.csv", "results.csv"}
    assert {path.name for path in folder.iterdir()} == named
    for model, query, limit_s in instances:
        bounds, cases = read_query((folder / query).read_text())
        read = onnx.load(folder / model)
        onnx.checker.check_model(read, full_check=True)
        shape = read.graph.input[0].type.tensor_type.shape
        assert [size.dim_value for size in shape.dim] == [1, len(bounds)]
        assert cases and float(limit_s) > 0.0


@pytest.mark.slow
def test_results_have_the_columns_of_the_competition(folder):
    head, *table = rows(folder / "results.csv")
    assert head == ["benchmark", "instance", "result", "time"]
    assert [row[:3] for row in table] == [
        ["walking", f"gait-{name}-0", "verified"] for name in CONDITIONS
    ]
    assert all(float(row[3]) >= 0.0 for row in table)


def test_an_instance_that_is_broken_is_falsified_and_an_open_one_unknown(benchmark, monkeypatch):
    from neuralgaits.analysis.run import open_run

    (problem,) = benchmark.problems(open_run(SHIPPED), "tube-width")
    assert benchmark.answer(problem)[0] == "verified"
    assert benchmark.answer(replace(problem, least=(1e3,)))[0] == "falsified"

    def unbounded(self, low, high):
        return np.full((len(low), 1), np.nan), np.full((len(low), 1), np.nan)

    monkeypatch.setattr(type(problem), "bounds", unbounded)
    point = replace(problem, low=problem.low, high=problem.low)
    assert benchmark.answer(point)[0] == "unknown"


def test_a_folder_that_exists_is_left_alone(benchmark, monkeypatch, tmp_path):
    monkeypatch.setattr(sys, "argv", ["walking_queries.py", str(tmp_path)])
    with pytest.raises(SystemExit, match="does not exist yet"):
        benchmark.main()
    assert not list(tmp_path.iterdir())
