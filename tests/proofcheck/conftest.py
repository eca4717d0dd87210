"""The C++ checker, built once, and what tests ask it."""

import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

# Tests of this folder share the helper module beside them, and the random robots.
sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parents[1] / "robots")]

SOURCE = Path(__file__).parents[2] / "tools" / "proofcheck" / "proofcheck.cpp"
FLAGS = "-std=c++17 -O1 -frounding-math -ffp-contract=off -Wall -Wextra -Werror".split()

Ask = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture(scope="session")
def proofcheck(tmp_path_factory) -> Ask:
    """Runs the checker with arguments and an optional text on its standard input."""
    compiler = shutil.which(os.environ.get("CXX", "g++"))
    if compiler is None:
        pytest.skip("no g++ to build the C++ checker with")
    base = tmp_path_factory.getbasetemp()
    shared = base.parent if "PYTEST_XDIST_WORKER" in os.environ else base
    program = _built(compiler, shared / "proofcheck")

    def ask(*arguments: object, text: str = "") -> subprocess.CompletedProcess[str]:
        command = [str(program), *map(str, arguments)]
        return subprocess.run(command, input=text, capture_output=True, text=True, timeout=120)

    return ask


def _built(compiler: str, program: Path) -> Path:
    """Compile; the first worker to come does it, the others wait."""
    done, claim = program.with_suffix(".done"), program.with_suffix(".claim")
    try:
        claim.mkdir()
    except FileExistsError:
        while not done.exists():
            time.sleep(0.1)
    else:
        try:
            subprocess.run([compiler, *FLAGS, str(SOURCE), "-o", str(program)], check=True)
        finally:
            done.touch()
    assert program.exists(), "the C++ checker does not compile"
    return program
