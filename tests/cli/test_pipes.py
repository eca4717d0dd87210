"""Readers that leave early, as in `neuralgaits VERB 2>&1 | head -1`."""

import os
import subprocess
import sys
from pathlib import Path

import neuralgaits
from neuralgaits.cli.main import ProgressStream

SOURCE = Path(neuralgaits.__file__).parents[1]


def unread() -> int:
    """Return the writing end of a pipe that nobody reads."""
    reader, writer = os.pipe()
    os.close(reader)
    return writer


def told(*words: str, cwd: Path, stderr: int | None = None) -> int:
    """Return the exit code of a command whose stdout nobody reads."""
    environment = os.environ | {"PYTHONPATH": str(SOURCE)}
    line = [sys.executable, "-m", "neuralgaits", *words]
    done = subprocess.run(line, cwd=cwd, env=environment, stdout=unread(), stderr=stderr)
    return done.returncode


def test_progress_that_nobody_reads_stops_nothing() -> None:
    stream = ProgressStream(os.fdopen(unread(), "wb"), encoding="utf-8", line_buffering=True)
    for _ in range(3):
        stream.write("step 1/10\n")
        stream.flush()
    stream.close()


def test_the_exit_code_is_that_of_the_work(tmp_path: Path) -> None:
    assert told("inspect", "amber3m", cwd=tmp_path, stderr=unread()) == 0
    assert told("inspect", "missing.xml", cwd=tmp_path, stderr=unread()) == 2
    assert told("--help", cwd=tmp_path) == 0
