from dataclasses import replace

import equinox as eqx
import numpy as np
import pytest

from neuralgaits import logs
from neuralgaits.errors import InputError
from neuralgaits.logs.strides import SETTLING_S
from neuralgaits.logs.zero_states import output_states, zero_states

STEPS = 8
FIELDS = ("t", "stance", "q", "dq", "qd", "dqd", "tau", "pitch", "dpitch", "z", "z2_plant", "rows")


@pytest.fixture(scope="module")
def strides(amber, log):
    return logs.cut([log], amber).strides


def repeated(strides, count):
    """Strides enough to split."""
    return [replace(strides[i % len(strides)], number=i) for i in range(count)]


def test_there_is_a_stride_for_every_step(amber, log):
    found, left_out = logs.cut([log], amber)
    assert len(found) == STEPS
    assert [stride.leg for stride in found] == [0, 1] * (STEPS // 2)
    assert [stride.number for stride in found] == list(range(STEPS))
    assert sum(stride.t.size for stride in found) + sum(left_out.values()) == len(log)
    # Two falls or walks are two logs; numbers start again.
    both = logs.cut([log, replace(log, source="another")], amber).strides
    assert [stride.source for stride in both] == ["episode 0"] * STEPS + ["another"] * STEPS


def test_the_first_20_ms_after_each_touchdown_are_left_out(log, strides):
    touchdowns = log.t[np.flatnonzero(np.diff(log.stance)) + 1]
    for stride in strides[1:]:
        since = stride.t[0] - touchdowns[touchdowns <= stride.t[0]].max()
        assert since == pytest.approx(SETTLING_S, abs=1e-9)


def test_z_from_the_angles_is_the_logged_one(amber, log, strides):
    """The logged z2 counts the foot's creep on the compliant floor; z1 is the same number."""
    for stride in strides:
        rows = np.searchsorted(log.t, stride.t)
        np.testing.assert_allclose(stride.z[:, 0], log.z[rows, 0], atol=1e-12)
        np.testing.assert_allclose(stride.z[:, 1], log.z[rows, 1], rtol=0.02)


def test_z_and_eta_are_those_of_the_state(zd, log):
    """Any number of states, none included, gives the same as one state at a time."""
    q, dq = log.q[:5], log.dq[:5]
    for k in range(5):
        eta, z = zd.phi(np.concatenate([q[k], dq[k]]))
        np.testing.assert_allclose(zero_states(zd.robot, q, dq)[k], z, rtol=1e-12)
        np.testing.assert_allclose(output_states(zd, q, dq)[k], eta, atol=1e-12)
    assert zero_states(zd.robot, q[:0], dq[:0]).shape == (0, 2)
    assert output_states(zd, q[:0], dq[:0]).shape == (0, 8)


def test_a_gap_cuts_a_stride_but_keeps_it_one(amber, log):
    keep = np.ones(len(log), dtype=bool)
    first = np.searchsorted(log.t, 0.9)
    keep[first : first + 7] = False
    before, after = (logs.cut([each], amber).strides for each in (log, log.only(keep)))
    assert len(after) == len(before)
    holed = [stride for stride in after if stride.piece[-1] > 0]
    assert len(holed) == 1
    assert np.diff(holed[0].t)[np.diff(holed[0].piece) > 0] == pytest.approx(8e-3)
    assert logs.windows(holed).t.shape[0] < logs.windows(before).t.shape[0]


def test_a_gap_at_the_touchdown_hides_it(amber, zd, log):
    change = int(np.flatnonzero(np.diff(log.stance))[2]) + 1
    keep = np.ones(len(log), dtype=bool)
    keep[change - 3 : change + 3] = False
    seen = logs.touchdowns(logs.cut([log.only(keep)], amber).strides, zd)
    whole = logs.touchdowns(logs.cut([log], amber).strides, zd)
    assert len(seen.after_s) == len(whole.after_s) - 1


def test_standing_is_no_stride(amber, log):
    stood = np.arange(3000)
    still = replace(
        log,
        **{name: np.repeat(getattr(log, name)[:1], stood.size, axis=0) for name in FIELDS},
    )
    still = replace(still, t=1e-3 * stood)
    found, left_out = logs.cut([still], amber)
    assert found == []
    assert left_out["standing"] + left_out["settling"] == stood.size


def test_a_foot_that_bounces_settles_anew(amber, log):
    """A second impact 30 ms after a touchdown: z2 jumps as no weight could make it."""
    down = int(np.flatnonzero(np.diff(log.stance))[2]) + 1
    dq = log.dq.copy()
    dq[: down + 30] *= 1.05
    before, after = (logs.cut([each], amber) for each in (log, replace(log, dq=dq)))
    assert len(after.strides) == len(before.strides)
    start = log.t[down + 30]
    assert after.strides[3].t[0] == pytest.approx(start + SETTLING_S, abs=1e-9)
    assert after.strides[3].t[-1] == before.strides[3].t[-1]
    # When it landed is not known any more, so the touchdown before is not learned from.
    assert before.strides[2].landed is not None
    assert after.strides[2].landed is None
    assert after.left_out["settling"] - before.left_out["settling"] == 30


def test_a_foot_that_strikes_in_mid_step_cuts_the_stride(amber, log):
    down = int(np.flatnonzero(np.diff(log.stance))[2]) + 1
    dq = log.dq.copy()
    dq[: down + 200] *= 1.05
    before, after = (logs.cut([each], amber) for each in (log, replace(log, dq=dq)))
    assert len(after.strides) == len(before.strides)
    struck = after.strides[3]
    assert list(np.unique(struck.piece)) == [0, 1]
    assert struck.t[struck.piece == 1][0] == pytest.approx(log.t[down + 200] + SETTLING_S, abs=1e-9)
    assert struck.t[struck.piece == 0][-1] == log.t[down + 199]
    assert after.left_out["settling"] - before.left_out["settling"] == 20
    assert after.strides[2].landed is not None


def test_a_hip_far_ahead_of_the_foot_is_a_fall(amber, log):
    down = int(np.flatnonzero(np.diff(log.stance))[5]) + 1
    q = log.q.copy()
    q[down - 10 : down, 0] -= 0.5
    found, left_out = logs.cut([replace(log, q=q)], amber)
    assert left_out["falling"] == 10
    assert found[5].t[-1] == log.t[down - 11]
    assert found[5].landing is None


def test_a_fall_is_left_out_from_where_joints_are_far_from_what_was_asked(amber, log):
    down = int(np.flatnonzero(np.diff(log.stance))[5]) + 1
    qd = log.qd.copy()
    qd[down - 40 :, 2] += 0.6
    found, left_out = logs.cut([replace(log, qd=qd)], amber)
    whole, nothing = logs.cut([log], amber)
    assert nothing["falling"] == 0
    assert [stride.number for stride in found] == [0, 1, 2, 3, 4, 5]
    assert found[-1].t[-1] == log.t[down - 41]
    assert found[-1].landing is None
    assert left_out["falling"] == 40 + sum(stride.t.size for stride in whole[6:])


@pytest.mark.parametrize(("samples", "step"), [(3, 0.01), (11, 0.01), (2, 0.05), (4, 0.0037)])
def test_windows_lie_in_one_piece_of_one_stride(strides, samples, step):
    found = logs.windows(strides, samples=samples, step=step)
    assert found.t.shape == (len(found.stride), samples)
    assert found.z.shape == (len(found.stride), samples, 2)
    np.testing.assert_allclose(np.diff(found.t, axis=1), step, atol=1.2e-3)
    for t, z, owner in zip(*found, strict=True):
        stride = strides[owner]
        rows = np.searchsorted(stride.t, t)
        np.testing.assert_array_equal(stride.t[rows], t)
        np.testing.assert_array_equal(stride.z[rows], z)
        assert len(set(stride.piece[rows])) == 1
    expected = sum(
        int((stride.t[-1] - stride.t[0] - (samples - 1) * step) / step + 1e-6) + 1
        for stride in strides
    )
    assert abs(len(found.stride) - expected) <= len(strides)


def test_windows_never_cross_the_split(strides):
    """No sample of a part occurs in another: windows are cut after the split."""
    split = logs.split(repeated(strides, 20), seed=3)
    numbers = [{stride.number for stride in part} for part in split]
    assert [len(part) for part in numbers] == [14, 3, 3]
    assert set.union(*numbers) == set(range(20))
    assert not numbers[0] & numbers[1] and not numbers[0] & numbers[2]
    assert not numbers[1] & numbers[2]
    for part, names in zip(split, numbers, strict=True):
        owners = logs.windows(part).stride
        assert {part[owner].number for owner in owners} == names


def test_a_split_is_the_seed_s(strides):
    many = repeated(strides, 20)
    order = [[s.number for s in part] for part in logs.split(many, seed=1)]
    assert order == [[s.number for s in part] for part in logs.split(many, seed=1)]
    assert order != [[s.number for s in part] for part in logs.split(many, seed=2)]


@pytest.mark.parametrize("count", range(3, 12))
def test_every_part_of_a_split_has_strides(strides, count):
    parts = logs.split(repeated(strides, count))
    assert sum(map(len, parts)) == count
    assert all(parts)


def test_too_little_data_is_refused(strides):
    with pytest.raises(InputError, match=r"expected at least 3 strides.*found 2: walk longer"):
        logs.split(strides[:2])


@pytest.mark.parametrize("wrong", [{"samples": 1}, {"step": 0.0}, {"every": -1.0}])
def test_windows_that_make_no_sense_are_refused(strides, wrong):
    with pytest.raises(InputError, match="expected at least 2 samples and positive times"):
        logs.windows(strides, **wrong)


def test_no_strides_make_no_windows_and_no_touchdowns(zd):
    assert logs.windows([]).t.shape == (0, 3)
    found = logs.touchdowns([], zd)
    assert found.q_before.shape == (0, 5)
    assert found.eta_after.shape == (0, 8)


def test_touchdowns_obey_the_rigid_impact(amber, zd, log, strides):
    """Before: the last row of the old stance. After: the reset map, then 20 ms of flow."""
    found = logs.touchdowns(strides, zd)
    assert len(found.after_s) == STEPS - 1
    np.testing.assert_array_equal(found.stride, np.arange(STEPS - 1))
    np.testing.assert_allclose(found.after_s, SETTLING_S + 1e-3, atol=1e-9)
    changes = np.flatnonzero(np.diff(log.stance))[: STEPS - 1]
    np.testing.assert_array_equal(found.q_before, log.q[changes])
    for k in range(STEPS - 1):
        after = amber.impact(found.q_before[k], found.dq_before[k])
        eta, z = zd.phi(np.concatenate([after.q, after.dq]))
        predicted = flowed(zd, z, found.after_s[k])
        np.testing.assert_allclose(found.z_after[k, 0], predicted[0], atol=2e-3)
        np.testing.assert_allclose(found.z_after[k, 1], predicted[1], rtol=0.03)
        assert np.max(np.abs(found.eta_after[k, :4])) < 5e-3
        del eta


def flowed(zd, z, duration, steps=20):
    """Classical fourth-order steps of the zero dynamics."""
    h = duration / steps
    rate = eqx.filter_jit(zd.zdot)
    for _ in range(steps):
        a = rate(z)
        b = rate(z + 0.5 * h * a)
        c = rate(z + 0.5 * h * b)
        z = z + h / 6 * (a + 2 * b + 2 * c + rate(z + h * c))
    return np.asarray(z)
