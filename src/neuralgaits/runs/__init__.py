"""Run folders: configuration, weights, metrics and results of a run on disk.

Dicts and arrays go in and come out; the stages give them their meaning. JAX is imported only when
a tree of arrays is read or written: a check of a proof does without.
"""

from typing import TYPE_CHECKING, Any

from neuralgaits.runs.arrays import read_arrays, write_arrays
from neuralgaits.runs.atomic import write_bytes, write_text
from neuralgaits.runs.folder import FORMAT, RunFolder
from neuralgaits.runs.latest import RUNS_ROOT, finish, resolve, resolve_unfinished
from neuralgaits.runs.plain import from_json, object_from_json, plain, to_json

if TYPE_CHECKING:
    from neuralgaits.runs.array_tree import read_tree, write_tree

__all__ = [
    "FORMAT",
    "RUNS_ROOT",
    "RunFolder",
    "finish",
    "from_json",
    "object_from_json",
    "plain",
    "read_arrays",
    "read_tree",
    "resolve",
    "resolve_unfinished",
    "to_json",
    "write_arrays",
    "write_bytes",
    "write_text",
    "write_tree",
]


def __getattr__(name: str) -> Any:
    """Import names that need JAX. Raises: AttributeError for any other name."""
    if name not in ("read_tree", "write_tree"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from neuralgaits.runs import array_tree

    return getattr(array_tree, name)
