import numpy as np
import pytest

from neuralgaits.errors import InputError
from neuralgaits.simulation import logs
from neuralgaits.simulation.walk import walk


@pytest.fixture(scope="module")
def recorded(amber, slow):
    policy, x = slow
    return walk(amber, policy, x[None], controller="fblin", steps=3, record=True)


def test_a_log_reads_back_exactly(amber, recorded, tmp_path):
    log = logs.of_record(amber, recorded.episodes.record)
    logs.write(tmp_path / "walk.csv", log)
    again = logs.read(tmp_path / "walk.csv")
    assert dict(again.units) == dict(log.units)
    for name, values in log.columns.items():
        np.testing.assert_array_equal(again.columns[name], values)


def test_the_header_is_the_agreed_one(amber, recorded, tmp_path):
    logs.write(tmp_path / "walk.csv", logs.of_record(amber, recorded.episodes.record))
    header = (tmp_path / "walk.csv").read_text().splitlines()[0].split(",")
    assert header[:2] == ["t[s]", "stance[-]"]
    names, actuated = amber.joint_names, amber.joint_names[1:]
    for column in (
        *(f"q_{name}[rad]" for name in names),
        *(f"dq_{name}[rad/s]" for name in names),
        *(f"qd_{name}[rad]" for name in actuated),
        *(f"dqd_{name}[rad/s]" for name in actuated),
        *(f"tau_{name}[N m]" for name in actuated),
        *("z1[m]", "z2[kg m^2/s]", "pitch[rad]", "dpitch[rad/s]"),
    ):
        assert column in header


def test_what_is_logged_is_what_happened(amber, recorded):
    log = logs.of_record(amber, recorded.episodes.record)
    q, dq = log.group("q_", "rad"), log.group("dq_", "rad/s")
    np.testing.assert_allclose(np.diff(log.columns["t"]), 1e-3, rtol=1e-9)
    np.testing.assert_allclose(log.columns["z1"], q @ amber.hip_gradient, atol=1e-12)
    np.testing.assert_allclose(log.columns["pitch"], q[:, :3].sum(axis=1), atol=1e-12)
    np.testing.assert_allclose(log.columns["z2"], log.columns["z2_plant"], rtol=1e-12)
    # Between touchdowns rates are the slopes of positions.
    stays = np.flatnonzero(np.diff(log.columns["stance"]) == 0)[300:500]
    slope = (q[stays + 1] - q[stays]) / 1e-3
    np.testing.assert_allclose(slope, 0.5 * (dq[stays + 1] + dq[stays]), atol=5e-3)
    assert set(log.columns["stance"]) == {0.0, 1.0}


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "line 1: expected columns name[unit]"),
        ("t,stance\n0,1\n", "line 1: expected columns name[unit]"),
        ("t[s],t[s]\n0,1\n", "same name"),
        ("t[s],z1[m]\n0,1\n0\n", "line 3: expected 2 numbers"),
        ("t[s],z1[m]\n0,one\n", "line 2: expected 2 numbers, found '0,one'"),
    ],
)
def test_a_file_that_is_no_log_is_refused(tmp_path, text, says):
    path = tmp_path / "bad.csv"
    path.write_text(text)
    with pytest.raises(InputError) as refusal:
        logs.read(path)
    assert says in str(refusal.value)
    assert str(path) in str(refusal.value)


def test_a_log_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(InputError, match="expected a CSV file"):
        logs.read(tmp_path / "none.csv")
