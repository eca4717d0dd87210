"""The supervisor in C on a robot in MuJoCo: it stands, walks, stops and damps."""

import numpy as np
import pytest
from mujoco import mj_forward

from neuralgaits.analysis.run import open_run
from neuralgaits.control.safeguard import Fault
from neuralgaits.export import build, controller_facts
from neuralgaits.robots.standing import Stand, posture
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.simulation.setup.sensing import sensed
from neuralgaits.simulation.supervised.supervised_robot import (
    Mode,
    Reason,
    Request,
    SupervisedRobot,
    Waiting,
)
from neuralgaits.workflows import demo
from neuralgaits.workflows.export import design_of


@pytest.fixture(scope="module")
def design():
    return design_of(open_run(demo.FOLDER))


@pytest.fixture(scope="module", params=build.PRECISIONS)
def robot(request, design):
    return SupervisedRobot(design, precision=request.param)


@pytest.fixture(scope="module")
def double(design):
    return SupervisedRobot(design)


def until(robot, request, done, most=8000):
    """Ticks under a request up to one that is the last, which must come."""
    ticks = []
    for _ in range(most):
        ticks.append(robot.tick(request))
        if done(ticks):
            return ticks
    raise AssertionError(f"not within {most} ticks: {ticks[-1]}")


def steps(count):
    return lambda ticks: sum(tick.touchdown for tick in ticks) == count


def changed(ticks):
    return ticks[-1].reason != Reason.NO_CHANGE


def settled(ticks):
    return ticks[-1].reason == Reason.SETTLED


def changes(ticks):
    return [(tick.mode, tick.reason) for tick in ticks if tick.reason]


def follow_touchdowns(ticks):
    """Whether the time since a touchdown is that, in modes without steps, too."""
    since = None
    for tick in ticks:
        if tick.touchdown:
            since = 0.0
        elif since is not None:
            since += 1e-3
        if since is not None:
            assert tick.since_touchdown == pytest.approx(since, abs=2e-3), tick.mode
    assert since is not None


def test_the_time_since_a_touchdown_goes_on_in_every_mode(double):
    double.start()
    before = until(double, Request.WALK, lambda ticks: ticks[-1].mode == Mode.WALK)
    assert min(tick.since_touchdown for tick in before) == 1e30
    walking = until(double, Request.WALK, steps(2))
    stopped = until(double, Request.STAND, settled)
    later = until(double, Request.STAND, lambda ticks: len(ticks) == 50)
    damped = until(double, Request.DAMP, lambda ticks: len(ticks) == 50)
    assert {tick.mode for tick in (*stopped, *later, *damped)} == set(Mode) - {Mode.WALK}
    follow_touchdowns([*walking, *stopped, *later, *damped])


def test_feet_that_friction_holds_apart_are_said_to_be(double):
    """Its motors are too weak to pull them together: it damps after two tries, not in 15 s."""
    robot = double.plant.robot
    q = posture(robot, Stand(0.67, 0.86, -0.5, -0.1))
    assert q is not None
    double.start(q)
    ticks = until(double, Request.WALK, lambda ticks: ticks[-1].mode == Mode.DAMP)
    assert (ticks[-1].reason, ticks[-1].fault) == (Reason.FEET_HELD, Fault.NONE)
    assert len(ticks) < 8000
    assert double.tick(Request.WALK).waiting == Waiting.FOR_DAMP


@pytest.mark.parametrize(("ahead", "walks"), [(0.06, True), (0.12, False), (0.18, False)])
def test_with_the_weight_before_the_feet_it_steps_or_says_why_not(double, ahead, walks):
    """Nearly all steps from further ahead ended in a fall."""
    robot = double.plant.robot
    spacing = 0.18
    q = posture(robot, Stand(spacing, 0.9, ahead / (spacing * robot.leg_length), -0.25))
    assert q is not None
    double.start(q)
    if walks:
        ticks = until(double, Request.WALK, steps(4))
        assert (Mode.WALK, Reason.TIPS_FORWARD) in changes(ticks)
    else:
        ticks = until(double, Request.WALK, changed, most=5)
        if ticks[-1].reason == Reason.AS_REQUESTED:
            ticks = until(double, Request.WALK, changed, most=5)
        assert (ticks[-1].mode, ticks[-1].reason) == (Mode.DAMP, Reason.TIPPED_OVER)


