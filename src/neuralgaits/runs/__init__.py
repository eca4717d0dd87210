"""Run folders: configuration, weights, metrics and results of a run on disk.

Dicts and arrays go in and come out; what they mean is the business of the stages.
"""

from neuralgaits.runs.atomic import write_bytes, write_text
from neuralgaits.runs.folder import FORMAT, RunFolder
from neuralgaits.runs.latest import RUNS_ROOT, finish, resolve, resolve_unfinished
from neuralgaits.runs.plain import plain, to_json
from neuralgaits.runs.tree import read_arrays, read_tree, write_arrays, write_tree

__all__ = [
    "FORMAT",
    "RUNS_ROOT",
    "RunFolder",
    "finish",
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
