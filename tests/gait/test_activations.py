"""Activations and their derivative rules, against Cauchy's integral formula.

f and its derivatives are read off a circle in the complex plane: nothing of the rules is used.
"""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.errors import InputError
from neuralgaits.gait import Network
from neuralgaits.gait.activations import ACTIVATIONS, logistic, relu, softplus, tanh

X = np.linspace(-6.0, 6.0, 41)
RADIUS, NODES = 1.0, 64  # The nearest poles are pi / 2 away; the formula's error is 1e-12.

COMPLEX = {
    tanh: np.tanh,
    logistic: lambda w: 1.0 / (1.0 + np.exp(-w)),
    softplus: lambda w: np.log1p(np.exp(w)),
}


def derivatives(function, x):
    """The function and its first three derivatives at x. [4, N]."""
    circle = np.exp(2j * np.pi * np.arange(NODES) / NODES)
    values = function(x[:, None] + RADIUS * circle)
    taylor = np.fft.fft(values, axis=1)[:, :4].real / NODES
    return (taylor * np.array([1.0, 1.0, 2.0, 6.0]) / RADIUS ** np.arange(4)).T


@pytest.mark.parametrize("activation", COMPLEX)
def test_rules_of_all_orders(activation):
    """Forward and reverse: training uses both."""

    def along(function):
        return lambda x: jax.jvp(function, (x,), (jnp.ones_like(x),))[1]

    orders = [activation]
    for _ in range(3):
        orders.append(along(orders[-1]))
    expected = derivatives(COMPLEX[activation], X)
    for order, function in enumerate(orders):
        np.testing.assert_allclose(function(X), expected[order], rtol=0, atol=1e-11)
    gradient = jax.grad(lambda x: jnp.sum(activation(x)))
    np.testing.assert_allclose(gradient(X), expected[1], rtol=0, atol=1e-11)
    backwards = jax.grad(lambda x: jnp.sum(gradient(x)))
    np.testing.assert_allclose(backwards(X), expected[2], rtol=0, atol=1e-11)


@pytest.mark.parametrize("activation", [tanh, logistic])
def test_saturation_is_finite(activation):
    far = np.array([-800.0, 800.0])
    value, slope = jax.jvp(activation, (far,), (np.ones(2),))
    assert np.all(np.isfinite(value))
    np.testing.assert_allclose(slope, 0.0, atol=1e-300)


def test_relu_is_the_rectifier():
    np.testing.assert_array_equal(relu(jnp.array(X)), np.maximum(X, 0.0))


@pytest.mark.parametrize("name", ACTIVATIONS)
def test_the_network_is_what_it_says(name):
    """Against a NumPy evaluation, layer by layer."""
    network = Network.init((2, 7, 5, 3), activation=name, key=jax.random.key(0))
    assert [w.shape for w in network.weights] == [(7, 2), (5, 7), (3, 5)]
    plain = {
        "tanh": np.tanh,
        "softplus": lambda v: np.log1p(np.exp(v)),
        "relu": lambda v: v * (v > 0),
    }
    value = np.array([0.3, -0.7])
    for weight, bias in zip(network.weights[:-1], network.biases[:-1], strict=True):
        bound = weight.shape[1] ** -0.5
        assert np.max(np.abs(weight)) <= bound
        assert np.max(np.abs(bias)) <= bound
        value = plain[name](weight @ value + bias)
    value = network.weights[-1] @ value + network.biases[-1]
    np.testing.assert_allclose(network(np.array([0.3, -0.7])), value, rtol=1e-13)


def test_other_activations_are_refused():
    with pytest.raises(
        InputError, match="unknown activation 'gelu': use one of tanh, softplus, relu"
    ):
        Network.init((2, 3, 1), activation="gelu", key=jax.random.key(0))
