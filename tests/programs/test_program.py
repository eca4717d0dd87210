"""Programs as data: hashes, serialisation, refusal of damaged files, life without JAX."""

import base64
import json
import os
import subprocess
import sys

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.errors import InputError, SpecError
from neuralgaits.programs import POINT, Program, evaluate
from neuralgaits.programs.ops import KINDS
from neuralgaits.programs.tracing.tracer import trace

LAYER_HASH = "8bd218e76bd065844ccdf9767d86cc89f097e3a922340ae45e0fd66638f563ae"
EVERYTHING_HASH = "33cf22a7fd9ad1e5b6e1b6c6daf17f30c4ffa7d4a54c6fe5b10170d983e75b41"

WEIGHT = np.arange(6.0).reshape(2, 3) / 7.0


def layer(weight=WEIGHT, bias=0.1):
    """A small Program with an input of three and an output of two elements."""
    return trace(lambda x: {"y": jnp.tanh(weight @ x + bias), "s": jnp.sum(x)}, {"x": (3,)})


def test_hash_is_of_the_mathematics():
    """Neither names of Python variables nor the order of commutative operands count."""
    assert layer().hash == layer().hash
    left = trace(lambda a, b: {"y": jnp.sin(a) * b + a}, {"a": (3,), "b": (3,)})
    right = trace(lambda b, a: {"y": a + b * jnp.sin(a)}, {"b": (3,), "a": (3,)})
    assert left == right
    assert hash(left) == hash(right)


@pytest.mark.parametrize(
    "other",
    [
        layer(weight=np.nextafter(WEIGHT, 1.0)),
        layer(bias=0.2),
        trace(lambda x: {"y": jnp.tanh(WEIGHT @ x + 0.1)}, {"x": (3,)}),
        trace(lambda x: {"y": jnp.sin(WEIGHT @ x + 0.1), "s": jnp.sum(x)}, {"x": (3,)}),
        trace(lambda v: {"y": jnp.tanh(WEIGHT @ v + 0.1), "s": jnp.sum(v)}, {"v": (3,)}),
    ],
)
def test_hash_tells_apart(other):
    """A weight's last bit, a constant, an output, an operation, a name."""
    assert layer().hash != other.hash
    assert layer() != other


def test_hash_is_the_same_everywhere():
    """These were found with Python 3.11 and JAX 0.10.2, and with Python 3.12 and JAX 0.12.0."""
    assert layer().hash == LAYER_HASH
    assert everything().hash == EVERYTHING_HASH


def everything():
    """A Program with all seventeen operations."""

    def function(x):
        table = x[:, None] - x[None, :]
        smooth = jnp.sqrt(1.0 + x * x) / jnp.exp(x) + jnp.log1p(jnp.exp(-x))
        curve = jnp.tanh(x) * jnp.cos(x) - jax.nn.sigmoid(x)
        links = jnp.sum(WEIGHT[:1] * jnp.sin(table), axis=1)
        mixed = jnp.concatenate([(WEIGHT @ x + 0.5)[::-1], x[:1]]) @ links
        return {"y": smooth + curve, "f": mixed, "g": -mixed, "d": jnp.diag(table @ table)}

    return trace(function, {"x": (3,)})


def test_all_operations_have_a_form():
    """The Program above is worth its hash."""
    assert {operation.kind for operation in everything().operations} == set(KINDS)


def test_round_trip_is_exact():
    """Constants that print badly, signs of zero and subnormals survive."""
    odd = np.array([0.1, -0.0, 5e-324, 1.7976931348623157e308, np.pi])
    program = trace(lambda x: {"y": odd * x}, {"x": (5,)}, parameters=[odd])
    again = Program.from_json(program.to_json())
    assert again.to_json() == program.to_json()
    assert again.constants[0].array.tobytes() == odd.tobytes()
    assert again.constants[0].name == "[0]"


def test_a_program_cannot_be_changed():
    """Frozen, constants included."""
    program = layer()
    with pytest.raises(ValueError, match="read-only"):
        program.constants[0].array[...] = 0.0
    with pytest.raises(AttributeError):
        program.outputs = ()  # pyright: ignore[reportAttributeAccessIssue]


