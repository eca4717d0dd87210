"""Boxes left open as rows of a batch: where they lie, what they count for, that they help."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.training import Extra, lay_out
from neuralgaits.training.repair import LEAST_WIDTH, ROWS, with_extra


@pytest.fixture(scope="module")
def layout(spec, amber, gait, sampler):
    return lay_out(spec, amber, gait, sampler)


def boxes(*corners):
    pairs = np.array(corners, dtype=np.float64)
    return pairs[:, 0], pairs[:, 1]


OPEN = {
    "tube": boxes(((0.5, 0.25), (0.5625, 0.3125)), ((0.0, 0.0), (0.25, 0.5))),
    "ends": boxes(((0.09375, 0.5), (0.1, 0.500001))),
    "guard": boxes(((1.0, 0.75), (1.0, 1.0))),
}


def counted(extra, row, layout, spec):
    return {c.name for c in spec.conditions if extra.counts[row, layout.columns[c.name]].all()}


def test_rows_lie_in_the_regions_and_hold_the_boxes(spec, layout):
    extra = Extra.of(OPEN, spec, layout)
    assert extra.low.shape == extra.high.shape == (ROWS, 2)
    shares = {"tube": 22, "ends": 21, "guard": 21}
    row = 0
    for region, share in shares.items():
        (lows, highs), root = OPEN[region], spec.regions[region]
        for low, high in zip(*(part[row : row + share] for part in extra[:2]), strict=True):
            inside = [
                np.all(low <= a) and np.all(b <= high) for a, b in zip(lows, highs, strict=True)
            ]
            assert any(inside)
            assert any(
                np.all(np.array(r.low) <= low) and np.all(high <= np.array(r.high)) for r in root
            )
        row += share
    assert row == ROWS
    widths = extra.high - extra.low
    # A curve stays a curve; a sliver gets surroundings, as far as its region goes.
    assert np.all(widths[-21:, 0] == 0.0)
    np.testing.assert_allclose(widths[22:43, 1], LEAST_WIDTH)
    np.testing.assert_allclose(extra.high[22:43, 0], 0.1)


def test_rows_count_for_every_condition_that_must_hold_there(spec, layout):
    extra = Extra.of(OPEN, spec, layout)
    everywhere = {"torso", "hip"}
    assert counted(extra, 0, layout, spec) == everywhere
    assert counted(extra, 22, layout, spec) == everywhere | {"rates"}
    assert counted(extra, ROWS - 1, layout, spec) == everywhere | {"rates", "foot", "hips"}


def test_half_of_the_rows_are_those_of_earlier_rounds(spec, layout):
    first = Extra.of({"tube": OPEN["tube"]}, spec, layout)
    second = Extra.of({"guard": OPEN["guard"]}, spec, layout, first)
    assert np.all(second.low[: ROWS // 2, 0] == 1.0)
    assert np.all(second.low[ROWS // 2 :, 0] < 1.0)
    assert second.counts.shape == first.counts.shape


def test_points_are_fresh_and_in_their_boxes(spec, layout, sampler):
    extra = Extra.of(OPEN, spec, layout)
    before, counts = sampler.draw(jax.random.key(0)), layout.counts
    drawn = []
    for seed in (0, 1):
        u, table = with_extra(extra, 3, before, counts, jax.random.key(seed))
        assert u.shape == (len(counts) + 3 * ROWS, 2)
        np.testing.assert_array_equal(u[: len(counts)], before)
        np.testing.assert_array_equal(table[len(counts) :], np.tile(extra.counts, (3, 1)))
        more = np.asarray(u[len(counts) :]).reshape(3, ROWS, 2)
        assert np.all((extra.low <= more) & (more <= extra.high))
        assert not np.any(more[0, :22] == more[1, :22])
        drawn.append(more)
    assert not np.any(drawn[0][0, :22] == drawn[1][0, :22])


def test_a_repair_lowers_the_violation_where_it_looks(trainer, gait, spec):
    """Steps with points in the worst corner leave less violation there than steps without."""
    corner = {"tube": boxes(((0.875, 0.875), (1.0, 1.0)))}
    repairer = trainer.repairing(40)
    extra = jax.tree.map(jnp.asarray, Extra.of(corner, repairer.spec, repairer.layout))

    def loss_there(trained):
        state = trained.init(gait)
        while not trained.done(state):
            state, _ = trained.step(state)
        return (
            repairer.for_repair_round(extra, 1).report(repairer.gait(state.parameters), seed=0).loss
        )

    assert loss_there(repairer.for_repair_round(extra, 1)) < loss_there(repairer)


def test_rounds_have_samples_of_their_own(trainer, gait):
    repairer = trainer.repairing(40)
    extra = Extra.of(OPEN, repairer.spec, repairer.layout)
    states = [
        repairer.for_repair_round(extra, number).step(repairer.init(gait))[1] for number in (1, 2)
    ]
    assert float(states[0].total) != float(states[1].total)
    again = repairer.for_repair_round(extra, 1).step(repairer.init(gait))[1]
    assert float(again.total) == float(states[0].total)
