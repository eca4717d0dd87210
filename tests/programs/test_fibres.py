"""Models in several symbols, with a second input from the unit ball or without, both arithmetics.

Bounds hold on all boxes and all of the ball, and are no wider than they should be.
"""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from flint import arb
from hypothesis import given, settings
from hypothesis import strategies as st

from neuralgaits.errors import InputError
from neuralgaits.programs import POINT, evaluate
from neuralgaits.programs.algebras.ball import BallAlgebra
from neuralgaits.programs.algebras.taylor_algebra import TaylorAlgebra
from neuralgaits.programs.program import Constant, Input, Operation, Output, Program
from neuralgaits.programs.tracing.tracer import trace

SIZE = 3
UNARY = ("sin", "cos", "tanh", "exp", "logistic", "square", "neg")
SAFE = {"sqrt": 3.0, "log1p": 1.0, "div": 3.0}
"""What is added to an argument in [-1.5, 1.5] so that the function is defined there."""


def _sphere(count: int) -> np.ndarray:
    """Points of the unit ball, most of them on its rim."""
    draw = np.random.default_rng(5)
    xi = draw.normal(size=(count, SIZE))
    xi /= np.linalg.norm(xi, axis=1, keepdims=True)
    return xi * np.where(draw.random((count, 1)) < 0.7, 1.0, draw.random((count, 1)))


def _box(centre, half, count: int) -> np.ndarray:
    share = np.random.default_rng(6).choice([-1.0, 1.0, 0.0, 0.4], size=(count, len(centre)))
    return centre + half * share


def _bounds(program, degree, centre, half):
    """Lower and upper bounds of output g by both algebras, over one box. [elements] each."""
    centre, half = np.array([centre]), np.array([half])
    models = evaluate(program, {"u": (centre, half * (1 + 1e-15))}, TaylorAlgebra(degree))
    yield tuple(side[:, 0] for side in models["g"].range())
    corners = {"u": (centre - half, centre + half)}
    balls = evaluate(program, corners, BallAlgebra(degree))["g"].range()[:, 0]
    yield tuple(np.array([float(getattr(b, side)()) for b in balls]) for side in ("lower", "upper"))


def _check(program, degree, centre, half, count=600):
    """Every value at points lies inside; gives the widths of the bounds."""
    u, xi = _box(np.array(centre), np.array(half), count), _sphere(count)
    known = {"u": u, "xi": xi}
    inputs = {item.name: known[item.name] for item in program.inputs}
    values = evaluate(program, inputs, POINT)["g"].reshape(count, -1)
    widths = []
    for low, high in _bounds(program, degree, centre, half):
        slack = 1e-13 * (1.0 + np.abs(values).max())
        assert np.all(low - slack <= values.min(axis=0))
        assert np.all(values.max(axis=0) <= high + slack)
        widths.append(high - low)
    return values, widths


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("name", [*UNARY, *SAFE])
def test_a_function_stays_within_its_bounds(name, degree):
    """f(u0 + shift + a . xi) for slopes of several sizes, on wide and narrow boxes."""
    weights = np.array([[0.3, -0.1, 0.2], [1e-3, 0.0, 2e-3], [0.0, 0.9, 0.0]])
    operations = [
        Operation("affine", (2, 1), 3, columns=1),
        Operation("move", (0,), 3, index=(0, 0, 1)),
        Operation("add", (5, 6), 3),
        Operation("add", (7, 3), 3),
        Operation(name, (4, 8) if name == "div" else (8,), 3),
    ]
    program = Program(
        (Input("u", (2,)), Input("xi", (SIZE,))),
        (
            Constant(None, weights),
            Constant(None, np.full(3, SAFE.get(name, 0.0))),
            Constant(None, np.ones(3)),
        ),
        tuple(operations),
        (Output("g", (3,), 9),),
    )
    for half in (1e-6, 0.02, 0.4):
        _check(program, degree, (0.3, -0.5), (half, half))


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from([1, 2]), st.sampled_from([1, 2, 3, 4, 6, 8]))
def test_random_programs_stay_within_their_bounds(seed, degree, axes):
    draw = np.random.default_rng(seed)
    names = ["add", "sub", "mul", "sin", "tanh", "inner", "sum", "affine", "move"]
    kinds = [str(kind) for kind in draw.choice(names, 9)]
    # Arb's tanh has no bound where its argument may be anything: xi enters with a fifth.
    operations = [Operation("affine", (3, 1), SIZE)]
    sizes = [axes, SIZE, 4 * SIZE, SIZE * SIZE, SIZE]
    values = [4]
    for kind in kinds:
        first, second = draw.choice(values), draw.choice([0, *values])
        if kind in ("add", "sub", "mul"):
            second = draw.choice([v for v in values if sizes[v] in (1, sizes[first])])
            size = max(sizes[first], sizes[second])
            operations.append(Operation(kind, (int(first), int(second)), size))
        elif kind in ("inner", "sum"):
            operands = (int(first),) * (2 if kind == "inner" else 1)
            operations.append(Operation(kind, operands, 1))
        elif kind == "affine":
            if sizes[first] != SIZE:
                continue
            operations.append(Operation(kind, (2, int(first)), 4))
        elif kind == "move":
            total = sizes[first] + sizes[second]
            index = tuple(int(i) for i in draw.integers(0, total, SIZE))
            operations.append(Operation(kind, (int(first), int(second)), SIZE, index))
        else:
            operations.append(Operation(kind, (int(first),), sizes[first]))
        sizes.append(operations[-1].size)
        values.append(len(sizes) - 1)
    program = Program(
        (Input("u", (axes,)), Input("xi", (SIZE,))),
        (Constant(None, draw.uniform(-0.5, 0.5, (4, SIZE))), Constant(None, 0.2 * np.eye(SIZE))),
        tuple(operations),
        (Output("g", (sizes[-1],), len(sizes) - 1),),
    )
    half = draw.choice([0.0, 0.05, 0.1], axes)
    _check(program, degree, draw.uniform(-1, 1, axes), half, count=200)


