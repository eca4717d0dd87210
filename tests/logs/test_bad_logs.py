"""Every log that cannot be used is refused in one line: file, row, column, remedy."""

import numpy as np
import pytest

from neuralgaits import logs
from neuralgaits.errors import InputError
from neuralgaits.robots import load_robot


@pytest.fixture(scope="module")
def lines(log, tmp_path_factory):
    path = tmp_path_factory.mktemp("logs") / "walk.csv"
    logs.write(path, log)
    return path.read_text().splitlines()


@pytest.fixture
def refused(amber, tmp_path):
    """The line with which a file of these lines is refused."""

    def refuse(lines, robot=amber):
        path = tmp_path / "bad.csv"
        path.write_text("\n".join(lines) + "\n")
        with pytest.raises(InputError) as refusal:
            logs.read(path, robot)
        message = str(refusal.value)
        assert message.startswith(f"log {path}")
        assert "\n" not in message
        return message.removeprefix(f"log {path}")

    return refuse


def column_of(lines, name):
    return lines[0].split(",").index(name)


def with_column(lines, name, change, first=1):
    """Lines with a column changed from line `first` on."""
    at = column_of(lines, name)
    changed = list(lines)
    for i in range(first, len(lines)):
        cells = lines[i].split(",")
        cells[at] = repr(change(float(cells[at])))
        changed[i] = ",".join(cells)
    return changed


def with_cell(lines, row, name, text):
    """Lines with one cell changed; rows are counted from 1, the header's being 1."""
    changed = list(lines)
    cells = changed[row - 1].split(",")
    cells[column_of(lines, name)] = text
    changed[row - 1] = ",".join(cells)
    return changed


@pytest.mark.parametrize("name", ["q_swing_knee[rad]", "z1[m]"])
def test_a_column_that_is_missing(lines, refused, name):
    at = column_of(lines, name)
    without = [",".join(c for i, c in enumerate(line.split(",")) if i != at) for line in lines]
    assert f", row 1: expected column {name} of robot amber3m, found none" in refused(without)


def test_a_column_of_another_unit(lines, refused):
    told = [lines[0].replace("t[s]", "t[ms]"), *lines[1:]]
    assert refused(told) == (
        ", row 1, column t[ms]: expected unit s, found ms: convert the column to SI units"
    )


def test_a_column_given_twice(lines, refused):
    twice = [lines[0].replace("dpitch[rad/s]", "pitch[rad/s]"), *lines[1:]]
    assert "expected every column once, found pitch twice" in refused(twice)


@pytest.mark.parametrize("header", ["time,x,y", "t,stance"])
def test_a_header_of_neither_format(lines, refused, header):
    message = refused([header, *lines[1:]])
    assert ", row 1: expected columns name[unit] as in t[s],stance[-]" in message
    assert "38 columns of the AMBER-3M robot" in message


def test_a_header_that_is_missing(lines, refused):
    assert "found '29 columns without names'" in refused(lines[1:])


def test_a_row_of_another_width(lines, refused):
    broken = [*lines[:16], lines[16].rpartition(",")[0], *lines[17:]]
    assert ", row 17, column 29: expected 29 columns, found 28: delete the row" in refused(broken)
    broken[16] = lines[16] + ",1"
    assert ", row 17, column 30: expected 29 columns, found 30" in refused(broken)


@pytest.mark.parametrize("cell", ["nan", "inf", "", "one", "-NaN"])
def test_a_cell_that_is_no_finite_number(lines, refused, cell):
    message = refused(with_cell(lines, 23, "dq_swing_hip[rad/s]", cell))
    assert message == (
        f", row 23, column dq_swing_hip[rad/s]: expected a finite number, found {cell!r}: "
        "delete the row: a missing row counts as a gap"
    )


def test_time_that_repeats_or_goes_back(lines, refused):
    repeated = [*lines[:30], lines[29], *lines[30:]]
    assert (
        ", row 31, column t[s]: expected a time after 0.028 s, found 0.028 s, the same time again"
        in refused(repeated)
    )
    back = [*lines[:30], lines[20], *lines[30:]]
    assert "found 0.019 s, a step back" in refused(back)


def test_milliseconds_in_place_of_seconds(lines, refused):
    message = refused(with_column(lines, "t[s]", lambda t: 1e3 * t))
    assert ", row 3, column t[s]: expected rows 0.1 to 10.5 ms apart, found 1000 ms" in message
    assert "convert the times if they are milliseconds" in message


@pytest.mark.parametrize(
    ("name", "factor", "says"),
    [
        ("q_swing_knee[rad]", 180 / np.pi, "expected -0.1 to 1.6 rad"),
        ("q_stance_hip[rad]", 1e3, "expected -1.7 to 1.7 rad"),
        ("dq_stance_knee[rad/s]", 1e3, "expected -40 to 40 rad/s"),
        ("dq_stance_knee[rad/s]", 10.0, "expected the rate at which the angle changes"),
        ("dq_stance_knee[rad/s]", -1.0, "found angles that change -"),
        ("dq_swing_hip[rad/s]", 1e-3, "expected the rate at which the angle changes"),
        ("dqd_swing_hip[rad/s]", 1e-3, "found angles that change 1e+03 times as fast"),
        ("tau_stance_hip[N m]", 1e3, "expected -410 to 410 N m"),
        ("z1[m]", 1e3, "z1[m]: expected"),
        ("z2[kg m^2/s]", 1e3, "z2[kg m^2/s]: expected"),
        ("z2[kg m^2/s]", -1.0, "z2[kg m^2/s]: expected z of robot amber3m within"),
        ("dpitch[rad/s]", 1e3, "dpitch[rad/s]: expected -40 to 40 rad/s"),
    ],
)
def test_units_that_are_off(lines, refused, name, factor, says):
    message = refused(with_column(lines, name, lambda value: factor * value))
    assert ", row " in message
    assert says in message
    assert name in message


