"""Obstacles in a robot file are left out, and `inspect` says so in one line."""

import json

import pytest

from neuralgaits.cli.main import main
from neuralgaits.robots import load_robot, registry
from neuralgaits.robots.mjcf.loader import robot_from_text
from neuralgaits.workflows.inspect import inspect

AMBER = registry.model_file("amber3m").read_text(encoding="utf-8")
WORLD = "</body>\n  </worldbody>"
BOX = '<geom name="{}" type="box" size="0.1 1 0.1" pos="2 0 0" contype="1" conaffinity="1"/>'


def with_world(text):
    assert WORLD in AMBER
    return AMBER.replace(WORLD, f"</body>{text}</worldbody>")


def left_out(text):
    return inspect(robot_from_text(with_world(text), "edited")).left_out


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (BOX.format("obstacle"), "geom obstacle of the world: the robot passes through it"),
        (f'<body name="wall">{BOX.format("brick")}</body>', "geom brick of the world"),
        (
            f'<body name="wall">{BOX.format("").replace(" name=" + chr(34) * 2, "")}</body>',
            "of body wall of the world",
        ),
        (
            '<geom name="ramp" type="plane" size="1 1 0.1" euler="0 -0.1 0" contype="1"/>',
            "geom ramp of the world",
        ),
        (
            "".join(BOX.format(f"step_{n}") for n in range(9)),
            "geoms step_0, step_1, step_2, step_3, step_4 and 4 more of the world",
        ),
    ],
    ids=["geom", "body", "without a name", "second plane", "many"],
)
def test_an_obstacle_is_listed(text, words):
    [line] = left_out(text)
    assert words in line and "write simulate --terrain" in line


def test_pictures_and_the_floor_are_no_obstacles():
    picture = BOX.format("tree").replace('contype="1" conaffinity="1"', "")
    assert left_out(picture) == ()
    for name in registry.built_in():
        assert inspect(load_robot(name)).left_out == (), name


def test_inspect_shows_it_and_the_robot_is_the_same(tmp_path, capfd):
    file = tmp_path / "course.xml"
    file.write_text(with_world(BOX.format("obstacle")))
    assert main(["inspect", str(file)]) == 0
    assert "left out: geom obstacle of the world" in " ".join(capfd.readouterr().out.split())
    assert main(["inspect", str(file), "--json"]) == 0
    found = json.loads(capfd.readouterr().out)
    assert len(found["left_out"]) == 1 and found["mass_kg"] == float(load_robot("amber3m").mass)
