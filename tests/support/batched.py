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
    """The robot's numbers: names and places in the file are in no formula, and differ.

    Which joints there are is in some: of the layout torso, ankles and the number of joints stay.
    """
    blank = ("",) * robot.n
    leg = ("",) * robot.layout.joints_of_leg
    nowhere = cast(Any, None)
    joints = replace(
        robot.layout,
        xml="",
        root_joints=nowhere,
        root_origin=nowhere,
        pitch_sign=nowhere,
        root_angle=nowhere,
        root_to_hip=nowhere,
        leg_lengths=nowhere,
        leg_joints=(leg, leg),
        leg_joint_signs=nowhere,
        leg_joint_offsets=nowhere,
        feet=nowhere,
        actuators=nowhere,
        gears=nowhere,
    )
    return replace(robot, name="", link_names=blank, joint_names=blank, layout=joints)
