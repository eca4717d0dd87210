"""Lines for a shell that this program prints: quoted, and of paths that are there.

A robot's or spec's name in a run's config is for people. A command names the run's folder: it has
copies of both, wherever the files lay that it was started with.
"""

import shlex
from pathlib import Path
from typing import Any

PROGRAM, LATEST = "neuralgaits", "latest"


def command(*words: Any) -> str:
    """A command of this program, each word quoted if it must be."""
    return shlex.join([PROGRAM, *(str(word) for word in words)])


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
