"""Short trainings of other systems than point feet, which tests share."""

import importlib
from collections.abc import Callable
from pathlib import Path

from neuralgaits._families import verbs_module
from neuralgaits.robots import load_robot
from neuralgaits.systems.family_training import train_family
from neuralgaits.workflows.train import train


def feet(run: Path) -> None:
    """On flat feet: after 30 steps some conditions are broken still, after 150 all of them hold."""
    train(load_robot("amber3m-feet"), seed=0, steps=200, out=run, root=run.parent)


def small(family: str, steps: int) -> Callable[[Path], None]:
    """Of a family, with networks of two."""
    system = importlib.import_module(verbs_module(family)).SYSTEM

    def make(run: Path) -> None:
        config = system.new_config(seed=0, steps=steps, hidden=(2,))
        train_family(system, family, config, out=run, root=run.parent)

    return make
