"""The robots and gait specifications that come with the package."""

from neuralgaits.barriers import specs
from neuralgaits.records.installed import BuiltIn, Named
from neuralgaits.robots import registry


def robots() -> BuiltIn:
    """List what exists by name."""
    return BuiltIn(
        robots=tuple(Named(name, registry.describe(name)) for name in registry.built_in()),
        specs=tuple(Named(name, about) for name, about in specs.DESCRIPTIONS.items()),
    )
