"""A robot's own log, its columns named by a file, becomes the table that the known formats give."""

import jax
import mujoco
import numpy as np
import pytest

from neuralgaits import logs
from neuralgaits.control.measurement import standing_hip_velocity
from neuralgaits.control.momentum import momentum_about_foot
from neuralgaits.errors import InputError
from neuralgaits.logs.formats import mapped as mapped_format
from neuralgaits.logs.formats.column_file import joints_of, read_columns
from neuralgaits.logs.formats.sheet import text_of
from neuralgaits.robots.mjcf.loader import robot_from_text
from neuralgaits.robots.mjcf_state import StateMap
from support import own_columns
from support.random_biped import random_biped

RATED = tuple(own_columns.JOINTS.values())
TORQUES = "".join(
    f'{joint} = {{column = "u_{name}", unit = "mN m", sign = {own_columns.SIGNS.get(name, 1)}}}\n'
    for joint, name in own_columns.JOINTS.items()
)
DESIRED = own_columns.SHORT[own_columns.SHORT.index("hip_left") : own_columns.SHORT.index("[con")]
FULL = (
    'pitch_rate = {column = "gyro", unit = "rad/s"}\n'
    + own_columns.SHORT
    + own_columns.RATES
    + f"[torques]\n{TORQUES}"
    + "[desired]\n"
    + DESIRED.replace('"hip', '"ask_hip').replace('"knee', '"ask_knee')
    + "[desired_rates]\n"
    + own_columns.RATES.removeprefix("[rates]\n")
    .replace('"d', '"ask_d')
    .replace('"ask_deg', '"deg')
)


def in_both(log, other):
    """Rows of a log that another has, too: milliseconds and back rounds times."""
    return np.isin(log.t.round(6), other.t.round(6))


def settled(log, robot):
    """Rows that are learned from."""
    times = np.concatenate([stride.t for stride in logs.cut([log], robot).strides])
    return np.isin(log.t.round(6), times.round(6))


@pytest.fixture(scope="module")
def columns(amber, log):
    return own_columns.values(amber, log)


@pytest.fixture(scope="module")
def short(tmp_path_factory):
    path = tmp_path_factory.mktemp("columns") / "columns.toml"
    path.write_text(own_columns.SHORT)
    return path


@pytest.fixture(scope="module")
def encoders(amber, zd, columns, short):
    """The log of encoders, pitch and contact alone, as it is read."""
    path = own_columns.write(short.parent / "encoders.csv", columns)
    return logs.read(path, amber, columns=short, policy=zd.policy).log


def test_a_file_of_fifteen_lines_is_enough():
    assert len(own_columns.SHORT.splitlines()) <= 15


def test_all_that_is_in_a_file_is_read_as_it_was(amber, log, columns, tmp_path):
    """Degrees, milliseconds, millinewton metres, turned signs, moved zeros: the same table."""
    full = dict(columns)
    for by_leg in (0, 1):
        here = log.stance == by_leg
        order = [("knee_l", "hip_l", "hip_r", "knee_r"), ("knee_r", "hip_r", "hip_l", "knee_l")]
        for i, name in enumerate(order[by_leg]):
            sign = own_columns.SIGNS.get(name, 1) * file_sign(amber, name)
            zero = own_columns.OFFSETS.get(name, 0.0)
            for key, values, scale, moved in (
                (f"u_{name}", log.tau, 1e3, 0.0),
                (f"ask_{name}", log.qd, own_columns.DEGREE, zero),
                (f"ask_d{name}", log.dqd, own_columns.DEGREE, 0.0),
            ):
                column = full.setdefault(key, np.zeros(len(log)))
                column[here] = sign * scale * values[here, i] + moved
    full["note"] = np.zeros(len(log))
    path = own_columns.write(tmp_path / "own.csv", full, tuple(full))
    text = path.read_text().replace(",0.0\n", ",lost\n")
    path.write_text(text)
    (tmp_path / "columns.toml").write_text(FULL)
    again, left_out = logs.read(path, amber, columns=tmp_path / "columns.toml")
    assert left_out == {"missing": 0, "outliers": 0}
    kept = in_both(log, again)
    assert np.count_nonzero(~kept) <= 1  # The last row is no touchdown's second.
    np.testing.assert_array_equal(again.stance, log.stance[kept])
    for name in ("t", "q", "dq", "qd", "dqd", "tau", "pitch", "dpitch"):
        np.testing.assert_allclose(getattr(again, name), getattr(log, name)[kept], atol=1e-9)
    assert again.computed == (
        "stance leg from the contacts",
        "z from angles and rates, without the speed of the stance foot",
    )


