"""A reader meets the old file or the new one, whatever happens to the writer."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from neuralgaits.runs import atomic

WRITER = """
import sys
from pathlib import Path
from neuralgaits.runs.atomic import write_bytes
path, size = Path(sys.argv[1]), 4_000_000
print("ready", flush=True)
for number in range(1, 1000):
    write_bytes(path, bytes([number % 251]) * size)
"""


def test_replaces_the_content(tmp_path: Path) -> None:
    path = tmp_path / "deep" / "file.txt"
    atomic.write_text(path, "old")
    atomic.write_text(path, "new µ")
    assert path.read_text(encoding="utf-8") == "new µ"
    assert os.listdir(path.parent) == ["file.txt"]


def test_an_error_in_the_middle_keeps_the_old_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "file.txt"
    atomic.write_text(path, "old")

    def full_disk(handle: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full_disk)
    with pytest.raises(OSError, match="No space"):
        atomic.write_text(path, "new")
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["file.txt"]


@pytest.mark.parametrize("delay_s", [0.02, 0.05, 0.11])
def test_a_killed_writer_leaves_a_whole_file(tmp_path: Path, delay_s: float) -> None:
    path = tmp_path / "weights.bin"
    writer = subprocess.Popen(
        [sys.executable, "-c", WRITER, str(path)], stdout=subprocess.PIPE, env=_environment()
    )
    assert writer.stdout is not None
    writer.stdout.readline()
    while not path.exists():
        time.sleep(0.001)
    time.sleep(delay_s)
    writer.send_signal(signal.SIGKILL)
    writer.wait()
    writer.stdout.close()
    content = path.read_bytes()
    assert len(content) == 4_000_000
    assert len(set(content)) == 1


def _environment() -> dict[str, str]:
    source = Path(atomic.__file__).parents[2]
    return os.environ | {"PYTHONPATH": str(source)}
