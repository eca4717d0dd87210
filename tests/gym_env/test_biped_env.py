"""The environment: Gymnasium's own checks, what its numbers mean, and that episodes repeat."""

# ruff: noqa: E402

import importlib
import sys
from pathlib import Path

import jax
import mujoco
import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium", reason="needs the gym extra: gymnasium")

from gymnasium.utils.env_checker import check_env

import neuralgaits
from neuralgaits import gym_env
from neuralgaits.analysis.run import open_run
from neuralgaits.errors import InputError, NeuralGaitsError
from neuralgaits.gait.posture import walking_posture
from neuralgaits.gym_env import BipedEnv, Reward
from neuralgaits.gym_env.body import Body
from neuralgaits.robots import load_robot
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.simulation.setup.plant import build
from neuralgaits.simulation.setup.starts import full_states
from neuralgaits.simulation.ticks.falls import Ending, ending
from neuralgaits.simulation.walk import plant_states, walk


@pytest.fixture(scope="module")
def amber3m():
    return load_robot("amber3m")


@pytest.fixture(scope="module")
def env(amber3m):
    return BipedEnv(amber3m)


def rolled(env, seed: int, count: int = 10, **options) -> tuple[np.ndarray, list[float], dict]:
    """Observations and rewards of an episode of random actions, and the last info."""
    draw = np.random.default_rng(seed)
    seen, info = env.reset(seed=seed, options=options)
    observations, rewards = [seen], []
    for _ in range(count):
        action = draw.uniform(-1.0, 1.0, env.action_space.shape)
        seen, reward, fell, _, info = env.step(action)
        observations.append(seen)
        rewards.append(reward)
        if fell:
            break
    return np.stack(observations), rewards, info


@pytest.mark.parametrize(
    "settings",
    [
        {},
        {"action": "torque", "disturb": "encoder_noise=0.002,rate_noise=0.1,floor_height=0.01"},
        {"robot": "rabbit", "disturb": ["mass_scale=0.9", {"delay_ms": 4}, None], "push": (-8, 8)},
    ],
)
def test_gymnasium_finds_nothing_wrong(settings):
    made = gymnasium.make(gym_env.ID, **settings)
    check_env(made.unwrapped)
    made.close()


def test_an_episode_is_cut_after_its_time():
    spec = gymnasium.spec(gym_env.ID)
    assert spec.max_episode_steps == gym_env.EPISODE_STEPS


def test_the_same_seed_is_the_same_episode(env):
    first, second = rolled(env, 3), rolled(env, 3)
    assert np.array_equal(first[0], second[0]) and first[1] == second[1]
    assert not np.array_equal(first[0][0], rolled(env, 4)[0][0])


def test_the_state_asked_for_is_what_is_seen(env, amber3m):
    state = np.array([0.1, 0.3, -0.2, -0.4, 0.5, -1.0, 0.2, 0.3, -0.4, 0.6])
    seen, _ = env.reset(seed=0, options={"state": state, "speed": 0.7})
    q, dq = np.split(state, 2)
    # Knee and hip of the stance leg, then of the swing leg from its knee up.
    assert seen[2:6] == pytest.approx([q[1], q[2], q[4], q[3]], abs=1e-6)
    assert seen[6:10] == pytest.approx([dq[1], dq[2], dq[4], dq[3]], abs=1e-6)
    torso = amber3m.link_angles[amber3m.torso]
    assert seen[:2] == pytest.approx([torso @ q, torso @ dq], abs=1e-6)
    assert list(seen[-3:]) == pytest.approx([-1.0, 0.0, 0.7])


def test_it_begins_as_a_walk_begins(env, amber3m):
    """MuJoCo's state is that of `simulate` for the same state of the robot."""
    state = np.array([0.1, 0.3, -0.2, -0.4, 0.5, -1.0, 0.2, 0.3, -0.4, 0.6])
    env.reset(seed=0, options={"state": state})
    (expected,) = plant_states(build(amber3m), state[None])
    found = np.concatenate([[0.0], env.body.data.qpos, env.body.data.qvel])
    assert found == pytest.approx(expected, abs=1e-15)


