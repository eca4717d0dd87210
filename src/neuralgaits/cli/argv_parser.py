"""Parser of the command line: words become a verb with its settings."""

import ast
import inspect
import itertools
import re
import typing
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from typing import Annotated, Any

import tyro

from neuralgaits._version import __version__
from neuralgaits.cli import arguments as of
from neuralgaits.cli.misspelt import refuse_misspelt

Verb = (
    of.TrainOptions
    | of.SimulateOptions
    | of.CertifyOptions
    | of.CheckProofOptions
    | of.FitOptions
    | of.RefineOptions
    | of.EpisodesOptions
    | of.SweepOptions
    | of.OptimiseOptions
    | of.ImportGaitOptions
    | of.ExportOptions
    | of.ReportOptions
    | of.ViewOptions
    | of.DemoOptions
    | of.InspectOptions
    | of.RobotsOptions
    | of.DoctorOptions
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
    if words[0] in _VERBS and {"-h", "--help"} & set(words):
        _let_help_flow(_VERBS[words[0]])
    return tyro.cli(
        _SUBCOMMANDS,  # type: ignore[arg-type]
        prog="neuralgaits",
        description="Neural walking gaits from barrier conditions on the zero dynamics.",
        args=words,
        config=(tyro.conf.FlagCreatePairsOff,),
    )


def _let_help_flow(settings: type) -> None:
    """Let the help break lines at the terminal's width, not where the source does.

    tyro keeps a break before an indented line, and lines of an attribute's docstring are indented.
    """
    said = dict(_said(settings))
    hints = typing.get_type_hints(settings, include_extras=True)
    for name, hint in hints.items():
        kind = typing.get_args(hint)[0] if typing.get_origin(hint) is Annotated else hint
        if is_dataclass(kind):
            _let_help_flow(typing.cast(type, kind))
        elif text := said.get(name):
            settings.__annotations__[name] = Annotated[hint, of.arg(help=" ".join(text.split()))]


def _said(settings: type) -> Iterator[tuple[str, str]]:
    """Yield the fields of a class with the docstrings that follow them."""
    [found] = ast.parse(inspect.getsource(settings)).body
    assert isinstance(found, ast.ClassDef)
    for field, text in itertools.pairwise(found.body):
        match field, text:
            case (
                ast.AnnAssign(target=ast.Name(id=name)),
                ast.Expr(value=ast.Constant(value=str(docstring))),
            ):
                yield name, docstring


def options(verb: Any, *left_out: str) -> dict[str, Any]:
    """Return the settings of a verb by name; the names are those of its workflow's arguments.

    Args:
        verb: verb that `read` returned.
        left_out: names of settings to leave out. Those about output and workers are always left
            out.
    """
    others = {"output", "pool", *left_out}
    return {one.name: getattr(verb, one.name) for one in fields(verb) if one.name not in others}