def file_sign(robot, column):
    """Of a joint's coordinate by that of the file."""
    layout = robot.layout
    joint = next(joint for joint, name in own_columns.JOINTS.items() if name == column)
    return next(
        sign
        for joints, signs in zip(layout.leg_joints, layout.leg_joint_signs, strict=True)
        for name, sign in zip(joints, signs, strict=True)
        if name == joint
    )


def test_angles_and_stance_of_a_log_of_encoders_are_exact(log, encoders):
    kept = in_both(log, encoders)
    assert np.count_nonzero(~kept) <= 1
    np.testing.assert_array_equal(encoders.stance, log.stance[kept])
    np.testing.assert_allclose(encoders.q, log.q[kept], atol=1e-12)
    np.testing.assert_allclose(encoders.z[:, 0], log.z[kept, 0], atol=1e-12)
    assert not encoders.tau.any()


def test_rates_and_momentum_of_a_log_of_encoders(amber, log, encoders):
    """What the rows that are learned from are off by; docs/logs.md has the numbers."""
    true = log.only(in_both(log, encoders))
    rows = settled(true, amber)
    assert np.sqrt(np.mean((encoders.dq - true.dq)[rows] ** 2)) < 0.02
    off = (encoders.z - true.z)[rows, 1]
    usual = np.median(true.z[:, 1])
    assert np.sqrt(np.mean(off**2)) < 0.01 * usual
    assert np.abs(off).max() < 0.03 * usual


def test_what_was_asked_is_the_policy_s(amber, log, encoders):
    true = log.only(in_both(log, encoders))
    rows = settled(true, amber)
    assert np.abs(encoders.qd - true.qd)[rows].max() < 0.01
    assert np.sqrt(np.mean((encoders.dqd - true.dqd)[rows] ** 2)) < 0.1


def test_the_strides_are_the_same(amber, log, encoders):
    own, true = (logs.cut([each], amber).strides for each in (encoders, log))
    assert len(own) == len(true)
    for one, other in zip(own[:-1], true[:-1], strict=True):
        np.testing.assert_allclose(one.t, other.t, atol=1e-9)
        assert one.leg == other.leg


def test_it_can_be_written_in_the_project_s_own_format(amber, encoders, tmp_path):
    logs.write(tmp_path / "si.csv", encoders)
    again = logs.read(tmp_path / "si.csv", amber).log
    np.testing.assert_array_equal(again.q, encoders.q)
    np.testing.assert_array_equal(again.z, encoders.z)


def test_the_speed_of_the_hip_tells_that_of_the_foot(amber, zd, log, columns, tmp_path):
    """With it z2 is the momentum about a foot that creeps while it rolls."""
    creep = np.array([0.004, -0.002])
    q, dq = log.q, log.dq
    hip = (
        np.asarray(jax.jit(jax.vmap(lambda a, b: standing_hip_velocity(amber, a, b)))(q, dq))
        + creep
    )
    momentum = jax.jit(jax.vmap(lambda a, b: momentum_about_foot(amber, a, b, creep)))
    known = {**columns, "vx": 1e3 * hip[:, 0], "vz": 1e3 * hip[:, 1]}
    names = [*own_columns.COLUMNS, "vx", "vz", *(f"d{name}" for name in RATED), "gyro"]
    path = own_columns.write(tmp_path / "own.csv", known, names)
    (tmp_path / "columns.toml").write_text(
        'pitch_rate = {column = "gyro", unit = "rad/s"}\n'
        + own_columns.SHORT
        + own_columns.RATES
        + '[hip_velocity]\nx = {column = "vx", unit = "mm/s"}\nz = {column = "vz", unit = "mm/s"}\n'
    )
    read = logs.read(path, amber, columns=tmp_path / "columns.toml", policy=zd.policy).log
    kept = in_both(log, read)
    assert read.z is not None
    np.testing.assert_allclose(read.z[:, 1], np.asarray(momentum(q, dq))[kept], atol=1e-8)


