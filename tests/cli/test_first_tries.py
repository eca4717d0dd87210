"""What a new user tries first, and the line that says how to go on."""

import shutil
import subprocess
import sys

import pytest

from neuralgaits._environment import render_without_screen
from neuralgaits.analysis.walking_speeds import (
    fastest_by_gravity,
    fastest_by_torque,
    gait_doubt,
    length_doubt,
    speed_doubt,
)
from neuralgaits.barriers.spec_file_errors import PREFIX
from neuralgaits.cli import screen, verbs
from neuralgaits.cli.main import main
from neuralgaits.control import Fblin
from neuralgaits.errors import InputError
from neuralgaits.records.simulated import SimulationSummary
from neuralgaits.report.page.repeat_commands import settings_of_link
from neuralgaits.robots import load_robot
from neuralgaits.robots.mjcf.loader import robot_from_text
from neuralgaits.simulation.incompatible_settings import about_other_robot, link_of
from neuralgaits.workflows import check_proof as checking
from neuralgaits.workflows import train, train_seeds
from neuralgaits.workflows.inspect import inspect
from support.shipped_run import SHIPPED

WALKED = {
    **{"plant": "amber3m", "controller": "pd", "start": "centre", "seed": 0, "episodes": 3},
    **{"steps_walked": [50, 6, 8], "fell": [False, True, True], "poincare": None, "steps": 50},
    "fall_reasons": [None, "hip too low", "hip too low"],
}


def line_of(capfd, *arguments):
    assert main(list(arguments)) == 2
    line = capfd.readouterr().err
    assert line.count("\n") == 1
    return line


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (
            ("simulate", "latest", "--speed", "0.8"),
            "--speed belongs to train, optimise and demo; to command a gait use --command "
            "speed=0.8\n",
        ),
        (("simulate", "latest", "--slope=2"), "to command a gait use --command slope=2\n"),
        (("certify", "latest", "--speed", "1"), "use --within speed=0.8:0.8\n"),
        (("train", "amber3m", "--level", "2"), "--level belongs to certify; see"),
        (("episodes", "amber3m", "--log", "x"), "did you mean --logs?"),
    ],
)
def test_an_option_of_another_verb_names_it(capfd, arguments, words):
    assert words in line_of(capfd, *arguments)


@pytest.mark.parametrize("packed", [False, True])
def test_the_proof_of_a_run_is_found_by_its_folder(tmp_path, monkeypatch, packed):
    run = tmp_path / "runs" / "amber3m" / "one"
    shutil.copytree(SHIPPED, run)
    (tmp_path / "runs" / "latest").write_text("amber3m/one\n")
    monkeypatch.chdir(tmp_path)
    proof = run / "certificate" / "proof.json"
    content = proof.read_bytes() if proof.is_file() else b""
    for one in (proof, proof.with_name("proof.json.gz")):
        one.unlink(missing_ok=True)
    (proof.with_name("proof.json.gz") if packed else proof).write_bytes(content)
    assert checking.proof_file_at(run) == proof
    assert checking.proof_file_at("latest") == proof.relative_to(tmp_path)
    assert checking.proof_file_at(proof) == proof


def test_a_run_without_a_proof_names_the_file_that_it_lacks(tmp_path, capfd):
    run = tmp_path / "run"
    shutil.copytree(SHIPPED, run)
    for one in (run / "certificate").glob("proof.json*"):
        one.unlink()
    line = line_of(capfd, "check-proof", str(run))
    assert f"expected a proof file at {run / 'certificate' / 'proof.json'}, found none" in line
    assert "neuralgaits certify" in line


def test_a_speed_beyond_legs_is_doubted_before_training():
    robot = load_robot("amber3m")
    doubt = speed_doubt(robot, 5.0)
    assert doubt is not None and "no gait at 5 m/s is likely for amber3m" in doubt
    assert "ask for less than 2.9 m/s" in doubt
    assert speed_doubt(robot, (0.55, 5.0)) is not None
    slow = speed_doubt(robot, 1e-3)
    assert slow is not None and "no gait at 0.001 m/s is likely" in slow
    for usual in (None, 0.2, 0.8, (0.55, 0.90), 1.2):
        assert speed_doubt(robot, usual) is None
    # A pendulum of the same length falls as fast on another planet, slower by the root of g.
    moon = robot_from_text(robot.layout.xml.replace("-9.81", "-1.62"), "moon")
    ratio = fastest_by_gravity(robot) / fastest_by_gravity(moon)
    assert ratio == pytest.approx((9.81 / 1.62) ** 0.5)


