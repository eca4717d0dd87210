"""Run a module of this package in a process of its own."""

import os
import sys
from pathlib import Path

PACKAGE = Path(__file__).parents[1]
"""Folder from which the package is imported; the other process imports from the same one."""


def command_of(module: str, *arguments: str) -> list[str]:
    """The command line. `-P`: the folder that it is called in could shadow any module."""
    return [sys.executable, "-P", "-m", module, *arguments]


def environment_of(**more: str) -> dict[str, str]:
    """Return this process's environment with the package's path and more variables in it."""
    path = os.environ.get("PYTHONPATH")
    paths = [str(PACKAGE), *([path] if path else [])]
    return os.environ | {"PYTHONPATH": os.pathsep.join(paths)} | more
