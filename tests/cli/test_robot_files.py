"""`inspect`, `inspect --planarise` and `robots --out`: what is shown, and which files are made."""

import json
import re

import numpy as np
import pytest

from neuralgaits.cli.main import main
from neuralgaits.errors import InputError
from neuralgaits.robots import load_robot, registry
from neuralgaits.settings import TrainSettings
from support import brief_spec, door_robots, walkers


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "walker2d.xml").write_text(walkers.walker2d(), encoding="utf-8")
    return tmp_path


def listed(place):
    return sorted(file.name for file in place.iterdir())


def test_a_file_with_flat_feet_is_told_the_command_that_keeps_them(place, capfd):
    assert main(["inspect", "walker2d.xml"]) == 2
    err = capfd.readouterr().err
    assert "--planarise walker2d-planar.xml --feet flat`" in err
    assert main(["inspect", "walker2d.xml", "--planarise", "flat.xml", "--feet", "flat"]) == 0
    shown = " ".join(capfd.readouterr().out.split())
    assert "sole from 0 m behind the ankle to 0.2 m ahead" in shown
    assert main(["inspect", "flat.xml", "--feet", "flat"]) == 2
    assert "--feet: expected --planarise OUT.xml beside it" in capfd.readouterr().err


@pytest.mark.parametrize("verb", ["inspect", "train"])
def test_a_refusal_names_the_command_that_mends_the_file(place, capfd, verb):
    text = registry.model_file("rabbit").read_text(encoding="utf-8")
    flat = re.sub('type="sphere" size="[0-9.]+"', 'type="box" size="0.08 0.03 0.01"', text)
    (place / "flat.xml").write_text(flat, encoding="utf-8")
    assert main([verb, "flat.xml"]) == 2
    err = capfd.readouterr().err
    assert "is no foot that is treated" in err
    # A line for each foot, and one for the command.
    assert err.count("\n") == 3
    assert "`neuralgaits inspect flat.xml --planarise flat-planar.xml`" in err
    assert main(["inspect", "flat.xml", "--planarise", "flat-planar.xml"]) == 0


def test_nothing_is_promised_of_a_file_that_cannot_be_mended(place, capfd):
    text = registry.model_file("rabbit").read_text(encoding="utf-8")
    (place / "unlimited.xml").write_text(re.sub("ctrlrange=", "user=", text), encoding="utf-8")
    assert main(["inspect", "unlimited.xml"]) == 2
    err = capfd.readouterr().err
    assert "has no torque limit" in err
    assert "planarise" not in err


def test_what_is_unusual_is_a_warning_and_no_refusal(place, capfd):
    """No rotors, as in a URDF, and feet of 20 cm that become points."""
    (place / "robot.urdf").write_text(door_robots.humanoid_urdf(), encoding="utf-8")
    assert main(["inspect", "robot.urdf", "--planarise", "point.xml"]) == 0
    shown = " ".join(capfd.readouterr().out.split())
    assert "warning: armature is 0 on every joint" in shown
    assert "warning: soles of 200 mm, 0.32 of the leg, are cut to points" in shown
    flat = ["inspect", "robot.urdf", "--planarise", "flat.xml", "--feet", "flat", "--json"]
    assert main(flat) == 0
    (warning,) = json.loads(capfd.readouterr().out)["warnings"]
    assert 'write armature="J" into each <joint>' in warning
    (place / "h1.xml").write_text(door_robots.humanoid(), encoding="utf-8")
    assert (
        main(["inspect", "h1.xml", "--planarise", "h1-flat.xml", "--feet", "flat", "--json"]) == 0
    )
    assert json.loads(capfd.readouterr().out)["warnings"] == []


@pytest.mark.parametrize(
    ("limit", "heavy"),
    [
        ("2", "the torso (7.1 N m by its weight alone) or a straight leg (2.6 N m by"),
        ("4", "the torso (7.1 N m by its weight alone) 15"),
        # It cannot hold the torso level, but nobody walks like that: such gaits were trained.
        ("12", None),
    ],
)
def test_motors_that_do_not_hold_the_robot_are_a_warning(place, capfd, limit, heavy):
    text = load_robot("amber3m").layout.xml
    weak = re.sub(r'ctrlrange="[^"]*"', f'ctrlrange="-{limit} {limit}"', text)
    assert weak != text
    (place / "weak.xml").write_text(weak, encoding="utf-8")
    assert main(["inspect", "weak.xml"]) == 0
    shown = " ".join(capfd.readouterr().out.split())
    start = f"warning: motors of {limit} N m at the hips cannot hold "
    assert (start in shown) == (heavy is not None)
    if heavy is not None:
        assert start + heavy in shown and "15 degrees off upright: a gait is unlikely" in shown


