"""Files that a user gives: looked at before they are opened.

Opening a FIFO waits for ever, and a device or a file of gigabytes fills the memory. A file that is
run may change the folder that all other paths start from.
"""

import contextlib
import csv
import os
import re
import stat
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from neuralgaits._printable import shown
from neuralgaits.errors import InputError

MOST_BYTES = 2**26
"""Largest file that is read whole; the largest proof so far is a tenth of this."""
MOST_LOG_BYTES = 2**31
"""Largest log: days of walking."""


@contextlib.contextmanager
def same_folder() -> Iterator[None]:
    """Return to the working folder at the end: within, a user's file may be run, which leaves it.

    Paths that a user gave later, or that a run holds, are relative to the folder of the call.
    """
    here = None
    with contextlib.suppress(OSError):  # It may have been removed.
        here = os.getcwd()
    try:
        yield
    finally:
        if here is not None:
            os.chdir(here)


def kind_of(mode: int) -> str:
    """Return what lies at a path that is no regular file, by its `st_mode`."""
    kinds = (
        (stat.S_ISDIR, "a folder"),
        (stat.S_ISFIFO, "a FIFO"),
        (stat.S_ISSOCK, "a socket"),
    )
    return next((kind for is_one, kind in kinds if is_one(mode)), "a device")


def no_file_at(path: Path, nothing: str) -> str:
    """Return what lies where a regular file was expected, or the words for nothing."""
    try:
        return f"{kind_of(os.stat(path).st_mode)} and no regular file"
    except (OSError, ValueError):
        return nothing


def refuse_no_path(what: str, value: object) -> None:
    """Refuse what cannot be a path. Raises: InputError in one line."""
    if not isinstance(value, str | Path):
        raise InputError(f"expected {what}, found {shown(value)}")
    longest = 4096  # Characters of a path that Linux takes.
    if "\0" in str(value) or len(str(value)) > longest:
        raise InputError(
            f"expected {what}, found a name of {len(str(value))} characters, or with a NUL: "
            f"{shown(str(value))}"
        )
    # Halves of characters, which no name has, are told of where the file is looked for.
    names = (part.encode("utf-8", "surrogatepass") for part in Path(value).parts)
    longest = max(map(len, names), default=0)
    most_bytes = 255  # Of the name of one file or folder, on all usual systems.
    if longest > most_bytes:
        raise InputError(
            f"expected {what}, found a name of {longest} bytes, and a file's or folder's has at "
            f"most {most_bytes}: {shown(str(value))}"
        )


def refuse_unreadable(
    path: Path, most: int = MOST_BYTES, remedy: str = "is it the right file?"
) -> None:
    """Refuse what lies at a path if it is no regular file, or larger than `most` bytes.

    A folder, and a path where nothing lies or none can, is left to whoever opens it.

    Raises: InputError in one line.
    """
    try:
        status = os.stat(path)
    except (OSError, ValueError):
        return
    if stat.S_ISDIR(status.st_mode):
        return
    if not stat.S_ISREG(status.st_mode):
        kind, remedy = kind_of(status.st_mode), "put a regular file there, or name one"
        raise InputError(f"expected a file to read, found {kind} at {path}: {remedy}")
    if status.st_size > most:
        raise InputError(
            f"expected a file of at most {most} bytes, found {status.st_size} at {path}: {remedy}"
        )


def csv_lines(path: Path, what: str) -> list[list[str]]:
    """Return the lines of a CSV file that are not blank, as lists of their words.

    Args:
        path: path of the file.
        what: what its rows are, for the message.

    Raises: InputError in one line.
    """
    refuse_unreadable(path)
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            return [line for line in csv.reader(file) if any(word.strip() for word in line)]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        reason = getattr(error, "strerror", None) or "it is no text in UTF-8"
        raise InputError(f"expected a CSV file of {what} at {path}, found none: {reason}") from None


def between_commas(line: str) -> str:
    """Return what to do with a row of a CSV file that has not the numbers it should have."""
    if ";" in line:
        return "write commas for its semicolons, and points in its numbers"
    return "write one number in each column, between commas"


def toml_of(path: Path) -> dict[str, Any]:
    """Return the tables of a TOML file.

    Raises: OSError; ValueError on what is no TOML, or has values that nothing here can use.
    """
    text = path.read_bytes().decode("utf-8")
    try:
        table = tomllib.loads(text)
        _refuse_huge(table)
    except RecursionError:
        raise ValueError("values nested too deeply") from None
    except ValueError as error:
        # A whole number with more digits than Python reads.
        endless = re.search("[0-9][0-9_]{4300,}", text)
        if endless and not isinstance(error, tomllib.TOMLDecodeError):
            line = text.count("\n", 0, endless.start()) + 1
            raise ValueError(
                f"a number that is too large, of {len(endless[0])} digits, in line {line}"
            ) from None
        raise
    return table


def _refuse_huge(value: Any, key: str = "") -> None:
    """Refuse whole numbers that no float holds; `key` leads to the value. Raises: ValueError."""
    if isinstance(value, dict):
        for name, one in value.items():
            _refuse_huge(one, f"{key}.{name}" if key else name)
    elif isinstance(value, list):
        for one in value:
            _refuse_huge(one, key)
    elif isinstance(value, int) and abs(value) > sys.float_info.max:
        raise ValueError(f"a number that is too large, {key}")
