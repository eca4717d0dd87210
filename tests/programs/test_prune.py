"""A pruned Program computes the same outputs with fewer operations."""

import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.errors import InputError
from neuralgaits.programs import POINT, evaluate
from neuralgaits.programs.prune import prune
from neuralgaits.programs.tracing.tracer import trace

WEIGHTS = np.array([[1.0, 2.0], [3.0, -4.0]])


def _outputs(u):
    shared = jnp.sin(u)
    return {
        "a": WEIGHTS @ shared,
        "b": jnp.exp(shared[0]) + 2.0,
        "constant": jnp.asarray(WEIGHTS[0]),
        "input": u,
    }


@pytest.fixture(scope="module")
def program():
    return trace(_outputs, {"u": (2,)}, parameters={"w": WEIGHTS})


@pytest.mark.parametrize("names", [["a"], ["b"], ["constant"], ["input"], ["b", "a"]])
def test_outputs_keep_their_values(program, names):
    points = {"u": np.random.default_rng(0).normal(size=(5, 2))}
    part = prune(program, names)
    expected, found = evaluate(program, points, POINT), evaluate(part, points, POINT)
    assert sorted(found) == sorted(names)
    for name in names:
        np.testing.assert_array_equal(found[name], expected[name])


def test_needless_operations_and_constants_go(program):
    part = prune(program, ["input"])
    assert part.operations == ()
    assert part.constants == ()
    assert "exp" not in {operation.kind for operation in prune(program, ["a"]).operations}


def test_all_outputs_change_nothing(program):
    assert prune(program, [output.name for output in program.outputs]) == program


def test_unknown_outputs_are_named(program):
    with pytest.raises(InputError, match="'c'"):
        prune(program, ["a", "c"])
