"""Functions whose arguments are the fields of a class, which says what each of them is."""

import ast
import inspect
import itertools
import typing
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, fields
from functools import wraps
from textwrap import TextWrapper
from typing import Annotated, Any, ParamSpec, TypeVar

from neuralgaits._names import meant

P = ParamSpec("P")
Given = TypeVar("Given")
Result = TypeVar("Result")


def called_with(
    kind: Callable[P, Given],
) -> Callable[[Callable[[Given], Result]], Callable[P, Result]]:
    """Give a function of one object the arguments of its class.

    Signature and docstring list these arguments, so that they are written once. A text is read as
    the command line reads it, where that has a form of its own for a setting.
    """

    def decorate(carry_out: Callable[[Given], Result]) -> Callable[P, Result]:
        signature = inspect.signature(kind)
        readers = {name: _reader(one.annotation) for name, one in signature.parameters.items()}

        @wraps(carry_out)
        def verb(*args: P.args, **kwargs: P.kwargs) -> Result:
            _refuse_unknown(carry_out.__name__, kwargs, signature.parameters)
            arguments = signature.bind(*args, **kwargs).arguments
            for name, value in arguments.items():
                if isinstance(value, str) and (read := readers[name]) is not None:
                    arguments[name] = read([value])
            make: Callable[..., Given] = kind
            return carry_out(make(**arguments))

        texts = descriptions(typing.cast(type, kind))
        verb.__doc__ = _with_arguments(inspect.getdoc(carry_out) or "", texts)
        result = inspect.signature(carry_out).return_annotation
        parameters = [
            one.replace(annotation=_caller_type(one.annotation))
            for one in signature.parameters.values()
        ]
        verb.__dict__["__signature__"] = inspect.Signature(parameters, return_annotation=result)
        return verb

    return decorate


@dataclass(frozen=True)
class PythonType:
    """Mark of a field whose type is wider for a Python caller.

    Attributes:
        words: name of that type.
        kinds: its classes; empty if whatever uses the value judges it.
        elements: classes of its elements, for a sequence.
    """

    words: str
    kinds: tuple[type, ...] = ()
    elements: tuple[type, ...] = ()

    def __repr__(self) -> str:
        return self.words


def _caller_type(hint: Any) -> Any:
    """Return the type of a field for a Python caller, without the marks for the command line."""
    marks = marks_in(hint)
    wider = next((mark for mark in marks if isinstance(mark, PythonType)), None)
    return wider or (typing.get_args(hint)[0] if marks else hint)


def marks_in(hint: Any) -> tuple[Any, ...]:
    """Return the marks of an annotated type; none for a plain one."""
    return hint.__metadata__ if typing.get_origin(hint) is Annotated else ()


def _reader(hint: Any) -> Callable[[list[str]], Any] | None:
    """Return the function that reads a field's words of the command line; None for a plain type."""
    readers = (getattr(mark, "instance_from_str", None) for mark in marks_in(hint))
    return next(filter(None, readers), None)


def _refuse_unknown(name: str, arguments: Mapping[str, Any], names: Mapping[str, Any]) -> None:
    """Refuse a keyword that a function does not take. Raises: TypeError."""
    for word in arguments:
        if word not in names:
            hint = meant(word, names)
            raise TypeError(
                f"{name}() got an unexpected keyword argument {word!r}{hint and f'; {hint}'}"
            )


def descriptions(settings: type) -> dict[str, str]:
    """Return what a class of settings says about each field: the text behind it, on one line."""
    texts = {
        name: text for one in reversed(settings.__mro__[:-1]) for name, text in _field_texts(one)
    }
    hints = typing.get_type_hints(settings, include_extras=True)
    for name, hint in hints.items():
        for mark in marks_in(hint):
            if text := getattr(mark, "help", None):
                texts.setdefault(name, text)
    # As in the signature: arguments by keyword alone come last.
    order = [field.name for field in sorted(fields(settings), key=lambda one: one.kw_only is True)]
    return {name: " ".join(texts[name].split()) for name in order if name in texts}


def _field_texts(settings: type) -> Iterator[tuple[str, str]]:
    """Yield the fields of a class with the docstrings that follow them."""
    try:
        [definition] = ast.parse(inspect.getsource(settings)).body
    except OSError:
        # Installed without sources: nothing is said.
        return
    assert isinstance(definition, ast.ClassDef)
    for field, text in itertools.pairwise(definition.body):
        match field, text:
            case (
                ast.AnnAssign(target=ast.Name(id=name)),
                ast.Expr(value=ast.Constant(value=str(docstring))),
            ):
                yield name, docstring


def _with_arguments(doc: str, arguments: dict[str, str]) -> str:
    """Return a docstring with a section about its arguments behind its first part."""
    head, blank, tail = doc.partition("\n\nReturns:")
    wrapped = TextWrapper(
        96, initial_indent="    ", subsequent_indent="        ", break_on_hyphens=False
    )
    listed = "\n".join(wrapped.fill(f"{name}: {text}") for name, text in arguments.items())
    return f"{head}\n\nArgs:\n{listed}{blank}{tail}"