def test_it_stands_walks_stops_and_walks_again(robot):
    robot.start()
    first = until(robot, Request.WALK, steps(6))
    assert changes(first) == [
        (Mode.STAND, Reason.AS_REQUESTED),
        (Mode.WALK, Reason.AS_REQUESTED),
    ]
    assert {tick.waiting for tick in first} == {Waiting.NOTHING, Waiting.FOR_STANDING}
    stopped = until(robot, Request.STAND, settled)
    assert changes(stopped) == [
        (Mode.STOP, Reason.AS_REQUESTED),
        (Mode.STAND, Reason.SETTLED),
    ]
    until(robot, Request.STAND, lambda ticks: len(ticks) == 1000)
    at = robot.data.qpos.copy()
    still = until(robot, Request.STAND, lambda ticks: len(ticks) == 1000)[-1]
    assert still.mode == Mode.STAND and np.max(np.abs(robot.data.qpos - at)) < 0.02
    assert np.all(robot.data.sensordata[-2:] > 20.0)
    again = until(robot, Request.WALK, steps(6))
    assert changes(again) == [(Mode.WALK, Reason.AS_REQUESTED)]
    assert not any(tick.fault for tick in (*first, *stopped, *again))


def test_drives_and_torques_agree_at_the_reading(robot):
    """In every mode: what drives make of their targets is the torque of the tick."""
    robot.start()
    seen = set()
    joints = robot.plant.state_map.joints
    for number in range(3500):
        q, dq = robot.data.qpos[joints], robot.data.qvel[joints]
        request = Request.WALK if number < 2200 else Request.STAND
        tick = robot.tick(request if number > 20 else Request.DAMP)
        q_des, dq_des, kp, kd, ahead = np.moveaxis(tick.targets, -1, 0)
        torque = ahead + kp * (q_des - q) + kd * (dq_des - dq)
        seen.add(tick.mode)
        if tick.mode != Mode.DAMP:
            # Single precision rounds kp times an angle.
            np.testing.assert_allclose(torque, tick.torques, atol=2e-3)
        assert np.all(np.abs(tick.torques) <= 41.0 * (1.0 + 1e-6))
    assert seen == set(Mode)


@pytest.mark.parametrize("stop", range(1200, 2400, 240))
def test_it_stops_at_any_tick(double, stop):
    double.start()
    for _ in range(stop):
        walking = double.tick(Request.WALK)
    assert walking.mode == Mode.WALK
    ticks = until(double, Request.STAND, lambda ticks: ticks[-1].mode in (Mode.STAND, Mode.DAMP))
    assert ticks[-1].mode == Mode.STAND and ticks[-1].fault == Fault.NONE


@pytest.mark.parametrize(
    "stand",
    [Stand(0.12, 0.94, -0.4, 0.0), Stand(0.44, 0.87, -0.75, -0.2)],
    ids=["feet together", "far apart, leaning back"],
)
@pytest.mark.parametrize("front", [0, 1])
def test_it_walks_from_other_postures(double, stand, front):
    q = posture(double.plant.robot, stand)
    assert q is not None
    double.start(q, front=front)
    ticks = until(double, Request.WALK, steps(3))
    # The foot in front stands first.
    first = next(tick for tick in ticks if tick.mode == Mode.WALK)
    assert first.leg == front


def test_a_robot_in_mid_step_walks_on(double, design):
    run = open_run(demo.FOLDER)
    z = run.gait.z(np.array([0.5, 0.5]))
    q, dq = np.split(np.asarray(run.zero_dynamics.phi_inv(z)), 2)
    double.start()
    # A little into the floor: whether spheres that only touch are in contact is rounding.
    place = (0.0, float(double.plant.robot.foot_radius) - 1e-4)
    double.data.qpos[:], double.data.qvel[:] = double.plant.state_map.to_mjcf(q, dq, 1, place)
    # Touch sensors are of the last step, when it stood on both feet, until they are read anew.
    mj_forward(double.plant.model, double.data)
    first = double.tick(Request.WALK)
    assert (first.mode, first.reason, first.leg) == (Mode.WALK, Reason.FROM_MID_STEP, 1)
    until(double, Request.WALK, steps(3))


