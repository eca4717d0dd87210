"""The list of what a family provides, in CONTRIBUTING.md, has every member of its classes."""

import re
from dataclasses import fields

import pytest

from neuralgaits.systems.proved_system import ExportedSystem, ProvedSystem
from neuralgaits.systems.system_family import SystemFamily
from neuralgaits.systems.trained_system import TrainedSystem
from support import pages


def listed(name: str) -> set[str]:
    """Names in the last cell of the row about a class."""
    text = (pages.ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    (row,) = re.findall(rf"^\|[^|]*`{name}`[^|]*\|[^|]*\|([^|]*)\|$", text, re.MULTILINE)
    return set(re.findall(r"`([a-z_]+)`", row))


def test_fields_of_a_family_are_listed():
    assert listed("SystemFamily") == {one.name for one in fields(SystemFamily)}


@pytest.mark.parametrize("kind", [TrainedSystem, ProvedSystem, ExportedSystem])
def test_members_of_a_system_are_listed(kind):
    (above,) = kind.__bases__
    new = kind.__abstractmethods__ - getattr(above, "__abstractmethods__", frozenset())
    with_default = {name for name in kind.__annotations__ if hasattr(kind, name)}
    assert listed(kind.__name__) == new | (set(kind.__annotations__) - with_default)
