"""Shell commands that this program prints: quoted, with paths that exist.

A robot's or spec's name in a run's config is for people. A command names the run's folder: it has
copies of both, wherever the original files were.
"""

import os
import shlex
from pathlib import Path
from typing import Any

from neuralgaits._printable import printable

PROGRAM, LATEST = "neuralgaits", "latest"


def command(*words: Any) -> str:
    """Return a command of this program, each word quoted if it must be."""
    return " ".join(quoted(str(word)) for word in (PROGRAM, *words))


def quoted(word: str) -> str:
    """Quote a word for a shell; a path that is not UTF-8 byte by byte, as bash and zsh read it."""
    if printable(word) == word:
        return shlex.quote(word)
    # Bytes that need no escape between $' and '.
    plain = frozenset(range(0x20, 0x7F)) - frozenset(b"'\\")
    signs = (chr(byte) if byte in plain else f"\\x{byte:02x}" for byte in os.fsencode(word))
    return f"$'{''.join(signs)}'"


def named(path: str | Path) -> str:
    """Return a path as an argument; one that looks like a flag or `latest` gets ./ in front."""
    word = str(path)
    return f"./{word}" if word.startswith("-") or word == LATEST else word


def resuming(path: str | Path) -> str:
    """Return the command that resumes an unfinished training, on the run's own robot and spec."""
    return command("train", "--resume", named(path))


def learning(path: Path) -> str:
    """Return the commands that learn a residual from a run's walk, logged first if need be."""
    run, log = named(path), path / "simulation" / "walk.csv"
    learn = command("fit", run, named(log))
    return learn if log.is_file() else f"{command('simulate', run, '--log', named(log))} && {learn}"
