"""Every condition of a gait lies inside its bounds at random points of random boxes.

The bounds are compared with values in float64 and, at fewer points, with Arb's enclosures of the
exact values. More points: benchmarks/soundness.py.
"""

import jax
import numpy as np
import pytest

from neuralgaits.barriers import specs
from neuralgaits.certificate.traced import trace_spec
from neuralgaits.programs import POINT, evaluate, fold
from neuralgaits.programs.algebras.ball import BallAlgebra
from neuralgaits.programs.algebras.taylor_algebra import TaylorAlgebra
from neuralgaits.robots import load_robot

BOXES, POINTS, EXACT = 96, 100, 32
BEYOND, WIDTHS = 0.03, (1e-6, 0.1)


@pytest.fixture(scope="module", params=["default", "wide", "free"])
def program(request, trained):
    """Conditions of the trained default gait, and of a wide and a free one as they start."""
    if request.param == "default":
        return trace_spec(trained.spec, trained.robot, trained.gait)
    robot = load_robot("amber3m")
    spec = specs.load("walking-mlp" if request.param == "free" else "walking", robot)
    hidden = {"wide": (256, 256), "free": None}[request.param]
    gait = spec.new_gait(jax.random.key(4), "random", hidden)
    return trace_spec(spec, robot, gait)


@pytest.fixture(scope="module")
def boxes():
    """Centres and half widths in the tube and a little beyond, small and large. [BOXES, 2]."""
    draw = np.random.default_rng(2)
    half = 0.5 * np.exp(draw.uniform(np.log(WIDTHS[0]), np.log(WIDTHS[1]), (BOXES, 2)))
    return draw.uniform(-BEYOND + half, 1.0 + BEYOND - half), half


def bounds(program, boxes, degree):
    """Of every element of every output, by name. low, high: [elements, BOXES]."""
    algebra = TaylorAlgebra(degree)
    with np.errstate(all="ignore"):
        models = evaluate(program, {"u": boxes}, algebra, fold(program, algebra))
    ranges = {name: np.array(model.range()) for name, model in models.items()}
    return {name: np.broadcast_to(r, (*r.shape[:2], BOXES)) for name, r in ranges.items()}


@pytest.mark.parametrize("degree", [1, 2])
def test_floats_lie_inside(program, boxes, degree):
    draw, (centre, half) = np.random.default_rng(3), boxes
    share = draw.uniform(-1.0, 1.0, (BOXES, POINTS, 2))
    share[:, :4] = [[-1, -1], [1, -1], [-1, 1], [1, 1]]
    u = (centre[:, None] + half[:, None] * share).reshape(-1, 2)
    values = evaluate(program, {"u": u}, POINT)
    finite = []
    for name, (low, high) in bounds(program, boxes, degree).items():
        value = values[name].reshape(BOXES, POINTS, -1)
        known = np.isfinite(low) & np.isfinite(high)
        inside = (value >= low.T[:, None]) & (value <= high.T[:, None])
        assert np.all(inside | ~known.T[:, None]), name
        finite.append(known.mean())
    assert np.mean(finite) > 0.8


def test_exact_values_lie_inside(program, boxes):
    """Arb's ball around the exact value at a point lies in the bounds of the point's box."""
    draw, (centre, half) = np.random.default_rng(5), boxes
    u = (centre + half * draw.uniform(-1.0, 1.0, centre.shape))[:EXACT]
    exact = evaluate(program, {"u": (u, u)}, BallAlgebra(1))
    for name, (low, high) in bounds(program, boxes, 2).items():
        balls = np.broadcast_to(np.atleast_2d(exact[name].range()), (low.shape[0], EXACT))
        for element, box in np.argwhere(np.isfinite(low[:, :EXACT] + high[:, :EXACT])):
            ball = balls[element, box]
            assert low[element, box] <= ball, name
            assert ball <= high[element, box], name