def test_legs_of_a_hundred_metres_are_likely_to_be_in_millimetres(monkeypatch):
    robot = load_robot("amber3m")
    assert gait_doubt(robot, None, None) is None and inspect(robot).warnings == ()
    monkeypatch.setattr(type(robot.layout), "leg_length", 340.0)
    doubt = gait_doubt(robot, None, None)
    assert doubt is not None and "340 m long" in doubt and "write 0.34 for 340 mm" in doubt
    assert doubt in inspect(robot).warnings


def test_steps_as_long_as_usual_are_not_doubted():
    robot = load_robot("amber3m")
    for usual in (None, (0.3, 0.4), (0.3, robot.leg_length)):
        assert length_doubt(robot, usual) is None
    assert length_doubt(robot, (0.3, 1.01 * robot.leg_length)) is not None


def test_a_speed_beyond_motors_is_doubted_before_training():
    robot = load_robot("amber3m")
    weak = robot_from_text(robot.layout.xml.replace('"-41 41"', '"-0.41 0.41"'), "weak")
    # A hundredth of the torque takes ten times as long for the same turn of the leg.
    assert fastest_by_torque(robot) / fastest_by_torque(weak) == pytest.approx(10.0)
    doubt = speed_doubt(weak, 0.8)
    assert doubt is not None and "0.41 N m at the hip" in doubt


@pytest.mark.parametrize("more", [[], ["--seeds", "0:2"]], ids=["one seed", "two seeds"])
@pytest.mark.parametrize(
    ("asked", "doubt"),
    [
        (["--speed", "5"], "no gait at 5 m/s is likely"),
        (["--step-length", "0.3:1.4"], "no gait with steps of 1.4 m is likely for amber3m"),
    ],
)
def test_the_doubt_is_a_line_before_training(tmp_path, capfd, monkeypatch, more, asked, doubt):
    def stop(*_, **__):
        raise InputError("expected no training here")

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(train, "train_to_the_end", stop)
    monkeypatch.setattr(train_seeds.SeedsInParallel, "train", stop)
    assert main(["train", "amber3m", *asked, *more]) == 2
    first, last = capfd.readouterr().err.splitlines()
    assert doubt in first and "no training here" in last


