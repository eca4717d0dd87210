"""Networks and their derivatives, and the names of their weights."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.gait import activations
from neuralgaits.programs.tracing.tracer import trace


@pytest.fixture
def network():
    """A tanh network of two inputs and four outputs."""
    return eqx.nn.MLP(
        2, 4, 8, 2, activation=activations.tanh, key=jax.random.key(3), dtype=jnp.float64
    )


DERIVATIVES = {
    "value": lambda net: net,
    "jvp": lambda net: lambda z: jax.jvp(net, (z,), (z * z,))[1],
    "jacfwd": jax.jacfwd,
    "jacrev": jax.jacrev,
    "second": lambda net: (
        lambda z: jax.jvp(lambda z: jax.jvp(net, (z,), (z * z,))[1], (z,), (z[::-1],))[1]
    ),
    "hessian": lambda net: jax.jacfwd(jax.jacfwd(net)),
    "vmap": lambda net: lambda z: jax.vmap(net)(jnp.stack([z, 2.0 * z, z * z])),
}


@pytest.mark.parametrize("name", DERIVATIVES)
def test_derivatives(agree, network, name):
    """Derivatives in every form JAX offers."""
    agree(lambda z: {"y": DERIVATIVES[name](network)(z)}, z=(2,))


@pytest.mark.parametrize("activation", [activations.tanh, activations.softplus])
def test_activations_state_their_own_derivative(agree, activation):
    """Second derivatives included; tanh is evaluated once."""
    program = agree(
        lambda x: {"y": activation(x), "d": jax.jvp(activation, (x,), (jnp.ones_like(x),))[1]},
        x=(3,),
    )
    names = [operation.kind for operation in program.operations]
    assert names.count("tanh") <= 1
    agree(lambda x: {"h": jax.hessian(lambda x: jnp.sum(activation(x)))(x)}, x=(3,))


def test_transposes_cost_nothing(network):
    """A layer's tangents are a product and a multiplication, without moves between."""
    program = trace(lambda z: {"y": jax.jacfwd(network)(z)}, {"z": (2,)}, parameters=network)
    kinds = [
        operation.kind
        for operation, varies in zip(
            program.operations, program.varies[program.first_operation :], strict=True
        )
        if varies
    ]
    assert kinds.count("affine") == 4
    assert kinds.count("tanh") == 2
    # One to repeat 1 - t^2 for both tangents of each layer.
    assert kinds.count("move") <= 2


def test_parameters_are_named_by_their_path(network):
    """The proof file can say which weights it speaks of."""
    program = trace(lambda z: {"y": network(z)}, {"z": (2,)}, parameters={"policy": network})
    weights = program.parameters
    assert sorted(weights) == sorted(
        f"policy.layers[{i}].{name}" for i in range(3) for name in ("weight", "bias")
    )
    np.testing.assert_array_equal(
        weights["policy.layers[1].weight"], network.layers[1].weight, strict=True
    )
    assert not trace(lambda z: {"y": network(z)}, {"z": (2,)}).parameters


def test_values_of_parameters_do_not_change_the_structure(network):
    """Weights that happen to be 0 or 1 leave the same operations."""

    def operations(net):
        return trace(lambda z: {"y": net(z)}, {"z": (2,)}, parameters=net).operations

    last = network.layers[2]
    special = eqx.tree_at(lambda net: net.layers[2].bias, network, jnp.array([0.0, 1, 0, 0]))
    special = eqx.tree_at(lambda net: net.layers[2].weight, special, jnp.ones_like(last.weight))
    assert operations(network) == operations(special)


def test_equal_weights_are_stored_once(network):
    """Constants are known by their content."""
    copied = eqx.tree_at(lambda net: net.layers[0].weight, network, network.layers[0].weight + 0.0)
    program = trace(
        lambda z: {"y": network(z), "w": copied(z)}, {"z": (2,)}, parameters=(network, copied)
    )
    assert len(program.parameters) == 6
    assert program.outputs[0].value == program.outputs[1].value
