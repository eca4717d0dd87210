"""Which axis is halved, where the cost of each alone does not say it."""

from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.certificate.chart import CoupledAxes
from neuralgaits.certificate.search.box_tree import BoxTree
from neuralgaits.certificate.search.branch_and_bound import bound_here, search, start
from neuralgaits.certificate.search.halved_axis import axis_to_halve
from neuralgaits.certificate.search.problem import Problem
from neuralgaits.programs.tracing.tracer import trace


def problem_of(low, high, margin) -> Problem:
    program = trace(lambda u: {"margin": margin(u)}, {"u": (len(low),)})
    # Only the sign is proved, as in every chart of more axes than two; no compiled code.
    return Problem("root", low, high, ("margin",), (1.0,), program, degree=1, tight=0.0)


def confirm_nothing(name, u):
    """No counterexample is expected."""


def test_axes_that_are_harmless_alone_are_halved_where_they_leave_no_bound_together():
    def margin(u):
        # With x or y at the centre, 0, the divisor is a constant: alone they cost nothing.
        product = u[5] * u[6]
        return 1.0 / (1.02 + product * jnp.cos(product)) - 0.3 * jnp.sin(4.0 * u[0])

    problem = problem_of((-1.0,) * 7, (1.0,) * 7, margin)
    first = start(problem, confirm_nothing)
    tree = search(problem, first, confirm_nothing, phase="decide", most=8000).tree
    assert np.all(tree.lower[tree.is_leaf] > 0.0)


@pytest.mark.parametrize(
    ("low", "high", "cut"),
    [
        ((0.0, 0.0, 0.0), (1.0, 0.1, 1.0), 0),
        ((0.0, 0.0, 0.0), (0.1, 1.0, 1.0), 1),
        # Half of either is within reach of some of the other.
        ((0.0, 0.0, 0.0), (1.0, 0.4, 1.0), 2),
    ],
)
def test_half_an_axis_beyond_the_reach_of_its_partner_is_cut_off_first(low, high, cut):
    problem = replace(
        problem_of(low, high, lambda u: 1.5 + u[0] + u[1] + jnp.sin(9.0 * u[2])),
        coupled_axes=(CoupledAxes(0, 1, 0.2),),
    )
    tree = BoxTree.root(low, high, 1).measured(np.array([0]), np.array([[0.1, 0.1, 0.5]]))
    lacking = np.array([[0.2]])
    axis = axis_to_halve(problem, tree, np.array([0]), lacking, np.inf, bound_here)
    assert axis.tolist() == [cut]
