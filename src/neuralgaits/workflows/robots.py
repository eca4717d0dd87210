"""The robots and gait specifications that come with the package."""

from dataclasses import replace
from pathlib import Path

from neuralgaits.barriers import specs
from neuralgaits.errors import InputError
from neuralgaits.records.installed import BuiltIn, CatalogueEntry
from neuralgaits.robots import registry
from neuralgaits.robots.mjcf.loader import robot_text
from neuralgaits.runs.atomic import write_new
from neuralgaits.runs.shell_words import command
from neuralgaits.systems.family_tasks import all_families


def robots() -> BuiltIn:
    """List the built-in robots and specs by name."""
    names = {name: registry.describe(name) for name in registry.built_in()}
    for family in all_families():
        names |= family.built_in
    return BuiltIn(
        robots=tuple(CatalogueEntry(name, about) for name, about in names.items()),
        specs=tuple(CatalogueEntry(name, one.description) for name, one in specs.BUILT_IN.items()),
    )


def write_built_in(name: str, out: Path | None) -> BuiltIn:
    """Write the file of a built-in robot, as a starting point.

    Returns: a record of that robot alone, with `written`.
    Raises: RobotError if the robot does not exist; InputError if a file exists at `out`, or `out`
        is None.
    """
    if name not in registry.built_in() and Path(name).exists():
        raise InputError(f"expected the name of a built-in robot, found the file {name}: copy it")
    text, _ = robot_text(name)
    if out is None:
        line = command("robots", name, "--out", f"{name}.xml")
        raise InputError(f"expected a file to write {name} to, found none: write `{line}`")
    write_new(out, text)
    one = CatalogueEntry(name, registry.describe(name))
    return replace(robots(), robots=(one,), specs=(), written=str(out))
