"""Families of systems beside walkers: a folder of `systems/` each, with an entry here.

The folder is a module with `FAMILY`, an object of `systems.system_family.SystemFamily`'s kind.
Beside it are two modules that begin with the family's name: NAME_verbs carries out what users ask
for, NAME_retrace traces a run again in a process of its own. Nothing here needs JAX.
"""

from collections.abc import Mapping
from typing import Any

FAMILIES = {
    "cartpole": "neuralgaits.systems.cartpole",
    "hopper": "neuralgaits.systems.hopper",
    "walker3d": "neuralgaits.systems.walker3d",
}
"""Module of each family, by the name that configs of runs and models of proof files have for it."""


def verbs_module(name: str) -> str:
    """Return the module with a family's verbs."""
    return f"{FAMILIES[name]}.{name}_verbs"


def retrace_module(config: Mapping[str, Any]) -> str | None:
    """Return the module that traces a run of this config again; None for a walker's."""
    name = config.get("family")
    return f"{FAMILIES[name]}.{name}_retrace" if name in FAMILIES else None
