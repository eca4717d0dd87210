from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.simulation.ticks.falls import Ending, ending

UPRIGHT = {
    "hip_height": 0.83,
    "pitch": 0.0,
    "since_touchdown": 0.4,
    "steps_left": 3,
    "in_gap": False,
    "finite": True,
}


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({}, Ending.RUNNING),
        ({"steps_left": 0}, Ending.WALKED),
        ({"hip_height": 0.4}, Ending.LOW_HIP),
        ({"pitch": -1.1}, Ending.TORSO),
        ({"pitch": 1.1}, Ending.TORSO),
        ({"since_touchdown": 4.0}, Ending.STALLED),
        ({"finite": False, "hip_height": float("nan")}, Ending.NOT_FINITE),
        ({"steps_left": 0, "hip_height": 0.4}, Ending.LOW_HIP),
        ({"in_gap": True, "hip_height": 0.4}, Ending.GAP),
    ],
)
def test_verdicts(amber, change, expected):
    state: dict[str, Any] = UPRIGHT | change
    traced = {name: jnp.asarray(value) for name, value in state.items()}
    verdict = Ending(int(ending(amber, **traced)))
    # Environments judge in NumPy, by the same rules.
    assert verdict == expected == Ending(int(ending(amber, **state, xp=np)))
    assert verdict.fell == (expected > Ending.WALKED)
    assert (verdict.reason is not None) == verdict.fell
    # It stands where neither hip, torso nor foot is where a fall puts it.
    assert verdict.upright == (verdict in (Ending.RUNNING, Ending.WALKED, Ending.STALLED))
