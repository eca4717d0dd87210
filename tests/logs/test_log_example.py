"""The example of docs/logs.md is what its files hold, and those are a walk of the shipped run."""

import re

import numpy as np
import pytest

from neuralgaits import logs
from neuralgaits.analysis.run import open_run
from support import log_example, own_columns, pages
from support.shipped_run import SHIPPED

PAGE = pages.ROOT / "docs" / "logs.md"


@pytest.fixture(scope="module")
def made(amber, shipped_walk):
    return log_example.columns(logs.read(shipped_walk / "si.csv", amber).log)


def test_the_example_is_a_walk_of_the_shipped_run(made):
    lines = log_example.LOG.read_text(encoding="utf-8").splitlines()
    assert lines[0] == ",".join(own_columns.COLUMNS)
    rows = np.array([[float(cell) for cell in line.split(",")] for line in lines[1:]])
    assert rows.shape == (log_example.ROWS, len(own_columns.COLUMNS))
    for i, name in enumerate(own_columns.COLUMNS):
        # Engines and processors differ by less than the digits that are written.
        np.testing.assert_allclose(rows[:, i], made[name], atol=10.0**-log_example.DIGITS)


def test_the_example_is_read(made):
    run = open_run(SHIPPED)
    log, left_out = logs.read(
        log_example.LOG, run.robot, columns=log_example.COLUMNS, policy=run.gait.policy
    )
    assert left_out == {"missing": 0, "outliers": 0}
    assert len(log) == log_example.ROWS
    assert list(log.stance) == [1] * 10 + [0] * 10
    degrees = made["knee_r"][:10] - own_columns.OFFSETS.get("knee_r", 0.0)
    np.testing.assert_allclose(log.q[:10, 1], degrees / own_columns.DEGREE, atol=1e-4)
    # Where the rates of the walk itself were known: with rows 5 ms apart and three digits.
    np.testing.assert_allclose(log.dq[:10, 1], made["dknee_r"][:10] / own_columns.DEGREE, atol=0.05)


def test_the_page_shows_these_files():
    files = pages.files(PAGE)
    assert files["walk.csv"] == log_example.LOG.read_text(encoding="utf-8")
    assert files["columns.toml"] == log_example.COLUMNS.read_text(encoding="utf-8")
    lines = [line for line in files["columns.toml"].splitlines() if re.match(r"\w", line)]
    assert len(lines) <= 15


def test_the_page_has_every_key_and_every_unit():
    from neuralgaits.logs.formats import units
    from neuralgaits.logs.formats.column_file import PLAIN

    text = pages.read(PAGE)
    keys = [*PLAIN, "joints", "rates", "contact", "torques", "desired", "desired_rates"]
    for key in [*keys, "hip_velocity"]:
        assert re.search(rf"^\| `\[?{key}\]?`", text, re.MULTILINE), key
    for value in vars(units).values():
        if isinstance(value, units.Dimension):
            for unit in value.units:
                assert f"`{unit}`" in text, unit
