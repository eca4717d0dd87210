"""Level 5 of the default gait, derived by the C++ checker from the robot's own numbers."""

import json
import shutil

import pytest

from neuralgaits.records.certified import PROOF
from neuralgaits.workflows.certify import certify

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def file(trained, tmp_path_factory):
    folder = shutil.copytree(trained.path, tmp_path_factory.mktemp("level-5") / "run")
    done = certify(folder, level=5)
    assert done.verdict == "proved", done.conclusions[-1].reason
    return folder / PROOF


def test_every_premise_is_derived(proofcheck, file):
    answer = proofcheck(file)
    lines = [line.strip() for line in answer.stdout.splitlines()]
    assert answer.returncode == 0, answer.stdout
    assert "level 5 proved" in lines
    assert lines[-1].startswith("proved of the robot, policy and spec above: ")


def test_twice_the_error_is_not(proofcheck, file, tmp_path):
    """The bound is a parameter of the theorem, and premises are derived with it."""
    table = json.loads(file.read_text())
    (theorem,) = (one for one in table["theorems"] if one["level"] == 5)
    claimed = float.fromhex(theorem["parameters"]["push"])
    theorem["parameters"]["push"] = (2.0 * claimed).hex()
    spoilt = tmp_path / "proof.json"
    spoilt.write_text(json.dumps(table))
    answer = proofcheck(spoilt)
    assert answer.returncode != 0
    assert "level 5 proved" not in answer.stdout
