"""What makes the Python checker quick where a forgery is one of structure."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any
from unittest import mock

import jax
import numpy as np

from neuralgaits.certificate import check as checker
from neuralgaits.workflows import full_order, sets

Traced = dict[Any, Any]


@contextmanager
def statements_taken_as_checked() -> Iterator[None]:
    """No box is bounded: what is judged is the file, and what is concluded from it."""
    with mock.patch.object(checker._Checker, "walk", lambda self, leaves: iter(())):
        yield


@contextmanager
def traced_once(known: Traced) -> Iterator[None]:
    """The Program of a run and its parameters is traced once for all forgeries."""
    with (
        mock.patch.object(sets, "trace_certificate", _once(sets.trace_certificate, known)),
        mock.patch.object(full_order, "trace_full_order", _once(full_order.trace_full_order, known)),
    ):
        yield


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
    if hasattr(part, "gait") and hasattr(part, "bandwidth"):
        return (*map(_key, (part.robot, part.gait, part.spec)), part.bandwidth)
    if hasattr(part, "policy"):
        return tuple(np.asarray(leaf).tobytes() for leaf in jax.tree.leaves(part) if _number(leaf))
    return repr(part)


def _number(leaf: Any) -> bool:
    return isinstance(leaf, np.ndarray | jax.Array | float | int)
