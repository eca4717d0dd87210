"""Orbits of a family by speed: which of them a curve of the command may be laid through."""

import numpy as np
import pytest

from neuralgaits.training.calibration import rising_part


@pytest.mark.parametrize(
    ("speeds", "kept"),
    [
        ([0.6, 0.7, 0.8, 0.9, 1.0], [0.6, 0.7, 0.8, 0.9, 1.0]),
        # The last orbit is slower than the one before, as at an end that is trained little.
        ([0.68, 0.69, 0.71, 0.733, 0.732], [0.68, 0.69, 0.71, 0.733]),
        ([0.7, 0.69, 0.71, 0.73, 0.75], [0.69, 0.71, 0.73, 0.75]),
        ([np.nan, 0.69, 0.71, np.nan, 0.75], [0.69, 0.71]),
        ([0.6, 0.7, np.nan, 0.9, 1.0], [np.nan]),
    ],
)
def test_the_rising_part_about_the_middle_is_kept(speeds, kept):
    np.testing.assert_array_equal(np.array(speeds)[rising_part(np.array(speeds))], kept)
