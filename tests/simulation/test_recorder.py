"""Records of many episodes, and the logs that come of them: what a robot could have written."""

import numpy as np
import pytest

from neuralgaits import logs
from neuralgaits.robots import load_robot
from neuralgaits.simulation.episode_log import log_of
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.simulation.walk import walk

STEP = 2.0 * np.pi / 4096.0
EVERYTHING = PlantChanges(
    friction=0.5,
    torque_limit=38.0,
    delay_ms=2.0,
    floor_height=0.005,
    slope_deg=-1.0,
    mass_scale=1.05,
    torso_shift_m=-0.01,
    joint_friction=0.2,
    encoder_noise=2e-4,
    rate_noise=0.01,
    encoder_step=STEP,
)


def walked(robot, gait, *, episodes=2, **settings):
    policy, start = gait
    starts = np.tile(start, (episodes, 1))
    # The second one starts faster, so that the episodes differ.
    starts[1:, robot.n :] *= 1.02
    done = walk(robot, policy, starts, controller="fblin", longest=10**6, **settings)
    return done, done.episodes.records


def through_a_file(robot, record, path):
    logs.write(path, log_of(robot.joint_names, record, "episode"))
    return logs.read(path, robot)


def test_every_episode_has_the_record_it_would_have_alone(amber, slow):
    policy, start = slow
    done, records = walked(amber, slow, steps=2)
    alone = walk(amber, policy, start[None], controller="fblin", steps=2, record=True)
    first, second = records[0], records[1]
    assert alone.episodes.record is not None
    np.testing.assert_allclose(first.result.q, alone.episodes.record.result.q, atol=1e-12)
    ticks = [int(count) for count in done.episodes.gauge.ticks]
    assert [len(first.time), len(second.time)] == ticks
    assert np.abs(first.result.dq[0] - second.result.dq[0]).max() > 1e-3


def test_a_log_reads_back_exactly_with_everything_disturbed_at_once(amber, slow, tmp_path):
    done, records = walked(amber, slow, steps=4, disturbance=EVERYTHING, seed=3)
    assert min(done.episodes.gauge.steps) > 0
    for episode in range(2):
        record = records[episode]
        found = through_a_file(amber, record, tmp_path / "walk.csv")
        kept = log_of(amber.joint_names, record, "episode")
        assert len(found.log) + found.left_out["outliers"] == len(kept)
        same = np.isin(kept.t, found.log.t)
        for name in ("q", "dq", "qd", "dqd", "tau", "z", "pitch", "dpitch", "z2_plant"):
            np.testing.assert_array_equal(getattr(found.log, name), getattr(kept, name)[same])


def test_angles_are_counted_and_the_plant_knows_better(amber, slow):
    _, records = walked(amber, slow, steps=2, disturbance=PlantChanges(encoder_step=STEP))
    record = records[0]
    counts = record.result.q[:, 1:] / STEP
    np.testing.assert_allclose(counts, np.round(counts), atol=1e-9)
    assert np.abs(record.result.dq[:, 1:] / STEP % 1.0 - 0.5).min() < 0.4
    _, exact = walked(amber, slow, steps=2)
    before, after = exact[0].result.q[0], record.result.q[0]
    assert 0.0 < np.abs(before - after)[1:].max() <= 0.5 * STEP + 1e-12


def test_rounding_leaves_the_walk_where_it_was(amber, slow):
    done, _ = walked(amber, slow, steps=6, disturbance=PlantChanges(encoder_step=STEP))
    assert list(done.episodes.gauge.steps) == [6, 6]


@pytest.mark.parametrize(
    ("plant", "disturbance"),
    [("amber3m-tail", PlantChanges(torso_shift_m=-0.04)), ("amber3m", PlantChanges(friction=0.05))],
)
def test_falls_are_logged_to_their_end_and_their_strides_can_be_learned_from(
    amber, slow, tmp_path, plant, disturbance
):
    done, records = walked(amber, slow, steps=30, plant=load_robot(plant), disturbance=disturbance)
    assert all(ending.fell for ending in done.episodes.endings)
    for episode, steps in enumerate(done.episodes.gauge.steps):
        record = records[episode]
        if not steps:
            continue
        found = through_a_file(amber, record, tmp_path / f"fall-{episode}.csv")
        assert len(found.log) == pytest.approx(len(record.time), abs=0.02 * len(record.time))
        assert logs.cut([found.log], amber).strides
