"""Compare a Program in NumPy with the JAX function it was traced from."""

import jax
import numpy as np
import pytest

from neuralgaits.programs import POINT, Program, evaluate
from neuralgaits.programs.tracing.tracer import trace

POINTS = 16


@pytest.fixture
def agree():
    """Trace, evaluate one point and a batch, compare with JAX to 1e-12. Gives the Program."""

    def compare(function, *, low=-1.0, high=1.0, parameters=None, **shapes) -> Program:
        program = trace(function, shapes, parameters=parameters)
        draw = np.random.default_rng(7)
        batch = {
            name: draw.uniform(low, high, size=(POINTS, *shape)) for name, shape in shapes.items()
        }
        expected = jax.jit(jax.vmap(lambda arrays: function(**arrays)))(batch)
        found = evaluate(program, batch, POINT)
        assert sorted(found) == sorted(expected)
        for name, value in expected.items():
            scale = float(np.max(np.abs(value), initial=1.0))
            np.testing.assert_allclose(found[name], value, rtol=1e-12, atol=1e-12 * scale)
            assert found[name].shape == value.shape
        one = evaluate(program, {name: values[3] for name, values in batch.items()}, POINT)
        for name, value in one.items():
            np.testing.assert_allclose(value, found[name][3], rtol=1e-13, atol=1e-14)
            assert value.shape == found[name].shape[1:]
        return program

    return compare
