"""A family of policies: hybrid invariant whatever command follows which, exact footholds."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.barriers import specs
from neuralgaits.barriers.commanded_spec import commands_of
from neuralgaits.errors import InputError, SpecError
from neuralgaits.gait import HybridInvariantPolicy, ZeroDynamics
from neuralgaits.gait.believed_robot import believed_robot
from neuralgaits.gait.command_polynomials import plain_curves
from neuralgaits.gait.commands import Command, Pair, all_pairs, pair_at, values
from neuralgaits.gait.policies.commanded import CommandedPolicy
from neuralgaits.gait.policies.step_ends import Foothold, on_foothold_exactly, with_hip_at
from neuralgaits.gait.posture import hip_indices, walking_posture
from neuralgaits.gait.tubes import CommandedTube
from neuralgaits.robots import load_robot
from neuralgaits.robots.dynamics import swing_foot

SPEED = Command("speed", 0.5, 0.9, 0.08)
LENGTH, HEIGHT = Command("step_length", 0.3, 0.4), Command("step_height", -0.01, 0.01)
SLOPE = Command("slope", -0.03, 0.03, 0.02)
SHORT = Command("step_length", 0.28, 0.36)
"""Within reach of the leg downhill as well."""
LEAN = Command("lean", -0.02, 0.02, 0.0048)
FAMILIES = {
    "speed": (SPEED,),
    "footholds": (LENGTH, HEIGHT),
    "all": (SPEED, SHORT, SLOPE),
    "lean": (LEAN, SPEED),
}


def wild(family, key):
    """The family with guards that depend on the command, and a steep network."""
    draws = jax.random.split(key, 3)
    outputs = 0.005 * jax.random.normal(draws[0], family.guard_outputs.shape)
    slopes = 0.1 * jax.random.normal(draws[1], family.guard_slopes.shape)
    weights = jax.tree.map(lambda leaf: 5.0 * leaf, family.network.weights)
    curves = plain_curves(family.commands) + 0.05
    return eqx.tree_at(
        lambda f: (f.guard_outputs, f.guard_slopes, f.network.weights, f.curves),
        family,
        (family.guard_outputs + outputs, family.guard_slopes + slopes, weights, curves),
    )


ON = {"speed": "rabbit", "footholds": "amber3m", "all": "amber3m", "lean": "amber3m"}


@pytest.fixture(scope="module", params=ON.items(), ids=list(ON))
def family(request):
    name, robot = request.param[0], load_robot(request.param[1])
    made = CommandedPolicy.init(robot, FAMILIES[name], key=jax.random.key(2), hidden=(8,))
    return robot, wild(made, jax.random.key(3))


def command_at(commands, shares):
    return jnp.stack([c.low + s * (c.high - c.low) for c, s in zip(commands, shares, strict=True)])


def test_whatever_follows_begins_where_the_impact_leaves_the_robot(family):
    """Three commands in a row: the impact between two steps lands on the next one's manifold."""
    robot, policy = family
    draws = np.random.default_rng(5).uniform(size=(8, 3, len(policy.commands)))

    def mismatch(shares):
        first, second, third = (command_at(policy.commands, row) for row in shares)
        now = policy.at(robot, Pair(first, second), exact=True)
        then = policy.at(robot, Pair(second, third), exact=True)
        momentum = 3.0 * now.input_scale[1]
        # The impact is that of the robot that the gait believes in.
        walks = believed_robot(robot, policy.commands, second)
        point = ZeroDynamics(walks, now).point(jnp.stack([now.z_guard, momentum]))
        after = point.impact
        eta, z = ZeroDynamics(walks, then).phi(jnp.concatenate([after.q, after.dq]))
        ratio = z[1] / momentum - now.momentum_ratio
        return eta, z[0] - then.z_start, ratio, point.foot_above_ground

    for found in jax.jit(jax.vmap(mismatch))(draws):
        assert np.max(np.abs(found)) < 1e-8


def test_the_foot_is_on_its_foothold(family):
    robot, policy = family
    names = [c.name for c in policy.commands]
    draws = np.random.default_rng(6).uniform(size=(16, len(names)))

    def foot(shares):
        command = command_at(policy.commands, shares)
        step = policy.at(robot, Pair(command, command))
        z = jnp.stack([step.z_guard, 3.0 * step.input_scale[1]])
        return command, ZeroDynamics(robot, step).point(z).foot

    command, feet = jax.jit(jax.vmap(foot))(draws)
    if "step_length" in names:
        np.testing.assert_allclose(feet[:, 0], command[:, names.index("step_length")], atol=1e-9)
    height = np.zeros(len(draws))
    if "step_height" in names:
        height = command[:, names.index("step_height")]
    if "slope" in names:
        height = feet[:, 0] * np.tan(command[:, names.index("slope")])
    np.testing.assert_allclose(feet[:, 1], height, atol=1e-9)