def test_a_changed_copy_is_trained_in_one_command(place, capfd):
    urdf = door_robots.files()["rabbit-floating.urdf"]
    (place / "robot.urdf").write_text(urdf, encoding="utf-8")
    spec = ("--spec", f"{brief_spec.__file__}:brief")
    assert (
        main(["train", "robot.urdf", "--feet", "point", "--steps", "1", *spec, "--out", "run"]) == 0
    )
    said = capfd.readouterr().err
    assert re.search(r"changed: \d+ things in robot.urdf, listed in robot.xml", said)
    assert "warning: armature is 0 on every joint" in said
    assert main(["inspect", "robot.urdf", "--planarise", "point.xml"]) == 0
    assert (place / "run" / "robot.xml").read_text() == (place / "point.xml").read_text()
    assert main(["train", "run/robot.xml", "--weld", "left_knee"]) == 2
    assert "--weld: expected --feet point or --feet flat" in capfd.readouterr().err
    with pytest.raises(InputError, match="feet: expected the path of a robot file"):
        TrainSettings(load_robot("rabbit"), feet="flat")


def test_feet_that_point_back_are_a_warning(place, capfd):
    turned = door_robots.humanoid("box").replace('pos="0.055 0 -0.06"', 'pos="-0.055 0 -0.06"')
    (place / "h1.xml").write_text(turned, encoding="utf-8")
    assert main(["inspect", "h1.xml", "--planarise", "flat.xml", "--feet", "flat"]) == 0
    shown = " ".join(capfd.readouterr().out.split())
    assert "warning: soles reach 155 mm behind the ankle and 45 mm ahead: forward is +x" in shown


def test_pictures_that_are_not_there_are_left_out_and_said(place, capfd):
    shell = '<asset><mesh name="shell" file="shell.stl"/></asset>'
    text = door_robots.adam().replace("<worldbody>", f"{shell}<worldbody>")
    geom = '<geom type="mesh" mesh="shell" contype="0" conaffinity="0"/>'
    shown = text.replace('<inertial pos="0 0 0.15"', f'{geom}<inertial pos="0 0 0.15"')
    (place / "robot.xml").write_text(shown, encoding="utf-8")
    assert main(["inspect", "robot.xml", "--planarise", "new.xml", "--json"]) == 0
    changes = json.loads(capfd.readouterr().out)["changes"]
    assert "pictures not there, left out: shell.stl; masses are as given" in changes
    bare = shown.replace('<inertial pos="0 0 0.15" mass="6" diaginertia="0.1 0.1 0.05"/>', "")
    (place / "robot.xml").write_text(bare, encoding="utf-8")
    assert main(["inspect", "robot.xml", "--planarise", "other.xml"]) == 2
    assert "body torso has its mass from mesh shell, whose file is not there" in (
        capfd.readouterr().err
    )
    assert "other.xml" not in listed(place)


def test_weld_needs_a_file_to_write(place, capfd):
    assert main(["inspect", "walker2d.xml", "--weld", "foot_joint"]) == 2
    assert "--weld: expected --planarise OUT.xml beside it" in capfd.readouterr().err
    weld = ["--weld", "foot_joint,foot_left_joint"]
    assert main(["inspect", "walker2d.xml", "--planarise", "welded.xml", *weld]) == 0
    assert "welded as named, at zero: foot_joint (0), foot_left_joint (0)" in " ".join(
        capfd.readouterr().out.split()
    )


def test_planarise_writes_a_file_and_says_each_change(place, capfd):
    assert main(["inspect", "walker2d.xml", "--planarise", "point.xml"]) == 0
    out = capfd.readouterr().out
    assert "changed: 12 things" in out
    assert "- ankle foot_joint: removed, flat foot foot is welded to leg\n" in out
    assert "neuralgaits train point.xml" in out
    assert listed(place) == ["point.xml", "walker2d.xml"]
    assert (place / "walker2d.xml").read_text(encoding="utf-8") == walkers.walker2d()
    assert load_robot("point.xml").name == "walker2d"


def test_an_include_is_put_in_place(place, capfd):
    (place / "common").mkdir()
    part = "<mujoco><visual><map force='0.1'/></visual></mujoco>"
    (place / "common" / "visual.xml").write_text(part, encoding="utf-8")
    (place / "walker.xml").write_text(walkers.dm_walker("./common/visual.xml"), encoding="utf-8")
    (place / "new").mkdir()
    assert main(["inspect", "walker.xml", "--planarise", "new/walker.xml", "--json"]) == 0
    first, *others = json.loads(capfd.readouterr().out)["changes"]
    assert first == "includes put in place, files of meshes and textures named by their full paths"
    assert len(others) == 8
    assert "include" not in (place / "new" / "walker.xml").read_text(encoding="utf-8")


