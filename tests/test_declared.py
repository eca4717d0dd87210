"""What the package imports is what it asks to be installed."""

import ast
import re
import sys
import tomllib
from importlib.metadata import packages_distributions
from pathlib import Path

import neuralgaits

PACKAGE = Path(neuralgaits.__file__).parent
PROJECT = tomllib.loads((PACKAGE.parents[1] / "pyproject.toml").read_text())["project"]


def _names(requirements: list[str]) -> set[str]:
    return {re.split(r"[\[<>=!;, ]", text)[0].lower() for text in requirements}


def _imported() -> set[str]:
    modules = set()
    for file in PACKAGE.rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                modules |= {alias.name.split(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                modules.add(node.module.split(".")[0])
    return modules - set(sys.stdlib_module_names) - {"neuralgaits"}


# Too large to be installed for every test.
NOT_INSTALLED = {"pydrake": ["drake"]}


def _distribution(module: str, installed: dict[str, list[str]]) -> str:
    return installed.get(module, [module])[0].lower().replace("_", "-")


def test_every_import_is_declared() -> None:
    installed = NOT_INSTALLED | dict(packages_distributions())
    needed = {_distribution(module, installed) for module in _imported()}
    extras = PROJECT["optional-dependencies"]
    shipped = ("deploy", "drake", "gym", "hzd", "mcap", "onnx", "ray", "video")
    optional = set().union(*(_names(extras[name]) for name in shipped))
    assert needed <= _names(PROJECT["dependencies"]) | optional
    assert optional <= needed
