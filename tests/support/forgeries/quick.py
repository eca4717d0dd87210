"""What makes the Python checker quick where a forgery is one of structure."""

import hashlib
import json
from collections.abc import Callable, Container, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any
from unittest import mock

import jax
import numpy as np

from neuralgaits.certificate.chart import PLANE_ONLY, Chart
from neuralgaits.certificate.levels import problems
from neuralgaits.certificate.proof_file import reader as claims
from neuralgaits.certificate.proof_file import shared_check
from neuralgaits.certificate.proof_file.statement_check import StatementCheck
from neuralgaits.certificate.proof_file.theorem_tables import Theorems
from neuralgaits.certificate.run_certificate import retrace, verified_summary
from neuralgaits.errors import InputError, NeuralGaitsError
from neuralgaits.programs import Program

Traced = dict[Any, Any]


class _Taken:
    """A statement that is not looked at."""

    verdict, reason = "holds", None
    boxes = boxes_in_balls = 0

    def walk(self, leaves: object) -> Iterator[int]:
        return iter(())


def stated(proof: Path) -> frozenset[str]:
    """What a proof states, each statement with its Program."""
    found = claims.read_claims(proof)
    return frozenset(_stated(found.program, statement) for statement in found.statements)


def all_but_the_first(content: bytes, folder: Path) -> frozenset[str]:
    """What a forged file states, as in `stated`, but for the statement at its front."""
    file = folder / "stated.json"
    file.write_bytes(content)
    found = claims.read_claims(file)
    return frozenset(_stated(found.program, statement) for statement in found.statements[1:])


@contextmanager
def statements_taken_as_checked(known: Container[str] | None = None) -> Iterator[None]:
    """No box is bounded: what is judged is the file, and what is concluded from it.

    Args:
        known: of `stated`, if only these are taken as checked and others bounded.
    """
    check = StatementCheck.of

    def of(program: Program, statement: claims.Statement, *how: Any) -> Any:
        if known is None or _stated(program, statement) in known:
            return _Taken()
        return check(program, statement, *how)

    with ExitStack() as stack:
        stack.enter_context(mock.patch.object(StatementCheck, "of", of))
        stack.enter_context(mock.patch.object(shared_check, "cores", lambda: 1))
        if known is None:
            stack.enter_context(
                mock.patch.object(verified_summary, "first_broken_bound", lambda _: None)
            )
        yield


@contextmanager
def traced_once(known: Traced) -> Iterator[None]:
    """Runs are traced in this process, each with its parameters once for all forgeries.

    And a Program is read once, which most forgeries leave as it was. Not for a run whose code is
    hostile.
    """
    with ExitStack() as stack:
        stack.enter_context(programs_read_once(known))
        stack.enter_context(mock.patch.object(retrace, "retrace_in_subprocess", _here))
        trace = _once(problems.trace_certificate, known)
        stack.enter_context(mock.patch.object(problems, "trace_certificate", trace))
        yield


@contextmanager
def programs_read_once(known: Traced) -> Iterator[None]:
    """Proofs that have the same Program, to the last character, share the one that was read."""
    with mock.patch.object(claims, "_program", _read_once(claims._program, known)):
        yield


def _stated(program: Program, statement: claims.Statement) -> str:
    return f"{program.hash} {statement}"


def _here(run: Path, theorems: Theorems, chart: Chart = PLANE_ONLY) -> dict[str, Any]:
    """What `retrace.retrace_in_subprocess` gets from a process of its own."""
    try:
        return json.loads(json.dumps(retrace.describe_run(run, theorems, chart)))
    except (NeuralGaitsError, OSError) as error:
        raise InputError(str(error)) from None


def _read_once(read: Callable, known: Traced) -> Callable:
    """By a file's very text; what is refused is read and refused again."""

    def program(*given):
        key = ("program", hashlib.sha256(repr(given).encode(errors="surrogatepass")).digest())
        if key not in known:
            known[key] = read(*given)
        return known[key]

    return program


def _once(trace: Callable, known: Traced) -> Callable:
    def traced(*parts):
        key = (trace.__name__, *map(_key, parts))
        if key not in known:
            known[key] = trace(*parts)
        return known[key]

    return traced


def _key(part: Any) -> Any:
    """Equal for equal robots, gaits, specs and parameters."""
    if hasattr(part, "layout"):
        return part.layout.xml
    if hasattr(part, "describe"):
        return repr(part.describe())
    if hasattr(part, "policy"):
        return tuple(np.asarray(leaf).tobytes() for leaf in jax.tree.leaves(part) if _number(leaf))
    return repr(part)


def _number(leaf: Any) -> bool:
    return isinstance(leaf, np.ndarray | jax.Array | float | int)
