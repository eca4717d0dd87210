"""Families of systems: which one a run is of. A walker's config does not say so."""

from collections.abc import Mapping
from typing import Any

WALKER, CARTPOLE = "walker", "cartpole"


def family_of(config: Mapping[str, Any]) -> str:
    """Return the family that a run's config names."""
    return str(config.get("family", WALKER))
