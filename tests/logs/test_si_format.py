import numpy as np
import pytest

from neuralgaits import logs
from neuralgaits.errors import InputError

ARRAYS = ("t", "stance", "q", "dq", "qd", "dqd", "tau", "pitch", "dpitch", "z", "z2_plant")


@pytest.fixture(scope="module")
def file(log, tmp_path_factory):
    path = tmp_path_factory.mktemp("logs") / "walk.csv"
    logs.write(path, log)
    return path


def test_a_log_reads_back_exactly(amber, log, file):
    again, left_out = logs.read(file, amber)
    assert left_out == {"missing": 0, "outliers": 0}
    assert again.joint_names == log.joint_names
    assert again.source == str(file)
    for name in ARRAYS:
        np.testing.assert_array_equal(getattr(again, name), getattr(log, name))
    np.testing.assert_array_equal(again.rows, np.arange(2, len(log) + 2))


def test_the_header_is_the_agreed_one(amber, file):
    names, actuated = amber.joint_names, amber.joint_names[1:]
    agreed = [
        "t[s]",
        "stance[-]",
        *(f"q_{name}[rad]" for name in names),
        *(f"dq_{name}[rad/s]" for name in names),
        *(f"qd_{name}[rad]" for name in actuated),
        *(f"dqd_{name}[rad/s]" for name in actuated),
        *(f"tau_{name}[N m]" for name in actuated),
        *("z1[m]", "z2[kg m^2/s]", "pitch[rad]", "dpitch[rad/s]"),
    ]
    header = file.read_text().splitlines()[0].split(",")
    assert header[: len(agreed)] == agreed
    assert header[len(agreed) :] == ["z2_plant[kg m^2/s]"]


def test_columns_may_stand_in_any_order_beside_others(amber, log, file, tmp_path):
    rows = [line.split(",") for line in file.read_text().splitlines()]
    order = np.random.default_rng(0).permutation(len(rows[0]))
    shuffled = [
        ",".join([*(row[i] for i in order), "heat[K]" if k == 0 else "300"])
        for k, row in enumerate(rows)
    ]
    (tmp_path / "other.csv").write_text("\r\n".join(shuffled) + "\r\n\r\n")
    again = logs.read(tmp_path / "other.csv", amber).log
    for name in ARRAYS:
        np.testing.assert_array_equal(getattr(again, name), getattr(log, name))


def test_what_is_logged_is_what_happened(amber, log):
    np.testing.assert_allclose(np.diff(log.t), 1e-3, rtol=1e-9)
    np.testing.assert_allclose(log.z[:, 0], log.q @ amber.hip_gradient, atol=1e-12)
    np.testing.assert_allclose(log.pitch, log.q[:, :3].sum(axis=1), atol=1e-12)
    np.testing.assert_allclose(log.z[:, 1], log.z2_plant, rtol=1e-12)
    # Between touchdowns rates are the slopes of positions.
    stays = np.flatnonzero(np.diff(log.stance) == 0)[300:500]
    slope = (log.q[stays + 1] - log.q[stays]) / 1e-3
    np.testing.assert_allclose(slope, 0.5 * (log.dq[stays + 1] + log.dq[stays]), atol=5e-3)
    assert set(log.stance) == {0, 1}


def test_a_log_without_z_is_not_written(log, tmp_path):
    from dataclasses import replace

    with pytest.raises(InputError, match="expected z beside q and dq"):
        logs.write(tmp_path / "walk.csv", replace(log, z=None))
    assert not list(tmp_path.iterdir())
