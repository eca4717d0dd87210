"""A robot that is pushed, tilted, loaded and moved while it walks."""

import math

import jax
import mujoco
import numpy as np
import pytest

from neuralgaits.control import Controller, Fblin
from neuralgaits.errors import InputError
from neuralgaits.gait import ZeroDynamics
from neuralgaits.simulation.live import LiveWalk
from neuralgaits.simulation.live_floor import TILT_DEG_S
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.simulation.setup.plant import PERIOD_S, build
from neuralgaits.simulation.setup.push import DURATION_S
from neuralgaits.simulation.walk import walk

LAW = Fblin()


@pytest.fixture
def live(amber, slow):
    policy, start = slow
    return LiveWalk(Controller.init(amber, policy, LAW), start)


def advance(live, seconds):
    for _ in range(round(seconds / PERIOD_S)):
        live.tick()


def mujoco_state(live):
    return np.concatenate([[live.data.time], live.data.qpos, live.data.qvel])


def momentum_x(live):
    """Of the whole robot, from MuJoCo's own velocities of the links (kg m/s)."""
    fresh = mujoco.MjData(live.plant.model)
    fresh.qpos[:], fresh.qvel[:] = live.data.qpos, live.data.qvel
    mujoco.mj_forward(live.plant.model, fresh)
    mujoco.mj_subtreeVel(live.plant.model, fresh)
    return fresh.subtree_linvel[0, 0] * np.sum(live.plant.model.body_mass)


def velocity_of_contact(live):
    """Return MuJoCo's velocity of the point of foot 0 that touches the floor (m/s)."""
    model, fresh = live.plant.model, mujoco.MjData(live.plant.model)
    fresh.qpos[:], fresh.qvel[:] = live.data.qpos, live.data.qvel
    mujoco.mj_forward(model, fresh)
    foot = model.geom(live.plant.state_map.layout.feet[0]).id
    jacobian = np.zeros((3, model.nv))
    touching = fresh.geom_xpos[foot] - [0.0, 0.0, model.geom_size[foot, 0]]
    mujoco.mj_jac(model, fresh, jacobian, None, touching, model.geom_bodyid[foot])
    return jacobian @ fresh.qvel


def test_undisturbed_it_is_the_walk_of_an_episode_to_the_last_bit(amber, slow, live):
    policy, start = slow
    states = walk(amber, policy, start[None], controller=LAW, steps=3, record=True).episodes.states
    for expected in states:
        np.testing.assert_array_equal(mujoco_state(live), expected)
        live.tick()
    assert len(states) > 1000


def test_a_push_changes_momentum_by_its_impulse(live):
    # In the air, with no ground to push back, and no torques.
    live.data.qpos[live.plant.state_map.root[1]] += 50.0
    still = momentum_x(live)
    live.push(np.array([7.0, 0.0]))
    for _ in range(round(DURATION_S / PERIOD_S)):
        live.tick()
    assert np.any(live.impulse_given)
    np.testing.assert_allclose(live.impulse_given, [7.0, 0.0], rtol=1e-12)
    assert momentum_x(live) - still == pytest.approx(7.0, rel=2e-3)
    now = momentum_x(live)
    advance(live, 0.05)
    np.testing.assert_allclose(live.impulse_given, [7.0, 0.0], rtol=1e-12)
    assert momentum_x(live) == pytest.approx(now, abs=7e-3)


def test_a_push_up_takes_weight_off_the_foot(live):
    advance(live, 0.2)
    weight = live.data.sensordata[-2:].sum()
    live.push(np.array([0.0, 10.0]))
    advance(live, 0.05)
    assert live.pushing[1] == pytest.approx(100.0)
    assert live.data.sensordata[-2:].sum() < weight - 50.0


def test_a_jump_lands_on_the_zero_dynamics(amber, slow, live):
    policy, _ = slow
    zd = ZeroDynamics(amber, policy)
    advance(live, 0.3)
    hip = live.hip[0]
    start, guard = np.asarray(policy.z1_range)
    for share in (0.1, 0.5, 0.9):
        z = np.array([start + share * (guard - start), 14.0 + 2.0 * share])
        live.place(np.asarray(zd.phi_inv(z)))
        sensors = live.plant.state_map.sensors(live.data.qpos, live.data.qvel)
        foot, _ = live.plant.state_map.foot(0, sensors)
        np.testing.assert_allclose(velocity_of_contact(live), 0.0, atol=1e-12)
        assert foot[1] == pytest.approx(float(amber.foot_radius), abs=1e-12)
        live.tick()
        found = live.record.result
        eta, reached = jax.jit(lambda x: zd.phi(x))(np.concatenate([found.q[0], found.dq[0]]))
        np.testing.assert_allclose(reached, z, rtol=0.0, atol=1e-9)
        np.testing.assert_allclose(eta, 0.0, atol=1e-9)
    assert live.hip[0] == pytest.approx(hip, abs=0.01)


