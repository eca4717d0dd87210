"""Controllers that somebody else has started: programs that print the port they listen at."""

import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def listening(program: Path) -> Iterator[tuple["subprocess.Popen[str]", str]]:
    """A process of a program, which ends with the block, and its address."""
    process = subprocess.Popen(
        [str(program)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    try:
        assert process.stdout is not None
        yield process, f"127.0.0.1:{process.stdout.readline().split()[1]}"
    finally:
        process.kill()
        process.communicate()