def test_a_speed_that_is_refused_is_not_doubted_too(tmp_path, capfd, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert "seed from 0" in line_of(capfd, "train", "amber3m", "--speed", "5", "--seed", "-1")


@pytest.mark.parametrize(
    ("controller", "way"),
    [
        ("fblin", "write --controller c --link law=fblin,lockstep=1"),
        (Fblin(), "write --controller c --link lockstep=1"),
    ],
)
def test_what_contradicts_names_a_combination_that_works(controller, way):
    with pytest.raises(InputError) as found:
        link_of("loss=0.1", controller)
    assert way in str(found.value)


def test_the_combinations_that_are_named_work():
    assert link_of(None, "pd") is None
    for words in ("law=fblin,lockstep=1", "lockstep=1"):
        assert link_of(words, "c") is not None


@pytest.mark.parametrize(
    ("mode", "words"),
    [("lock-step", "the walk is the same each time"), ("real time", "--link lockstep=1 waits")],
)
def test_late_answers_are_a_share_and_say_whether_they_matter(capsys, mode, words):
    link = {"law": "pd", "mode": mode, "ticks": 20_000, "deadline_misses": 892, "faults": [0]}
    screen.show_walks(SimulationSummary.of(WALKED | {"link": link}))
    out = " ".join(capsys.readouterr().out.split())
    assert "892 ticks (4.5 %) kept the command of the tick before" in out and words in out


def test_somebody_else_s_controller_has_its_address(capsys):
    link = {"law": "pd", "mode": "lock-step", "ticks": 9, "faults": [0], "address": "robot:9000"}
    found = SimulationSummary.of(WALKED | {"link": link})
    screen.show_walks(found)
    out = " ".join(capsys.readouterr().out.split())
    assert "process of its own" not in out
    assert found.link is not None
    assert settings_of_link(found.link) == "law=pd,lockstep=1,address=robot:9000"


def test_no_late_answer_is_no_news(capsys):
    link = {"law": "pd", "mode": "lock-step", "ticks": 20_000, "faults": [0]}
    screen.show_walks(SimulationSummary.of(WALKED | {"link": link}))
    assert "of the tick before" not in capsys.readouterr().out


def test_a_push_that_ended_walks_is_said(capsys):
    screen.show_walks(SimulationSummary.of(WALKED | {"push": 64.0}))
    out = " ".join(capsys.readouterr().out.split())
    assert "2 of 3 walks ended once their push of 64 N s was due" in out and "at step 6 to 8" in out
    screen.show_walks(SimulationSummary.of(WALKED | {"push": None}))
    screen.show_walks(SimulationSummary.of(WALKED | {"push": 64.0, "steps_walked": [50, 2, 4]}))
    assert "their push" not in capsys.readouterr().out


def test_a_plant_that_is_another_robot_is_said():
    amber = load_robot("amber3m")
    for own in ("amber3m", "amber3m-tail", "amber3m-paper"):
        assert about_other_robot(amber, load_robot(own)) is None
    said = about_other_robot(load_robot("rabbit"), amber)
    assert said is not None and "plant amber3m is another robot than rabbit" in said
    assert "joints" in said or "kg" in said
    renamed = amber.layout.xml.replace("knee_left", "left_knee")
    said = about_other_robot(amber, robot_from_text(renamed, "renamed"))
    assert said is not None and "left_knee" in said and "kg" not in said


def test_a_plant_with_other_joints_welded_is_said():
    amber = load_robot("amber3m")
    words = (
        "<!-- changed:\n  welded at zero, no part of a leg: waist, arm\n  ankle a: removed, x -->"
    )
    other = robot_from_text(f"{words}\n{amber.layout.xml}", "amber3m")
    said = about_other_robot(amber, other)
    assert said is not None
    assert "joints welded in its file: waist, arm, a, and in that of the gait: none" in said
    assert about_other_robot(other, other) is None


def test_a_walk_on_other_feet_is_refused_in_a_line(tmp_path, capfd):
    run = tmp_path / "run"
    shutil.copytree(SHIPPED, run)
    assert main(["simulate", str(run), "--plant", "amber3m-feet", "--steps", "1"]) == 2
    said = "plant amber3m-feet has 6 links, the policy's robot amber3m has 5, and flat feet instead"
    assert f"{said} of point ones: take a plant with the same joints" in capfd.readouterr().err


def test_a_walk_on_another_robot_says_so(tmp_path, capfd):
    run = tmp_path / "run"
    shutil.copytree(SHIPPED, run)
    main(["simulate", str(run), "--plant", "rabbit", "--steps", "1", "--json"])
    assert "plant rabbit is another robot" in capfd.readouterr().err


SCREENS = ("DISPLAY", "WAYLAND_DISPLAY", "MUJOCO_GL")


@pytest.mark.parametrize(
    ("given", "there", "found"),
    [
        ({}, ("libEGL.so.1", "libOSMesa.so"), "egl"),
        ({}, ("libOSMesa.so",), "osmesa"),
        ({}, (), None),
        ({"DISPLAY": ":0"}, ("libEGL.so.1",), None),
        ({"MUJOCO_GL": "glfw"}, ("libEGL.so.1",), "glfw"),
    ],
)
def test_a_machine_without_a_screen_renders_off_it(monkeypatch, given, there, found):
    from neuralgaits import _environment as environment

    class Libraries:
        @staticmethod
        def CDLL(name):
            if name not in there:
                raise OSError(name)

    monkeypatch.setattr(environment, "ctypes", Libraries)
    monkeypatch.setattr(environment.sys, "platform", "linux")
    monkeypatch.delitem(sys.modules, "mujoco")
    for name in SCREENS:
        # Set and then removed, so that it is as it was afterwards.
        monkeypatch.setenv(name, "x")
        monkeypatch.delenv(name)
    for name, value in given.items():
        monkeypatch.setenv(name, value)
    render_without_screen()
    assert environment.os.environ.get("MUJOCO_GL") == found


def test_the_command_line_settles_that_before_mujoco_is_imported(tmp_path):
    program = """
import sys
from neuralgaits import _environment
_environment.render_without_screen = lambda: sys.exit(5 + ("mujoco" in sys.modules))
from neuralgaits.cli.main import main
sys.exit(main(["simulate", "nowhere", "--video", "film.mp4"]))
"""
    done = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, capture_output=True)
    assert done.returncode == 5


@pytest.mark.parametrize(
    "text",
    ["import sys\nsys.exit(0)\n", "\ndef own(robot): raise SystemExit(3)\n"],
    ids=["imported", "called"],
)
def test_a_spec_file_that_exits_does_not_end_the_command_in_silence(capfd, tmp_path, text):
    file = tmp_path / "own.py"
    file.write_text(text)
    line = line_of(capfd, "train", "amber3m", "--spec", f"{file}:own", "--out", str(tmp_path / "o"))
    assert f"{file}:2: SystemExit" in line and not (tmp_path / "o").exists()


@pytest.mark.parametrize("raised", ["SystemExit(0)", "GeneratorExit", "BaseException('no')"])
def test_whatever_a_users_line_raises_is_told_by_that_line(capfd, monkeypatch, raised):
    """Wherever it runs: a condition is evaluated deep in any verb."""
    code = compile(f"def condition(*_):\n    raise {raised}", "own.py", "exec")
    module = {"__name__": f"{PREFIX}own"}
    exec(code, module)
    monkeypatch.setattr(verbs, "carry_out", module["condition"])
    assert "own.py:2: " in line_of(capfd, "robots")
