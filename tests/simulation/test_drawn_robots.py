"""Walks of robots drawn from a box: which robot a walk is of, and that it is that one."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.errors import InputError
from neuralgaits.robots import load_robot
from neuralgaits.robots.mjcf.drawn_robots import DrawnRobots
from neuralgaits.simulation.native_walk import engine_of_trained
from neuralgaits.simulation.setup.command_schedule import schedule_of
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.simulation.setup.floor_of_box import on_floor_of
from neuralgaits.simulation.trained_walks import TrainedWalks, to_arrays
from neuralgaits.workflows.simulate import simulate

BOX = {"mass": 0.1, "com": 0.01, "floor": 0.002, "friction": 0.5}


def test_which_robot_a_walk_is_of_depends_on_its_number_alone():
    drawn = DrawnRobots(load_robot("amber3m"), BOX, 3)
    errors = drawn.errors(0, 200)
    assert errors.shape == (200, len(drawn.names)) == (200, 9)
    assert np.array_equal(errors[120:125], drawn.errors(120, 5))
    half = np.array([0.1] * 3 + [0.01] * 6)
    assert np.all(np.abs(errors) <= half)
    assert np.all(np.abs(errors).max(axis=0) > 0.9 * half)
    heavier = load_robot("amber3m").mass * (1.0 + errors[7, :3] @ _shares())
    assert float(drawn.of(7, 1)[0].mass) == pytest.approx(float(heavier))


def _shares():
    """Of shins, thighs and torso in the mass."""
    masses = np.array([2 * 0.85216, 2 * 3.4261, 13.0])
    return masses / masses.sum()


def test_the_floor_of_a_box_is_walked_on():
    floor = on_floor_of(BOX, PlantChanges(delay_ms=2.0))
    assert (floor.floor_height, floor.friction, floor.delay_ms) == (0.002, 0.5, 2.0)
    with pytest.raises(InputError, match="leave one out"):
        on_floor_of(BOX, PlantChanges(friction=0.4))


@pytest.mark.parametrize("choice", ["native", pytest.param("jax", marks=pytest.mark.slow)])
def test_each_walk_is_of_its_own_robot(trained, choice):
    run = open_run(trained)
    library = engine_of_trained(run, "native").library if choice == "native" else None
    drawn = DrawnRobots(run.robot, {"mass": 0.1, "com": 0.01}, 1)
    walks = TrainedWalks(
        run=run,
        library=library,
        plant=None,
        controller="pd",
        steps=1,
        start="centre",
        push=0.0,
        disturbance=PlantChanges(),
        seed=1,
        schedule=schedule_of((), None, None, 1),
        drawn=drawn,
        threads=1,
    )
    both = to_arrays(walks.walk(0, 2))
    alone = [
        to_arrays(replace(walks, drawn=None, plant=robot).walk(number, 1))
        for number, robot in enumerate(drawn.of(0, 2))
    ]
    for name, values in both.items():
        if name.startswith("gauge"):
            found = np.concatenate([one[name] for one in alone])
            assert np.allclose(values, found, rtol=1e-9, atol=1e-9, equal_nan=True), name
    first, second = both["gauge.energy."]
    assert abs(first - second) > 1e-3


def test_robots_are_drawn_around_the_run_s_own(trained):
    for name, value in (("plant", "amber3m-tail"), ("terrain", "stones"), ("controller", "c")):
        with pytest.raises(InputError, match=f"without --{name}"):
            others: dict[str, Any] = {name: value}
            simulate(trained, parameters={"mass": 0.1}, **others)