def test_the_clip_of_training_changes_nothing_inside_the_bounds(family):
    robot, policy = family
    command = command_at(policy.commands, np.full(len(policy.commands), 0.3))
    exact = policy.at(robot, Pair(command, command), exact=True)
    clipped = policy.at(robot, Pair(command, command))
    bounded = policy.at(robot, Pair(command, command), exact=True, bounded=True)
    for name in ("cubic", "z_start", "z_guard", "start_outputs", "momentum_ratio"):
        np.testing.assert_array_equal(getattr(exact, name), getattr(clipped, name))
        # The closed form of the foothold in place of Newton's steps.
        np.testing.assert_allclose(getattr(exact, name), getattr(bounded, name), atol=1e-9)
    z = jnp.stack([0.5 * (exact.z_start + exact.z_guard), 3.0 * exact.input_scale[1]])
    np.testing.assert_allclose(exact(z), clipped(z), rtol=1e-12)


def test_one_command_that_stays_is_an_ordinary_policy():
    """The plain policy of the same guard, matched to the robot, is the family's member."""
    robot = load_robot("amber3m")
    policy = wild(
        CommandedPolicy.init(robot, (SPEED,), key=jax.random.key(2), hidden=(8,)), jax.random.key(3)
    )
    command = jnp.array([0.6])
    step = policy.at(robot, Pair(command, command))
    plain = HybridInvariantPolicy.init(robot, key=jax.random.key(0), hidden=(8,))
    plain = eqx.tree_at(
        lambda p: (p.network, p.guard_outputs, p.guard_slopes, p.z_guard),
        plain,
        (step.network, step.guard_outputs, step.guard_slopes, step.z_guard),
    ).match_impact(robot)
    for name in ("z_start", "cubic", "start_outputs", "start_slopes", "momentum_ratio"):
        np.testing.assert_allclose(getattr(plain, name), getattr(step, name), atol=1e-9)
    z = jnp.array([0.03, 14.0])
    np.testing.assert_allclose(plain(z), step(z), atol=1e-10)


@pytest.mark.parametrize("command", [SPEED, LENGTH])
def test_the_chart_holds_every_pair_that_may_follow(command):
    """And no other but where the box of (middle, difference) has corners."""
    rng = np.random.default_rng(0)
    before = rng.uniform(command.low, command.high, 1000)
    after = rng.uniform(command.low, command.high, 1000)
    if command.largest_change is not None:
        after = before + np.clip(after - before, -command.largest_change, command.largest_change)
    axes = command.axes
    pairs = zip(before, after, strict=True)
    first, second = np.array([command.coordinates(*pair) for pair in pairs]).T
    for value, (_, low, high) in zip((first, second), axes, strict=True):
        assert np.all((low - 1e-12 <= value) & (value <= high + 1e-12))
    again = jax.vmap(lambda v: pair_at((command,), v))(np.stack([first, second], axis=1))
    np.testing.assert_allclose(again.before[:, 0], before, atol=1e-12)
    np.testing.assert_allclose(again.after[:, 0], after, atol=1e-12)
    if (largest := command.largest_change) is None:
        return
    # What else it holds is hardly outside: one of a pair, by an eighth of the largest change.
    grids = np.meshgrid(*(np.linspace(low, high, 41) for _, low, high in axes))
    points = np.stack([grid.ravel() for grid in grids], axis=1)
    held = jax.vmap(lambda v: jnp.concatenate(pair_at((command,), v)))(points)
    outside = np.maximum(command.low - held, held - command.high).max()
    assert outside == pytest.approx(largest / 8.0)


@pytest.mark.parametrize("command", [SPEED, LENGTH])
def test_pairs_are_admissible_and_reach_every_end(command):
    before, after = command.pairs(5).T
    change = command.largest_change or command.high - command.low
    for values_ in (before, after):
        assert values_.min() == command.low and values_.max() == command.high
    assert np.max(np.abs(after - before)) == pytest.approx(change)
    assert np.all(np.abs(after - before) <= change + 1e-12)
    both = all_pairs((SPEED, LENGTH), 2)
    assert both.shape == (16, 4) and len(np.unique(both, axis=0)) == 16
    assert all_pairs((), 2).shape == (1, 0)


def test_fences_depend_on_the_command_before_at_the_start_and_after_at_the_guard():
    robot = load_robot("amber3m")
    tube = specs.commanded(robot, (SPEED,)).new_gait(jax.random.key(0), "posture", None).tube
    assert isinstance(tube, CommandedTube)
    noise = 0.02 * np.random.default_rng(1).normal(size=(2, *tube.lower.shape))
    tube = eqx.tree_at(lambda t: (t.lower, t.upper), tube, (tube.lower + noise[0], tube.upper))
    a, b, c = (jnp.array([x]) for x in (-0.8, 0.1, 0.7))
    ab, ac, cb = (tube.at(Pair(*pair), exact=True) for pair in ((a, b), (a, c), (c, b)))
    np.testing.assert_allclose(ab.fences(0.0), ac.fences(0.0), rtol=1e-13)
    np.testing.assert_allclose(ab.fences(1.0), cb.fences(1.0), rtol=1e-13)
    assert not np.allclose(ab.fences(0.5), ac.fences(0.5))
    # In between, F(t, c) at the point of the line between the commands.
    middle = tube.at(Pair(0.5 * (a + b), 0.5 * (a + b)), exact=True)
    np.testing.assert_allclose(ab.fences(0.5), middle.fences(0.5), rtol=1e-13)


