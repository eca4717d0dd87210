"""The words of a command line, turned into a verb with its settings."""

import re
import typing
from dataclasses import fields
from typing import Any

import tyro

from neuralgaits._version import __version__
from neuralgaits.cli import arguments as of
from neuralgaits.cli.misspelt import refuse_misspelt

Verb = (
    of.Train
    | of.Simulate
    | of.Certify
    | of.CheckProof
    | of.Fit
    | of.Refine
    | of.Episodes
    | of.Sweep
    | of.Optimise
    | of.ImportGait
    | of.Export
    | of.Report
    | of.View
    | of.Demo
    | of.Inspect
    | of.Robots
    | of.Doctor
)
"""One subcommand each: the class name in lower case, with hyphens."""
_VERBS = {
    re.sub("(?<=[a-z])(?=[A-Z])", "-", one.__name__).lower(): one for one in typing.get_args(Verb)
}


def read(arguments: list[str]) -> Verb:
    """Turn words into a verb.

    Raises: InputError for a word that is misspelt; SystemExit as tyro does, after printing help or
        the version (code 0) or an error (code 2).
    """
    words = list(arguments) or ["--help"]
    if words == ["--version"]:
        print(f"neuralgaits {__version__}")
        raise SystemExit(0)
    if words and words[0] in ("-v", "--verbose"):
        words = [*words[1:], "-v"]
    refuse_misspelt(words, _VERBS)
    return tyro.cli(
        Verb,  # type: ignore[arg-type]
        prog="neuralgaits",
        description="Neural walking gaits from barrier conditions on the zero dynamics.",
        args=words,
        config=(tyro.conf.FlagCreatePairsOff,),
    )


def options(verb: Any, *left_out: str) -> dict[str, Any]:
    """Settings of a verb by their names, which are those of its workflow's arguments.

    Args:
        verb: of `read`.
        left_out: what is given otherwise. How the answer is printed, and where the work is done,
            are left out anyway.
    """
    others = {"output", "at_work", *left_out}
    return {one.name: getattr(verb, one.name) for one in fields(verb) if one.name not in others}