def test_without_a_posture_to_stand_in_a_step_that_does_not_end_damps(design, monkeypatch):
    """Its standing postures are zeros then, which no leg is to be driven to."""
    monkeypatch.setattr(controller_facts, "standing_postures", lambda robot: None)
    robot = SupervisedRobot(design)
    run = open_run(demo.FOLDER)
    z = run.gait.z(np.array([0.5, 0.5]))
    q, dq = np.split(np.asarray(run.zero_dynamics.phi_inv(z)), 2)
    robot.start()
    place = (0.0, float(robot.plant.robot.foot_radius))
    qpos, qvel = robot.plant.state_map.to_mjcf(q, dq, 1, place)
    for _ in range(4000):
        robot.data.qpos[:], robot.data.qvel[:] = qpos, qvel
        tick = robot.tick(Request.WALK)
        if tick.mode == Mode.WALK and tick.reason:
            continue
        if tick.reason:
            break
    assert (tick.mode, tick.reason) == (Mode.DAMP, Reason.TOO_LATE)
    assert not np.any(tick.targets[..., 2])


def test_a_fault_damps_every_joint_once_and_for_all(robot):
    robot.start()
    until(robot, Request.WALK, steps(2))
    robot.data.qpos[robot.plant.state_map.joints[0, 0]] = 5.0
    fault = robot.tick(Request.WALK)
    assert (fault.mode, fault.reason, fault.fault) == (Mode.DAMP, Reason.BY_FAULT, Fault.ANGLE)
    assert fault.fault_is_new
    np.testing.assert_array_equal(fault.targets[..., [0, 1, 2, 4]], 0.0)
    assert np.all(fault.targets[..., 3] > 10.0)
    for request in (Request.DAMP, Request.STAND, Request.WALK):
        rates = robot.data.qvel[robot.plant.state_map.joints]
        later = robot.tick(request)
        assert (later.mode, later.fault, later.fault_is_new) == (Mode.DAMP, Fault.ANGLE, False)
        moving = (np.abs(rates) > 1.0) & (np.abs(later.torques) > 1.0)
        assert np.all(later.torques[moving] * rates[moving] < 0.0)
    robot.start()
    assert robot.tick(Request.STAND).mode == Mode.STAND


def test_a_reading_that_is_no_number_damps_with_estimated_rates(design):
    """The estimator keeps nothing of it: joints go on damping, and a new start is a new start."""
    robot = SupervisedRobot(design, sensed(PlantChanges(), "encoders"))
    robot.start()
    until(robot, Request.WALK, steps(2))
    sense, joints = robot._sense, robot.plant.state_map.joints
    fastest = int(np.argmax(np.abs(robot.data.qvel[joints])))

    def spoilt():
        sense()
        robot._sensors[6 + fastest] = np.nan

    robot._sense = spoilt
    tick = robot.tick(Request.WALK)
    assert (tick.mode, tick.fault) == (Mode.DAMP, Fault.NOT_FINITE)
    robot._sense = sense
    damped = np.zeros(tick.torques.shape, bool)
    for _ in range(20):
        rates = robot.data.qvel[joints]
        tick = robot.tick(Request.WALK)
        moving = np.abs(rates) > 1.0
        assert np.all(tick.torques[moving] * rates[moving] < 0.0)
        damped |= moving
    # The joint whose reading was spoilt is among them.
    assert damped.reshape(-1)[fastest]


def test_the_time_to_stand_counts_from_the_request(double):
    """Not from the end of the walk before, after which it may have stood for long."""
    double.start()
    until(double, Request.WALK, steps(2))
    until(double, Request.STAND, settled)
    until(double, Request.STAND, lambda ticks: len(ticks) == 16000, most=16000)
    knee = double.plant.state_map.joints[1, 0]
    at = double.data.qpos[knee]
    for _ in range(2500):
        double.data.qpos[knee], double.data.qvel[knee] = at, 0.0
        tick = double.tick(Request.WALK)
        assert tick.mode == Mode.STAND and tick.reason == Reason.NO_CHANGE


