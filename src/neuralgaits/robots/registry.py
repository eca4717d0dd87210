"""The robots that come with the package: a name, one line about it, and its file."""

from importlib import resources
from importlib.resources.abc import Traversable

_DESCRIPTIONS = {
    "amber3m": "AMBER-3M, identified model: rotor inertia and measured torso centre of mass",
    "amber3m-feet": "amber3m on flat feet of 10 cm, with motors at the ankles",
    "amber3m-paper": "AMBER-3M, nominal model of the paper: no rotor inertia, higher torso mass",
    "amber3m-tail": "amber3m with the torso's centre of mass 3 cm further back, to learn from",
    "rabbit": "RABBIT, the five-link biped of Chevallereau et al. (2003)",
}


def built_in() -> tuple[str, ...]:
    """Return the names that `load_robot` knows without a file."""
    return tuple(_DESCRIPTIONS)


def describe(name: str) -> str:
    """Return one line about a built-in robot.

    Raises: KeyError if there is no such robot.
    """
    return _DESCRIPTIONS[name]


def model_file(name: str) -> Traversable:
    """Return the MJCF file of a built-in robot."""
    return resources.files("neuralgaits.robots").joinpath("models", f"{name}.xml")
