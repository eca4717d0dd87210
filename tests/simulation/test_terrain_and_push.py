import numpy as np

from neuralgaits.simulation.setup.push import DURATION_S, STEPS_BEFORE, WINDOW_S, Push
from neuralgaits.simulation.setup.uneven_floor import UnevenFloor

DOWN, UP = np.array([True]), np.array([False])
LEG = np.array([0])


def footholds(seed, episode_count=1, steps=40, height=0.01):
    """Levels of the stance foothold, step after step, of the last episode."""
    terrain = UnevenFloor(height, seed, episode_count)
    ones, heard = np.ones(episode_count), []
    for step in range(steps):
        leg = np.full(episode_count, step % 2)
        terrain.advance(ones > 0, leg, -0.1 * ones, 0.03 * ones)
        assert not terrain.advance(ones < 0, leg, -0.1 * ones, 0.03 * ones)
        terrain.advance(ones < 0, leg, 0.1 * ones, 0.03 * ones)
        heard.append(terrain.levels[-1, 1 - step % 2])
    return np.array(heard)


def test_each_foothold_is_a_step_up_down_or_level():
    rises = np.round(np.diff(footholds(0), prepend=0.0), 12)
    assert set(rises) == {-0.01, 0.0, 0.01}


def test_levels_depend_on_seed_and_episode_only():
    np.testing.assert_array_equal(footholds(3), footholds(3))
    assert not np.array_equal(footholds(3), footholds(4))
    lonely, last_of_three = footholds(3), footholds(3, 3)
    assert not np.array_equal(lonely, last_of_three)
    np.testing.assert_array_equal(last_of_three, footholds(3, 3))


def test_a_floor_waits_until_the_foot_is_above_it():
    terrain = UnevenFloor(0.01, 0, 1)
    for _ in range(50):
        terrain.advance(DOWN, LEG, np.array([-0.1]), np.array([0.0]))
        assert not terrain.advance(UP, LEG, np.array([0.1]), np.array([-0.02]))
    assert not terrain.levels.any()


def test_a_flat_floor_stays_flat():
    assert not footholds(0, height=0.0).any()


def test_a_push_gives_its_impulse_once_after_the_first_steps():
    push = Push(-8.0, steps=50, seed=1, episodes=3)
    count, impulse, first = np.zeros(3, dtype=int), np.zeros(3), np.full(3, np.inf)
    for tick in range(6000):
        time = tick * 1e-3
        touchdown = np.full(3, tick % 600 == 599)
        count += touchdown
        force = push.at(time, touchdown, count)
        impulse += 1e-3 * force
        first = np.where((force != 0) & ~np.isfinite(first), time, first)
    np.testing.assert_allclose(impulse, -8.0, rtol=0.02)
    begun = 0.6 * STEPS_BEFORE
    assert np.all((first >= begun - 2e-3) & (first <= begun + WINDOW_S))
    assert len(set(first)) == 3
    assert DURATION_S == 0.1


def test_a_short_episode_is_pushed_half_way():
    push = Push(8.0, steps=2, seed=0, episodes=1)
    forces = [push.at(0.6 + t * 1e-3, DOWN if t == 0 else UP, np.array([1])) for t in range(700)]
    assert any(force[0] for force in forces)
