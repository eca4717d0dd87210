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
    with contextlib.suppress(OSError):
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
    if not done:
        return [write(*sheet) for sheet in sheets]
    paths = iter(ours)
    return [
        (sheet.folder / f"{sheet.name}.png", sheet.folder / f"{sheet.name}.svg")
        if number % 2
        else next(paths)
        for number, sheet in enumerate(sheets)
    ]


def _hand_over(pen: Pen | None, sheets: Sequence[Sheet]) -> bool:
    """Let the process write them. Returns: whether it did."""
    if pen is None or not sheets:
        return False
    try:
        pen.communicate(pickle.dumps([tuple(sheet) for sheet in sheets]))
    except (OSError, pickle.PicklingError, TypeError, AttributeError):
        return False
    return pen.returncode == 0


if __name__ == "__main__":
    for sheet in pickle.load(sys.stdin.buffer):
        write(*sheet)
