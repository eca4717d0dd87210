"""Drives with loops of their own: what they do between two ticks, and what is refused."""

import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from neuralgaits.control import Fblin, Pd
from neuralgaits.control.law_by_name import law_named
from neuralgaits.control.measurement import Measurement
from neuralgaits.errors import InputError
from neuralgaits.robots import load_robot
from neuralgaits.simulation.setup.disturbance import PlantChanges, parse
from neuralgaits.simulation.setup.drives import held_by_drives, law_of_drives, with_gains
from neuralgaits.simulation.setup.plant import build
from neuralgaits.simulation.ticks.wiring import controls

DRIVEN = PlantChanges(drive_stiffness=300.0, drive_damping=5.0)


@pytest.mark.parametrize("robot", ["amber3m", "rabbit", "amber3m-feet"])
def test_between_ticks_a_drive_adds_what_the_joint_has_moved(robot):
    """MuJoCo's torque on every joint, against tau + kp (q_tick - q) + kd (dq_tick - dq)."""
    plant = build(load_robot(robot), DRIVEN)
    model, layout, rng = plant.model, plant.state_map.layout, np.random.default_rng(0)
    data = mujoco.MjData(model)
    shape = np.shape(layout.gears)
    torque, angles, rates = (scale * rng.standard_normal(shape) for scale in (3.0, 0.1, 0.2))
    moved, faster = 0.01 * rng.standard_normal(shape), 0.1 * rng.standard_normal(shape)
    nothing = np.zeros(())
    seen = Measurement(nothing, nothing, nothing, angles, rates, np.zeros(2), np.zeros(2))
    held = held_by_drives(plant.state_map, seen, jnp.array([300.0, 5.0]))
    data.ctrl[:] = controls(plant.state_map, jnp.asarray(torque) + held)
    signs, offsets = np.array(layout.leg_joint_signs), np.array(layout.leg_joint_offsets)
    joints = plant.state_map.joints
    data.qpos[joints] = signs * (angles + moved - offsets)
    data.qvel[joints] = signs * (rates + faster)
    mujoco.mj_forward(model, data)
    expected = torque - 300.0 * moved - 5.0 * faster
    np.testing.assert_allclose(signs * data.qfrc_actuator[joints], expected, atol=1e-9)


def test_their_limit_is_that_of_the_whole_torque():
    """A drive far from its target gives the motor's limit, not its gains times the error."""
    robot = load_robot("amber3m")
    plant = build(robot, PlantChanges(drive_stiffness=1e5, torque_limit=20.0))
    data = mujoco.MjData(plant.model)
    data.qpos[plant.state_map.joints] += 0.5
    mujoco.mj_forward(plant.model, data)
    assert np.abs(data.qfrc_actuator[plant.state_map.joints]).max() == pytest.approx(20.0)


def test_joint_pd_control_has_their_gains_and_no_other_law():
    assert law_of_drives(law_named("pd"), DRIVEN) == Pd(stiffness=(300.0,), damping=(5.0,))
    own = Pd(stiffness=(1.0,), damping=(2.0,))
    assert law_of_drives(own, DRIVEN) == own
    assert law_of_drives(law_named("fblin"), DRIVEN) == Fblin()
    assert law_of_drives(law_named("pd"), PlantChanges()) == Pd()


@pytest.mark.parametrize(
    ("disturb", "gains", "says"),
    [
        ("drive_damping=1", (300.0, 5.0), "found --gains beside drive_stiffness"),
        ("", (0.0, 0.0), "expected --gains KP,KD above 0"),
        ("", (-1.0, 5.0), "drive_stiffness: expected 0 to 100000"),
        ("", (float("nan"), 5.0), "drive_stiffness: expected 0 to 100000"),
    ],
)
def test_odd_gains_are_refused_in_one_line(disturb, gains, says):
    with pytest.raises(InputError) as refusal:
        with_gains(parse(disturb), gains)
    assert says in str(refusal.value) and "\n" not in str(refusal.value)
    assert with_gains(parse("friction=0.4"), None) == PlantChanges(friction=0.4)


def test_a_rate_of_the_drives_is_one_of_mujocos_steps():
    """A drive that damps far too much for 2 kHz chatters there, and not at 20 kHz."""
    robot = load_robot("amber3m")

    def chatter(rate: float) -> float:
        plant = build(robot, PlantChanges(drive_damping=3000.0, drive_rate=rate))
        model, data = plant.model, mujoco.MjData(plant.model)
        assert plant.substeps == round(rate / 1e3)
        assert plant.substeps * model.opt.timestep == pytest.approx(1e-3, rel=1e-12)
        # In the air; damping that MuJoCo integrates implicitly would hide the rate.
        model.opt.integrator = mujoco.mjtIntegrator.mjINT_EULER
        data.qpos[plant.state_map.root[1]] = 2.0
        data.qvel[plant.state_map.joints] = 1.0
        for _ in range(20 * plant.substeps):
            mujoco.mj_step(model, data)
        return float(np.abs(data.qvel[plant.state_map.joints]).max())

    assert chatter(20e3) < 0.005 < chatter(2e3)


@pytest.mark.parametrize(
    ("disturb", "gains", "rate", "says"),
    [
        ("", None, 1e4, "expected --gains beside --drive-rate"),
        ("", (300.0, 5.0), 2500.0, "drive_rate: expected whole kilohertz"),
        ("", (300.0, 5.0), 5e4, "drive_rate: expected 1000 to 40000"),
        ("", (300.0, 5.0), float("nan"), "drive_rate: expected 1000 to 40000"),
        ("drive_damping=1,drive_rate=5000", None, 1e4, "found --drive-rate beside drive_rate"),
        ("drive_rate=5000", None, None, "drive_rate: expected drives with a loop"),
    ],
)
def test_odd_rates_are_refused_in_one_line(disturb, gains, rate, says):
    with pytest.raises(InputError) as refusal:
        with_gains(parse(disturb), gains, rate)
    assert says in str(refusal.value) and "\n" not in str(refusal.value)
    found = with_gains(parse("drive_stiffness=5"), None, 1e4)
    assert found == PlantChanges(drive_stiffness=5.0, drive_rate=1e4)
