"""Smooth activations that state their own derivative.

JAX differentiates tanh through exponentials; a bound on that expression is two to four times
looser than a bound on 1 - t^2. Each rule calls its own activation, so that second derivatives
use the rule as well. ReLU is here for comparison with the paper: it trains, but nothing with a
kink can be traced into a Program, so its gaits are not provable.
"""

from collections.abc import Callable

import jax
import jax.numpy as jnp

from neuralgaits._types import Array, Float

Activation = Callable[[Float[Array, "*k"]], Float[Array, "*k"]]


@jax.custom_jvp
def tanh(x: Float[Array, "*k"]) -> Float[Array, "*k"]:
    """Hyperbolic tangent, derivative 1 - tanh^2."""
    return jnp.tanh(x)


@tanh.defjvp
def _tanh_rule(primals, tangents):
    value = tanh(primals[0])
    return value, (1.0 - value * value) * tangents[0]


@jax.custom_jvp
def logistic(x: Float[Array, "*k"]) -> Float[Array, "*k"]:
    """Logistic function 1 / (1 + exp(-x)), derivative s (1 - s)."""
    return jax.lax.logistic(x)


@logistic.defjvp
def _logistic_rule(primals, tangents):
    value = logistic(primals[0])
    return value, value * (1.0 - value) * tangents[0]


@jax.custom_jvp
def softplus(x: Float[Array, "*k"]) -> Float[Array, "*k"]:
    """Softplus log(1 + exp x), derivative the logistic function."""
    return jnp.log1p(jnp.exp(x))


@softplus.defjvp
def _softplus_rule(primals, tangents):
    return softplus(primals[0]), logistic(primals[0]) * tangents[0]


def relu(x: Float[Array, "*k"]) -> Float[Array, "*k"]:
    """Rectifier max(x, 0): the paper's activation; trains, but is not provable."""
    return jax.nn.relu(x)


ACTIVATIONS: dict[str, Activation] = {
    "tanh": tanh,
    "softplus": softplus,
    "relu": relu,
}
