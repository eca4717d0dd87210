"""Write figures in two processes at once, since drawing files takes most of a report's time."""

import contextlib
import pickle
import subprocess
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

from matplotlib.figure import Figure

from neuralgaits._own_process import command_of, environment_of
from neuralgaits.report.drawing.figure import FigurePaths, paths_of, write


class FigureFile(NamedTuple):
    """A figure and the files that it becomes, `folder/name.png` and its like."""

    figure: Figure
    folder: Path
    name: str


Pen = subprocess.Popen[bytes]


@contextlib.contextmanager
def second_pen() -> Iterator[Pen | None]:
    """Start a process that imports the drawing code ahead of time; None if it cannot start."""
    pen = None
    with contextlib.suppress(OSError, TypeError):  # TypeError: this Python has no executable.
        pen = subprocess.Popen(
            command_of("neuralgaits.report.drawing.parallel_figures"),
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            env=environment_of(),
        )
    try:
        yield pen
    finally:
        if pen is not None:
            pen.kill()
            pen.communicate()


def write_all(sheets: Sequence[FigureFile], pen: Pen | None) -> list[FigurePaths]:
    """Write all figures, every second one in the other process.

    If the other process fails, this one writes its figures, and errors are raised here.

    Returns: paths of their files, in the order of `sheets`.
    """
    if pen is None:
        return [write(*sheet) for sheet in sheets]
    with ThreadPoolExecutor(1) as beside:
        written = beside.submit(_hand_over, pen, sheets[1::2])
        for sheet in sheets[::2]:
            write(*sheet)
        if not written.result():
            # Only these: a figure that was drawn once is in its narrow form.
            for sheet in sheets[1::2]:
                write(*sheet)
    return [paths_of(sheet.folder, sheet.name) for sheet in sheets]


def _hand_over(pen: Pen, sheets: Sequence[FigureFile]) -> bool:
    """Let the other process write these figures. Returns: whether it succeeded."""
    patience_s = 300.0  # A process that has not written its half by then is abandoned.
    try:
        pen.communicate(pickle.dumps([tuple(sheet) for sheet in sheets]), timeout=patience_s)
    except (OSError, pickle.PicklingError, TypeError, AttributeError, subprocess.TimeoutExpired):
        pen.kill()
        return False
    return pen.returncode == 0


if __name__ == "__main__":
    for sheet in pickle.load(sys.stdin.buffer):
        write(*sheet)
