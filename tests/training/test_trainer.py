"""Training as an explicit state: steps, resuming, keeping the best."""

from functools import partial

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from neuralgaits.barriers import Recipe
from neuralgaits.gait import posture_path
from neuralgaits.runs import read_tree, write_tree
from neuralgaits.training import start_from_posture
from neuralgaits.training.learning_rate import optimizer_of, width_factor
from neuralgaits.training.trainer import samplers_of
from support.small_spec import REGIONS


def same(one, other):
    for a, b in zip(jax.tree.leaves(one), jax.tree.leaves(other), strict=True):
        assert np.asarray(a).dtype == np.asarray(b).dtype
        np.testing.assert_array_equal(a, b)


@pytest.fixture(scope="module")
def states(trainer, gait):
    """All states of one training, validated every 40 steps, and the losses."""
    state, found, losses = trainer.init(gait), [], []
    while not trainer.done(state):
        state, loss = trainer.step(state)
        if int(state.step) % 40 == 0:
            state = trainer.validate(state)
        found.append(state)
        losses.append(float(loss.total))
    return found, losses


def test_training_lowers_the_loss(states, trainer):
    found, losses = states
    assert len(found) == trainer.steps
    assert np.mean(losses[-10:]) < 0.5 * np.mean(losses[:3])


def test_resuming_from_a_file_is_exact(states, trainer, gait, tmp_path):
    """To the last bit, optimiser and best parameters included."""
    found, _ = states
    write_tree(tmp_path / "state.safetensors", found[54])
    state = read_tree(tmp_path / "state.safetensors", trainer.init(gait))
    same(state, found[54])
    for expected in found[55:]:
        state, _ = trainer.step(state)
        if int(state.step) % 40 == 0:
            state = trainer.validate(state)
        np.testing.assert_array_equal(state.parameters, expected.parameters)
    same(state, found[-1])


def test_steps_come_to_the_same_bits_however_they_are_counted_out(states, trainer, gait):
    found, losses = states
    state = trainer.init(gait)
    for count in (7, 1, 31):
        state, loss = trainer.step(state, count)
        assert float(loss.total) == losses[int(state.step) - 1]
    assert int(state.step) == 39
    same((state.parameters, state.optimizer), (found[38].parameters, found[38].optimizer))


def test_the_best_parameters_are_kept(states, trainer):
    """The lowest of the validated losses, measured again."""
    found, _ = states
    validated = found[39::40]
    losses = [trainer.report(trainer.gait(s.parameters), seed=0).loss for s in validated]
    best = int(np.argmin(losses))
    assert float(found[-1].best_loss) == losses[best]
    np.testing.assert_array_equal(found[-1].best, validated[best].parameters)


def test_a_worse_state_does_not_replace_the_best(states, trainer):
    last = states[0][-1]
    for parameters in (last.parameters + 1.0, jnp.full_like(last.parameters, jnp.nan)):
        kept = trainer.validate(last._replace(parameters=parameters))
        np.testing.assert_array_equal(kept.best, last.best)
        assert float(kept.best_loss) == float(last.best_loss)


def test_the_gait_is_float64_and_holds_the_parameters(states, trainer, gait):
    """What is not trainable is untouched; what is comes back out of the gait."""
    last = states[0][-1]
    found = trainer.gait(last.parameters)
    arrays = [leaf for leaf in jax.tree.leaves(found) if eqx.is_array(leaf)]
    assert all(leaf.dtype == np.float64 for leaf in arrays)
    np.testing.assert_array_equal(trainer.init(found).parameters, last.parameters)
    np.testing.assert_array_equal(found.policy.lower, gait.policy.lower)
    np.testing.assert_array_equal(found.tube.unit, gait.tube.unit)
    assert not np.array_equal(found.tube.lower, gait.tube.lower)


def test_a_report_covers_each_condition_s_region(trainer, gait, spec):
    """Fresh samples inside the regions, and a number for each row that counts."""
    report = trainer.report(gait, seed=3)
    assert list(report.margins) == [c.name for c in spec.conditions]
    assert report.margins["hip"].shape == (8 * 24, 1)
    assert report.margins["rates"].shape == (8 * 12, 4)
    assert report.margins["hips"].shape == (8 * 4, 4)
    _, validation = samplers_of(spec)
    u = np.asarray(validation.draw(jax.random.key(3)))
    assert np.all((u >= 0.0) & (u <= 1.0))
    assert trainer.report(gait, seed=3).loss == report.loss
    assert trainer.report(gait, seed=4).loss != report.loss
    assert len(REGIONS) == 3


@pytest.mark.parametrize("warmup", [0.0, 0.08])
@pytest.mark.parametrize("milestones", [None, (0.1, 0.4, 0.8)])
def test_the_learning_rate(milestones, warmup):
    """Under a constant gradient Adam moves by the learning rate exactly."""
    recipe = Recipe(
        steps=50,
        samples={},
        learning_rate=0.04,
        weight_decay=0.0,
        milestones=milestones,
        warmup=warmup,
    )
    optimizer = optimizer_of(recipe, 50, 0.5)
    gradient, place = jnp.ones(1), jnp.zeros(1)
    state, moves = optimizer.init(place), []
    for _ in range(50):
        move, state = optimizer.update(gradient, state, place)
        moves.append(-np.asarray(move)[0])
    k, rise = np.arange(50), round(50 * warmup)
    expected = 0.01 * (1.0 + np.cos(np.pi * (k - rise) / (50 - rise)))
    if milestones:
        expected = 0.02 * 0.1 ** ((k >= 5) * 1.0 + (k >= 20) + (k >= 40))
    expected[:rise] = 0.02 * k[:rise] / max(rise, 1)
    np.testing.assert_allclose(moves, expected, rtol=1e-6)


@pytest.mark.parametrize(("hidden", "factor"), [((4,), 1.0), ((2, 2), 1.0), ((3, 16), 0.5)])
def test_wider_networks_take_smaller_steps(spec, hidden, factor):
    """One over the root of the width, from the spec's own width of 4."""
    wide = spec.new_gait(jax.random.key(0), "posture", hidden)
    assert width_factor(spec, wide) == pytest.approx(factor)


def test_the_start_from_a_posture(amber, gait):
    """The network ends near the path by inverse kinematics, all over the tube."""
    fitted = start_from_posture(partial(posture_path, amber), gait, 400, jax.random.key(0))
    phases = np.linspace(0.05, 0.95, 7)
    start, guard = (float(end) for end in gait.span)
    targets = posture_path(amber, start + phases * (guard - start))

    def error(some):
        worst = []
        for level in (0.0, 1.0):
            z = jax.vmap(some.z)(np.column_stack([phases, np.full(7, level)]))
            worst.append(np.asarray(jax.vmap(some.policy)(z)) - targets)
        return float(np.sqrt(np.mean(np.square(worst))))

    assert error(fitted) < 0.1 < 0.5 * error(gait)
    np.testing.assert_array_equal(fitted.tube.lower, gait.tube.lower)
