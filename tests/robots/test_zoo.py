"""The robot files of examples/robots: they load, need nothing, and are what their table says."""

import re

import jax
import numpy as np
import pytest

from neuralgaits.robots import load_robot
from neuralgaits.robots.mjcf.loader import robot_from_text
from neuralgaits.robots.mjcf.planariser import planarise
from neuralgaits.simulation.setup.plant import build
from neuralgaits.workflows.inspect import inspect
from support import pages, walkers

FOLDER = pages.ROOT / "examples" / "robots"
FILES = sorted(FOLDER.glob("*.xml"))
ROW = re.compile(r"^\| \[([\w.-]+)\]\(\1\) \| ([\d.]+) \| ([\d.]+) \| (\d+) \|", re.MULTILINE)


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_a_file_is_what_its_row_says(file):
    rows = {row[0]: row[1:] for row in ROW.findall(pages.read(FOLDER / "README.md"))}
    assert set(rows) == {one.name for one in FILES}
    mass, leg, motors = rows[file.name]
    robot = load_robot(file)
    facts = inspect(robot)
    assert f"{facts.mass_kg:.4g}" == mass
    assert f"{facts.hip_height_m:.4g}" == leg
    assert len(facts.actuators) == int(motors)
    assert robot.name == file.stem
    feet = "point" if robot.feet is None else "flat"
    assert planarise(file.read_text(encoding="utf-8"), file.stem, feet).changes == ()
    assert build(robot)


@pytest.mark.parametrize(
    ("name", "text"),
    [("walker2d", walkers.walker2d()), ("dm-walker", walkers.dm_walker())],
)
@pytest.mark.parametrize("feet", ["point", "flat"])
def test_the_walkers_are_what_planarise_makes(name, text, feet):
    ours, made = (
        load_robot(FOLDER / f"{name}-{feet}-feet.xml"),
        robot_from_text(planarise(text, name, feet).text, "x"),
    )
    for one, other in zip(jax.tree.leaves(ours), jax.tree.leaves(made), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-12, atol=1e-12)
    assert ours.layout.leg_joints == made.layout.leg_joints
    assert ours.layout.feet == made.layout.feet


def test_the_hips_of_walker2d_turn_back_only():
    """What the table says: a positive hip angle swings the thigh back."""
    robot = load_robot(FOLDER / "walker2d-point-feet.xml")
    hip = robot.joint_names.index("stance_joint2") - 1
    assert (robot.joint_lower[hip], robot.joint_upper[hip]) == (0.0, np.radians(150.0))


def test_the_stilts_are_those_of_the_page():
    page = pages.files(pages.ROOT / "docs" / "your_robot.md")
    assert (FOLDER / "stilts.xml").read_text(encoding="utf-8") == page["stilts.xml"]
