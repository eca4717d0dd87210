"""Logs with dropped rows and glitches are used as far as they are good; the rest is counted."""

import numpy as np
import pytest

from neuralgaits import logs
from neuralgaits.logs.outliers import outliers

NOISE_RAD, NOISE_RAD_S = 2e-4, 0.02


@pytest.fixture
def read(amber, tmp_path):
    def read(log):
        logs.write(tmp_path / "walk.csv", log)
        return logs.read(tmp_path / "walk.csv", amber)

    return read


def settled_rows(log, count):
    """Rows well inside stance phases, no two near each other."""
    changes = np.concatenate([[0], np.flatnonzero(np.diff(log.stance)) + 1])
    since = (
        np.arange(len(log)) - changes[np.searchsorted(changes, np.arange(len(log)), "right") - 1]
    )
    inside = np.flatnonzero((since > 50) & (since < 400))
    return inside[:: len(inside) // count][:count]


def test_a_clean_walk_has_no_outliers(log):
    assert not outliers(log).any()


def test_a_noisy_walk_has_no_outliers(changed):
    draws = np.random.default_rng(0)
    noisy = changed(
        q=lambda q: q + NOISE_RAD * draws.standard_normal(q.shape),
        dq=lambda dq: dq + NOISE_RAD_S * draws.standard_normal(dq.shape),
    )
    assert not outliers(noisy).any()


@pytest.mark.parametrize(("array", "size"), [("q", 0.2), ("q", 30.0), ("dq", 5.0), ("dq", 300.0)])
def test_glitches_are_left_out_and_counted(amber, log, changed, read, array, size):
    """Whether or not the value is one the joint could have had."""
    rows = settled_rows(log, 6)

    def glitch(values):
        values[rows, 1 + np.arange(6) % 4] += size
        return values

    good, left_out = read(changed(**{array: glitch}))
    assert left_out == {"missing": 0, "outliers": 6}
    assert set(np.flatnonzero(np.isin(log.t, good.t, invert=True))) == set(rows)
    whole, holed = (logs.cut([each], amber).strides for each in (log, good))
    assert len(whole) == len(holed)
    # Single rows are bridged; windows that need them are not cut.
    assert all(stride.piece[-1] == 0 for stride in holed)
    found = logs.windows(holed)
    assert not np.isin(found.t, log.t[rows]).any()
    assert len(found.stride) > 0.8 * len(logs.windows(whole).stride)


def test_dropped_rows_are_counted(log, read):
    keep = np.ones(len(log), dtype=bool)
    keep[400:420] = False
    keep[[700, 900]] = False
    good, left_out = read(log.only(keep))
    assert left_out == {"missing": 22, "outliers": 0}
    assert len(good) == len(log) - 22


def test_a_third_of_the_rows_missing_at_random_leaves_the_strides(amber, log, read):
    """Neighbours stand in for a missing sample, at their own time."""
    keep = np.random.default_rng(0).random(len(log)) > 0.3
    good, _ = read(log.only(keep))
    whole, holed = (logs.cut([each], amber).strides for each in (log, good))
    assert len(holed) == len(whole)
    found = logs.windows(holed)
    assert len(found.t) > 0.7 * len(logs.windows(whole).t)
    assert np.isin(found.t, log.t[keep]).all()
    assert np.all(np.abs(np.diff(found.t, axis=1) - 0.01) <= 4.1e-3)


def test_counts_of_several_files_add_up(amber, log, changed, tmp_path):
    rows = settled_rows(log, 3)

    def glitch(q):
        q[rows, 2] -= 0.5
        return q

    logs.write(tmp_path / "a.csv", changed(q=glitch))
    keep = np.ones(len(log), dtype=bool)
    keep[500:510] = False
    logs.write(tmp_path / "b.csv", log.only(keep))
    found, left_out = logs.read_all([tmp_path / "a.csv", str(tmp_path / "b.csv")], amber)
    assert len(found) == 2
    assert left_out == {"missing": 10, "outliers": 3}