def test_json_has_the_changes_and_the_robot_written(place, capfd):
    assert main(["inspect", "walker2d.xml", "--planarise", "point.xml", "--json"]) == 0
    facts = json.loads(capfd.readouterr().out)
    assert facts["written"] == "point.xml"
    assert len(facts["changes"]) == 12
    assert facts["stance_foot"] == "foot_point"
    assert main(["inspect", "point.xml", "--planarise", "again.xml", "--json"]) == 0
    assert json.loads(capfd.readouterr().out)["changes"] == []
    assert (place / "again.xml").read_bytes() == (place / "point.xml").read_bytes()


def test_a_file_that_needs_nothing_is_said_to(place, capfd):
    assert main(["inspect", "amber3m", "--planarise", "mine.xml"]) == 0
    assert capfd.readouterr().out.startswith("nothing to change: the new file is a copy")


@pytest.mark.parametrize("out", ["walker2d.xml", "./walker2d.xml", "link.xml"])
def test_no_file_is_overwritten(place, capfd, out):
    (place / "link.xml").symlink_to(place / "walker2d.xml")
    before = listed(place)
    assert main(["inspect", "walker2d.xml", "--planarise", out]) == 2
    assert "is there: give another name" in capfd.readouterr().err
    assert (place / "walker2d.xml").read_text(encoding="utf-8") == walkers.walker2d()
    assert main(["robots", "rabbit", "--out", out]) == 2
    assert listed(place) == before


def test_what_cannot_be_planarised_leaves_no_file(place, capfd):
    text = walkers.walker2d().replace('range="-150 0"', 'limited="false"', 1)
    (place / "walker2d.xml").write_text(text, encoding="utf-8")
    assert main(["inspect", "walker2d.xml", "--planarise", "point.xml"]) == 2
    err = capfd.readouterr().err
    assert "walker2d cannot be planarised: joint thigh_joint has no range" in err
    assert err.count("\n") == 1
    assert listed(place) == ["walker2d.xml"]


def test_a_built_in_file_is_written_to_start_from(place, capfd):
    assert main(["robots", "rabbit", "--out", "mine.xml"]) == 0
    assert "neuralgaits inspect mine.xml" in capfd.readouterr().out
    shipped = registry.model_file("rabbit").read_text(encoding="utf-8")
    assert (place / "mine.xml").read_text(encoding="utf-8") == shipped
    assert main(["robots", "rabbit", "--out", "other.xml", "--json"]) == 0
    answer = json.loads(capfd.readouterr().out)
    assert (answer["written"], [one["name"] for one in answer["robots"]]) == (
        "other.xml",
        ["rabbit"],
    )


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["rabbit"], "write `neuralgaits robots rabbit --out rabbit.xml`"),
        (["--out", "mine.xml"], "write `neuralgaits robots ROBOT --out FILE.xml`"),
        (["rabit", "--out", "mine.xml"], "unknown robot rabit: did you mean rabbit?"),
        (["walker2d.xml", "--out", "mine.xml"], "found the file walker2d.xml: copy it"),
    ],
)
def test_robots_refuses_in_one_line(place, capfd, words, said):
    assert main(["robots", *words]) == 2
    err = capfd.readouterr().err
    assert said in err
    assert err.count("\n") == 1
    assert listed(place) == ["walker2d.xml"]


def test_inspect_shows_the_names_of_the_file_with_masses(capfd):
    assert main(["inspect", "amber3m", "--json"]) == 0
    facts = json.loads(capfd.readouterr().out)
    rows = [(link["name"], link["body"], link["mass_kg"]) for link in facts["links"]]
    assert rows == [
        ("stance_shin", "shin_left", 0.85216),
        ("stance_thigh", "thigh_left", 3.4261),
        ("torso", "torso", 13.0),
        ("swing_thigh", "thigh_right", 3.4261),
        ("swing_shin", "shin_right", 0.85216),
    ]
    centres = [link["centre_of_mass_m"] for link in facts["links"]]
    np.testing.assert_allclose(
        centres[:3], [[0.4667 - 0.171885, 0], [0.4064 - 0.1494, 0], [0.21483, 0]], atol=1e-12
    )
    joints = [(row["joint"], row["file_joint"], row["file_motor"]) for row in facts["actuators"]]
    assert joints == [
        ("stance_knee", "knee_left", "knee_left"),
        ("stance_hip", "hip_left", "hip_left"),
        ("swing_hip", "hip_right", "hip_right"),
        ("swing_knee", "knee_right", "knee_right"),
    ]
    assert (facts["written"], facts["changes"]) == (None, [])


def test_a_centre_of_mass_beside_the_link_is_said_to_be(place, capfd):
    assert main(["inspect", "amber3m-tail", "--json"]) == 0
    facts = json.loads(capfd.readouterr().out)
    np.testing.assert_allclose(facts["links"][2]["centre_of_mass_m"], [0.21483, -0.03])
    assert main(["inspect", "amber3m-tail"]) == 0
    assert "0.03" in (out := capfd.readouterr().out)
    assert "behind" in out
    assert "your joint" in out