def test_one_glitch_of_an_encoder_spoils_one_row(amber, zd, columns, encoders, short, tmp_path):
    glitch = {**columns, "knee_l": columns["knee_l"].copy()}
    glitch["knee_l"][400] += 20.0
    path = own_columns.write(tmp_path / "own.csv", glitch)
    read, left_out = logs.read(path, amber, columns=short, policy=zd.policy)
    assert left_out == {"missing": 0, "outliers": 1}
    rest = in_both(encoders, read)
    np.testing.assert_allclose(read.dq, encoders.dq[rest], atol=0.02)


def test_forces_in_place_of_contacts(amber, zd, columns, encoders, short, tmp_path):
    pushed = dict(columns)
    for name in ("contact_l", "contact_r"):
        pushed[name] = np.where(columns[name] == 1, 150.0, 2.0)
    path = own_columns.write(tmp_path / "own.csv", pushed)
    forces = own_columns.SHORT.replace('"contact_l"', '"contact_l", unit = "N"')
    forces = forces.replace('"contact_r"', '"contact_r", unit = "N"')
    (tmp_path / "columns.toml").write_text(forces)
    read = logs.read(path, amber, columns=tmp_path / "columns.toml", policy=zd.policy).log
    np.testing.assert_array_equal(read.stance, encoders.stance)


@pytest.fixture
def refused(amber, zd, short, tmp_path):
    """The line with which such columns are refused."""

    def refuse(columns, names=own_columns.COLUMNS, edit=lambda text: text, **settings):
        path = own_columns.write(tmp_path / "own.csv", columns, names)
        path.write_text(edit(path.read_text()))
        settings = {"policy": zd.policy, **settings}
        with pytest.raises(InputError) as refusal:
            logs.read(path, amber, columns=short, **settings)
        message = str(refusal.value)
        assert "\n" not in message
        assert message.startswith(f"log {path}")
        return message.removeprefix(f"log {path}")

    return refuse


def test_a_column_that_is_missing(columns, refused):
    message = refused({**columns, "kneel": columns["knee_l"]}, ("t_ms", "hip_l", "kneel"))
    assert ", row 1: expected the columns imu_pitch, knee_l, hip_r, knee_r, contact_l, " in message
    message = refused(
        {**columns, "Knee_l": columns["knee_l"]},
        tuple(name.replace("knee_l", "Knee_l") for name in own_columns.COLUMNS),
    )
    assert "write 'Knee_l' for 'knee_l' in " in message


def test_semicolons(columns, refused):
    message = refused(columns, edit=lambda text: text.replace(",", ";"))
    assert message.endswith("separate columns by commas")


def test_a_header_that_is_missing(columns, refused):
    message = refused(columns, edit=lambda text: text.split("\n", 1)[1])
    assert "found 8 columns without names" in message


@pytest.mark.parametrize("cell", ["nan", "", "lost"])
def test_a_cell_that_is_no_number(columns, refused, cell):
    def edit(text):
        lines = text.splitlines()
        cells = lines[20].split(",")
        cells[2] = cell
        lines[20] = ",".join(cells)
        return "\n".join(lines)

    message = refused(columns, edit=edit)
    assert f", row 21, column knee_l: expected a finite number, found {cell!r}" in message


def test_a_row_of_another_width(columns, refused):
    message = refused(columns, edit=lambda text: text.removesuffix(",0\n").removesuffix(",1\n"))
    assert "expected 8 columns, found 7" in message


def test_times_that_go_back(columns, refused):
    t = columns["t_ms"].copy()
    t[100] = t[50]
    assert ", row 102, column t_ms: expected a time after" in refused({**columns, "t_ms": t})


def test_times_of_another_unit(columns, refused):
    message = refused({**columns, "t_ms": 1e-3 * columns["t_ms"]})
    assert "column t_ms: expected rows 0.1 to 10.5 ms apart, found 0.001 ms" in message


