"""A proof is about a run only if every file and every weight is the run's own."""

from pathlib import Path

import numpy as np
import pytest

from neuralgaits.certificate.proof_file.check import check
from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.certificate.proof_file.run_match import differences
from neuralgaits.errors import RunError
from support.small_proof import CENTRE, FILES, program, sha256, weights, with_program, write


@pytest.fixture
def run(tmp_path: Path) -> Path:
    folder = tmp_path / "run"
    folder.mkdir()
    for name, text in FILES.items():
        (folder / name).write_text(text)
    (folder / "policy.safetensors").write_bytes(weights())
    return folder


def test_a_proof_of_the_run_has_no_differences(tmp_path, proof, run):
    assert differences(read_claims(write(tmp_path, proof)), run) == []


@pytest.mark.parametrize("what", ["robot", "spec"])
def test_the_name_that_differs_is_told(tmp_path, mutated, run, what):
    mutated[what]["name"] = "another"
    (line,) = differences(read_claims(write(tmp_path, mutated)), run)
    assert line.startswith(f"the proof is about {what} 'another', the run about '")


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ('<mujoco model="atlas"/>', "robot.xml names its model 'atlas', the proof 'point'"),
        ('<mujoco model="point"/>', None),
        ('<mujoco model="&#10;point "/>', None),
        ('<mujoco model="MuJoCo Model"/>', None),
        ("<mujoco/>", None),
        ("no robot", None),
    ],
)
def test_a_model_that_the_robot_file_names_is_the_proofs(tmp_path, mutated, run, text, told):
    """Without one, the robot is called as its file was, which nobody can know any more."""
    (run / "robot.xml").write_text(text)
    mutated["robot"]["sha256"] = sha256(text)
    found = differences(read_claims(write(tmp_path, mutated)), run)
    assert found == ([] if told is None else [f"robot: {told}"])


@pytest.mark.parametrize("file", ["robot.xml", "spec.py", "policy.safetensors"])
def test_the_file_that_differs_is_named(tmp_path, proof, run, file):
    content = weights(CENTRE + 1e-16 * 2**4) if file.startswith("policy") else b"another"
    (run / file).write_bytes(content)
    wrong = differences(read_claims(write(tmp_path, proof)), run)
    assert wrong[0].startswith(file)
    assert sha256(content) in wrong[0]


def test_weights_in_the_program_must_be_those_of_the_run(tmp_path, mutated, run):
    other = CENTRE.copy()
    other[1] = np.nextafter(other[1], 1.0)
    claims = read_claims(write(tmp_path, with_program(mutated, program(other))))
    assert check(claims).verdict == "consistent"
    (line,) = differences(claims, run)
    assert "policy.centre" in line


def test_missing_and_damaged_runs_are_one_line(tmp_path, proof, run):
    claims = read_claims(write(tmp_path, proof))
    (run / "policy.safetensors").write_bytes(b"\x10\0\0\0\0\0\0\0 nonsense")
    with pytest.raises(RunError, match="damaged"):
        differences(claims, run)
    with pytest.raises(RunError, match="give a run folder"):
        differences(claims, tmp_path / "nowhere")
