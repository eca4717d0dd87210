"""No two folders of a room import each other: a folder's own files count as one more folder."""

import ast
import os
from collections import defaultdict
from pathlib import Path

import neuralgaits

ROOT = Path(neuralgaits.__file__).parent
COPIES = ("demo_run", "demo_speed_run", "demo_lean_run")
"""Copies of a spec, which are not imported."""


def modules():
    files = [file for file in ROOT.rglob("*.py") if file.relative_to(ROOT).parts[0] not in COPIES]
    return {".".join(file.relative_to(ROOT.parent).with_suffix("").parts): file for file in files}


def imports(tree):
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module is not None:
            yield from ([node.module, f"{node.module}.{name.name}"] for name in node.names)
        elif isinstance(node, ast.Import):
            yield from ([name.name] for name in node.names)


def siblings(one, other):
    """The folders of both just below the folder that they share, or that folder itself."""
    depth = len(Path(os.path.commonpath([one, other])).parts) + 1
    return tuple(Path(*folder.parts[:depth]) for folder in (one, other))


def test_no_two_folders_of_a_room_import_each_other():
    known, edges = modules(), defaultdict(list)
    for name, file in known.items():
        # A package's own __init__ offers what its files have.
        for places in imports(ast.parse(file.read_text())) if file.name != "__init__.py" else ():
            for place in places:
                there = known.get(place)
                if there is not None and there.parent != file.parent:
                    edges[siblings(file.parent, there.parent)].append(f"{name} -> {place}")
    assert len(edges) > 100
    circles = [
        edges[pair][0]
        for pair in edges
        if pair[::-1] in edges
        and pair[0].relative_to(ROOT).parts[:1] == pair[1].relative_to(ROOT).parts[:1]
    ]
    assert circles == []
