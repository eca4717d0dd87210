"""Parser of the command line: words become a verb with its settings."""

import re
import typing
from dataclasses import fields, is_dataclass
from typing import Annotated, Any

import tyro

from neuralgaits._called_with import descriptions
from neuralgaits._version import __version__
from neuralgaits.cli import arguments
from neuralgaits.cli.misspelt import refuse_misspelt
from neuralgaits.settings.options import arg

Verb = (
    arguments.TrainOptions
    | arguments.SimulateOptions
    | arguments.CertifyOptions
    | arguments.CheckProofOptions
    | arguments.FitOptions
    | arguments.RefineOptions
    | arguments.EpisodesOptions
    | arguments.SweepOptions
    | arguments.OptimiseOptions
    | arguments.ImportGaitOptions
    | arguments.ExportOptions
    | arguments.CheckDeployOptions
    | arguments.ReportOptions
    | arguments.ViewOptions
    | arguments.DemoOptions
    | arguments.InspectOptions
    | arguments.RobotsOptions
    | arguments.DoctorOptions
)
"""One subcommand each, see `verb_name`."""


def verb_name(settings: type) -> str:
    """Return the verb of a class of options: `ImportGaitOptions` is `import-gait`."""
    name = settings.__name__.removesuffix("Options")
    return re.sub("(?<=[a-z])(?=[A-Z])", "-", name).lower()


_VERBS = {verb_name(one): one for one in typing.get_args(Verb)}
_SUBCOMMANDS = typing.Union[  # noqa: UP007 - they are counted at run time.
    tuple(Annotated[one, tyro.conf.subcommand(name)] for name, one in _VERBS.items())
]


def read(words: list[str]) -> Verb:
    """Turn words into a verb.

    Raises: InputError for a word that is misspelt; SystemExit as tyro does, after printing help or
        the version (code 0) or an error (code 2).
    """
    words = list(words) or ["--help"]
    if words == ["--version"]:
        print(f"neuralgaits {__version__}")
        raise SystemExit(0)
    if words[0] == "help":
        words = [*words[1:], "--help"]
    if words and words[0] in ("-v", "--verbose"):
        words = [*words[1:], "-v"]
    refuse_misspelt(words, _VERBS)
    if words[0] in _VERBS and {"-h", "--help"} & set(words):
        _let_help_flow(_VERBS[words[0]])
        # The help of a verb leaves out what is given already, as a run.
        words = [words[0], "--help"]
    return tyro.cli(
        _SUBCOMMANDS,  # type: ignore[arg-type]
        prog="neuralgaits",
        description=(
            "Train a walking gait, walk it in MuJoCo, prove it.\n"
            "`neuralgaits demo` shows a proved gait on a live page.\n"
            "`neuralgaits train amber3m` trains one. Commands end with the next to give.\n"
            "`neuralgaits VERB --help` lists the options of a verb.\n"
            "  To begin: demo, train, simulate, certify, view, report.\n"
            "  Your own robot: robots, inspect, doctor; on the robot: export, check-deploy.\n"
            "  From logs: fit, refine, episodes. Proof files of others: check-proof.\n"
            "  Many runs: sweep. Gaits found otherwise: optimise, import-gait."
        ),
        args=words,
        config=(tyro.conf.FlagCreatePairsOff, tyro.conf.SuppressFixed),
    )


def _let_help_flow(settings: type) -> None:
    """Let the help break lines at the terminal's width, not where the source does.

    tyro keeps a break before an indented line, and lines of an attribute's docstring are indented.
    """
    texts = descriptions(settings)
    hints = typing.get_type_hints(settings, include_extras=True)
    for name, hint in hints.items():
        kind = typing.get_args(hint)[0] if typing.get_origin(hint) is Annotated else hint
        if is_dataclass(kind):
            _let_help_flow(typing.cast(type, kind))
        elif text := texts.get(name):
            settings.__annotations__[name] = Annotated[hint, arg(help=text)]


def given(verb: Any, settings: type, **others: Any) -> dict[str, Any]:
    """Return what a verb was given, as arguments of its workflow.

    Args:
        verb: verb that `read` returned.
        settings: class of the settings that the workflow takes.
        others: settings that only Python has, and those in another form.
    """
    own = {one.name for one in fields(verb)}
    names = (one.name for one in fields(settings) if one.name in own)
    return {name: getattr(verb, name) for name in names} | others