@pytest.mark.parametrize("disturb", [{}, {"floor_height": 0.01, "delay_ms": 2, "slope_deg": 1.0}])
def test_the_plant_is_that_of_simulate(disturb):
    """Torques of a walk, given again, make the same walk: states, touchdowns, floors."""
    run = open_run(Path(neuralgaits.__file__).parent / "demo_run")
    gait, disturbance = run.gait, PlantChanges(**disturb)
    starts = full_states(run.zero_dynamics, gait, "centre", seed=5, episodes=1)
    walked = walk(
        run.robot, gait.policy, starts, steps=4, seed=5, disturbance=disturbance, record=True
    ).episodes
    assert walked.record is not None and walked.gauge.steps[0] == 4
    body = Body(run.robot, build(run.robot, disturbance))
    q, dq = np.split(starts[0], 2)
    body.stand(body.plant, q, dq, 0, push=0.0, seed=5)
    command = walked.record.result
    for i, torque in enumerate(command.torque):
        assert body.leg == command.leg[i]
        here = np.concatenate([[body.data.time], body.data.qpos, body.data.qvel])
        np.testing.assert_allclose(here, walked.states[i], atol=1e-9)
        body.tick(lambda angles, rates, torque=torque: np.asarray(torque).ravel())
    assert body.steps == 4


