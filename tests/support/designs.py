"""Designs of untrained gaits, to be compiled."""

import jax

from neuralgaits.barriers import specs
from neuralgaits.control import PAPER, Fblin, Pd
from neuralgaits.export.facts import Design, Origin
from neuralgaits.robots import load_robot
from neuralgaits.simulation.starts import momentum_range

ORIGIN = Origin("0" * 64, "1" * 64, None, None, "walking", "test")
LAWS = {"pd": Pd(), "fblin": Fblin(), "paper": PAPER}


def design_for(name: str, laws: dict) -> Design:
    """The design of an untrained gait."""
    robot = load_robot(name)
    gait = specs.walking(robot).new_gait(jax.random.key(3), "posture", None)
    return Design.of(robot, gait, laws, momentum_range(gait), ORIGIN)