def test_in_the_air_it_stands_and_waits_to_walk(double):
    double.start()
    height = double.plant.state_map.root[1]
    for _ in range(1500):
        double.data.qpos[height], double.data.qvel[height] = 1.5, 0.0
        tick = double.tick(Request.WALK)
    assert (tick.mode, tick.waiting) == (Mode.STAND, Waiting.FOR_TWO_FEET)


def test_a_robot_that_tips_over_damps_and_waits_for_the_operator(double):
    double.start()
    until(double, Request.STAND, lambda ticks: len(ticks) == 700)
    double.data.qvel[double.plant.state_map.root[0]] -= 1.0
    ticks = until(double, Request.STAND, changed)
    assert (ticks[-1].mode, ticks[-1].reason) == (Mode.DAMP, Reason.TIPPED_OVER)
    assert double.tick(Request.WALK).waiting == Waiting.FOR_DAMP
    double.tick(Request.DAMP)
    # Now it tries again, as far over as it is.
    tick = double.tick(Request.STAND)
    assert (tick.waiting, tick.reason) == (Waiting.NOTHING, Reason.TIPPED_OVER)


@pytest.mark.parametrize("push", [0.7, 1.0])
def test_a_step_catches_a_push_forward(double, push):
    double.start()
    until(double, Request.STAND, lambda ticks: len(ticks) == 700)
    double.data.qvel[double.plant.state_map.root[0]] += push
    ticks = until(double, Request.STAND, settled)
    assert changes(ticks) == [(Mode.STOP, Reason.TIPS_FORWARD), (Mode.STAND, Reason.SETTLED)]


def test_a_second_step_brakes_where_the_first_is_not_enough(double):
    double.start()
    until(double, Request.WALK, steps(3))
    first = until(double, Request.STAND, lambda ticks: len(ticks) == 520)
    double.data.qvel[double.plant.state_map.root[0]] += 0.7
    rest = until(double, Request.STAND, settled)
    # The second step begins the controller anew, and as after a touchdown: rates of joints are
    # filtered more quickly, and for 0.1 s no foot that is on the floor counts as landed.
    both = [*first, *rest]
    since = [tick.since_touchdown for tick in both]
    begun = [k for k, time in enumerate(since) if k and time < since[k - 1]]
    landed = [k for k, tick in enumerate(both) if tick.touchdown]
    assert set(landed) < set(begun) and len(begun) == 3
    assert since[begun[1]] < 0.002 and both[begun[1]].mode == Mode.STOP
    assert sum(tick.touchdown for tick in (*first, *rest)) == 2
    assert rest[-1].fault == Fault.NONE


@pytest.mark.parametrize("late", [300, 450, 600])
def test_a_request_to_stand_while_it_leans_is_met(double, late):
    double.start()
    until(double, Request.WALK, lambda ticks: ticks[-1].mode == Mode.WALK)
    leaning = until(double, Request.WALK, lambda ticks: len(ticks) == late)
    assert not any(tick.touchdown for tick in leaning)
    ticks = until(double, Request.STAND, lambda ticks: len(ticks) == 4000)
    assert ticks[-1].mode == Mode.STAND
    assert not any(tick.mode == Mode.DAMP for tick in ticks)


def test_a_walk_that_does_not_begin_goes_back_to_standing(double):
    """Held by its hip, it cannot lean forward."""
    double.start()
    until(double, Request.WALK, lambda ticks: ticks[-1].mode == Mode.WALK)
    forward = double.plant.state_map.root[0]
    at = double.data.qpos[forward]
    for _ in range(6000):
        double.data.qpos[forward], double.data.qvel[forward] = at, 0.0
        tick = double.tick(Request.WALK)
        if tick.reason:
            break
    assert (tick.mode, tick.reason) == (Mode.STAND, Reason.TOO_LATE)


def test_encoders_are_enough(design):
    robot = SupervisedRobot(design, sensed(PlantChanges(), "encoders"))
    robot.start()
    until(robot, Request.WALK, steps(4))
    until(robot, Request.STAND, settled)


def test_torques_alone_are_enough(design):
    robot = SupervisedRobot(design, drives=False)
    robot.start()
    until(robot, Request.WALK, steps(4))
    until(robot, Request.STAND, settled)
