import numpy as np
import pytest

from neuralgaits import logs
from neuralgaits.errors import InputError
from neuralgaits.logs.zero_states import zero_states
from neuralgaits.robots.mjcf.loader import robot_from_text
from support import amber3m_files
from support.random_biped import random_biped


@pytest.fixture(scope="module")
def table(log):
    return amber3m_files.rows(log)


@pytest.mark.parametrize("header", [amber3m_files.HEADER, amber3m_files.SHORT_HEADER, None])
def test_both_legs_are_read_whatever_the_header(amber, log, table, header, tmp_path):
    path = amber3m_files.write(tmp_path / "data.csv", table, header)
    again, left_out = logs.read(path, amber)
    assert left_out == {"missing": 0, "outliers": 0}
    np.testing.assert_array_equal(again.stance, log.stance)
    np.testing.assert_allclose(again.t, log.t + 15.0, atol=1e-9)
    for name in ("q", "dq", "qd", "dqd", "tau", "pitch", "dpitch"):
        np.testing.assert_allclose(getattr(again, name), getattr(log, name), atol=1e-9)
    assert again.z is None


def test_z_follows_from_the_angles(amber, log, table, tmp_path):
    again = logs.read(amber3m_files.write(tmp_path / "data.csv", table), amber).log
    here, there = zero_states(amber, again.q, again.dq), zero_states(amber, log.q, log.dq)
    np.testing.assert_allclose(here, there, atol=1e-9)
    assert len(logs.cut([again], amber).strides) == len(logs.cut([log], amber).strides)


def test_zeros_after_the_walk_are_passed_over(amber, log, table, tmp_path):
    filled = np.vstack([table, np.zeros((500, 38))])
    assert len(logs.read(amber3m_files.write(tmp_path / "data.csv", filled), amber).log) == len(log)


def test_a_broken_row_is_named(amber, table, tmp_path):
    path = amber3m_files.write(tmp_path / "data.csv", table)
    lines = path.read_text().splitlines()
    lines[40] = lines[40].rpartition(",")[0]
    path.write_text("\n".join(lines))
    with pytest.raises(InputError) as refusal:
        logs.read(path, amber)
    assert f"log {path}, row 41, column 38: expected 38 columns, found 37" in str(refusal.value)


def test_the_file_column_of_the_leg_that_stands_is_named(amber, log, table, tmp_path):
    """The left knee, a_state_2, is the swing knee while the right leg stands."""
    first = int(np.flatnonzero(log.stance == 1)[0])
    table = table.copy()
    table[first:, 7] = 25.0
    with pytest.raises(InputError) as refusal:
        logs.read(amber3m_files.write(tmp_path / "data.csv", table), amber)
    assert f"row {first + 2}, column a_state_2: expected -0.1 to 1.6 rad, found 25" in str(
        refusal.value
    )


def test_a_stance_flag_is_left_or_right(amber, table, tmp_path):
    table = table.copy()
    table[9, 5] = 2.0
    with pytest.raises(InputError, match=r"row 11, column stance: expected 0 \(left\) or 1"):
        logs.read(amber3m_files.write(tmp_path / "data.csv", table), amber)


def test_legs_that_are_exchanged(amber, table, tmp_path):
    """The leg said to stand is in the air: its foot is above the other one."""
    table = table.copy()
    table[:, 5] = 1.0 - table[:, 5]
    with pytest.raises(InputError, match=r"column stance: expected the leg whose foot is on the"):
        logs.read(amber3m_files.write(tmp_path / "data.csv", table), amber)


def test_seconds_in_place_of_milliseconds_are_seen(amber, table, tmp_path):
    table = table.copy()
    table[:, 0] *= 1e-3
    with pytest.raises(
        InputError, match=r"column t: expected rows 0\.1 to 10\.5 ms apart, found 0\.001"
    ):
        logs.read(amber3m_files.write(tmp_path / "data.csv", table), amber)


def test_a_biped_of_other_joints_did_not_write_it(table, tmp_path):
    compass = robot_from_text(random_biped(3, 1, torso=False), "compass")
    path = amber3m_files.write(tmp_path / "data.csv", table[:50])
    with pytest.raises(InputError, match="expected a log of robot compass"):
        logs.read(path, compass)
