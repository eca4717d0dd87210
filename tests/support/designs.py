"""Designs of untrained gaits, to be compiled."""

import jax
import numpy as np

from neuralgaits.barriers import specs
from neuralgaits.control import PAPER, Fblin, Pd, ScheduledPd
from neuralgaits.control.controlled_gait import ControlledGait
from neuralgaits.export.design import Design, Origin
from neuralgaits.gait.commands import Command
from neuralgaits.gait.policies.commanded_gait import CommandedGait
from neuralgaits.robots import load_robot
from neuralgaits.simulation.setup.starts import momentum_range

ORIGIN = Origin("0" * 64, "1" * 64, None, None, "walking", "test")
LAWS = {"pd": Pd(), "fblin": Fblin(), "paper": PAPER, "scheduled-pd": ScheduledPd()}
SPEED = Command("speed", 0.55, 0.90, 0.07)
FOOTHOLDS = (Command("step_length", 0.32, 0.37), Command("step_height", -0.01, 0.01))


def design_for(name: str, laws: dict) -> Design:
    """The design of an untrained gait."""
    robot = load_robot(name)
    gait = specs.walking(robot).new_gait(jax.random.key(3), "posture", None)
    return Design.of(ControlledGait(robot, gait, momentum_range(gait)), laws, ORIGIN)


def family_for(name: str, commands: tuple[Command, ...] = (SPEED,)) -> CommandedGait:
    """A family of untrained gaits."""
    gait = specs.commanded(load_robot(name), commands).new_gait(jax.random.key(3), "posture", None)
    return jax.tree.map(np.asarray, gait)


def commanded_design(name: str, laws: dict, commands: tuple[Command, ...] = (SPEED,)) -> Design:
    """The design of a family of untrained gaits."""
    gait = family_for(name, commands)
    return Design.of(ControlledGait(load_robot(name), gait, momentum_range(gait)), laws, ORIGIN)