def _with(change):
    table = json.loads(layer().to_json())
    change(table)
    return json.dumps(table)


NAN = base64.b64encode(np.full(6, np.nan).tobytes()).decode()

DAMAGE = {
    "no JSON": ("{", "JSON text of a Program"),
    "not a table": ("[]", "JSON text of a Program"),
    "version": (_with(lambda t: t.update(version=99)), "version 99"),
    "format": (_with(lambda t: t.update(format="else")), "found else"),
    "operation": (_with(lambda t: t["operations"][0].__setitem__(0, "erf")), "operation 'erf'"),
    "operand": (_with(lambda t: t["operations"][0].__setitem__(1, [99, 0])), "come later"),
    "size": (_with(lambda t: t["operations"][-1].__setitem__(2, 7)), "result size 7"),
    "NaN": (_with(lambda t: t["constants"][0].__setitem__(2, NAN)), "NaN, infinity"),
    "cut constant": (_with(lambda t: t["constants"][0].__setitem__(2, "AAAA")), "ValueError"),
    "output": (_with(lambda t: t["outputs"][0].__setitem__(2, 0)), "output s"),
    "names": (_with(lambda t: t["outputs"].reverse()), "unique and sorted"),
    "no constants": (_with(lambda t: t.pop("constants")), "KeyError"),
    "affine of a variable": (
        _with(lambda t: t["operations"].append(["affine", [0, 0], 1, 1])),
        "not constant",
    ),
    "move outside": (
        _with(lambda t: t["operations"].append(["move", [0], 1, [3]])),
        "move of operand sizes",
    ),
}


@pytest.mark.parametrize("name", DAMAGE)
def test_damaged_files_are_refused(name):
    """One line that says what was found."""
    text, message = DAMAGE[name]
    with pytest.raises(SpecError, match=message) as error:
        Program.from_json(text)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("inputs", "message"),
    [
        ({}, r"expected the inputs \['x'\], found \[\]"),
        ({"x": np.zeros(3), "y": np.zeros(3)}, "found"),
        ({"x": np.zeros(4)}, "found"),
        ({"x": np.zeros((2, 2, 3))}, r"found \(2, 2, 3\)"),
        ({"x": 0.0}, r"found \(\)"),
    ],
)
def test_wrong_inputs_are_refused(inputs, message):
    """Names and shapes."""
    with pytest.raises(InputError, match=message):
        evaluate(layer(), inputs, POINT)


def test_batches_must_be_equal():
    """One batch axis for all inputs, or none."""
    program = trace(lambda a, b: {"y": a + b}, {"a": (3,), "b": ()})
    batch = np.arange(6.0).reshape(2, 3)
    shared = evaluate(program, {"a": batch, "b": 1.0}, POINT)["y"]
    np.testing.assert_array_equal(shared, batch + 1.0)
    with pytest.raises(InputError, match="one batch size"):
        evaluate(program, {"a": batch, "b": np.zeros(5)}, POINT)


WITHOUT_JAX = """
import sys
import numpy as np
from neuralgaits.programs import POINT, Program, evaluate
program = Program.from_json(sys.stdin.read())
print(program.hash)
print(evaluate(program, {"x": np.array([0.1, 0.2, 0.3])}, POINT)["y"].tobytes().hex())
assert "jax" not in sys.modules and "equinox" not in sys.modules
"""


def test_programs_are_read_without_jax():
    """A proof checker needs NumPy only."""
    program = layer()
    result = subprocess.run(
        [sys.executable, "-c", WITHOUT_JAX],
        input=program.to_json(),
        capture_output=True,
        text=True,
        check=False,
        env={"PYTHONPATH": os.pathsep.join(sys.path)},
    )
    assert result.returncode == 0, result.stderr
    expected = evaluate(program, {"x": np.array([0.1, 0.2, 0.3])}, POINT)["y"]
    assert result.stdout.split() == [program.hash, expected.tobytes().hex()]
