"""What cannot be traced is refused by name, at the user's line, with the way out."""

import re

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.errors import SpecError
from neuralgaits.programs.tracing import refusals
from neuralgaits.programs.tracing.tracer import trace

C = np.array([1.0, 2.0, 3.0])

REFUSED = {
    "where": (lambda x: jnp.where(x > 0, x, 0.0), "cannot trace gt: .*split the region"),
    "clip": (lambda x: jnp.clip(x, 0.0, 1.0), "max inside clip: .*two inequalities"),
    "abs": (lambda x: jnp.abs(x), "cannot trace abs: write two inequalities"),
    "maximum": (lambda x: jnp.maximum(x, C), "cannot trace max: .*two inequalities"),
    "minimum": (lambda x: jnp.minimum(x, C), "cannot trace min: .*two inequalities"),
    "relu": (lambda x: jax.nn.relu(x), "max inside relu: .*tanh or softplus"),
    "softplus": (lambda x: jax.nn.softplus(x), "softplus from gait.activations"),
    "max": (lambda x: x.max(), "reduce_max: write one inequality for each element"),
    "sign": (lambda x: jnp.sign(x), "cannot trace sign"),
    "norm": (lambda x: jnp.linalg.norm(x), r"jnp\.linalg\.norm: compare squares"),
    "det": (lambda x: jnp.linalg.det(jnp.outer(x, x)), r"jnp\.linalg\.det: .*closed form"),
    "solve": (lambda x: jnp.linalg.solve(jnp.outer(x, x), x), r"robots\.linear\.solve"),
    "at set": (lambda x: x.at[0].set(1.0), "scatter: .*jnp.concatenate"),
    "at add": (lambda x: x.at[0].add(1.0), "scatter-add: .*jnp.concatenate"),
    "float power": (lambda x: x**1.5, "cannot trace pow: use an integer power"),
    "scan": (lambda x: jax.lax.scan(lambda a, b: (a + b, a), 0.0, x)[0], "scan: .*Python loop"),
    "while": (lambda x: jax.lax.while_loop(lambda a: a[0] < 3, lambda a: a + 1, x), "while"),
    "cond": (lambda x: jax.lax.cond(x[0] > 0, lambda: x, lambda: -x), "split the region"),
    "sort": (lambda x: jnp.sort(x), "sort"),
    "index": (lambda x: x[jnp.argmax(x)], "argmax"),
    "float32": (lambda x: x.astype(jnp.float32), "float32.*remove the cast"),
    "float32 constant": (lambda x: x * jnp.asarray(C, jnp.float32), "float32"),
    "integer": (lambda x: x.astype(int) * 2.0, "a cast to int64"),
    "stop_gradient": (lambda x: jax.lax.stop_gradient(x), "stop_gradient: .*true derivative"),
    "random": (lambda x: x + jax.random.normal(jax.random.key(0), (3,)), "random"),
    "old random": (lambda x: x + jax.random.uniform(jax.random.PRNGKey(0)), "random"),
    "if": (lambda x: x if x[0] > 0 else -x, "no `if`"),
    "float": (lambda x: jnp.asarray(float(x[0])), r"float\(\)"),
    "numpy": (lambda x: np.sin(x), "NumPy call"),
    "log": (lambda x: jnp.log(x), r"log: write jnp\.log1p\(x - 1\.0\)"),
    "expm1": (lambda x: jnp.expm1(x), r"jnp\.exp\(x\) - 1\.0"),
    "product": (lambda x: jnp.prod(x), "reduce_prod: write the product out"),
    "cumsum": (lambda x: jnp.cumsum(x), "cumsum: multiply by a constant"),
    "arctan2": (lambda x: jnp.arctan2(x, x), "atan2"),
    "floor": (lambda x: jnp.floor(x), "round nothing"),
    "remainder": (lambda x: x % 2.0, "rem inside remainder"),
    "erf": (lambda x: jax.scipy.special.erf(x), r"erf: .*the page 'Conditions'"),
    "callback": (lambda x: jax.pure_callback(np.sin, x, x), "pure_callback"),
    "empty": (lambda x: x[:0] @ jnp.ones((0, 2)), "axis without elements: it sums no terms"),
    "empty rows": (lambda x: jnp.ones((3, 0)) @ x[:0] + x, "axis without elements"),
    "nested": (lambda x: jax.jit(lambda y: jnp.clip(y, 0.0, 1.0))(x), "max inside clip"),
    "index beyond": (lambda x: x[3], r"cannot trace index 3 of an axis of 3: index inside"),
    "index before": (lambda x: x[-4], r"cannot trace index -4 of an axis of 3: index inside"),
    "indices beyond": (
        lambda x: x[np.array([0, 5])],
        r"cannot trace index 5 of an axis of 3: index inside",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused_at_its_line(name):
    """One line: this file and the line of the entry above, the name, the remedy."""
    function, message = REFUSED[name]
    with pytest.raises(SpecError, match=message) as error:
        trace(lambda x: {"y": function(x)}, {"x": (3,)})
    found = re.match(r"(.+):(\d+): cannot trace ", str(error.value))
    assert found
    assert found[1] == __file__
    assert int(found[2]) == function.__code__.co_firstlineno
    assert "\n" not in str(error.value)


def test_the_line_is_not_that_of_an_earlier_caller():
    """JAX caches clip; the second caller must not be shown the first one's line."""

    def first(x):
        return {"y": jnp.clip(x, -3.0, 3.0)}

    def second(x):
        return {"y": jnp.clip(x, -3.0, 3.0)}

    for function in (first, second):
        with pytest.raises(SpecError) as error:
            trace(function, {"x": (3,)})
        assert f":{function.__code__.co_firstlineno + 1}: " in str(error.value)


@pytest.mark.parametrize(
    ("function", "message"),
    [
        (lambda x: [x], "must return a dict by name, found list"),
        (lambda x: {1: x}, "must return a dict by name"),
        (lambda x: {"y": jnp.arange(3)}, "outputs must be float64, found int64"),
        (lambda x: {"y": x * np.nan}, "found NaN, infinity"),
        (lambda x: {"y": x + np.array([0.0, np.inf, 1.0])}, "found NaN, infinity"),
    ],
)
def test_outputs_and_constants(function, message):
    """What is wrong as a whole."""
    with pytest.raises(SpecError, match=message):
        trace(function, {"x": (3,)})


def test_x64_must_be_on():
    """Otherwise weights and 9.81 would silently be float32."""
    with jax.enable_x64(False), pytest.raises(SpecError, match="x64 off; enable x64"):
        trace(lambda x: {"y": x}, {"x": (3,)})


def test_float32_weights_are_refused():
    """A tree that was cast for training is not the one to prove."""
    weight = jnp.ones((2, 3), dtype=jnp.float32)
    with pytest.raises(SpecError, match="float32"):
        trace(lambda x: {"y": weight @ x}, {"x": (3,)})


def test_what_has_no_advice_of_its_own_points_to_the_list():
    """Every primitive gets an answer."""
    assert "the page 'Conditions'" in refusals.advice("no_such_primitive")
    assert refusals.advice("scatter-mul") == refusals.advice("scatter-add")
