"""Commands on their way to a step: clamped, spread over steps, latched at touchdowns."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.control import Controller, Fblin, Measurement, Pd, start, step, tell
from neuralgaits.control import command_state as tolds
from neuralgaits.control.measurement import leg_joints, standing_hip_velocity
from neuralgaits.gait.commands import Command, Pair
from neuralgaits.robots import load_robot
from support.designs import FOOTHOLDS, SPEED, family_for


@pytest.fixture(scope="module")
def robot():
    return load_robot("amber3m")


@pytest.fixture(scope="module", params=[(SPEED,), FOOTHOLDS], ids=["speed", "footholds"])
def family(request):
    return family_for("amber3m", request.param).policy


@pytest.fixture(scope="module")
def speed():
    return family_for("amber3m").policy


def told_of(wanted, after, commands):
    nothing = jnp.zeros(0)
    after = jnp.asarray(after)
    return tolds.CommandState(jnp.asarray(wanted), Pair(after, after), nothing)


@pytest.mark.parametrize(
    ("given", "taken"),
    [(0.6, 0.6), (2.0, 0.9), (-1.0, 0.55), (np.inf, 0.9), (-np.inf, 0.55), (np.nan, 0.7)],
)
def test_a_wish_is_clamped_and_nan_keeps_the_last(given, taken):
    told = tolds.tell((SPEED,), told_of([0.7], [0.7], (SPEED,)), jnp.array([given]))
    assert float(told.requested[0]) == taken


def test_a_change_that_is_too_fast_is_spread_over_steps():
    told = told_of([0.9], [0.6], (SPEED,))
    walked = []
    for _ in range(7):
        pair = tolds.next_pair((SPEED,), told)
        assert float(pair.before[0]) == float(told.pair.after[0])
        told = told._replace(pair=pair)
        walked.append(float(pair.after[0]))
    np.testing.assert_allclose(walked, [0.67, 0.74, 0.81, 0.88, 0.9, 0.9, 0.9], atol=1e-12)


def test_where_any_may_follow_any_one_step_is_enough():
    command = Command("step_length", 0.3, 0.4)
    pair = tolds.next_pair((command,), told_of([0.4], [0.3], (command,)))
    assert (float(pair.before[0]), float(pair.after[0])) == (0.3, 0.4)


def test_numbers_of_a_step_are_its_policy(robot, family):
    low, high = (np.array([getattr(c, end) for c in family.commands]) for end in ("low", "high"))
    before, after = 0.6 * low + 0.4 * high, 0.5 * low + 0.5 * high
    at = jax.jit(lambda pair: family.at(robot, pair, exact=True))(Pair(before, after))
    numbers = jax.jit(lambda pair: family.parameters_of_step(robot, pair))(Pair(before, after))
    assert numbers.shape == (family.step_size,)
    one = family.from_step_parameters(numbers)
    for z in np.array([[-0.1, 12.0], [0.02, 11.0], [0.15, 14.0]]):
        np.testing.assert_allclose(one(z), at(z), rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(one.z1_range, at.z1_range, rtol=1e-12)
    assert one.step_size == family.step_size


def reading(robot, q, dq, force):
    return Measurement(
        time=jnp.zeros(()),
        pitch=jnp.asarray(float(np.sum(q[:3]))),
        dpitch=jnp.asarray(float(np.sum(dq[:3]))),
        angles=leg_joints(robot.layout, jnp.asarray(q[1:]), jnp.asarray(0)),
        rates=leg_joints(robot.layout, jnp.asarray(dq[1:]), jnp.asarray(0)),
        hip_velocity=standing_hip_velocity(robot, q, dq),
        normal_force=jnp.asarray(force),
    )


@pytest.mark.parametrize("law", [Pd(), Fblin()])
def test_a_wish_waits_for_the_touchdown(robot, speed, law):
    controller = Controller.init(robot, speed, law)
    run = jax.jit(lambda state, seen: step(controller, state, seen))
    q, dq = np.array([0.0, 0.0, 0.1, -0.25, 0.0]), np.zeros(5)
    state = tell(controller, start(controller, 0, jnp.array([0.6])), jnp.array([0.9]))
    state, before = run(state, reading(robot, q, dq, (90.0, 0.0)))
    np.testing.assert_allclose(before.commands, [[0.6], [0.6]])
    state, after = run(state, reading(robot, q, dq, (0.0, 99.0)))
    assert after.touchdown
    np.testing.assert_allclose(after.commands, [[0.6], [0.67]])
    pair = Pair(*jnp.asarray(after.commands))
    np.testing.assert_allclose(
        state.commands.step_parameters, speed.parameters_of_step(robot, pair), rtol=1e-9, atol=1e-9
    )
    # The outputs are those of the new step, at the z that its own interval bounds.
    policy = speed.from_step_parameters(state.commands.step_parameters)
    bounded = controller.bounds.over(policy)(after.z)
    np.testing.assert_allclose(after.y_d, policy(bounded), rtol=1e-9, atol=1e-9)


def test_a_gait_without_commands_is_told_nothing(robot):
    from neuralgaits.barriers import specs

    policy = specs.walking(robot).new_gait(jax.random.key(0), "posture", None).policy
    state = start(Controller.init(robot, policy, Pd()))
    assert [leaf.size for leaf in jax.tree.leaves(state.commands)] == [0, 0, 0, 0]
