"""Deployment files: what is written is read, and all that is wrong is named at once."""

import re
import sys

import pytest

from neuralgaits.deployment.deployment_reader import read_deployment
from neuralgaits.deployment.deployment_template import deployment_text
from neuralgaits.errors import InputError, ManyProblems
from neuralgaits.robots import load_robot
from support.deployments import about, drawn, plain


@pytest.fixture(scope="module")
def robot():
    return load_robot("amber3m")


@pytest.fixture
def write(tmp_path):
    """Write a text and return its path."""

    def written(text: str | bytes):
        path = tmp_path / "deploy.yaml"
        path.write_bytes(text.encode() if isinstance(text, str) else text)
        return path

    return written


def _problems(path, robot) -> list[str]:
    with pytest.raises(InputError) as error:
        read_deployment(path, about(robot))
    found = error.value
    problems = list(found.problems) if isinstance(found, ManyProblems) else [str(found)]
    assert all("\n" not in one and "expected" in one and "found" in one for one in problems)
    return problems


@pytest.mark.parametrize("name", ["amber3m", "amber3m-feet", "rabbit"])
def test_what_is_written_is_read(name, write):
    robot = load_robot(name)
    for deployment in (plain(robot), drawn(robot, 1)):
        found = read_deployment(write(deployment_text(deployment)), about(robot))
        assert len(found.sha256) == 64
        assert vars(found) == vars(deployment) | {"sha256": found.sha256}


def test_a_number_may_be_written_as_people_write_it(robot, write):
    text = deployment_text(plain(robot)).replace("period_s: 0.001", "period_s: 1e-3")
    text = text.replace("zero_rad: 0.0", "zero_rad: -.5").replace("sign: 1", "sign: +1")
    found = read_deployment(write(text), about(robot))
    assert (found.period_s, found.joints[0].zero_rad, found.joints[0].sign) == (1e-3, -0.5, 1)


WRONG = {
    "    sign: 1": ("    sign: 2", "joints[0]: sign: expected 1 or -1, found '2'"),
    "gear: 1.0": ("gear: 0", "joints[0]: gear: expected a number from 1e-06 to 1e+06, found '0'"),
    "gear: 1.0\n    lower": (
        "gear: 1e-300\n    lower",
        "joints[0]: gear: expected a number from 1e-06 to 1e+06, found '1e-300'",
    ),
    "motor: 1": ("motor: 0", "motor: expected each index once, found 0 at knee_left, hip_left"),
    "    zero_rad: 0.0": (
        "    zero_deg: 0.0",
        "found the key 'zero_deg': write zero_rad, in that unit",
    ),
    "kp_nm_rad: 200": ("kp_nm_rda: 200", "found the key 'kp_nm_rda': write kp_nm_rad"),
    "    gear: 1.0\n": ("", "joints[0]: expected the key gear, found none: add it"),
    "'hip_left'": ("'hip_lefd'", "did you mean hip_left?"),
    "'foot_left'": ("'foot_right'", "expected foot_right once, found it 2 times"),
    "channel: 1": ("channel: 0", "channel: expected each index once, found 0 at foot_left"),
    "period_s: 0.001": ("period_s: 0.002", "expected 0.001, the tick that the controller"),
    "pitch_sign: 1": ("pitch_sign: yes", "imu: pitch_sign: expected 1 or -1, found 'yes'"),
    "0" * 64: ("2" * 64, f"files.robot: expected sha256 {'0' * 64} as of a run"),
    "1" * 64: ("none", "files.policy: sha256: expected a sha256 of 64 hexadecimal digits"),
    "upper_rad: 1.5": ("upper_rad: -1", "expected lower_rad below upper_rad, found 0 and -1"),
    "upper_rad: 1.6": ("upper_rad: 1.7", "a range within the robot file's, -1.6 to 1.6 rad"),
    "torque_limit_nm: 41.0": ("torque_limit_nm: 42.0", "at most the robot file's 41 N m"),
    "torque_limit_nm: 4": (
        "torque_limit_nm: .inf#",
        "expected a number from 1e-06 to 1e+06, found '.inf#1.0'",
    ),
    "deployment: 1": ("deployment: 2", "deployment: expected 1, found 2: update the package"),
    "proof: null": (f"proof: {{name: p, sha256: {'3' * 64}}}", "files.proof: expected null"),
    "joints:": ("joint:", "found the key 'joint': did you mean joints?"),
}


@pytest.mark.parametrize("right", WRONG)
def test_a_mistake_is_named(right, robot, write):
    wrong, said = WRONG[right]
    text = deployment_text(plain(robot))
    assert right in text
    problems = _problems(write(text.replace(right, wrong, 1)), robot)
    assert len(problems) == 1 + (right == "'foot_left'")
    assert any(said in one for one in problems), problems


def test_all_mistakes_are_named_at_once(robot, write):
    text = deployment_text(plain(robot))
    some = ("motor: 1", "period_s: 0.001", "0" * 64, "upper_rad: 1.6", "torque_limit_nm: 41.0")
    for right in some:
        text = text.replace(right, WRONG[right][0], 1)
    problems = _problems(write(text), robot)
    assert len(problems) == len(some)
    for right in some:
        assert any(WRONG[right][1] in one for one in problems)
    # A joint that could not be read is no missing one.
    lines = _problems(write(text.replace("sign: 1", "sign: 2")), robot)
    assert not any("every joint" in one for one in lines)


BAD = {
    "empty": ("", "found an empty file"),
    "no mapping": ("- 1\n- 2\n", "expected the keys deployment, run, files"),
    "no YAML": ("a: [1, 2\n", "expected YAML, found"),
    "tab": ("a:\n\t- 1\n", "in line 2"),
    "latin-1": ("run: 'caf\u00e9'\n".encode("latin-1"), "expected UTF-8, found byte 0xe9"),
    "twice": ("run: a\nrun: b\n", "expected each key once, found 'run' again, first in line 1"),
    "bomb": ("a: &a [1, 1]\nb: [*a, *a]\n", "line 1: expected plain values, found the anchor"),
    "tag": ("a: !!python/object/apply:os.system ['true']\n", "found the tag"),
    "deep": ("[" * 200 + "]" * 200, "expected at most 20 levels"),
    "huge": ("#" * 70000, "expected a file of at most 65536 bytes, found 70000"),
    "two": ("a: 1\n---\nb: 2\n", "expected YAML, found"),
    "odd key": ("{[1]: 2}\n", "expected a key, found a sequence"),
    "control": ("a: \x07\n", "expected YAML, found"),
}


@pytest.mark.parametrize("name", BAD)
def test_what_is_no_deployment_file_is_refused(name, robot, write):
    text, said = BAD[name]
    (problem,) = _problems(write(text), robot)
    assert said in problem


def test_what_is_no_file_is_refused(robot, tmp_path):
    for path, said in ((tmp_path, "a folder"), (tmp_path / "none.yaml", "found none")):
        with pytest.raises(InputError, match=re.escape(said)):
            read_deployment(path, about(robot))


def test_without_its_package_a_line_says_which_extra(robot, write, monkeypatch):
    monkeypatch.setitem(sys.modules, "yaml", None)
    (problem,) = _problems(write(deployment_text(plain(robot))), robot)
    assert problem.endswith("found none: pip install 'neuralgaits[deploy]'")
