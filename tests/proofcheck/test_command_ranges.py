"""A gait that is told any speed of a wide range: what the C++ checker bounds over wide boxes."""

import gzip
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import neuralgaits
from support.checker_case import bounds, holds

PACKED = Path(neuralgaits.__file__).parent / "demo_speed_run" / "certificate" / "proof.json.gz"


@pytest.fixture(scope="module")
def whole() -> dict[str, Any]:
    """The shipped proof of all speeds from 0.55 to 0.90 m/s, of which nothing is concluded."""
    table = json.loads(gzip.decompress(PACKED.read_bytes()))
    for theorem in table["theorems"]:
        theorem["claimed"] = False
    return table


def _about(table: dict[str, Any], region: str, name: str) -> list[dict[str, Any]]:
    """The statements about one condition on a region."""
    return [s for s in table["statements"] if s["region"] == region and s["conditions"] == [name]]


def test_what_an_impact_leaves_is_bounded_about_as_well_as_by_the_program(
    proofcheck, whole, tmp_path
):
    """After the guard of a speed that is known to a sixth of its range: neither bounds far more."""
    path = tmp_path / "proof.json"
    path.write_text(json.dumps({**whole, "statements": _about(whole, "strips", "torso-upper")}))
    draw = np.random.default_rng(7)
    low = np.stack(
        [np.full(8, 1.0002), draw.uniform(0.0, 0.9, 8), np.full(8, 0.725), np.full(8, 0.683)], 1
    )
    high = low + np.array([0.0002, 0.01, 0.0583, 0.001])
    own = bounds(proofcheck, path, low, high)
    program = bounds(proofcheck, path, low, high, "--program")
    for one, other in zip(own, program, strict=True):
        widths = [np.ptp(found["torso-upper"], axis=1) for found in (one, other)]
        assert np.all(widths[0] < 5.0 * widths[1]), widths


@pytest.mark.parametrize("name", ["impulse", "impulse-forward", "old-foot-leaves"])
def test_a_tree_that_ends_too_early_is_gone_on_with(asked, whole, name):
    """Over all speeds at once a bound is lost to terms of high degree, not to coefficients."""
    statements = [{**s, "tree": "-", "bounds": {name: 0.0}} for s in _about(whole, "guard", name)]
    answer = asked({**whole, "statements": statements})
    assert len(statements) == 1 and holds(answer), answer.stdout[-600:]
