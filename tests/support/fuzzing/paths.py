"""Paths of any bytes that a file system takes, and everything that a verb reads or writes there.

The inputs at such a path are whole: what may go wrong is how the path is opened, printed and kept.
"""

import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

from neuralgaits import logs
from neuralgaits.analysis.run import open_run
from neuralgaits.barriers import specs
from neuralgaits.robots import load_robot
from neuralgaits.runs import resolve, to_json, write_text
from neuralgaits.workflows.check_proof import check_proof
from neuralgaits.workflows.inspect import inspect
from neuralgaits.workflows.planarise import planarise_file
from neuralgaits.workflows.robots import write_built_in
from support.fuzzing.alter import Draw
from support.fuzzing.place import FILES, RUN, Place

ODD_FOLDER = "odd"
"""Everything lies below it and goes with it."""
ALLOWED = bytes(byte for byte in range(1, 256) if byte != ord("/"))
PIECES = (
    *("é".encode(), "é".encode("latin-1"), "日本".encode(), "\u2028".encode(), "\u202e".encode()),
    *(b"\xed\xb3\xbf", b"\xc0\xaf", b"\xf4\x90\x80\x80", b"\x1b[31m", b"\n", b"\r\n", b"\t", b" "),
    *(b"-v", b"--json", b"~", b"$HOME", b"*", b"%s", b"{0}", b"[bold]", b"`x`", b"'", b'"', b"\\"),
    *(b"latest", b"a:b", b".py:x", b"a=b,c", b".gz", b"..x", b"#", b"<b>", b"&amp;"),
)
"""What people, other systems' encodings and mischief put into a name."""
LONGEST = 40
"""Bytes of a part drawn at random."""


def odd_path(draw: Draw, number: int) -> bytes:
    """Return a relative path of one to three parts; those of the first numbers have every byte."""
    parts = [_part(draw) for _ in range(int(draw.integers(1, 4)))]
    if number < len(ALLOWED):
        parts[-1] += ALLOWED[number : number + 1]
    return b"/".join([ODD_FOLDER.encode(), *parts])


def _part(draw: Draw) -> bytes:
    """Return a name that is neither this folder nor the one above."""
    kind = draw.random()
    if kind < 0.4:
        drawn = draw.integers(0, len(ALLOWED), int(draw.integers(1, LONGEST)))
        name = bytes(ALLOWED[int(i)] for i in drawn)
    elif kind < 0.5:
        name = b"\xff" * int(draw.integers(1, 255))
    else:
        count = int(draw.integers(1, 4))
        name = b"a".join(PIECES[int(draw.integers(len(PIECES)))] for _ in range(count))
    return b"p" + name if name in (b".", b"..") else name


def placed(place: Place, path: str, source: str, suffix: str = "") -> Path:
    """Put an input, or a whole run, at a path. Returns: where it lies."""
    end = place.root / (path + suffix)
    if end.exists():
        return end
    end.parent.mkdir(parents=True, exist_ok=True)
    if (place.kept / source).is_dir():
        shutil.copytree(place.kept / source, end, copy_function=os.link)
    else:
        shutil.copy(place.kept / source, end)
    return end


def remove_odd(place: Place) -> None:
    """Take away all that was put or written."""
    shutil.rmtree(place.root / ODD_FOLDER, ignore_errors=True)


def _at(source: str, suffix: str, read: Callable[[Place, Path], Any]) -> Callable[..., None]:
    """Read an input at a path, and show what is found there as `--json` and a screen would."""

    def reader(place: Place, path: str) -> None:
        try:
            found = read(place, placed(place, path, source, suffix))
            to_json(found).encode()
            str(found).encode()
        finally:
            remove_odd(place)

    return reader


def _new(suffix: str, write: Callable[[Place, Path], Any]) -> Callable[..., None]:
    """Write a file to a path, and show what is said of it."""

    def writer(place: Place, path: str) -> None:
        end = place.root / (path + suffix)
        try:
            end.parent.mkdir(parents=True, exist_ok=True)
            to_json(write(place, end)).encode()
            if not end.is_file():
                raise FileNotFoundError(f"{os.fsencode(end)!r} was not written")
        finally:
            remove_odd(place)

    return writer


def _spec(place: Place, path: Path) -> Any:
    return specs.load(f"{path}:brief", place.robot).describe()


def _run(place: Place, path: Path) -> Any:
    resolve(path)
    run = open_run(path)
    return [run.summary, str(run.path), run.zero_dynamics.robot.name]


PATH_READERS: tuple[Callable[..., None], ...] = (
    _at(f"{FILES}/amber3m.xml", ".xml", lambda place, path: inspect(load_robot(path))),
    _at(f"{FILES}/brief.py", ".py", _spec),
    _at(f"{FILES}/small.json", ".json", lambda place, path: check_proof(path)),
    _at(RUN, "", _run),
    _new(".xml", lambda place, path: write_built_in("amber3m", path)),
    _new(".xml", lambda place, path: planarise_file("amber3m", path)),
    _new(".txt", lambda place, path: write_text(path, "x\n")),
)
"""Each with a path, relative to the place, to which it adds what its kind of file ends in."""


def _lines(place: Place, path: Path) -> int:
    return sum(map(len, logs.read_all([path], place.robot)[0]))


_READ_LOG = _at(f"{FILES}/walk.csv", ".csv", _lines)


def log_reader(place: Place, path: str) -> None:
    """Read a log at a path, where the run has one."""
    if (place.kept / FILES / "walk.csv").is_file():
        _READ_LOG(place, path)


WORDS_OF_PATHS: tuple[tuple[str, str, Callable[[str], list[str]]], ...] = (
    (f"{FILES}/amber3m.xml", ".xml", lambda path: ["inspect", path]),
    (f"{FILES}/amber3m.xml", ".xml", lambda path: ["inspect", path, "--json"]),
    (f"{FILES}/small.json", ".json", lambda path: ["check-proof", path]),
    (f"{FILES}/small.json", ".json", lambda path: ["check-proof", path, "--json"]),
    (RUN, "", lambda path: ["simulate", path, "--steps", "1"]),
    (RUN, "", lambda path: ["simulate", path, "--steps", "1", "--log", f"{path}.csv", "--json"]),
    (RUN, "", lambda path: ["report", path, "--out", f"{path}.html"]),
    (RUN, "", lambda path: ["certify", path, "--level", "1", "--budget", "1"]),
    (f"{FILES}/brief.py", ".py", lambda path: ["train", "amber3m", "--spec", path]),
    ("", ".xml", lambda path: ["robots", "amber3m", "--out", path]),
    ("", "", lambda path: ["simulate", path]),
    ("", "", lambda path: ["report", path]),
)
"""What lies at the path, what it ends in, and a command about it; nothing lies at an empty one."""
