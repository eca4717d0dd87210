"""Commands that the program prints, read off its pages and screens, and what they stand for."""

import html
import re
import shlex
from pathlib import Path

from neuralgaits.barriers import specs
from neuralgaits.cli.arguments import FitOptions, TrainOptions
from neuralgaits.cli.argv_parser import Verb, read
from neuralgaits.robots import load_robot
from neuralgaits.runs import resolve, resolve_unfinished

_CODE = re.compile(r"<code>(.*?)</code>", re.DOTALL)


def on_page(page: str) -> list[str]:
    """Commands of a page, in order, each once."""
    lines = [line for code in _CODE.findall(page) for line in html.unescape(code).splitlines()]
    return _commands(lines + _ticked(html.unescape(page)))


def on_screen(text: str) -> list[str]:
    """Commands of a screen: behind a label, or between backticks."""
    labelled = re.findall(r"^[a-z ]*?\b(neuralgaits .*)$", text, re.MULTILINE)
    return _commands(labelled + _ticked(text))


def _ticked(text: str) -> list[str]:
    return re.findall(r"`(neuralgaits [^`]*)`", text)


def _commands(lines: list[str]) -> list[str]:
    parts = [part.strip() for line in lines for part in line.split(" && ")]
    return list(dict.fromkeys(part for part in parts if part.startswith("neuralgaits ")))


def check(lines: list[str]) -> list[Verb]:
    """Read commands as the command line does, and find all that they name.

    What a command writes is there for those after it.
    """
    assert lines
    made: set[Path] = set()
    verbs = []
    for line in lines:
        program, *words = shlex.split(line)
        assert program == "neuralgaits"
        verb = read(words)
        _find(verb, made)
        verbs.append(verb)
        made |= {Path(to) for name in ("out", "log") if (to := getattr(verb, name, None))}
    return verbs


def _find(verb: Verb, made: set[Path]) -> None:
    """Everything that a command names is there, or is made by one before it."""
    asked = vars(verb)
    robot = load_robot(asked["robot"]) if asked.get("robot") else None
    if asked.get("plant"):
        load_robot(asked["plant"])
    if asked.get("spec"):
        assert robot is not None
        specs.load(asked["spec"], robot)
    if asked.get("run") and Path(asked["run"]) not in made:
        resolve(asked["run"])
    if asked.get("resume"):
        if isinstance(verb, TrainOptions):
            resolve_unfinished(asked["resume"])
        elif isinstance(asked["resume"], str):
            resolve(asked["resume"])
    logs = asked["logs"] if isinstance(verb, FitOptions) else ()
    for file in (asked.get("residual"), asked.get("file"), *logs):
        assert file is None or file in made or file.is_file(), file
