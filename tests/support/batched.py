"""Functions of a robot and a state over many states, compiled once for all robots of a size."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any, cast

import jax
import numpy as np

from neuralgaits._quick_jit import QUICK
from neuralgaits.robots import PlanarBiped

LEAST = QUICK | {"xla_backend_optimization_level": 0}
"""Compiling takes longer than the runs."""


def batched(function: Callable[..., Any]) -> Callable[..., Any]:
    """`function(robot, *one state)` as a function of states with one batch axis, in NumPy."""

    def many(robot: PlanarBiped, *states: Any) -> Any:
        return jax.vmap(partial(function, robot))(*states)

    run = jax.jit(many, compiler_options=LEAST)
    return lambda robot, *states: jax.tree.map(np.asarray, run(unnamed(robot), *states))


def unnamed(robot: PlanarBiped) -> PlanarBiped:
    """The robot's numbers: names and the file's layout are in no formula, and differ."""
    blank = ("",) * robot.n
    nowhere = cast(Any, None)
    return replace(robot, name="", link_names=blank, joint_names=blank, layout=nowhere)
