"""A file of columns that cannot be meant is refused in one line: file, key, remedy."""

import numpy as np
import pytest

from neuralgaits.errors import InputError
from neuralgaits.logs.formats.column_file import joints_of, read_columns
from neuralgaits.logs.formats.units import ANGLE, FORCE, RATE, SPEED, TIME, TORQUE
from neuralgaits.robots import load_robot
from support.own_columns import RATES, SHORT


@pytest.fixture
def refused(amber, tmp_path):
    def refuse(text):
        path = tmp_path / "columns.toml"
        path.write_text(text)
        with pytest.raises(InputError) as refusal:
            read_columns(path, amber)
        message = str(refusal.value)
        assert "\n" not in message
        assert message.startswith(f"columns {path}")
        return message.removeprefix(f"columns {path}")

    return refuse


def test_what_a_file_says(amber, tmp_path):
    path = tmp_path / "columns.toml"
    path.write_text(SHORT + RATES)
    found = read_columns(path, amber)
    source = found.sources["joints.hip_right"]
    assert (source.column, source.sign, source.offset) == ("hip_r", -1.0, -12.5)
    # What it shows at zero, and a degree further.
    np.testing.assert_allclose(source.si(np.array([-12.5, -11.5])), [0.0, -np.pi / 180.0])
    assert found.has("rates") and not found.has("torques") and not found.has("pitch_rate")


def test_joints_are_those_of_the_robot_file(amber):
    assert joints_of(amber) == ("hip_left", "knee_left", "hip_right", "knee_right")
    assert len(joints_of(load_robot("rabbit"))) == 4


def test_units_are_those_of_si():
    assert [d.si for d in (TIME, ANGLE, RATE, TORQUE, SPEED, FORCE)] == [
        *("s", "rad", "rad/s", "N m", "m/s", "N")
    ]
    for dimension in (TIME, ANGLE, RATE, TORQUE, SPEED, FORCE):
        assert dimension.units[dimension.si] == 1.0
    assert 180.0 * ANGLE.units["deg"] == pytest.approx(np.pi)
    assert 60.0 * RATE.units["rpm"] == pytest.approx(2.0 * np.pi)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        (
            'unit = "ms"',
            'unit = "msec"',
            "time: expected the unit of a time (s, ms, us, ns), found",
        ),
        ('unit = "ms"', 'unit = "msec"', 'write unit = "ms"'),
        (', unit = "ms"', "", 'found none: write unit = "s"'),
        ('"t_ms", unit = "ms"', '"t_ms", unti = "ms"', "found 'unti': write unit"),
        ('{column = "t_ms", unit = "ms"}', '"t_ms"', 'time: expected {column = "NAME", unit'),
        ('column = "t_ms"', "column = 3", "expected column = the name in the log's first row"),
        ("time =", "tiem =", "tiem: expected one of time, pitch, pitch_rate, joints, "),
        ("time =", "tiem =", "found 'tiem': write time"),
        ("[joints]", "[joint]", "found 'joint': write joints"),
        ("knee_left", "left_knee", "joints.left_knee: expected a joint of robot amber3m (hip_left"),
        ("knee_left", "kneeleft", "write knee_left"),
        ("foot_left", "foot", "contact.foot: expected a foot of robot amber3m (foot_left, "),
        ("sign = -1", "sign = 2", "joints.hip_left: expected sign 1 or -1, found 2"),
        ("sign = -1", "sign = true", "expected sign 1 or -1, found True"),
        (
            "offset = 3.0",
            'offset = "3"',
            "joints.knee_left: expected offset = what the",
        ),
        (
            "offset = 3.0",
            "offset = nan",
            "the column shows at zero, found nan",
        ),
        ('{column = "contact_l"}', '{column = "contact_l", unit = "kg"}', "leave it out for 0 and"),
        (
            'foot_left = {column = "contact_l"}\n',
            "",
            "found none for contact.foot_left: add a",
        ),
        ("[contact]", "[contact]\npitch_rate = 1", "put it above the line [contact]"),
        ("[joints]", "joints = 3", "joints: expected a table, found 3: begin it with a line"),
        ('"imu_pitch"', "imu_pitch", "found a line that is no TOML (Invalid value (at line 2, col"),
    ],
)
def test_a_line_that_cannot_be_meant(refused, old, new, says):
    assert old in SHORT
    text = SHORT.replace(old, new, 1)
    if new == "joints = 3":
        text = text.split("[contact]")[0].split("joints = 3")[0] + new + "\n"
    assert says in refused(text)


def test_an_empty_file(refused):
    message = refused("")
    assert "found none for time, pitch, joints.hip_left, joints.knee_left" in message
    assert message.endswith(
        'add a line such as time = {column = "NAME", unit = "ms"}; see the page \'Your own logs\''
    )


def test_a_table_that_is_begun_is_filled(refused):
    one = '[torques]\nhip_left = {column = "u", unit = "N m"}\n'
    assert "found none for torques.knee_left, torques.hip_right" in refused(SHORT + one)
    rates = RATES.replace("[rates]", "[desired_rates]")
    assert "found none for desired.hip_left" in refused(SHORT + rates)


def test_a_file_that_is_not_there(amber, tmp_path):
    said = r"none that can be read \(No such file.*the page 'Your own logs' has"
    with pytest.raises(InputError, match=said):
        read_columns(tmp_path / "columns.toml", amber)
    (tmp_path / "bytes.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match=r"expected a TOML file"):
        read_columns(tmp_path / "bytes.toml", amber)
