"""Functions whose arguments are the fields of a class, which says what each of them is."""

import ast
import inspect
import itertools
import typing
from collections.abc import Callable, Iterator
from dataclasses import fields
from functools import wraps
from typing import Annotated, Any, ParamSpec, TypeVar

P = ParamSpec("P")
Given = TypeVar("Given")
Result = TypeVar("Result")


def called_with(
    kind: Callable[P, Given],
) -> Callable[[Callable[[Given], Result]], Callable[P, Result]]:
    """Give a function of one object the arguments of its class.

    Signature and docstring list these arguments, so that they are written once.
    """

    def decorate(carry_out: Callable[[Given], Result]) -> Callable[P, Result]:
        @wraps(carry_out)
        def verb(*args: P.args, **kwargs: P.kwargs) -> Result:
            return carry_out(kind(*args, **kwargs))

        said = descriptions(typing.cast(type, kind))
        verb.__doc__ = _with_arguments(inspect.getdoc(carry_out) or "", said)
        result = inspect.signature(carry_out).return_annotation
        parameters = inspect.signature(kind).parameters.values()
        shown = [one.replace(annotation=_unmarked(one.annotation)) for one in parameters]
        verb.__dict__["__signature__"] = inspect.Signature(shown, return_annotation=result)
        return verb

    return decorate


def _unmarked(hint: Any) -> Any:
    """Return a type without the marks for the command line."""
    return typing.get_args(hint)[0] if typing.get_origin(hint) is Annotated else hint


def descriptions(settings: type) -> dict[str, str]:
    """Return what a class of settings says about each field: the text behind it, on one line."""
    said = {name: text for one in reversed(settings.__mro__[:-1]) for name, text in _said(one)}
    hints = typing.get_type_hints(settings, include_extras=True)
    for name, hint in hints.items():
        for mark in typing.get_args(hint)[1:]:
            if text := getattr(mark, "help", None):
                said.setdefault(name, text)
    order = [field.name for field in fields(settings)]
    return {name: " ".join(said[name].split()) for name in order if name in said}


def _said(settings: type) -> Iterator[tuple[str, str]]:
    """Yield the fields of a class with the docstrings that follow them."""
    try:
        [found] = ast.parse(inspect.getsource(settings)).body
    except OSError:
        # Installed without sources: nothing is said.
        return
    assert isinstance(found, ast.ClassDef)
    for field, text in itertools.pairwise(found.body):
        match field, text:
            case (
                ast.AnnAssign(target=ast.Name(id=name)),
                ast.Expr(value=ast.Constant(value=str(docstring))),
            ):
                yield name, docstring


def _with_arguments(doc: str, arguments: dict[str, str]) -> str:
    """Return a docstring with a section about its arguments behind its first part."""
    head, blank, tail = doc.partition("\n\nReturns:")
    listed = "\n".join(f"    {name}: {text}" for name, text in arguments.items())
    return f"{head}\n\nArgs:\n{listed}{blank}{tail}"
