"""The C++ checker, built once, what tests ask it, and the default gait's proof."""

import copy
import json
import os
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

REPOSITORY = Path(__file__).parents[2]
PROGRAM = REPOSITORY / "build" / "proofcheck"

QUICK = 450
"""Signs of the largest tree of a statement that is checked again and again."""
Ask = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture(scope="session")
def proofcheck(made_once) -> Ask:
    """Runs the checker with arguments and an optional text on its standard input."""
    if not all(map(shutil.which, ("make", os.environ.get("CXX", "g++")))):
        pytest.skip("no make or g++ to build the C++ checker with")
    # What users build, if it is older than its source.
    build = ["make", "--silent", "proofcheck"]
    made_once("proofcheck", lambda _: subprocess.run(build, cwd=REPOSITORY, check=True))

    def ask(*arguments: object, text: str = "") -> subprocess.CompletedProcess[str]:
        command = [str(PROGRAM), *map(str, arguments)]
        return subprocess.run(command, input=text, capture_output=True, text=True, timeout=1200)

    return ask


@pytest.fixture(scope="session")
def proof_file(certified) -> Path:
    return certified.path / "certificate" / "proof.json"


@pytest.fixture(scope="session")
def proof(proof_file) -> dict[str, Any]:
    return json.loads(proof_file.read_text())


@pytest.fixture
def spoilt(proof) -> dict[str, Any]:
    """A copy to spoil, with the quick statements of level 1, from which nothing is concluded."""
    table = copy.deepcopy(proof)
    for theorem in table["theorems"]:
        theorem["claimed"] = False
    table["statements"] = [
        s
        for s in table["statements"]
        if s["region"] in table["model"]["regions"] and len(s["tree"]) <= QUICK
    ]
    return table


@pytest.fixture
def asked(proofcheck, tmp_path):
    """Runs the checker on a table or a text."""

    def ask(table: Any):
        path = tmp_path / "proof.json"
        path.write_text(table if isinstance(table, str) else json.dumps(table))
        return proofcheck(path)

    return ask
