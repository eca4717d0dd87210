from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import optax
import pytest

from neuralgaits.residual.nero import ZERO_SCALE, balanced, nero


@pytest.fixture
def parameters():
    draws = np.random.default_rng(0)
    return {
        "weight": jnp.asarray(draws.normal(size=(5, 7))),
        "first": jnp.asarray(draws.normal(size=(4, 2))),
        "bias": jnp.zeros(5),
    }


def gradients(parameters, seed) -> Any:
    draws = np.random.default_rng(seed)
    return jax.tree.map(lambda p: jnp.asarray(draws.normal(size=p.shape)), parameters)


def stepped(optimizer, parameters, found, state=None) -> Any:
    state = optimizer.init(parameters) if state is None else state
    change, state = optimizer.update(found, state, parameters)
    return optax.apply_updates(parameters, change), state


def test_rows_stay_balanced_whatever_the_gradients(parameters):
    optimizer, state = nero(0.05), None
    for seed in range(20):
        parameters, state = stepped(optimizer, parameters, gradients(parameters, seed), state)
    weight = np.asarray(parameters["weight"])
    np.testing.assert_allclose(weight.mean(axis=1), 0.0, atol=1e-14)
    np.testing.assert_allclose(np.linalg.norm(weight, axis=1), 1.0, rtol=1e-14)


def test_rows_of_two_keep_their_direction_free(parameters):
    # Zero mean and unit norm would leave (1, -1)/sqrt(2) and its negative only.
    first = np.asarray(balanced(parameters)["first"])
    np.testing.assert_allclose(np.linalg.norm(first, axis=1), 1.0, rtol=1e-14)
    directions = first * np.sign(first[:, :1])
    assert np.ptp(directions[:, 1]) > 0.1


def test_a_steady_gradient_turns_a_row_by_the_learning_rate():
    # Tangent, of zero mean and always the same size: the step is the rate itself.
    row = jnp.array([[1.0, -1.0, 0.0, 0.0]]) / np.sqrt(2.0)
    slope = jnp.array([[0.0, 0.0, 3.0, -3.0]])
    moved, _ = stepped(nero(0.01), row, slope)
    assert float(jnp.arccos(jnp.sum(moved * row))) == pytest.approx(np.arctan(0.01), rel=1e-6)


@pytest.mark.parametrize("factor", [1e-6, 1e6])
def test_the_size_of_a_loss_does_not_matter(parameters, factor):
    # Nor does that of one neuron's gradient alone.
    parameters = balanced(parameters)
    found = gradients(parameters, 1)
    scaled = found | {"weight": found["weight"].at[2].multiply(factor)}
    one, _ = stepped(nero(), parameters, found)
    other, _ = stepped(nero(), parameters, scaled)
    for name in parameters:
        np.testing.assert_allclose(one[name], other[name], rtol=1e-9, atol=1e-12)


def test_steps_are_scaled_by_the_norm_at_the_start(parameters):
    found = gradients(parameters, 2)
    after, _ = stepped(nero(0.01), parameters, found)
    # The first running mean, its bias corrected, is this gradient's own square.
    np.testing.assert_allclose(
        after["bias"], -0.01 * ZERO_SCALE * np.sign(found["bias"]), rtol=1e-12
    )
    state: Any = nero().init(parameters)
    norms = np.linalg.norm(np.asarray(parameters["weight"]), axis=1)
    assert float(state.scale["weight"]) == pytest.approx(norms.mean())


def test_the_running_mean_is_of_squared_norms_with_its_start_corrected(parameters):
    optimizer, state = nero(0.01, beta=0.9), None
    squares = []
    for seed in range(3):
        found = gradients(parameters, seed)
        squares.append(np.asarray(found["bias"]) ** 2)
        before = parameters
        parameters, state = stepped(optimizer, parameters, found, state)
    weights = 0.9 ** np.arange(2, -1, -1)
    typical = np.sqrt(np.tensordot(weights / weights.sum(), np.array(squares), axes=1))
    expected = before["bias"] - 0.01 * ZERO_SCALE * np.asarray(found["bias"]) / typical
    np.testing.assert_allclose(parameters["bias"], expected, rtol=1e-12)


def test_a_neuron_without_gradient_stays(parameters):
    parameters = balanced(parameters)
    found = gradients(parameters, 3)
    found["weight"] = found["weight"].at[1].set(0.0)
    after, _ = stepped(nero(), parameters, found)
    np.testing.assert_allclose(after["weight"][1], parameters["weight"][1], rtol=1e-14)


def test_it_needs_the_parameters(parameters):
    optimizer = nero()
    with pytest.raises(ValueError, match="parameters"):
        optimizer.update(gradients(parameters, 0), optimizer.init(parameters))
