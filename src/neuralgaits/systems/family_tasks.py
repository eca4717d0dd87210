"""Which family a command is about, and its verb carried out there.

A verb of a family is a function of its module of verbs. The function's own arguments are the
options that the verb has for this family; all others of the command are a walker's.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import MISSING, fields
from importlib import import_module
from inspect import signature
from pathlib import Path
from typing import Any

from neuralgaits._families import FAMILIES, verbs_module
from neuralgaits.errors import InputError, RunError
from neuralgaits.runs import resolve
from neuralgaits.systems.system_family import ProgressCallbacks, SystemFamily, VerbResult

_SHARED_OPTIONS = ("run", "robot", "output", "progress", "watch", "begun", "root")
"""Settings that say what a command is about, or how it is shown."""


def family_named(name: object) -> SystemFamily | None:
    """Return the family of this name, or None."""
    if not isinstance(name, str) or name not in FAMILIES:
        return None
    family: SystemFamily = import_module(FAMILIES[name]).FAMILY
    return family


def all_families() -> list[SystemFamily]:
    """Return all families beside walkers."""
    return [family for name in FAMILIES if (family := family_named(name)) is not None]


def family_of_run(run: object) -> SystemFamily | None:
    """Return the family of a run's folder; None for a walker's, or if it cannot be opened."""
    if not isinstance(run, str | Path):
        return None
    try:
        return family_named(resolve(run, finished=False).config.get("family"))
    except (RunError, OSError, ValueError):
        return None  # Who opens it says what is wrong.


def family_of_robot(robot: object) -> SystemFamily | None:
    """Return the family that a robot, by name or path, is meant for; None for walkers."""
    if not isinstance(robot, str | Path):
        return None
    return next((family for family in all_families() if family.recognises(robot)), None)


Task = Callable[[ProgressCallbacks], VerbResult]
"""A verb of a family with all that it was given, to be carried out."""


def task_of(verb: str, settings: Any) -> Task | None:
    """Return the task of a verb whose settings are a dataclass; None if it is about a walker.

    Raises: InputError if the family has no such verb or option.
    """
    return task_with(verb, _changed_settings(settings))


def _changed_settings(settings: Any) -> dict[str, Any]:
    """Return the settings that have not their usual values; those without a default always."""
    values = {one.name: (getattr(settings, one.name), one.default) for one in fields(settings)}
    return {
        name: value
        for name, (value, usual) in values.items()
        if usual is MISSING or (value is not usual and value != usual)
    }


def task_with(verb: str, options: Mapping[str, Any]) -> Task | None:
    """Return the task of a verb with these settings, as `task_of` does."""
    run = options.get("run", options.get("resume"))
    run = getattr(run, "path", run)
    family = family_of_run(run)
    robot_verbs = ("train", "inspect", "robots")  # Verbs about a robot that has no run yet.
    if family is None and run is None and verb in robot_verbs:
        family = family_of_robot(options.get("robot"))
    if family is None:
        return None
    verbs = import_module(verbs_module(family.name)).VERBS
    if verb not in verbs:
        raise InputError(
            f"expected a walker's run for this verb, found that of {family.words}, which has "
            f"{', '.join(verbs)} and check-proof"
        )
    parameters = signature(verbs[verb]).parameters
    own = [name for name in parameters if name != "progress"]
    others = [name for name in options if name not in (*own, *_SHARED_OPTIONS)]
    if others:
        raise InputError(
            f"expected options of {family.words} ({_flags(own) or 'none'}), found "
            f"{_flags(others)}: leave it out"
        )
    own_options = {name: value for name, value in options.items() if name in own}
    if run is not None:
        own_options["run"] = run
    if own_options.get("out") is not None:
        own_options["out"] = Path(own_options["out"])

    def task(progress: ProgressCallbacks) -> VerbResult:
        more = {"progress": progress} if "progress" in parameters else {}
        result: VerbResult = verbs[verb](**own_options, **more)
        return result

    return task


def _flags(names: Sequence[str]) -> str:
    flags = (f"--{name.replace('_', '-')}" for name in names if name not in _SHARED_OPTIONS)
    return ", ".join(flags)
