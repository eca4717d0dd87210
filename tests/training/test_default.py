"""What the default training promises."""

import jax
import numpy as np
import pytest

LEAST_MARGIN = 0.04
"""In the scale of each condition."""
SAMPLES = 1500


@pytest.fixture(scope="module")
def worst(trained):
    """Smallest margin over scale of each condition, on uniform samples of its region."""
    spec, gait, zd = trained.spec, trained.gait, trained.zero_dynamics
    margins = jax.jit(jax.vmap(lambda u: spec.margins(gait, zd, u)))
    draw, found = np.random.default_rng(12), {}
    for name, (box,) in spec.regions.items():
        values = margins(draw.uniform(box.low, box.high, (SAMPLES, 2)))
        for c in spec.conditions:
            if c.region == name:
                found[c.name] = float(np.min(values[c.name])) / c.scale
    return found


def test_every_condition_holds_with_room_to_spare(trained, worst):
    assert set(worst) == {c.name for c in trained.spec.conditions}
    assert min(worst.values()) >= LEAST_MARGIN, worst


def test_the_summary_says_so_too(trained):
    scales = {c.name: c.scale for c in trained.spec.conditions}
    for name, found in trained.summary["conditions"].items():
        assert found["max_violation"] == found["mean_violation"] == 0.0
        assert found["min_margin"] >= LEAST_MARGIN
        assert found["scale"] == scales[name]
