"""Signs that keep every angle in its range: the balance of momentum finds them."""

from dataclasses import replace

import numpy as np
import pytest

from neuralgaits import logs
from neuralgaits.errors import InputError
from neuralgaits.logs.momentum_balance import momentum_misfit
from neuralgaits.robots import load_robot
from support import own_columns

TURNED = {"imu_pitch": ("pitch", "-1"), "hip_l": ("joints.hip_left", "1")}


@pytest.fixture(scope="module")
def own(amber, log):
    return own_columns.values(amber, log.only(np.arange(len(log)) < 4000))


@pytest.fixture
def read(amber, zd, tmp_path):
    """A reader of columns."""
    (tmp_path / "columns.toml").write_text(own_columns.SHORT)

    def of(columns, policy=zd.policy):
        path = own_columns.write(tmp_path / "own.csv", columns)
        return logs.read(path, amber, columns=tmp_path / "columns.toml", policy=policy)

    return of


def turn(own, name):
    """The log of a robot whose encoder counts the other way about its zero."""
    return {name: 2.0 * own_columns.OFFSETS.get(name, 0.0) - own[name]}


@pytest.mark.parametrize("name", TURNED)
def test_a_wrong_sign_is_named_with_its_column(own, read, name):
    key, sign = TURNED[name]
    with pytest.raises(InputError) as error:
        read(own | turn(own, name))
    message = str(error.value)
    assert f"column {name}: expected angles with which the momentum" in message
    assert f"write sign = {sign} for {key} in " in message and "\n" not in message


def test_where_contacts_show_no_step_feet_still_land_in_the_air(own, read):
    """With this hip, the stance leg changes once: neither phase is a step."""
    later = {name: values[630:] for name, values in own.items()}
    with pytest.raises(
        InputError, match=r"found \d+ mm, and .* write sign = 1 for joints.hip_left"
    ):
        read(later | turn(later, "hip_l"))


def test_both_hips_of_a_wrong_sign_are_refused(own, read):
    with pytest.raises(InputError) as error:
        read(own | turn(own, "hip_l") | turn(own, "hip_r"))
    message = str(error.value)
    assert "column hip_l and hip_r" in message
    assert "sign = 1 for joints.hip_left and sign = 1 for joints.hip_right" in message


def test_the_right_signs_are_read_with_noise_and_a_small_wrong_zero(own, read):
    rng = np.random.default_rng(0)
    angles = {"imu_pitch", *own_columns.JOINTS.values()}
    noisy = {
        name: values + np.rad2deg(2e-3) * rng.standard_normal(len(values))
        for name, values in own.items()
        if name in angles
    }
    assert len(read(own | noisy).log) > 3000
    # 2 degrees of the pitch are no matter of signs.
    assert len(read(own | {"imu_pitch": own["imu_pitch"] + 2.0}).log) > 3000


def test_masses_and_joints_of_another_robot_are_no_matter_of_signs(amber, log):
    """The misfit of a walk is small, of models that are off by a tenth as well."""
    heavier = replace(amber, mass_moment=1.1 * np.asarray(amber.mass_moment))
    found = [momentum_misfit(log, robot) for robot in (amber, heavier)]
    assert None not in found
    assert np.all(np.array(found, dtype=float) < [0.03, 0.3])
    assert momentum_misfit(log, load_robot("amber3m-feet")) is None
    assert momentum_misfit(log.only(np.arange(len(log)) < 5), amber) is None


def test_a_log_of_standing_is_not_judged(amber, log):
    still = np.repeat(log.q[:1], len(log), axis=0)
    held = replace(log, q=still, dq=np.zeros_like(still), stance=np.zeros_like(log.stance))
    held = replace(held, t=2.0 * log.t)
    assert momentum_misfit(held, amber) is None
