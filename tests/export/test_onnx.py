"""Graphs of ONNX against Programs, and models of a run: facts inside, agreement, refusals."""

import hashlib
import json
import re
import sys
from dataclasses import replace
from importlib.util import find_spec

import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.control.pd import BANDWIDTH
from neuralgaits.errors import InputError, MismatchError, SpecError
from neuralgaits.gait.joint_inertia import JointResponse
from neuralgaits.programs import POINT, evaluate
from neuralgaits.programs.tracing.tracer import trace
from neuralgaits.runs import to_json
from neuralgaits.workflows.export import export_controller
from support.program_cases import CASES, points_of

pytestmark = pytest.mark.skipif(
    find_spec("onnx") is None or find_spec("onnxruntime") is None, reason="needs the extra onnx"
)
STATES = 500
ROOT = "square root"


def session(model):
    import onnxruntime

    return onnxruntime.InferenceSession(model, providers=["CPUExecutionProvider"])


def answers_of(program, points, real):
    """What ONNX Runtime makes of points, by output, one call a point."""
    from onnx import helper

    from neuralgaits.programs.onnx_graph import OPERATOR_SET, graph

    model = helper.make_model(
        graph(program, "case", real, {}),
        opset_imports=[helper.make_opsetid("", OPERATOR_SET)],
        ir_version=8,
    )
    run, names = session(model.SerializeToString()), [item.name for item in program.outputs]
    count = len(next(iter(points.values())))
    rows = [
        run.run(names, {name: values[i].astype(real) for name, values in points.items()})
        for i in range(count)
    ]
    return {name: np.array([row[k] for row in rows]) for k, name in enumerate(names)}


@pytest.mark.parametrize("name", [*CASES, ROOT])
def test_a_graph_computes_what_the_program_says(name):
    """Every operation, names and shapes of inputs and outputs included."""
    root = (lambda x: {"y": jnp.sqrt(x * x + 1.0).reshape(3, 1)}, {"x": (3,)})
    program = trace(*CASES.get(name, root))
    points = points_of(program, 50)
    expected = evaluate(program, points, POINT)
    double = answers_of(program, points, np.float64)
    single = answers_of(program, points, np.float32)
    for item, values in expected.items():
        np.testing.assert_allclose(double[item], values, rtol=1e-13, atol=1e-13)
        size = np.maximum(np.max(np.abs(values)), 1.0)
        np.testing.assert_allclose(single[item], values, atol=1e-5 * size)
        assert single[item].dtype == np.float32
        assert double[item].shape == values.shape


def test_names_are_told_apart():
    """A weight may be called as an input is; an output may not."""
    program = trace(lambda x: {"y": x @ jnp.asarray(np.eye(2))}, {"x": (2,)})
    named = tuple(replace(item, name="x") for item in program.constants)
    points = points_of(program, 3)
    found = answers_of(replace(program, constants=named), points, np.float64)
    np.testing.assert_array_equal(found["y"], points["x"])
    with pytest.raises(SpecError, match=r"outputs with names of their own"):
        answers_of(trace(lambda x: {"x": 2.0 * x}, {"x": (2,)}), points, np.float64)


@pytest.fixture(scope="module")
def exported(trained, tmp_path_factory):
    out = tmp_path_factory.mktemp("onnx") / "out"
    return out, export_controller(trained, out, format="onnx", states=STATES)


def test_what_is_printed(exported):
    out, done = exported
    summary = json.loads(to_json(done.summary))
    assert done.checked and summary["format"] == "onnx"
    assert summary["files"] == [str(out / "policy.onnx"), str(out / "policy_float.onnx")]
    assert sorted(str(path) for path in out.iterdir()) == summary["files"]
    assert 0.0 < summary["max_abs_error"] < 1e-12
    assert 0.0 < summary["latency_us"]["p50"] <= summary["latency_us"]["p99"]
    double, single = summary["builds"]
    assert 1e-9 < single["agreement"]["output"] <= summary["limits"]["float"]["output"] == 4e-6
    assert double["agreement"]["rate"] <= 1e-12