def test_a_state_that_diverges_is_a_fall(env, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # MuJoCo leaves a log of it.
    env.reset(seed=0)
    env.body.data.qvel[:] = 1e12
    seen, reward, fell, _, info = env.step(np.zeros(4))
    assert fell and info["ending"] == "state not finite"
    assert np.isfinite(seen).all() and np.isfinite(reward)
    assert env.observation_space.contains(env.reset(seed=1)[0])


def test_a_reward_is_the_sum_of_its_parts(env):
    _, rewards, info = rolled(env, 0, 1)
    assert sum(info["reward"].values()) == pytest.approx(rewards[-1])
    parts = Reward().parts(
        speed=0.7, requested_speed=0.7, power=0.1, pitch=0.2, change=1.0, fell=False
    )
    assert parts == pytest.approx(
        {"speed": 1.0, "alive": 0.2, "effort": -0.03, "lean": -0.02, "change": -0.02, "fall": 0.0}
    )


def test_work_is_that_of_the_torques():
    """Against the kinetic and potential energy that a free robot gains by them."""
    robot = load_robot("amber3m")
    body = Body(robot, build(robot))
    body.stand(body.plant, np.zeros(5), np.zeros(5), 0, push=0.0, seed=0)
    body.data.qpos[1] += 1.0  # In the air, no contact takes part.
    constant = np.array([0.5, 1.0, 0.4, -0.8])
    body.tick(lambda angles, rates: constant)
    rates = body.measured()[6:10]
    # At rest, constant torques do the work of their mean rates, which are half the last ones.
    assert body.work == 0.0
    body.tick(lambda angles, rates: constant)
    assert body.work == pytest.approx(1e-3 * np.abs(constant * rates).sum())


def test_targets_are_reached_or_at_their_bounds(env):
    """No load, no gravity to speak of: joints go where the action says, in the order it says."""
    posture = walking_posture(env.robot)
    env.reset(seed=0)
    env.body.data.qpos[1] += 100.0
    for _ in range(20):
        seen, *_ = env.step(np.array([1.0, 0.0, -1.0, 0.0]))
    knees = posture.upper[0], posture.lower[3]
    assert (seen[2], seen[4]) == pytest.approx(knees, abs=0.05)
    assert seen[3] == pytest.approx(seen[5], abs=0.05)


def test_a_delay_holds_torques_back(amber3m):
    body = Body(amber3m, build(amber3m, PlantChanges(delay_ms=2)))
    body.stand(body.plant, np.zeros(5), np.zeros(5), 0, push=0.0, seed=0)
    given = []
    for torque in (1.0, 2.0, 3.0):
        body.tick(lambda angles, rates, torque=torque: np.full(4, torque))
        given.append(body.data.ctrl.copy())
    assert not given[0].any() and not given[1].any()
    assert np.abs(given[2]).max() > 0.0


@pytest.mark.parametrize("torso", [0.0, 1.2])
@pytest.mark.parametrize("bent", [0.0, 1.3])
@pytest.mark.parametrize("since", [0.1, 5.0])
def test_falls_are_those_of_a_simulation(amber3m, torso, bent, since):
    body = Body(amber3m, build(amber3m))
    q = np.array([bent, -2.0 * bent, torso + bent, torso, 0.0])
    body.stand(body.plant, q, np.zeros(5), 0, push=0.0, seed=0)
    body.since = since
    expected = ending(
        amber3m,
        hip_height=body.hip[1],
        pitch=np.asarray(body.pitch),
        since_touchdown=np.asarray(since),
        steps_left=np.asarray(1),
        in_gap=np.asarray(False),
        finite=np.asarray(True),
    )
    assert body.ending() is Ending(int(expected))


def test_a_push_moves_the_robot(amber3m):
    """The whole impulse goes into the momentum of a robot in the air."""
    body = Body(amber3m, build(amber3m))
    body.stand(body.plant, np.zeros(5), np.zeros(5), 0, push=5.0, seed=0)
    body.data.qpos[1] += 10.0
    body.steps, body._landed = 5, True
    while body.data.time < 0.7:
        body.tick(lambda angles, rates: np.zeros(4))
        body._landed = False
    masses, model = body.plant.model.body_mass, body.plant.model
    mujoco.mj_forward(model, body.data)
    mujoco.mj_subtreeVel(model, body.data)
    momentum = masses.sum() * body.data.subtree_linvel[0][0]
    assert momentum == pytest.approx(5.0, rel=0.02)


def test_it_needs_no_setting_of_jax(amber3m):
    """Learners have their own; a robot is loaded in double precision all the same."""
    with jax.enable_x64(False):
        env = BipedEnv("amber3m", disturb=["", "torque_limit=30"])
        for seed in range(4):
            env.reset(seed=seed)
            env.step(np.zeros(4))
        assert not jax.config.read("jax_enable_x64")
    assert env.robot.mass == amber3m.mass


@pytest.mark.parametrize(
    "settings",
    [
        {"robot": "no-such-robot"},
        {"action": "velocity"},
        {"speed": (0.9, 0.5)},
        {"speed": "fast"},
        {"push": float("nan")},
        {"disturb": "frictoin=0.4"},
        {"disturb": []},
        {"reward": {"speeed": 1.0}},
        {"reward": {"width": 0.0}},
        {"ticks": 0},
        {"render_mode": "human"},
    ],
)
def test_bad_settings_get_one_line(settings):
    with pytest.raises(NeuralGaitsError) as found:
        BipedEnv(**settings)
    assert "\n" not in str(found.value)


def test_a_missing_extra_gets_one_line(monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    monkeypatch.delitem(sys.modules, "neuralgaits.gym_env")
    with pytest.raises(InputError, match=r"pip install 'neuralgaits\[gym\]'$"):
        importlib.import_module("neuralgaits.gym_env")


@pytest.mark.parametrize(
    "options",
    [
        {"state": [0.0]},
        {"state": "x"},
        {"state": [[1], [2, 3]]},
        {"speed": -1.0},
        {"speed": True},
        {"speed": "0.5"},
        {"pace": 1.0},
        {5: 1, "a": 2},
        5,
        "x",
    ],
)
def test_bad_options_get_one_line(env, options):
    with pytest.raises(InputError) as refusal:
        env.reset(options=options)
    assert "expected" in str(refusal.value) and "\n" not in str(refusal.value)


@pytest.mark.parametrize(
    "settings",
    [
        {"robot": None},
        {"robot": 5},
        {"robot": b"x"},
        {"disturb": 5},
        {"disturb": "drive_stiffness=5"},
        {"reward": 5},
        {"reward": {5: 1.0}},
        {"ticks": True},
        {"ticks": 1.5},
        {"speed": "0.5"},
        {"push": True},
    ],
)
def test_odd_settings_get_one_line(settings):
    with pytest.raises(InputError) as refusal:
        BipedEnv(**settings)
    assert "expected" in str(refusal.value) and "\n" not in str(refusal.value)


def test_a_decision_before_an_episode_is_refused():
    with pytest.raises(InputError, match="call reset"):
        BipedEnv("amber3m").step(np.zeros(4))


def test_an_action_that_is_no_number_is_refused(env):
    env.reset(seed=0)
    for action in (np.full(4, np.nan), "abcd", [0, 0, 0, "x"], [[0], [0, 1]], {}, [10**400] * 4):
        with pytest.raises(InputError, match="finite numbers"):
            env.step(action)
