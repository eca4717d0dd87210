"""Functions whose Programs use every operation, for whoever writes Programs in another language."""

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits.export.programs import path, rate
from neuralgaits.gait import BezierPolicy, MLPPolicy
from neuralgaits.robots import load_robot

RNG = np.random.default_rng(5)
MATRIX, TALL, OFFSET = RNG.normal(size=(3, 3)), RNG.normal(size=(8, 3)), RNG.normal(size=8)
WIDE = RNG.normal(size=(5, 8))


def elementwise(x):
    a, b = jnp.sin(x), jnp.cos(x) + 2.0
    c = jnp.exp(0.1 * a) / jnp.sqrt(b) - jnp.log1p(b * b)
    return {"y": jnp.tanh(c) * jax.lax.logistic(x) - jnp.square(a), "z": -c}


def products(x):
    hidden = jnp.tanh(jnp.asarray(TALL) @ x + OFFSET)
    other = jnp.asarray(TALL) @ (x * x)
    return {"y": jnp.asarray(WIDE) @ (hidden * other), "z": jnp.asarray(WIDE) @ hidden}


def tables(x):
    """Matrices of values, sums, moves, broadcasting."""
    table = x[:, None] * jnp.cos(x)[None, :] - x[None, ::-1]
    turned = jnp.asarray(MATRIX) @ table @ jnp.asarray(MATRIX).T
    mixed = jnp.concatenate([turned[0], jnp.diag(table), jnp.array([1.0, 2.0]), x[1:]])
    return {"y": jnp.sum(turned, axis=1) * x[2], "z": mixed, "s": jnp.sum(mixed) + turned @ x}


def cancelling(u):
    """A hard value that is read twice, and nearly cancels: 0.3 y + 0.3 u."""
    y = jnp.exp(jnp.sin(3.0 * u[0]) * u[1]) / (2.0 + jnp.cos(2.0 * u[1]))
    return {"h": y * (10.0 + u[1]) - y * (9.7 + u[1]) + 0.3 * u[0]}


def network(widths):
    return MLPPolicy.init(load_robot("amber3m"), key=jax.random.key(1), hidden=widths)


def rows(x):
    """Matrices of few columns, one of a single row."""
    row, other = jnp.asarray(MATRIX[:1]), jnp.asarray(MATRIX)
    return {"y": (row @ jnp.tanh(x)) * x[0], "z": other @ (x * x) + OFFSET[:3], "s": row @ x + 1.0}


CASES = {
    "elementwise": (elementwise, {"x": (3,)}),
    "products": (products, {"x": (3,)}),
    "rows": (rows, {"x": (3,)}),
    "tables": (tables, {"x": (3,)}),
    "constant": (lambda x: {"c": jnp.asarray(OFFSET) * 2.0, "y": x}, {"x": (1,)}),
    "unread": (lambda x, a: {"y": x[0] * 3.0}, {"x": (2,), "a": (2,)}),
    "network": (rate(network((16, 16))), {"z": (2,), "dz": (2,)}),
    "odd network": (path(network((7, 5))), {"z": (2,), "dz": (2,), "ddz": (2,)}),
    "bezier": (
        rate(BezierPolicy(RNG.normal(size=(4, 6)), (-0.2, 0.2))),
        {"z": (2,), "dz": (2,)},
    ),
}


def points_of(program, count=200):
    """Random inputs that single precision holds, by name. [count, ...]."""
    return {
        item.name: RNG.uniform(-1.0, 1.0, (count, *item.shape)).astype(np.float32).astype(float)
        for item in program.inputs
    }
