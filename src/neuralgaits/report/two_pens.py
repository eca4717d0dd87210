"""Figures written by two processes at once: most of what a report takes is drawing its files."""

import contextlib
import os
import pickle
import subprocess
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

from matplotlib.figure import Figure

from neuralgaits.report.figure import write

PACKAGE = Path(__file__).parents[2]
"""Where the package is imported from: the other process imports the same."""
PATIENCE_S = 300.0
"""A process that has not written its half by then is given up [s]."""


class Sheet(NamedTuple):
    """A figure and the files it becomes, `folder/name.png` and `folder/name.svg`."""

    figure: Figure
    folder: Path
    name: str


Pen = subprocess.Popen[bytes]


@contextlib.contextmanager
def second_pen() -> Iterator[Pen | None]:
    """A process that imports what drawing needs while figures are made here; None without one."""
    known = os.environ.get("PYTHONPATH")
    paths = os.pathsep.join([str(PACKAGE), *([known] if known else [])])
    pen = None
    with contextlib.suppress(OSError, TypeError):  # TypeError: this Python has no executable.
        pen = subprocess.Popen(
            # Without -P the folder that it is called in could shadow any module.
            [sys.executable, "-P", "-m", "neuralgaits.report.two_pens"],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            env=os.environ | {"PYTHONPATH": paths},
        )
    try:
        yield pen
    finally:
        if pen is not None:
            pen.kill()
            pen.communicate()


def write_all(sheets: Sequence[Sheet], pen: Pen | None) -> list[tuple[Path, Path]]:
    """Write all figures, every other one in the process beside.

    What that process cannot write, for whatever reason, is written here and raises here.

    Returns: paths of the PNG and SVG files, in order.
    """
    theirs = [] if pen is None else list(sheets[1::2])
    with ThreadPoolExecutor(1) as beside:
        waiting = beside.submit(_hand_over, pen, theirs)
        ours = [write(*sheet) for sheet in (sheets[::2] if theirs else sheets)]
        if not theirs:
            return ours
        done = waiting.result()
    # A figure that was drawn once is not drawn again: its size would be that of the SVG.
    rest = [_paths(sheet) if done else write(*sheet) for sheet in theirs]
    both = [*ours, *rest]
    both[::2], both[1::2] = ours, rest
    return both


def _paths(sheet: Sheet) -> tuple[Path, Path]:
    return sheet.folder / f"{sheet.name}.png", sheet.folder / f"{sheet.name}.svg"


def _hand_over(pen: Pen | None, sheets: Sequence[Sheet]) -> bool:
    """Let the process write them. Returns: whether it did."""
    if pen is None or not sheets:
        return False
    try:
        pen.communicate(pickle.dumps([tuple(sheet) for sheet in sheets]), timeout=PATIENCE_S)
    except (OSError, pickle.PicklingError, TypeError, AttributeError, subprocess.TimeoutExpired):
        pen.kill()
        return False
    return pen.returncode == 0


if __name__ == "__main__":
    for sheet in pickle.load(sys.stdin.buffer):
        write(*sheet)