def test_values_outside_their_range_are_refused():
    assert values((LENGTH, HEIGHT), {"step_height": 0.0, "step_length": 0.3}).tolist() == [0.3, 0.0]
    with pytest.raises(InputError, match=r"expected speed between 0.5 and 0.9 m/s, found 1"):
        values((SPEED,), {"speed": 1.0})
    with pytest.raises(InputError, match=r"expected a value for each .* speed, found pace"):
        values((SPEED,), {"pace": 0.6})
    with pytest.raises(InputError, match=r"found nan"):
        values((SPEED,), {"speed": np.nan})
    with pytest.raises(InputError, match=r"expected speed as a number, found None"):
        values((SPEED,), {"speed": None})
    with pytest.raises(InputError, match=r"expected a value for each .* speed, found 1"):
        values((SPEED,), {1: 0.6})


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("speed", 0.9, 0.5), "LOW < HIGH, found 0.9:0.5"),
        (("speed", 0.5, np.inf), "LOW < HIGH"),
        (("speed", 0.5, 0.9, 0.0), "a largest change above 0"),
        (("a/b", 0.5, 0.9), "has a slash"),
    ],
)
def test_commands_that_are_none_are_refused(arguments, words):
    with pytest.raises(SpecError, match=words):
        Command(*arguments)


def test_a_family_has_no_outputs_of_its_own():
    policy = CommandedPolicy.init(load_robot("amber3m"), (SPEED,), key=jax.random.key(0))
    with pytest.raises(InputError, match=r"ask .at\(robot, pair\) first"):
        policy(jnp.zeros(2))


@pytest.mark.parametrize("name", ["amber3m", "rabbit"])
def test_the_foot_is_put_on_its_foothold_in_closed_form(name):
    """From up to 0.2 rad off, on slopes, by the hip alone or with the last joint for the length."""
    robot = load_robot(name)
    posture = walking_posture(robot)
    random, z_guard = np.random.default_rng(7), jnp.asarray(posture.z_guard)
    reach = jnp.asarray(0.3 * robot.leg_length)

    def feet(shift, height, rise):
        outputs = posture.guard_outputs + shift
        free = Foothold(height=height, rise=rise)
        told = Foothold(reach, height, rise)
        ends = [on_foothold_exactly(robot, z_guard, outputs, each) for each in (free, told)]
        places = [swing_foot(robot, with_hip_at(robot, z_guard, end)) for end in ends]
        return jnp.stack(places), jnp.stack([end - outputs for end in ends])

    shifts = random.uniform(-0.02, 0.02, (16, robot.n - 1))
    heights, rises = random.uniform(-0.01, 0.01, 16), random.uniform(-0.03, 0.03, 16)
    places, moved = jax.jit(jax.vmap(feet))(shifts, heights, rises)
    for along, up in places.transpose(1, 2, 0):
        np.testing.assert_allclose(up, heights + rises * along, atol=1e-9)
    np.testing.assert_allclose(places[:, 1, 0], reach, atol=1e-9)
    assert 0.1 < np.abs(moved).max() < 0.6
    hip, last = hip_indices(robot)[-1], robot.n - 2
    others = [joint for joint in range(robot.n - 1) if joint not in (hip, last)]
    assert np.all(moved[:, :, others] == 0.0) and np.all(moved[:, 0, last] == 0.0)


def test_the_usual_largest_change_is_written_with_few_digits():
    """It stands, exactly, in the statements of a proof."""
    (speed,) = commands_of(speed=(0.55, 0.90))
    assert repr(speed.largest_change) == "0.042"
    (slope,) = commands_of(slope=(-0.03, 0.03))
    assert slope.largest_change == pytest.approx(0.0072, rel=1e-6)


@pytest.mark.parametrize(
    ("width", "alone", "beside_speed"),
    [(0.004, 0.002, 0.001), (0.02, 0.0048, 0.0024), (0.04, 0.0048, 0.0032), (0.06, 0.0048, 0.0048)],
)
def test_a_lean_beside_a_speed_changes_half_as_fast_but_crosses_its_range(
    width, alone, beside_speed
):
    ends = (-0.5 * width, 0.5 * width)
    (lean,) = commands_of(lean=ends)
    assert lean.largest_change == pytest.approx(alone)
    speed, lean = commands_of(speed=(0.55, 0.90), lean=ends)
    assert speed.largest_change == pytest.approx(0.021)
    assert lean.largest_change == pytest.approx(beside_speed)
