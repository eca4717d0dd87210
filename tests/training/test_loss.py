"""The Barrier Loss against its formula, written out in NumPy loops."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.training import barrier_loss, lay_out, margin_matrix
from neuralgaits.training.loss import lay_out_again
from neuralgaits.training.trainer import samplers_of
from support.small_spec import REGIONS

NAMES = ("torso", "hip", "rates", "foot", "hips")
SIZES = {"torso": 1, "hip": 1, "rates": 4, "foot": 2, "hips": 4}


@pytest.fixture(scope="module")
def table(spec, amber, gait, sampler):
    return lay_out(spec, amber, gait, sampler)


@pytest.fixture(scope="module")
def margins(sampler):
    return np.random.default_rng(0).normal(size=(len(sampler.low), 12))


def inside(region, low, high):
    """Whether a stratum lies in a region; overshoot aside."""
    middle = np.clip(0.5 * (low + high), 0.0, 1.0)
    return any(
        all(box.low[k] - 1e-12 <= middle[k] <= box.high[k] + 1e-12 for k in (0, 1))
        for box in REGIONS[region]
    )


def test_columns_and_rows(spec, sampler, table):
    """A row counts for a condition if its region of samples lies in the condition's region."""
    sizes = {name: block.stop - block.start for name, block in table.columns.items()}
    assert sizes == SIZES
    region_of = {row: name for name, part in sampler.rows.items() for row in range(100)[part]}
    regions = {c.name: c.region for c in spec.conditions}
    whole = {"tube": {"tube", "ends", "guard"}, "ends": {"ends", "guard"}, "guard": {"guard"}}
    for name, block in table.columns.items():
        for row, (low, high) in enumerate(zip(sampler.low, sampler.high, strict=True)):
            expected = region_of[row] in whole[regions[name]]
            assert np.all(table.counts[row, block] == expected)
            if expected:
                assert inside(regions[name], low, high)


def test_the_layout_for_other_samples_is_the_one_that_they_have(spec, amber, gait, sampler):
    other = samplers_of(spec)[1]
    assert len(other.low) != len(sampler.low)
    again = lay_out_again(lay_out(spec, amber, gait, sampler), spec, other)
    for one, two in zip(again, lay_out(spec, amber, gait, other), strict=True):
        np.testing.assert_equal(one, two)


def by_hand(spec, table, margins, torque):
    """Sum over conditions of weight x penalty, as the docstring of `barrier_loss` says."""
    recipe, terms = spec.recipe, []
    for c in spec.conditions:
        block = table.columns[c.name]
        rows = [i for i in range(len(margins)) if table.counts[i, block.start]]
        values = margins[rows][:, block]
        if c.absolute_loss:
            errors = []
            for row in values:
                below, above = row[:2], row[2:]
                errors.append(np.linalg.norm((above - below) / 2.0))
            penalty = np.mean(errors)
        else:
            penalties = []
            for column in values.T:
                hinges = [max(0.0, recipe.aim - g / c.scale) for g in column]
                penalties.append(np.mean(hinges) + recipe.worst_weight * max(hinges))
            penalty = np.mean(penalties)
        if recipe.logarithmic and penalty > 1.0:
            penalty = 1.0 + np.log(penalty)
        terms.append(spec.weights.get(c.name, 1.0) * penalty)
    effort = recipe.effort * np.mean((torque / recipe.effort_torque) ** 2)
    return np.array(terms), effort


@pytest.mark.parametrize(
    "changes",
    [
        {"aim": 0.0, "worst_weight": 0.0, "logarithmic": False},  # Eq. 10 itself.
        {"aim": 0.05, "worst_weight": 0.1, "logarithmic": False},
        {"aim": 0.05, "worst_weight": 0.1, "logarithmic": True},
        {"effort": 0.05, "effort_torque": 30.0},
    ],
)
@pytest.mark.parametrize("size", [1.0, 100.0])
def test_the_loss_is_its_formula(spec, table, margins, changes, size):
    spec = replace(spec, recipe=replace(spec.recipe, **changes))
    torque = 20.0 * np.random.default_rng(1).normal(size=(len(margins), 4))
    loss = barrier_loss(spec, table, jnp.asarray(size * margins), jnp.asarray(torque))
    terms, effort = by_hand(spec, table, size * margins, torque)
    np.testing.assert_allclose(loss.terms, terms, rtol=1e-12)
    assert float(loss.effort) == pytest.approx(effort, rel=1e-12)
    assert float(loss.total) == pytest.approx(terms.sum() + effort, rel=1e-12)


def test_zero_loss_is_no_violation(spec, table, margins):
    """Theorem 4's side that holds: all margins at least 0 on the samples, and only then."""
    plain = replace(spec.recipe, aim=0.0, worst_weight=0.0, logarithmic=False)
    hinges = tuple(c for c in spec.conditions if not c.absolute_loss)
    spec = replace(spec, recipe=plain, conditions=hinges)
    table = table._replace(
        counts=table.counts[:, :8],
        scale=table.scale[:8],
        mean_of=table.mean_of[:8, :4],
        absolute=table.absolute[:4],
        weight=table.weight[:4],
    )
    torque = jnp.zeros((len(margins), 4))
    good = np.abs(margins[:, :8])
    assert float(barrier_loss(spec, table, jnp.asarray(good), torque).total) == 0.0
    bad = good.copy()
    row = int(np.flatnonzero(table.counts[:, 3])[0])
    bad[row, 3] = -1e-6
    assert float(barrier_loss(spec, table, jnp.asarray(bad), torque).total) > 0.0


def test_the_logarithm_keeps_value_and_slope(spec, table, margins):
    """At one, where it begins."""
    spec = replace(spec, recipe=replace(spec.recipe, aim=0.0, worst_weight=0.0))
    torque = jnp.zeros((len(margins), 4))

    def term(size):
        ones = -size * jnp.ones_like(jnp.asarray(margins))
        return barrier_loss(spec, table, ones, torque).terms[1]

    at_one = 0.1  # The scale of the hip's margin.
    slope = jax.jit(jax.value_and_grad(term))
    below, above = (slope(at_one + move) for move in (-1e-9, 1e-9))
    np.testing.assert_allclose(below, above, rtol=1e-6)
    assert float(below[0]) == pytest.approx(1.0, rel=1e-7)


def test_single_precision_is_close(amber, spec, gait, trainer, sampler, table):
    """The loss of the first step, again in float64 on the same samples."""
    state = trainer.init(gait)
    _, loss = trainer.step(state)
    key = jax.random.fold_in(jax.random.key(trainer.seed), 0)
    u = np.asarray(sampler.draw(key))
    exact = jax.jit(lambda u: barrier_loss(spec, table, *margin_matrix(spec, amber, gait, u)))(u)
    assert loss.total.dtype == jnp.float32
    np.testing.assert_allclose(loss.terms, exact.terms, rtol=2e-4, atol=2e-5)
    assert float(exact.total) > 0.1
