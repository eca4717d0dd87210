"""Every primitive on the list, and every kind of data movement, against JAX."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

CONSTANT = np.array([1.0, 2.0, 3.0])
MATRIX = np.array([[0.5, -1.25, 3.0], [2.0, 0.75, -0.125]])
SQUARE = np.array([[0.5, -1.25, 3.0], [2.0, 0.75, -0.125], [0.0, 1.0, -1.0]])

ARITHMETIC = {
    "add": lambda x: x + CONSTANT,
    "sub": lambda x: CONSTANT - x,
    "mul": lambda x: x * x[0],
    "div": lambda x: CONSTANT / x,
    "neg": lambda x: -x,
    "square": lambda x: jnp.square(x),
    "sqrt": lambda x: jnp.sqrt(x),
    "rsqrt": lambda x: jax.lax.rsqrt(x),
    "exp": lambda x: jnp.exp(x),
    "log1p": lambda x: jnp.log1p(x),
    "sin": lambda x: jnp.sin(x),
    "cos": lambda x: jnp.cos(x),
    "tan": lambda x: jnp.tan(x),
    "tanh": lambda x: jnp.tanh(x),
    "logistic": lambda x: jax.nn.sigmoid(x),
    "power 0": lambda x: x**0 + x,
    "power 2": lambda x: x**2,
    "power 7": lambda x: x**7,
    "power -3": lambda x: x**-3,
    "constant arithmetic": lambda x: jnp.sin(jnp.asarray(CONSTANT)) / 3.0 * x,
    "variance": lambda x: jnp.var(x),
}

PRODUCTS = {
    "matrix vector": lambda x: MATRIX @ x,
    "vector matrix": lambda x: x @ SQUARE,
    "vector vector": lambda x: x @ x,
    "constant vector": lambda x: CONSTANT @ x,
    "matrix matrix": lambda x: jnp.outer(x, x) @ (jnp.outer(x, x) + SQUARE),
    "matrix with columns": lambda x: MATRIX @ jnp.outer(x, x),
    "columns with matrix": lambda x: jnp.outer(x, x) @ MATRIX.T,
    "selection": lambda x: np.eye(3)[[2, 0]] @ x,
    "selection of columns": lambda x: jnp.outer(x, x) @ np.eye(3)[:, [1, 1]],
    "offset": lambda x: MATRIX @ x + np.array([0.25, -4.0]),
    "batched": lambda x: jnp.einsum("bi,bij->bj", jnp.outer(x, x), jnp.stack([SQUARE * x[0]] * 3)),
    "einsum": lambda x: jnp.einsum("i,jk->kij", x, MATRIX),
    "cross": lambda x: jnp.cross(x, CONSTANT),
    "with zeros": lambda x: jnp.stack([x, jnp.zeros(3), x]) @ jnp.stack([x, x, CONSTANT]).T,
    "sum": lambda x: jnp.sum(x),
    "sum over axes": lambda x: jnp.sum(x[:, None, None] * MATRIX[None], axis=(0, 2)),
    "sum of nothing": lambda x: jnp.sum(x[:0]) + x,
    "mean": lambda x: jnp.mean(jnp.outer(x, x), axis=1),
    "trace": lambda x: jnp.trace(jnp.outer(x, x)),
}

MOVEMENT = {
    "index": lambda x: x[-1],
    "slice": lambda x: x[1:],
    "strided": lambda x: x[::2],
    "reversed": lambda x: x[::-1],
    "gather": lambda x: x[np.array([2, 0, 2])],
    "gather pairs": lambda x: jnp.outer(x, x)[np.array([0, 1]), np.array([1, 2])],
    "boolean mask": lambda x: x[np.array([True, False, True])],
    "dynamic slice": lambda x: jax.lax.dynamic_slice(x, (1,), (2,)),
    "reshape": lambda x: jnp.outer(x, x).reshape(-1),
    "transpose": lambda x: (x[:, None] * MATRIX.T).T,
    "broadcast": lambda x: jnp.broadcast_to(x, (2, 3)),
    "concatenate": lambda x: jnp.concatenate([x, CONSTANT, x[:1] * 2.0]),
    "stack": lambda x: jnp.stack([x, CONSTANT], axis=1),
    "split": lambda x: jnp.split(x, 3)[1],
    "unpack": lambda x: jnp.stack(list(jnp.outer(x, x))[::-1]),
    "pad": lambda x: jnp.pad(x, (2, 1)),
    "pad between": lambda x: jax.lax.pad(x, 0.5, ((1, -1, 2),)),
    "roll": lambda x: jnp.roll(x, 1),
    "tile": lambda x: jnp.tile(x, (2, 2)),
    "repeat": lambda x: jnp.repeat(x, 2),
    "flip": lambda x: jnp.flip(jnp.outer(x, x), axis=1),
    "diagonal matrix": lambda x: jnp.diag(x),
    "diagonal": lambda x: jnp.diag(jnp.outer(x, x)),
    "triangle": lambda x: jnp.tril(jnp.outer(x, x)),
    "squeeze": lambda x: jnp.squeeze(x[None, :, None]),
    "known mask": lambda x: jnp.where(CONSTANT > 1.5, x, 0.0),
    "iota": lambda x: jnp.arange(3) * x,
    "linspace": lambda x: jnp.linspace(x[0], x[1], 4),
    "copy": lambda x: jnp.copy(x),
    "constant output": lambda x: jnp.asarray(CONSTANT) + 0.0 * x,
}

CALLS = {
    "jit": jax.jit(lambda x: jnp.sin(x) * x),
    "filter_jit": eqx.filter_jit(lambda x: jnp.sin(x) * x),
    "checkpoint": jax.checkpoint(lambda x: jnp.sin(x) * x),
    "grad": jax.grad(lambda x: jnp.sum(jnp.sin(x) * x)),
    "hessian": jax.hessian(lambda x: jnp.sum(jnp.sin(x) * x)),
    "linearize": lambda x: jax.linearize(jnp.sin, x)[1](x),
    "vmap": lambda x: jax.vmap(lambda a: MATRIX @ (a * x))(jnp.outer(x, x)),
}


@pytest.mark.parametrize("name", ARITHMETIC)
def test_arithmetic(agree, name):
    """Values where all functions are defined."""
    agree(lambda x: {"y": ARITHMETIC[name](x)}, x=(3,), low=0.2, high=1.5)


@pytest.mark.parametrize("name", PRODUCTS)
def test_products(agree, name):
    """Sums and contractions in all arrangements."""
    agree(lambda x: {"y": PRODUCTS[name](x)}, x=(3,))


@pytest.mark.parametrize("name", MOVEMENT)
def test_movement_costs_at_most_one_move(agree, name):
    """Whatever moves data leaves no operation but the one that shapes the output."""
    program = agree(lambda x: {"y": MOVEMENT[name](x)}, x=(3,))
    moves = [operation for operation in program.operations if operation.kind == "move"]
    if all(operation.kind == "move" for operation in program.operations):
        assert len(moves) <= 1


@pytest.mark.parametrize("name", CALLS)
def test_calls_are_inlined(agree, name):
    """A function that JAX wraps is the same as one that it does not."""
    agree(lambda x: {"y": CALLS[name](x)}, x=(3,))


def test_several_inputs_and_outputs(agree):
    """Inputs are inputs, scalars included, and may be left unused."""
    program = agree(
        lambda z, eta, scale, unused: {"b": scale * eta, "a": z @ z, "c": scale},
        z=(2,),
        eta=(2, 4),
        scale=(),
        unused=(5,),
    )
    assert [item.name for item in program.inputs] == ["eta", "scale", "unused", "z"]
    assert [item.name for item in program.outputs] == ["a", "b", "c"]


@pytest.mark.parametrize(
    ("function", "kinds"),
    [
        (lambda x: x + 0.0, []),
        (lambda x: 1.0 * x / 1.0, []),
        (lambda x: 0.0 - x, ["neg"]),
        (lambda x: -(-1.0 * x), ["neg", "neg"]),
        (lambda x: x - x, []),
        (lambda x: x * x, ["square"]),
        (lambda x: jnp.cos(x - x) * x, []),
        (lambda x: x * jnp.zeros(3) + x, []),
        (lambda x: jnp.eye(3) @ x, []),
        (lambda x: SQUARE @ x + CONSTANT, ["affine"]),
        (lambda x: jnp.sin(x) * jnp.cos(x) + jnp.cos(x) * jnp.sin(x), ["cos", "sin", "mul", "add"]),
    ],
)
def test_exact_simplifications(agree, function, kinds):
    """What is exact leaves no operation; what is equal is computed once."""
    program = agree(lambda x: {"y": function(x)}, x=(3,))
    assert sorted(operation.kind for operation in program.operations) == sorted(kinds)


def test_constant_arithmetic_is_kept(agree):
    """Rounding a constant here would put an unproved error into a proof."""
    program = agree(lambda x: {"y": jnp.asarray(0.1) * 0.2 + x}, x=(3,))
    assert [operation.kind for operation in program.operations] == ["mul", "add"]
    assert program.varies[program.first_operation :] == (False, True)


def test_dead_operations_are_left_out(agree):
    """Only what the outputs need."""
    program = agree(lambda x: {"y": [jnp.exp(x), jnp.sin(x)][1]}, x=(3,))
    assert [operation.kind for operation in program.operations] == ["sin"]
