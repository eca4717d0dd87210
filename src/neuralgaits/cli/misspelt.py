"""Missing and misspelt words of a command line: one line that says what to do.

The parser would also refuse them, but with the help of every verb that has a similar option.
"""

import dataclasses
import re
import types
import typing
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

from neuralgaits._digits import decimal, whole
from neuralgaits._names import meant
from neuralgaits.errors import InputError
from neuralgaits.settings.options import ONLY_PYTHON, POSITIONAL

_NUMBERS = {float: ("a number", decimal), int: ("a whole number", whole)}


@dataclasses.dataclass(frozen=True)
class _Setting:
    """Option of a verb, or positional argument."""

    kind: type | tuple[str, ...] | None
    """Type of its value if that is a plain one, or the choices."""
    metavar: str
    """Placeholder of its value in the help."""
    required: bool
    many: bool
    """Whether it may be several words."""

    @property
    def expected(self) -> str:
        """Expected value of the option, in words."""
        if isinstance(self.kind, tuple):
            *others, last = self.kind
            return " or ".join((", ".join(others), last)) if others else last
        return _NUMBERS[self.kind][0] if self.kind in _NUMBERS else "a value"


def refuse_misspelt(words: Sequence[str], verbs: Mapping[str, type]) -> None:
    """Refuse unknown, superfluous or missing words, and impossible values.

    Args:
        words: words of the command line, without the program's name.
        verbs: classes of settings by the verb's name.

    Raises: InputError with the word, and what the user may have meant.
    """
    if not words or words[0].startswith("-"):
        return
    verb, *rest = words
    if verb not in verbs:
        if hint := meant(verb, verbs):
            raise InputError(f"no command {verb}; {hint}")
        raise InputError(f"no command {verb}: expected one of {', '.join(verbs)}")
    options = options_of(verbs[verb])
    positional = [one for _, one, alone in _settings(verbs[verb]) if alone]
    flags, alone = set(), []
    left = iter(rest)
    for word in left:
        if word in ("-h", "--help"):
            return
        if word == "--":
            alone += left
        elif word.startswith("--"):
            _refuse_elsewhere(verb, word, verbs)
            name = _option(verb, word, options, left)
            if name in flags:
                # The parser would take the last one and say nothing.
                raise InputError(
                    f"expected {name} once, found it twice: leave one out, or join NAME=... by "
                    "commas"
                )
            flags.add(name)
        elif word.startswith("-") and word not in ("-", "-v"):
            raise InputError(f"unknown option {word} of {verb}; {_see(verb)}")
        elif word != "-v":
            alone.append(word)
    _refuse_count(verb, alone, positional)
    for name, one in options.items():
        if one.required and name not in flags:
            raise InputError(f"expected {name} {one.metavar}, found none; {_see(verb)}")


def _refuse_elsewhere(verb: str, word: str, verbs: Mapping[str, type]) -> None:
    """Refuse an option that belongs to other verbs. Raises: InputError with their names."""
    name, _, value = word.partition("=")
    name = name.replace("_", "-")
    if name in options_of(verbs[verb]):
        return
    owners = [other for other, settings in verbs.items() if name in options_of(settings)]
    if not owners:
        return
    *others, last = owners
    listed = f"{', '.join(others)} and {last}" if others else last
    way = _see(verb)
    # Verbs that take a command in another way than `train`: option, purpose and form of the value.
    otherwise_commanded = {
        "simulate": ("--command", "command a gait", "{}"),
        "certify": ("--within", "prove a gait for a part of its commands", "{0}:{0}"),
    }
    examples = {
        "--speed": "0.8",
        "--step-length": "0.4",
        "--step-height": "0.02",
        "--slope": "3",
    }
    if verb in otherwise_commanded and name in examples:
        use, purpose, form = otherwise_commanded[verb]
        command = name.removeprefix("--").replace("-", "_")
        way = f"to {purpose} use {use} {command}={value or form.format(examples[name])}"
    # A plural of it: `--logs` where `--log` was typed.
    longer = next((own for own in options_of(verbs[verb]) if own.startswith(name)), None)
    if longer is not None:
        way = f"did you mean {longer}?"
    raise InputError(f"unknown option {name} of {verb}: {name} belongs to {listed}; {way}")


