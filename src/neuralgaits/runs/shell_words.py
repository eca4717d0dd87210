"""Lines for a shell that this program prints: quoted, and of paths that are there.

A robot's or spec's name in a run's config is for people. A command names the run's folder: it has
copies of both, wherever the files lay that it was started with.
"""

import os
import shlex
from pathlib import Path
from typing import Any

from neuralgaits._printable import printable

PROGRAM, LATEST = "neuralgaits", "latest"
_PLAIN = frozenset(range(0x20, 0x7F)) - frozenset(b"'\\")
"""Bytes that stand for themselves between $' and '."""


def command(*words: Any) -> str:
    """A command of this program, each word quoted if it must be."""
    return " ".join(quoted(str(word)) for word in (PROGRAM, *words))


def quoted(word: str) -> str:
    """Quote a word for a shell; a path that is no UTF-8 byte by byte, as bash and zsh read it."""
    if printable(word) == word:
        return shlex.quote(word)
    signs = (chr(byte) if byte in _PLAIN else f"\\x{byte:02x}" for byte in os.fsencode(word))
    return f"$'{''.join(signs)}'"


def named(path: str | Path) -> str:
    """A path as an argument: what would be read as a flag or as `latest` gets ./ in front."""
    word = str(path)
    return f"./{word}" if word.startswith("-") or word == LATEST else word


def resuming(path: str | Path) -> str:
    """Goes on with an unfinished training, on the run's own robot and spec."""
    return command("train", "--resume", named(path))


def learning(path: Path) -> str:
    """Learns a residual from a run's walk, which is logged first if it has not been."""
    run, log = named(path), path / "simulation" / "walk.csv"
    learn = command("fit", run, named(log))
    return learn if log.is_file() else f"{command('simulate', run, '--log', named(log))} && {learn}"
