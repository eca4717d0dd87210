"""What trials count: against an environment whose walk is known, and against its own episodes."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("gymnasium", reason="needs the gym extra: gymnasium")

from neuralgaits.errors import InputError
from neuralgaits.gym_env import BipedEnv, trials
from neuralgaits.gym_env.trials import LONGEST_S

DECISION_S, STRIDE_M, WORK_J, WEIGHT_N = 0.25, 0.125, 3.0, 200.0


class Known:
    """A step of `STRIDE_M` in every decision, until the decision in which it falls."""

    def __init__(self, falls_in: int | None, moves: bool = True):
        self._falls_in, self._moves = falls_in, moves
        self.asked: list[float] = []

    def reset(self, *, seed, options):
        self.asked.append(options["speed"])
        self.body = SimpleNamespace(
            hip=np.array([float(seed), 1.0]),
            data=SimpleNamespace(time=0.0),
            work=0.0,
            weight=WEIGHT_N,
        )
        self._decisions = 0
        return np.zeros(1), {"steps": 0, "ending": None}

    def step(self, action):
        assert action == 1.0
        body = self.body
        self._decisions += 1
        body.data.time += DECISION_S
        if self._moves:
            body.hip = body.hip + np.array([STRIDE_M, 0.0])
            body.work += WORK_J
        fell = self._decisions == self._falls_in
        info = {
            "steps": self._decisions if self._moves else 0,
            "ending": "hip too low" if fell else None,
        }
        return np.zeros(1), 0.0, fell, False, info


def act(seen):
    return np.ones(1)


def of(env, **settings):
    return trials(env, act, speed=0.7, **settings)


def test_speed_and_cost_of_walks_are_those_of_the_body():
    env = Known(None)
    found = of(env, steps=8, count=3)
    assert found.walked == (8, 8, 8) and found.done == 3 and found.endings == (None,) * 3
    assert found.up_s == pytest.approx([8 * DECISION_S] * 3)
    assert found.speed_m_s == pytest.approx(STRIDE_M / DECISION_S)
    assert found.cost_of_transport == pytest.approx(WORK_J / (WEIGHT_N * STRIDE_M))
    assert env.asked == [0.7] * 3


@pytest.mark.parametrize(("falls_in", "walked"), [(1, 1), (5, 5), (8, 7)])
def test_a_fall_is_no_walk_even_in_the_last_step(falls_in, walked):
    found = of(Known(falls_in), steps=8, count=2)
    assert found.walked == (walked, walked) and found.done == 0
    assert found.endings == ("hip too low",) * 2
    assert found.speed_m_s is None and found.cost_of_transport is None
    assert str(found) == f"0 of 2 walked 8 steps, up {falls_in * DECISION_S:.1f} s on average"


def test_who_does_not_step_runs_out_of_time():
    found = of(Known(None, moves=False), steps=1, count=1)
    assert found.walked == (0,) and found.endings == (None,) and found.done == 0
    assert found.up_s == pytest.approx([LONGEST_S])


@pytest.mark.parametrize("settings", [{"steps": 0}, {"count": 0}, {"steps": 1.5}, {"count": "a"}])
def test_nothing_to_walk_is_refused(settings):
    with pytest.raises(InputError, match="whole number of at least 1, found"):
        of(Known(None), **settings)


def test_what_is_no_environment_or_no_policy_is_refused():
    calls: Any = trials
    with pytest.raises(InputError, match=r"give `env.unwrapped`"):
        calls(5, lambda seen: seen, speed=0.6)
    with pytest.raises(InputError, match="expected a function of an observation"):
        calls(BipedEnv("amber3m"), 5, speed=0.6)


def test_of_a_robot_they_are_its_episodes():
    """The same seeds, stepped through by hand."""
    env = BipedEnv("amber3m")
    still = np.zeros(4)
    found = trials(env, lambda seen: still, speed=0.6, steps=1000, count=3)
    for seed in range(3):
        _, info = env.reset(seed=seed, options={"speed": 0.6})
        fell = False
        while not fell:
            *_, fell, _, info = env.step(still)
        assert found.endings[seed] == info["ending"] is not None
        assert found.walked[seed] == info["steps"]
        assert found.up_s[seed] == env.body.data.time