def _option(verb: str, word: str, options: Mapping[str, _Setting], left: Iterator[str]) -> str:
    """Check an option and its value, the next of the words left. Returns: its name."""
    name, separator, value = word.partition("=")
    name = name.replace("_", "-")
    if name not in options:
        raise InputError(f"unknown option {name} of {verb}; {meant(name, options) or _see(verb)}")
    one = options[name]
    if one.kind is bool:
        if separator:
            raise InputError(f"{name}: expected no value, found {value!r}")
        return name
    if not separator:
        value = next(left, "--")
        if value.startswith("--"):
            raise InputError(f"{name}: expected {one.expected}, found none")
    if not value.strip():
        raise InputError(f"{name}: expected {one.expected}, found {value!r}")
    if one.kind is not Path:
        _refuse_other_notations(name, value, names=one.kind is str)
    if isinstance(one.kind, tuple):
        if value not in one.kind:
            hint = meant(value, one.kind)
            raise InputError(
                f"{name}: expected {one.expected}, found {value!r}{hint and f'; {hint}'}"
            )
    elif one.kind in _NUMBERS:
        try:
            _NUMBERS[one.kind][1](value)
        except ValueError:
            raise InputError(f"{name}: expected {one.expected}, found {value!r}") from None
    return name


def _refuse_other_notations(name: str, value: str, *, names: bool) -> None:
    """Refuse numbers such as 1_0 or with other digits than 0 to 9, which Python reads too.

    A value may be a list of numbers, of NAME=NUMBER or of NUMBER:NUMBER. A word that is no number
    may have any character; if the option takes names, only numbers after = are meant as such.

    Raises: InputError.
    """
    for part in re.findall("=([^,:=]*)", value) if names else re.split("[,:=]", value):
        try:
            number = float(part)
        except ValueError:
            continue
        if part.isascii() and "_" not in part:
            continue
        # 0_7 is 7 to Python, and was meant as 0.7.
        point = re.match("[+-]?0+_", part) and "." not in part
        remedy = "use a point for decimals, and no _" if point else f"write {number:.15g}"
        raise InputError(f"{name}: expected the digits 0 to 9, found {part!r}: {remedy}")


def _refuse_count(verb: str, alone: Sequence[str], positional: Sequence[_Setting]) -> None:
    """Compare the number of positional words with what the verb takes. Raises: InputError."""
    needed = [one for one in positional if one.required]
    if len(alone) < len(needed):
        metavar = needed[len(alone)].metavar
        examples = {"RUN": "latest", "ROBOT": "amber3m"}
        example = examples.get(metavar)
        as_in = f"name one, as in `neuralgaits {verb} {example}`" if example else _see(verb)
        raise InputError(f"expected {metavar}, found none: {as_in}")
    if len(alone) > len(positional) and not any(one.many for one in positional):
        word = alone[len(positional)]
        words = " ".join(one.metavar.strip("[]") for one in positional) or "no word"
        raise InputError(f"{verb} takes {words} beside its options, found {word!r}; {_see(verb)}")


def _see(verb: str) -> str:
    return f"see `neuralgaits {verb} --help`"


def options_of(settings: type) -> dict[str, _Setting]:
    """Return the options of a verb, by name."""
    return {
        f"--{name.replace('_', '-')}": one for name, one, alone in _settings(settings) if not alone
    }


def _settings(settings: type) -> Iterator[tuple[str, _Setting, bool]]:
    """Yield name, setting and whether it is positional, for each field, nested ones included."""
    hints = typing.get_type_hints(settings, include_extras=True)
    for field in dataclasses.fields(settings):
        hint, marks = _unwrapped(hints[field.name])
        if ONLY_PYTHON in marks:
            continue
        if dataclasses.is_dataclass(hint):
            yield from _settings(typing.cast(type, hint))
            continue
        kind = hint if isinstance(hint, type) else None
        choices = typing.get_args(hint) if typing.get_origin(hint) is Literal else None
        metavar = next((one.metavar for one in marks if getattr(one, "metavar", None)), "VALUE")
        required = field.default is field.default_factory is dataclasses.MISSING
        many = typing.get_origin(hint) is tuple
        yield field.name, _Setting(choices or kind, metavar, required, many), POSITIONAL in marks


def _unwrapped(hint: Any) -> tuple[Any, tuple[Any, ...]]:
    """Split an annotation into its type, without None, and the marks around it."""
    marks: tuple[Any, ...] = ()
    while typing.get_origin(hint) is Annotated:
        hint, *more = typing.get_args(hint)
        marks += tuple(more)
    if typing.get_origin(hint) in (typing.Union, types.UnionType):
        kinds = [one for one in typing.get_args(hint) if one is not types.NoneType]
        hint = kinds[0] if len(kinds) == 1 else None
    return hint, marks
