"""Rows are evaluated in blocks of one size, and nothing of the padding is left."""

from typing import NamedTuple

import numpy as np
import pytest

from neuralgaits._blocks import in_blocks, in_blocks_of


class SumAndRoot(NamedTuple):
    """Two results a row."""

    total: np.ndarray
    roots: np.ndarray


@pytest.mark.parametrize("count", [0, 1, 3, 4, 5, 8, 11])
def test_every_row_is_evaluated_once_in_blocks_of_one_size(count):
    seen = []

    def evaluate(x, y):
        seen.append((x.shape, y.shape))
        return SumAndRoot(x.sum(axis=1) + y, np.sqrt(x))

    x = np.arange(1.0, 2.0 * count + 1.0).reshape(count, 2)
    y = np.arange(float(count))
    found = in_blocks(evaluate, 4, x, y)
    np.testing.assert_array_equal(found.total, x.sum(axis=1) + y)
    np.testing.assert_array_equal(found.roots, np.sqrt(x))
    assert seen == [((4, 2), (4,))] * max(1, -(-count // 4))


def test_padding_stays_in_the_domain_of_the_function():
    def reciprocal(x):
        assert np.all(x > 0.0)
        return 1.0 / x

    np.testing.assert_array_equal(in_blocks(reciprocal, 4, np.array([1.0, 2.0])), [1.0, 0.5])


def test_a_decorated_function_is_compiled_once_for_any_number_of_rows():
    traced = []

    @in_blocks_of(4)
    def scaled(factor, x):
        traced.append(x.shape)
        return factor * x

    for count in (1, 4, 9):
        x = np.arange(float(count))
        np.testing.assert_array_equal(scaled(np.array(2.0), x), 2.0 * x)
    assert traced == [(4,)]