def test_angles_in_radians_said_to_be_degrees(columns, refused):
    small = {name: columns[name] / own_columns.DEGREE for name in own_columns.JOINTS.values()}
    message = refused({**columns, **small})
    assert "mend them there)" in message


def test_a_sign_that_is_turned(columns, refused):
    message = refused({**columns, "knee_r": -columns["knee_r"]})
    assert "column knee_r: expected -0.1 to 1.6 rad" in message
    assert "(these are numbers after unit, sign and offset of " in message


def test_contacts_that_are_exchanged(columns, refused):
    swapped = {"contact_l": columns["contact_r"], "contact_r": columns["contact_l"]}
    message = refused({**columns, **swapped})
    assert "contact_l and contact_r: expected the foot that lands to be the one in front" in message


def test_contacts_that_never_change(columns, refused):
    both = np.ones(len(columns["t_ms"]), dtype=int)
    message = refused({**columns, "contact_l": both, "contact_r": both})
    assert "expected rows in which one foot alone is on the ground, found none" in message


def test_contacts_that_are_forces(columns, refused):
    message = refused({**columns, "contact_l": 140 * columns["contact_l"]})
    assert 'column contact_l: expected 0 or 1, found 140: write unit = "N" for contact.foot_l' in (
        message
    )


def test_desired_outputs_that_nobody_knows(columns, refused):
    message = refused(columns, policy=None)
    assert "expected desired joint angles, found no table [desired] in" in message


@pytest.mark.parametrize("torso", [False, True])
@pytest.mark.parametrize("leg", [0, 1])
def test_the_joints_of_every_biped_are_found(torso, leg, tmp_path):
    """A biped without a torso has one hip, which both legs share with opposite signs."""
    robot = robot_from_text(random_biped(7, 2, torso=torso), "random")
    rng, rows, layout = np.random.default_rng(3), 20, robot.layout
    q, dq = rng.uniform(-0.4, 0.4, (2, rows, robot.n))
    model = mujoco.MjModel.from_xml_string(layout.xml)
    qpos, qvel = StateMap.build(model, layout).to_mjcf(q, dq, np.full(rows, leg))
    columns, lines = {"t": 1e-3 * np.arange(rows)}, ['time = {column = "t", unit = "s"}']
    joints = joints_of(robot)
    for name in (layout.root_joints[2], *joints):
        at = model.joint(name).qposadr[0]
        columns |= {name: qpos[:, at], f"d_{name}": qvel[:, at]}
    columns |= {f"on_{foot}": np.full(rows, int(leg == i)) for i, foot in enumerate(layout.feet)}
    pitch = layout.root_joints[2]
    lines += [f'pitch = {{column = "{pitch}", unit = "rad"}}']
    lines += [f'pitch_rate = {{column = "d_{pitch}", unit = "rad/s"}}']
    for table, column, unit in (
        ("joints", "{}", "rad"),
        ("desired", "{}", "rad"),
        ("rates", "d_{}", "rad/s"),
        ("torques", "d_{}", "N m"),
    ):
        lines += [f"[{table}]"]
        lines += [
            f'{name} = {{column = "{column.format(name)}", unit = "{unit}"}}' for name in joints
        ]
    lines += ["[contact]", *(f'{foot} = {{column = "on_{foot}"}}' for foot in layout.feet)]
    (tmp_path / "columns.toml").write_text("\n".join(lines))
    path = own_columns.write(tmp_path / "own.csv", columns, tuple(columns))
    found = read_columns(tmp_path / "columns.toml", robot)
    log, labels = mapped_format.read(text_of(path), robot, found, None)
    assert set(log.stance) == {leg}
    np.testing.assert_allclose(log.q, q, atol=1e-12)
    np.testing.assert_allclose(log.dq, dq, atol=1e-12)
    np.testing.assert_allclose(log.qd, q[:, 1:], atol=1e-12)
    # Torque times rate is power, whatever the sign of a joint: here the two are equal.
    np.testing.assert_allclose(log.tau, dq[:, 1:], atol=1e-12)
    assert labels[f"q_{robot.joint_names[1]}"][leg] == layout.leg_joints[leg][0]