def test_a_model_alone_is_the_policy(exported, trained):
    """Loaded as a stranger would, against finite differences of the policy along a path."""
    out, _ = exported
    run = session((out / "policy.onnx").read_bytes())
    z, dz, step = np.array([0.02, 18.0]), np.array([0.6, 9.0]), 1e-6
    y, dy = map(np.asarray, run.run(["y", "dy"], {"z": z, "dz": dz}))
    policy = trained.gait.policy
    np.testing.assert_allclose(y, policy(jnp.asarray(z)), atol=1e-14)
    ahead, behind = (np.asarray(policy(jnp.asarray(z + s * dz))) for s in (step, -step))
    np.testing.assert_allclose(dy, (ahead - behind) / (2.0 * step), atol=1e-7)


def test_facts_are_those_of_the_header(exported, trained):
    """Each macro and array of `gait.h`, read back from C, stands in the metadata."""
    from neuralgaits.export.source import gait_files
    from neuralgaits.workflows.export import design_of

    out, _ = exported
    texts = gait_files(design_of(trained))
    for file in ("policy.onnx", "policy_float.onnx"):
        facts = session((out / file).read_bytes()).get_modelmeta().custom_metadata_map
        macros = re.findall(r"^#define NG_(\w+) (.+?)(?: /\*.*)?$", texts["gait.h"], re.M)
        shared = {name.lower(): text for name, text in macros if name.lower() in facts}
        assert len(shared) > 25
        for name, text in shared.items():
            number = re.fullmatch(r"\(?(-?)(?:NG\()?([\d.e+-]+)[u)]*", text)
            if number:
                assert json.loads(facts[name]) == float("".join(number.groups())), name
            else:
                assert facts[name] == text.strip('"'), name
        tables = re.findall(r"const ng_real ng_(\w+)(?:\[\d+\])+ = (\{[^;]+);", texts["gait.c"])
        known = [(name, braces) for name, braces in tables if name in facts]
        assert known
        for name, braces in known:
            found = [float(word) for word in re.findall(r"NG\(([^)]+)\)", braces)]
            assert np.ravel(json.loads(facts[name])).tolist() == found, name
        weights = hashlib.sha256((trained.path / "policy.safetensors").read_bytes()).hexdigest()
        assert facts["policy_sha256"] == weights
        assert json.loads(facts["coordinate_names"]) == list(trained.robot.joint_names)
        laws = json.loads(facts["laws"])
        stiffness = BANDWIDTH**2 * JointResponse(trained.robot).inertia
        assert "/".join(f"{gain:.4g}" for gain in stiffness) + " N m/rad" in laws["pd"]
        assert laws["paper"].startswith("578 N m/rad")
        assert set(json.loads(facts["units"])) <= set(facts)


def test_a_spoilt_weight_is_found(trained, tmp_path, monkeypatch):
    """The largest initialiser is off by 1e-9: nothing is written."""
    import onnx
    from onnx import numpy_helper

    from neuralgaits.export import onnx_model

    real = onnx_model.model_files

    def spoilt(design):
        files = real(design)
        model = onnx.load_from_string(files["policy.onnx"])
        tensor = max(model.graph.initializer, key=lambda item: len(item.raw_data))
        array = numpy_helper.to_array(tensor) + 1e-9
        tensor.CopyFrom(numpy_helper.from_array(array, tensor.name))
        return files | {"policy.onnx": model.SerializeToString()}

    monkeypatch.setattr(onnx_model, "model_files", spoilt)
    with pytest.raises(MismatchError, match=r"ONNX Runtime and Python disagree: .* double"):
        export_controller(trained, tmp_path / "out", format="onnx", states=STATES)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("package", ["onnx", "onnxruntime"])
def test_without_the_extra_it_says_what_to_install(trained, tmp_path, monkeypatch, package):
    for name in [name for name in sys.modules if name.startswith("neuralgaits.export.onnx_")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(InputError, match=rf"no {package}: pip install 'neuralgaits\[onnx\]'"):
        export_controller(trained, tmp_path / "out", format="onnx", states=STATES)
    assert list(tmp_path.iterdir()) == []
