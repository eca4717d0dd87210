"""Time of a live page: pace, pause, single steps, wishes and resets."""

import time

import numpy as np
import pytest

from neuralgaits.viewer.player import STEP_S, Player
from neuralgaits.viewer.walker import Margins, WalkFrame

PERIOD_S = 1e-3


class Clockwork:
    """A walker that does nothing but count, and falls when told to."""

    period_s = PERIOD_S

    def __init__(self):
        self.ticks, self.fall, self.resets, self.pushes = 0, None, 0, []

    def tick(self):
        if self.fall is not None:
            return False
        self.ticks += 1
        return True

    def shown(self):
        nothing = np.zeros(2)
        now = self.ticks * PERIOD_S
        return WalkFrame(
            time=now,
            walked=now,
            qpos=nothing,
            hip=nothing,
            slope=0.0,
            ground=0.0,
            z=nothing,
            trail=np.zeros((0, 2)),
            steps=0,
            speed=0.0,
            force=nothing,
            fall=self.fall,
        )

    def margins(self, z):
        return Margins(np.zeros(1), np.ones(1, dtype=bool))

    def push(self, impulse):
        self.pushes.append(np.asarray(impulse))

    def disturb(self, name, value):
        raise ValueError(f"{name} {value}")

    def tell(self, name, value):
        raise ValueError(f"{name} {value}")

    def adapt(self, active):
        raise ValueError(f"adapt {active}")

    def resize(self, name, size):
        raise ValueError(f"{name} {size}")

    def jump(self, z):
        return "not there" if z[0] > 0.0 else None

    def reset(self):
        self.fall, self.resets = None, self.resets + 1


@pytest.fixture
def played():
    """Walker, player and its pictures; the player is stopped at the end."""
    walker, pictures = Clockwork(), []
    player = Player(walker, pictures.append)
    yield walker, player, pictures
    player.stop()


def until(condition, seconds=300.0):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "it did not happen"
        time.sleep(0.005)


def test_simulated_time_keeps_pace_with_the_clock(played):
    walker, player, pictures = played
    player.start()
    until(lambda: len(pictures) > 3)
    start_time, ticks = time.perf_counter(), walker.ticks
    time.sleep(1.0)
    paced = (walker.ticks - ticks) * PERIOD_S / (time.perf_counter() - start_time)
    # A busy machine may play slower, but never faster.
    assert 0.0 < paced < 1.1
    player.speed = 0.25
    time.sleep(0.1)
    start_time, ticks = time.perf_counter(), walker.ticks
    time.sleep(0.8)
    assert (walker.ticks - ticks) * PERIOD_S / (time.perf_counter() - start_time) < 0.35


def test_a_pause_freezes_time_and_a_step_lets_a_little_pass(played):
    walker, player, pictures = played
    player.paused = True
    player.start()
    until(lambda: len(pictures) > 5)
    assert walker.ticks == 0
    assert pictures[-1].paused
    player.step()
    until(lambda: walker.ticks)
    seen = len(pictures)
    until(lambda: len(pictures) > seen + 3)
    assert walker.ticks == round(STEP_S / PERIOD_S)


def test_a_wish_is_granted_while_time_stands_still_and_answered(played):
    walker, player, pictures = played
    player.paused = True
    player.start()
    player.ask(lambda one: one.push(np.array([3.0, 0.0])))
    player.ask(lambda one: one.jump(np.array([1.0, 0.0])))
    until(lambda: any(picture.answer for picture in pictures))
    assert [picture.answer for picture in pictures if picture.answer] == ["not there"]
    np.testing.assert_array_equal(walker.pushes, [[3.0, 0.0]])


def test_a_fall_waits_for_the_visitor_or_resets_itself(played):
    walker, player, pictures = played
    player.start()
    walker.fall = "hip too low"
    until(lambda: any(picture.shown.fall for picture in pictures))
    time.sleep(0.2)
    assert walker.resets == 0
    assert pictures[-1].reset_in is None
    player.reset_after = 0.5
    until(lambda: walker.resets == 1)
    counted = [picture.reset_in for picture in pictures if picture.reset_in is not None]
    assert counted == sorted(counted, reverse=True)
    until(lambda: pictures[-1].shown.fall is None)
    ticks = walker.ticks
    until(lambda: walker.ticks > ticks)


def test_a_failure_of_its_thread_reaches_who_waits(played):
    _, player, _ = played
    player.ask(lambda one: one.disturb("slope", 1.0))
    player.start()
    with pytest.raises(ValueError, match="slope"):
        player.wait()
