"""The robots and gait specifications that come with the package."""

from typing import Any

from neuralgaits.barriers import specs
from neuralgaits.robots import registry


def robots() -> dict[str, Any]:
    """List what exists by name.

    Returns: dict with `robots` and `specs`, each a list of {name, about}.
    """
    return {
        "robots": [
            {"name": name, "about": registry.describe(name)} for name in registry.built_in()
        ],
        "specs": [{"name": name, "about": about} for name, about in specs.DESCRIPTIONS.items()],
    }