def test_torques_in_kilonewton_metres(lines, refused):
    for name in lines[0].split(","):
        if name.startswith("tau_"):
            lines = with_column(lines, name, lambda torque: 1e-3 * torque)
    assert "column tau_stance_knee[N m]: expected torques of more than" in refused(lines)


def test_a_pitch_that_the_joints_do_not_tell(lines, refused):
    message = refused(with_column(lines, "pitch[rad]", lambda pitch: 0.2 + pitch))
    assert "column pitch[rad]: expected the sum of the coordinates up to the torso" in message
    assert "differs by 0.2 rad" in message


def test_two_recordings_in_one_file(lines, refused):
    message = refused(with_column(lines, "t[s]", lambda t: t + 61.0, first=300))
    assert ", row 301, column t[s]: expected a time at most 60 s after" in message
    assert "split the file" in message


def test_rows_too_rare_to_learn_from(lines, refused):
    message = refused([lines[0], *lines[1::12]])
    assert "expected rows 0.1 to 10.5 ms apart, found 12 ms" in message


def test_one_row_out_of_range_does_not_hide_the_rates_of_the_others(lines, amber, tmp_path):
    path = tmp_path / "walk.csv"
    path.write_text("\n".join(with_cell(lines, 400, "dq_swing_hip[rad/s]", "1e300")) + "\n")
    assert logs.read(path, amber).left_out["outliers"] == 1


@pytest.mark.parametrize("kind", ["", "d"])
def test_angles_that_hardly_move_for_their_rates(lines, refused, kind):
    angle, rate = (f"{name}{kind}_swing_hip" for name in ("q", "dq"))
    message = refused(with_column(lines, f"{angle}[rad]", lambda q: 1e-3 * q))
    assert f"column {rate}[rad/s]: expected the rate at which the angle changes" in message


def test_joints_that_stay_outside_their_range(lines, refused):
    message = refused(with_column(lines, "q_swing_knee[rad]", lambda q: q + 1.5, first=300))
    assert ", row 301, column q_swing_knee[rad]: expected -0.1 to 1.6 rad, found" in message
    assert "give a log of this robot" in message


def test_a_log_of_a_robot_with_other_joints(lines, refused):
    rabbit = load_robot("rabbit")
    if rabbit.joint_names == load_robot("amber3m").joint_names:
        # Only the numbers tell them apart.
        assert "expected z of robot rabbit" in refused(lines, rabbit)
    else:
        assert "of robot rabbit, found none" in refused(lines, rabbit)


def test_a_log_of_a_robot_with_other_masses(lines, refused):
    """Joints and lengths are the same; 13 kg sit 7 cm higher."""
    message = refused(lines, load_robot("amber3m-paper"))
    assert "column z2[kg m^2/s]: expected z of robot amber3m-paper within" in message


def test_a_log_in_which_nobody_steps(log, lines, refused):
    first = int(np.flatnonzero(np.diff(log.stance))[0])
    assert "expected at least one complete stride, found leg 0 standing throughout" in refused(
        lines[:first]
    )


@pytest.mark.parametrize("kept", [1, 2])
def test_a_log_that_has_hardly_begun(lines, refused, kept):
    assert f"expected a walk, found {kept - 1} rows: walk longer" in refused(lines[:kept])


def test_an_empty_file_and_a_missing_one(refused, amber, tmp_path):
    assert "expected a header and rows, found an empty file" in refused([""])
    with pytest.raises(InputError, match="expected a CSV file of a walk, found none"):
        logs.read(tmp_path / "none.csv", amber)
    (tmp_path / "binary.csv").write_bytes(bytes(range(256)))
    with pytest.raises(InputError, match="expected a CSV file of a walk"):
        logs.read(tmp_path / "binary.csv", amber)
    with pytest.raises(InputError, match="expected a CSV file of a walk"):
        logs.read(tmp_path, amber)


def test_no_file_at_all(amber):
    with pytest.raises(InputError, match="expected at least one CSV or MCAP file"):
        logs.read_all([], amber)


def test_a_walk_given_twice(lines, amber, tmp_path):
    """Its strides would be on both sides of the split, under whatever name and rounding."""
    files = [tmp_path / "a.csv", tmp_path / "b.csv"]
    again = with_column(lines, "q_swing_hip[rad]", lambda q: q + 1e-13)
    for file, each in zip(files, (lines, again), strict=True):
        file.write_text("\n".join(each) + "\n")
    with pytest.raises(InputError, match=r"b\.csv: expected every walk once, .*a\.csv"):
        logs.read_all(files, amber)