@pytest.mark.parametrize("axes", [3, 4, 6, 8])
@pytest.mark.parametrize("degree", [1, 2])
def test_models_in_more_symbols_are_as_tight_as_their_degree(axes, degree):
    """A smooth function on a box: values fill the bounds to the order that the degree keeps."""

    def function(u):
        turned = jnp.sin(u) * jnp.roll(u, 1)
        return {"g": jnp.stack([jnp.sum(turned) / (2.0 + u[0]), jnp.exp(u @ u / axes)])}

    program = trace(function, {"u": (axes,)})
    centre = np.linspace(-0.6, 0.9, axes)
    excess = []
    for half in (0.02, 0.005):
        values, widths = _check(program, degree, centre, np.full(axes, half), count=20)
        # On a small box the function is nearly linear: its range is the sum of its slopes.
        slopes = jax.jacfwd(lambda u: function(u)["g"])(jnp.asarray(centre))
        linear = 2.0 * half * np.abs(np.asarray(slopes)).sum(axis=1)
        excess.append([width / linear - 1.0 for width in widths])
        assert np.all(np.ptp(values, axis=0) <= np.minimum(*widths))
    assert np.max(excess[0]) < 0.25
    assert np.all(np.array(excess[1]) < 0.5 * np.array(excess[0]) + 1e-9)


@pytest.fixture(scope="module")
def smooth():
    def function(u, xi):
        moved = jnp.sin(u[0] + 0.01 * xi[0]) * (2.0 + u[1] + 0.01 * xi[1])
        return {"g": jnp.stack([moved / (3.0 + 0.01 * xi[2]), jnp.cos(u[0]) * u[1]])}

    return trace(function, {"u": (2,), "xi": (SIZE,)})


@pytest.mark.parametrize("degree", [1, 2])
def test_bounds_are_tight_to_second_order(smooth, degree):
    """On a point of u the width is the length of the slope in xi, not the sum of its elements."""
    values, widths = _check(smooth, degree, (0.4, 0.2), (0.0, 0.0), count=4000)
    s, c = np.sin(0.4), np.cos(0.4)
    slope = 0.01 * np.array([c * 2.2 / 3.0, s / 3.0, -s * 2.2 / 9.0])
    for width in widths:
        assert width[0] == pytest.approx(2.0 * np.linalg.norm(slope), rel=0.02)
        assert width[1] < 1e-11
    assert np.ptp(values[:, 0]) <= min(width[0] for width in widths)


@pytest.mark.parametrize("algebra", [TaylorAlgebra(2), BallAlgebra(2)])
def test_what_is_undefined_somewhere_in_the_ball_is_not_bounded(algebra):
    program = trace(lambda u, xi: {"g": jnp.sqrt(u + xi[:2])}, {"u": (2,), "xi": (SIZE,)})
    box = (np.array([[0.5, 2.0]]), np.array([[0.5, 2.0]]))
    if isinstance(algebra, TaylorAlgebra):
        box = (box[0], 0.0 * box[1])
    found = evaluate(program, {"u": box}, algebra)["g"].range()
    if isinstance(algebra, TaylorAlgebra):
        assert np.isnan(found[0][0, 0])
        assert found[0][1, 0] > 0.9
    else:
        assert not found[0, 0] > arb(-1e9)
        assert found[1, 0] > arb(0.9)


@pytest.mark.parametrize("algebra", [TaylorAlgebra(1), BallAlgebra(1)])
def test_other_inputs_are_refused(algebra):
    box = (np.zeros((1, 2)), np.zeros((1, 2)))
    several = trace(lambda u, a, b: {"g": u * a * b}, {"u": (2,), "a": (2,), "b": (2,)})
    two = trace(lambda u, xi: {"g": u * xi}, {"u": (2,), "xi": (2,)})
    table = trace(lambda u: {"g": u}, {"u": (2, 1)})
    long = trace(lambda u: {"g": u}, {"u": (17,)})
    for program, boxes in (
        (several, {"u": box}),
        (two, {"u": box, "xi": box}),
        (two, {"x": box}),
        (table, {"u": box}),
        (long, {"u": (np.zeros((1, 17)), np.zeros((1, 17)))}),
    ):
        with pytest.raises(InputError, match=r"boxes of one input of shape .* one more input"):
            evaluate(program, boxes, algebra)


@pytest.mark.parametrize("algebra", [TaylorAlgebra(2), BallAlgebra(2)])
def test_what_does_not_depend_on_the_ball_has_no_terms_for_it(algebra):
    """A second input costs nothing where it is not used, and bounds are the same."""
    box = (np.array([[0.2, 0.4]]), np.array([[0.3, 0.5]]))
    alone = trace(lambda u: {"g": jnp.sin(u[0]) * u}, {"u": (2,)})
    beside = trace(lambda u, xi: {"g": jnp.sin(u[0]) * u, "h": u * xi}, {"u": (2,), "xi": (2,)})
    one, other = (evaluate(p, {"u": box}, algebra)["g"] for p in (alone, beside))
    if isinstance(algebra, TaylorAlgebra):
        assert one.poly.tolist() == other.poly.tolist()
        assert one.radius.tolist() == other.radius.tolist()
    else:
        assert one.terms.keys() == other.terms.keys()
        ranges = (model.range().ravel() for model in (one, other))
        assert all(b.str(20) == c.str(20) for b, c in zip(*ranges, strict=True))
