"""Expressions of CasADi against points, for every kind of operation."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.programs import POINT, evaluate
from neuralgaits.programs.algebras.symbols import SymbolAlgebra
from neuralgaits.programs.ops import KINDS
from neuralgaits.programs.tracing.tracer import trace

WEIGHTS = np.array([[0.5, 0.0, -0.25], [1.0, 0.0, 0.0], [0.125, -0.5, 0.25]])
OFFSET = np.array([0.3, 1.7, -0.4])


def everything(a, m):
    """Each kind at least once; matrices of several columns, so that rows and columns differ."""
    hidden = jnp.tanh(WEIGHTS @ m + OFFSET[:, None])
    inner = jnp.sum(hidden * m, axis=1)
    smooth = jnp.sqrt(1.0 + a * a) / (2.0 + jnp.cos(a)) - jnp.exp(-a) * jnp.log1p(a * a)
    return {
        "matrix": hidden,
        "vector": smooth + jnp.square(inner) - jnp.sin(a[::-1]) + jax.nn.sigmoid(-a),
        "scalar": jnp.sum(hidden) + a @ inner,
    }


def test_symbols_agree_with_points():
    casadi = pytest.importorskip("casadi")
    program = trace(everything, {"a": (3,), "m": (3, 2)})
    assert {operation.kind for operation in program.operations} == set(KINDS)
    symbols = {"a": casadi.SX.sym("a", 3), "m": casadi.SX.sym("m", 6)}
    found = evaluate(program, symbols, SymbolAlgebra(casadi))
    function = casadi.Function("f", list(symbols.values()), list(found.values()))
    rng = np.random.default_rng(3)
    for _ in range(5):
        a, m = rng.uniform(-1.0, 1.0, 3), rng.uniform(-1.0, 1.0, (3, 2))
        expected = evaluate(program, {"a": a, "m": m}, POINT)
        for name, value in zip(found, function(a, m.ravel()), strict=True):
            np.testing.assert_allclose(
                np.array(value).ravel(), expected[name].ravel(), rtol=1e-13, atol=1e-14
            )