def test_the_floor_tilts_as_the_disturbance_says(amber, live):
    advance(live, 0.1)
    live.disturb(slope_deg=2.0)
    advance(live, 2.0 / TILT_DEG_S + 0.02)
    expected = build(amber, PlantChanges(slope_deg=2.0))
    assert live.floor.slope == expected.slope == pytest.approx(math.tan(math.radians(2.0)))
    asked = mujoco.MjData(expected.model)
    np.testing.assert_allclose(live.data.mocap_quat, asked.mocap_quat, atol=1e-12)
    # Both planes pass through the foothold, and the tick knows the same floor.
    x, z = live.data.mocap_pos[0, 0], live.data.mocap_pos[0, 2]
    assert z + (live.hip[0] - x) * expected.slope == pytest.approx(live.floor.height(live.hip[0]))
    advance(live, 2.0)
    assert not live.ending.fell
    clear = live.hip[1] - live.floor.height(live.hip[0])
    assert 0.7 < clear < 0.95


def test_a_turning_floor_presses_no_contact(live):
    advance(live, 0.3)
    usual = live.data.sensordata[-2:].sum()
    live.disturb(slope_deg=-3.0)
    advance(live, 0.02)
    assert live.floor.slope < 0.0
    assert live.data.sensordata[-2:].sum() == pytest.approx(usual, rel=0.5)


def test_masses_friction_and_torque_limit_change_at_once(amber, live):
    advance(live, 0.2)
    before = mujoco_state(live)
    changes = {"mass_scale": 1.2, "friction": 0.3, "torque_limit": 15.0, "torso_shift_m": 0.03}
    live.disturb(**changes)
    np.testing.assert_array_equal(mujoco_state(live), before)
    expected = build(amber, PlantChanges(**changes)).model
    np.testing.assert_array_equal(live.plant.model.body_mass, expected.body_mass)
    np.testing.assert_array_equal(live.plant.model.body_ipos, expected.body_ipos)
    np.testing.assert_array_equal(live.plant.model.geom_friction, expected.geom_friction)
    torques = []
    for _ in range(400):
        live.tick()
        if live.ending.fell:
            break
        torques.append(np.abs(live.record.result.actuated).max())
    assert max(torques) <= 15.0


def test_a_fall_has_a_reason_and_stops_time(live):
    advance(live, 0.2)
    live.push(np.array([-60.0, 0.0]))
    for _ in range(4000):
        if not live.tick():
            break
    assert live.ending.fell
    assert live.ending.reason in ("hip too low", "torso tipped over")
    frozen = mujoco_state(live)
    assert not live.tick()
    np.testing.assert_array_equal(mujoco_state(live), frozen)
    live.reset()
    assert not live.ending.fell
    advance(live, 1.0)
    assert not live.ending.fell
    assert live.outcome.steps[0] >= 1


@pytest.mark.parametrize("impulse", [[math.nan, 0.0], [math.inf, 0.0], [1.0]])
def test_a_push_without_a_number_is_refused(live, impulse):
    with pytest.raises(InputError, match="finite impulse"):
        live.push(np.array(impulse))


@pytest.mark.parametrize(
    ("change", "what"),
    [
        ({"slope_deg": math.nan}, "slope_deg: expected"),
        ({"mass_scale": 0.0}, "mass_scale: expected"),
        ({"delay_ms": 2.0}, "expected changes of"),
    ],
)
def test_a_change_out_of_range_changes_nothing(live, change, what):
    plant = live.plant
    with pytest.raises(InputError, match=what):
        live.disturb(**change)
    assert live.plant is plant


def test_a_state_that_does_not_fit_is_refused(live):
    with pytest.raises(InputError, match="full state of 10 numbers"):
        live.place(np.zeros(4))
    with pytest.raises(InputError, match="full state of 10 numbers"):
        live.place(np.full(10, np.nan))
