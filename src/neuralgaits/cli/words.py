"""The words of a command line, turned into a verb with its settings."""

from typing import Annotated

import tyro
from tyro.conf import subcommand

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

_NAMED = (
    Annotated[Train, subcommand("train")]
    | Annotated[Simulate, subcommand("simulate")]
    | Annotated[Certify, subcommand("certify")]
    | Annotated[CheckProof, subcommand("check-proof")]
    | Annotated[Fit, subcommand("fit")]
    | Annotated[Refine, subcommand("refine")]
    | Annotated[Episodes, subcommand("episodes")]
    | Annotated[Export, subcommand("export")]
    | Annotated[Report, subcommand("report")]
    | Annotated[View, subcommand("view")]
    | Annotated[Demo, subcommand("demo")]
    | Annotated[Inspect, subcommand("inspect")]
    | Annotated[Robots, subcommand("robots")]
    | Annotated[Doctor, subcommand("doctor")]
)


def read(arguments: list[str]) -> Verb:
    """Turn words into a verb.

    Raises: SystemExit as tyro does, after printing help (code 0) or an error (code 2).
    """
    words = list(arguments)
    if words and words[0] in ("-v", "--verbose"):
        words = [*words[1:], "-v"]
    return tyro.cli(
        _NAMED,  # type: ignore[arg-type]
        prog="neuralgaits",
        description="Neural walking gaits from barrier conditions on the zero dynamics.",
        args=words,
        config=(tyro.conf.FlagCreatePairsOff,),
    )
