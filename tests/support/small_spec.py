"""Specs that compile and train in a second or two: few conditions, a tiny free network."""

from dataclasses import replace
from functools import partial

import jax.numpy as jnp

from neuralgaits.barriers import Barrier, Box, Equality, Gait, GaitSpec, Pointwise, Recipe, Tube
from neuralgaits.barriers import functions as f
from neuralgaits.gait import MLPPolicy

REGIONS = {
    "tube": (Box((0.0, 0.0), (1.0, 1.0)),),
    "ends": (Box((0.0, 0.0), (0.1, 1.0)), Box((0.9, 0.0), (1.0, 1.0))),
    "guard": (Box((1.0, 0.0), (1.0, 1.0)),),
}
SAMPLES = {"tube": 12, "ends": 8, "guard": 4}


def new_gait(robot, activation, key, init, hidden):
    del init
    policy = MLPPolicy.init(robot, key=key, hidden=hidden or (4,), activation=activation)
    tube = Tube.between_energies(robot, (0.2, 0.6), height=0.9, span=(-0.17, 0.17), trained=True)
    return Gait(policy, tube)


def hips(p):
    """Distance of both hips from a posture [rad]. [2]."""
    return p.q[2:4] + jnp.array([0.2, 0.3], dtype=p.q.dtype)


def small(robot, activation="tanh", *more):
    """Torso, hip height, joint rates at the ends, the foot at the guard."""
    conditions = (
        Barrier("torso", "tube", 2.0, f.at_least(f.torso_angle, -0.2), 10.0),
        Pointwise("hip", "tube", 0.1, f.at_least(f.hip_height, 0.8)),
        Pointwise("rates", "ends", 4.0, f.at_most(f.joint_rates, 4.0)),
        Equality("foot", "guard", 0.1, f.foot_height, 1e-3),
        Equality("hips", "guard", 1.0, hips, 1e-3, "absolute"),
        *more,
    )
    recipe = Recipe(
        steps=300,
        samples=SAMPLES,
        learning_rate=1e-2,
        weight_decay=1e-4,
        overshoot=(0.02, 0.03),
        aim=0.05,
        worst_weight=0.1,
        logarithmic=True,
    )
    start = partial(new_gait, robot, activation)
    return GaitSpec("small", conditions, REGIONS, start, recipe, {"foot": 2.0})


def relu(robot):
    """The paper's activation: trains, but cannot be proved."""
    return small(robot, "relu")


def kinked(robot):
    """A condition that no interpreter of a Program can read."""

    def kink(p):
        return jnp.where(p.foot[1] > 0.0, p.foot[1], 0.0)

    return small(robot, "tanh", Pointwise("kink", "tube", 1.0, kink))


def explosive(robot):
    """Training is pushed until a square root turns to NaN."""
    spec = small(
        robot,
        "tanh",
        Pointwise("push", "tube", 1.0, lambda p: p.outputs.y[0] - 1.4),
        Pointwise("root", "tube", 1.0, lambda p: 1.0 + jnp.sqrt(1.1 - p.outputs.y[0])),
    )
    return replace(spec, weights={"push": 100.0})


def hopeless(robot):
    """The same with steps so large that smaller ones are too large as well."""
    spec = explosive(robot)
    rate = 60.0 * spec.recipe.learning_rate
    return replace(spec, recipe=replace(spec.recipe, learning_rate=rate))
