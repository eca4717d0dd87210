"""The words of a command line, turned into a verb with its settings."""

import tyro

from neuralgaits.cli.arguments import (
    Certify,
    CheckProof,
    Demo,
    Doctor,
    Episodes,
    Export,
    Fit,
    Inspect,
    Refine,
    Report,
    Robots,
    Simulate,
    Train,
    View,
)

Verb = (
    Train
    | Simulate
    | Certify
    | CheckProof
    | Fit
    | Refine
    | Episodes
    | Export
    | Report
    | View
    | Demo
    | Inspect
    | Robots
    | Doctor
)
"""One subcommand each: the class name in lower case, with hyphens."""


def read(arguments: list[str]) -> Verb:
    """Turn words into a verb.

    Raises: SystemExit as tyro does, after printing help (code 0) or an error (code 2).
    """
    words = list(arguments)
    if words and words[0] in ("-v", "--verbose"):
        words = [*words[1:], "-v"]
    return tyro.cli(
        Verb,  # type: ignore[arg-type]
        prog="neuralgaits",
        description="Neural walking gaits from barrier conditions on the zero dynamics.",
        args=words,
        config=(tyro.conf.FlagCreatePairsOff,),
    )
