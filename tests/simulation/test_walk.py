"""Real walks in MuJoCo: the published gaits, alone, in batches and disturbed."""

import jax
import numpy as np
import pytest

from neuralgaits.errors import InputError
from neuralgaits.simulation.metrics import summary
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.simulation.ticks import world
from neuralgaits.simulation.ticks.falls import Ending
from neuralgaits.simulation.walk import walk

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def batch(amber, slow, brisk):
    """Two published gaits side by side, 20 steps each."""
    policies, starts = zip(slow, brisk, strict=True)
    return walk(amber, policies, np.array(starts), controller="fblin", steps=20)


def test_published_gaits_walk(batch, gaits):
    assert batch.episodes.endings == [Ending.WALKED, Ending.WALKED]
    figures = summary(batch)
    assert figures["steps_walked"] == [20, 20]
    assert figures["fell"] == [False, False]
    assert figures["fall_reasons"] == [None, None]
    assert figures["max_output_error_rad"] < 2e-3
    assert figures["min_normal_force_n"] > 100.0
    assert figures["saturated_fraction"] < 0.01
    steady = [gaits[name]["recomputed"]["steady"] for name in ("0.51", "0.67")]
    for name, theirs in {"speed_m_s": "v", "cost_of_transport": "mech_cot"}.items():
        mean = np.mean([one[theirs] for one in steady])
        assert figures[name] == pytest.approx(mean, rel=0.06)


@pytest.mark.parametrize(("episode", "name"), [(0, "0.51"), (1, "0.67")])
def test_the_gait_is_the_one_of_the_rigid_model(amber, gaits, batch, episode, name):
    """Compliant contact and finite gains cost a few per cent of speed, no more."""
    steady = gaits[name]["recomputed"]["steady"]
    gauge = jax.tree.map(lambda leaf: leaf[episode], batch.episodes.gauge)
    distance, time = gauge.last.hip - gauge.first.hip, gauge.last.time - gauge.first.time
    assert distance / time == pytest.approx(steady["v"], rel=0.06)
    assert distance / (gauge.steps - 2) == pytest.approx(steady["L"], rel=0.02)
    assert gauge.steady.settled_torque == pytest.approx(steady["umax"], rel=0.05)
    work = gauge.last.energy - gauge.first.energy
    cost = work / (float(amber.mass * amber.gravity) * distance)
    assert cost == pytest.approx(steady["mech_cot"], rel=0.05)


def test_an_episode_does_not_depend_on_its_neighbours(amber, slow, brisk):
    policy, x = brisk
    asked = {"controller": "fblin", "steps": 3}
    both = [slow[0], policy], np.array([slow[1], x])
    alone = walk(amber, policy, x[None], **asked).episodes.gauge
    together = walk(amber, *both, **asked).episodes.gauge
    assert alone.ticks[0] == together.ticks[1]
    np.testing.assert_allclose(alone.last.hip[0], together.last.hip[1], rtol=1e-7)
    np.testing.assert_allclose(alone.energy[0], together.energy[1], rtol=1e-6)


def test_a_walk_can_be_repeated_and_threads_change_nothing(amber, brisk, monkeypatch):
    policy, x = brisk
    noisy = PlantChanges(encoder_noise=1e-4, floor_height=0.002)
    # Two episodes, a thread for each.
    monkeypatch.setattr(world, "_MIN_EPISODES_PER_THREAD", 1)
    runs = [
        walk(
            amber,
            [policy, policy],
            np.tile(x, (2, 1)),
            controller="fblin",
            steps=1,
            disturbance=noisy,
            seed=seed,
            threads=threads,
        ).episodes.gauge
        for seed, threads in ((5, 1), (5, 2), (6, 1))
    ]
    np.testing.assert_array_equal(runs[0].energy, runs[1].energy)
    assert not np.array_equal(runs[0].energy, runs[2].energy)
    assert len(set(runs[0].energy)) > 1


def test_a_robot_that_falls_says_why(amber, brisk):
    policy, x = brisk
    backwards = x.copy()
    backwards[5:] *= -1.0
    leaning = x.copy()
    leaning[2] += 1.3
    starts = np.array([backwards, leaning])
    walked = walk(amber, [policy, policy], starts, controller="fblin", steps=20)
    figures = summary(walked)
    assert figures["fell"] == [True, True]
    assert all(figures["fall_reasons"])
    assert figures["speed_m_s"] is None
    assert figures["steps_walked"][0] == 0


def test_pushes_move_the_robot_their_way(amber, brisk):
    policy, x = brisk
    hips = []
    for impulse in (-4.0, 0.0, 4.0):
        walked = walk(
            amber, policy, x[None], controller="fblin", steps=5, push=impulse, record=True
        )
        assert walked.episodes.endings == [Ending.WALKED]
        hips.append(walked.episodes.gauge.last.time[0])
    assert hips[0] > hips[1] > hips[2]


def test_a_delay_delays_the_torques(amber, brisk):
    policy, x = brisk
    prompt, late = (
        walk(
            amber,
            policy,
            x[None],
            controller="fblin",
            steps=1,
            disturbance=PlantChanges(delay_ms=delay),
            record=True,
        ).episodes.states
        for delay in (0, 4)
    )
    # Without torque for the first 4 ms the states part in the first tick.
    assert not np.array_equal(prompt[1], late[1])
    np.testing.assert_array_equal(prompt[0], late[0])


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"controller": "lqr"}, "unknown controller 'lqr': expected one of pd, fblin, paper"),
        ({"steps": 0}, "steps: expected a whole number of at least 1, found 0"),
        ({"push": float("nan")}, "push: expected a finite impulse"),
        ({"starts": np.zeros((1, 9))}, r"shape [episodes, 10], found (1, 9)"),
        ({"starts": np.full((1, 10), np.nan)}, "finite full states"),
        ({"starts": np.zeros((0, 10))}, "found (0, 10)"),
    ],
)
def test_bad_input_is_refused_in_one_line(amber, brisk, change, says):
    policy, x = brisk
    arguments = {"starts": x[None], "steps": 1} | change
    with pytest.raises(InputError) as refusal:
        walk(amber, policy, **arguments)
    assert says in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_as_many_policies_as_starts_are_wanted(amber, brisk):
    policy, x = brisk
    with pytest.raises(InputError, match="expected one policy or 1, one a start; found 2"):
        walk(amber, [policy, policy], x[None])
