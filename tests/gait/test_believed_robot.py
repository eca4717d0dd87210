"""The robot of a step: the one that is believed, and those that are near it."""

from dataclasses import replace
from functools import partial

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.barriers import specs
from neuralgaits.barriers.commanded_spec import LEAN_ERROR, commands_of
from neuralgaits.certificate.traced import trace_spec
from neuralgaits.errors import SpecError
from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.believed_robot import robot_of_step
from neuralgaits.gait.commands import Command, Pair
from neuralgaits.gait.gaits import Gait
from neuralgaits.gait.policies.commanded_gait import CommandedGait
from neuralgaits.programs import POINT, evaluate
from neuralgaits.robots import load_robot
from neuralgaits.robots.mjcf.loader import robot_from_text
from neuralgaits.robots.mjcf.parameters import model_of
from neuralgaits.training import margin_matrix
from support.edited_robot import edited
from support.random_biped import random_biped

LEAN = Command("lean", -0.02, 0.02, 0.0048)
BEFORE, AFTER, ERROR = 0.006, 0.0075, -0.0025


@pytest.fixture(scope="module")
def leaning():
    """A spec of gaits that are told a lean, its gait before any training, and the one of a step."""
    spec = specs.commanded(load_robot("amber3m"), (LEAN,), speed=0.7)
    gait = spec.new_gait(jax.random.key(3), "posture", (8,))
    assert isinstance(gait, CommandedGait)
    pair = Pair(jnp.array([BEFORE]), jnp.array([AFTER]))
    return spec, gait, eqx.filter_jit(gait.of_pair)(load_robot("amber3m"), pair)


def edited_by(lean):
    return edited("amber3m", {"centre of mass of torso across (error in m)": -lean})


def test_a_step_is_walked_by_the_robot_near_the_belief_of_that_step(leaning):
    """Not by that of the step before; the policy is of the belief alone."""
    spec, _, step = leaning
    robot = load_robot("amber3m")
    found = robot_of_step(model_of(robot, spec.parameters), step, np.array([ERROR]))
    q = np.full(robot.n, 0.2)
    expected = edited_by(AFTER + ERROR).mass_matrix(q)
    np.testing.assert_allclose(found.mass_matrix(q), expected, rtol=1e-9)
    exactly = robot_of_step(robot, step, np.zeros(0)).mass_matrix(q)
    np.testing.assert_allclose(exactly, edited_by(AFTER).mass_matrix(q), rtol=1e-9)
    assert np.abs(np.asarray(exactly) - np.asarray(expected)).max() > 1e-3


def test_a_gait_without_leans_is_walked_by_the_robot_itself(amber):
    gait = specs.walking(amber).new_gait(jax.random.key(0), "posture", (4,))
    assert isinstance(gait, Gait)
    assert robot_of_step(amber, gait, np.zeros(0)) is amber


def test_training_and_proof_evaluate_that_robot(leaning):
    """Margins of a gait for the edited robot, with the policy of the believed one."""
    spec, gait, step = leaning
    names = "torque-upper", "friction-forward", "reset-above-lower-fence"
    few = tuple(one for one in spec.conditions if one.name in names)
    assert len(few) == len(names)
    spec, robot = replace(spec, conditions=few, aims=(), weights={}), load_robot("amber3m")
    zd, plane = ZeroDynamics(edited_by(AFTER + ERROR), step.policy), [0.4, 0.6]
    expected = eqx.filter_jit(spec.margins)(step, zd, jnp.array(plane))
    u = np.array([*plane, *LEAN.coordinates(BEFORE, AFTER), ERROR])
    model = model_of(robot, spec.parameters)
    trained, _ = jax.jit(partial(margin_matrix, spec, model, gait))(u[None])
    flat = np.concatenate([np.ravel(expected[one.name]) for one in few])
    np.testing.assert_allclose(trained[0], flat, rtol=1e-7, atol=1e-7)
    # A Program is a function of the pair itself.
    u[2:4] = BEFORE, AFTER
    proved = evaluate(trace_spec(spec, robot, gait), {"u": u[None]}, POINT)
    for name, value in expected.items():
        np.testing.assert_allclose(
            np.ravel(proved[name]), np.ravel(value), rtol=1e-6, atol=1e-7, err_msg=name
        )


def test_a_spec_with_leans_is_for_robots_near_the_belief_and_knows_z1_alone(leaning):
    spec, gait, _ = leaning
    (axis,) = spec.parameters
    assert axis == ("lean of torso beyond the belief (error in m)", LEAN_ERROR)
    assert not gait.policy.z2_dependence
    assert [aim.name for aim in spec.aims] == ["middle-followed", "middle-returns", "mean-speed"]
    other = specs.load("walking", load_robot("amber3m"), (LEAN,), parameters={"lean": 0.001})
    assert other.parameters[0].half == 0.001


def test_the_largest_change_of_a_lean_is_a_length():
    wide, narrow = (commands_of(lean=(-x, x))[0] for x in (0.03, 0.002))
    assert wide.largest_change == 0.0048 and narrow.largest_change == 0.002


def test_a_speed_beside_a_lean_changes_half_as_fast():
    """A tube has to follow both at once; other commands keep their change, alone and beside it."""
    told = commands_of(speed=(0.55, 0.90), step_height=(-0.01, 0.01), lean=(-0.03, 0.03))
    assert [one.largest_change for one in told] == [0.021, None, 0.0048]
    (speed, slope) = commands_of(speed=(0.55, 0.90), slope=(-0.03, 0.03))
    assert speed.largest_change == 0.042 and slope.largest_change == 0.0072


@pytest.mark.parametrize(
    ("box", "commands", "words"),
    [
        ({"lean": 0.003}, (), "expected a gait that takes lean as command"),
        ({"mass": 0.01}, (LEAN,), "expected lean alone .* found mass: leave that out"),
        ({"lean": 0.003, "com": 0.001}, (LEAN,), "found com: leave that out"),
    ],
)
def test_boxes_that_do_not_go_with_leans_are_refused(amber, box, commands, words):
    with pytest.raises(SpecError, match=words):
        specs.load("walking", amber, commands, parameters=box)


def test_leans_that_no_robot_walks_with_are_refused(amber):
    legs = robot_from_text(random_biped(3, 2, torso=False), "legs")
    with pytest.raises(SpecError, match="command lean: expected a robot with a torso, found legs"):
        specs.commanded(legs, (LEAN,))
    far = Command("lean", -0.4, 0.1, 0.0048)
    with pytest.raises(SpecError, match=r"leans below 0\.\d+ m, .* found 0.4 m: ask for less"):
        specs.commanded(amber, (far,))
