"""Walks of the rigid model under torques that are set at ticks and held between them.

The robot is integrated in its own coordinates, with the forward dynamics, so that neither outputs
nor zero dynamics have a formula of their own here. Each touchdown is a tick. Sampled evidence: it
would show a wrong formula that proof and theorem of level 5 share.
"""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._quick_jit import quick_jit
from neuralgaits._types import Array, Float, Scalar
from neuralgaits.analysis.run import Run
from neuralgaits.certificate.levels.full_order.model import FullOrderModel, weighted
from neuralgaits.certificate.levels.full_order.theorem import FullOrderConstants
from neuralgaits.gait.full_order import FullPoint
from neuralgaits.robots import dynamics
from support.full_order_check import Edges, distances_inside, model_of, states_of

STEPS_OF_TICK, SECANTS = 2, 8
"""Of the classical fourth-order method, and to a touchdown."""
State = Float[Array, " two_n"]
States = Float[Array, "walks two_n"]
Torque = Float[Array, " m"]


class HeldWalks(NamedTuple):
    """What walks came to.

    Attributes:
        left: share that was outside the set at some tick.
        error: the largest |S e| at the end of a hold [rad/s^2].
        slack: the least of contact and torque slacks at the end of a hold.
        touchdowns: the fewest of a walk.
    """

    left: float
    error: float
    slack: float
    touchdowns: int


Ticked = Callable[[States, float], tuple[States, "_Seen"]]
"""One hold of walks, of so many seconds."""


def ticker(run: Run, shape: FullOrderConstants, *, free_clock: bool = False) -> Ticked:
    """One hold of walks from a set, compiled for holds of any length.

    It ends at a touchdown; with a free clock motors keep their torque through that.
    """
    model, edges = model_of(run, shape.bandwidth, shape.weights), Edges.of(shape)
    return quick_jit(lambda x, hold: _ticked(run, model, edges, x, jnp.asarray(hold), free_clock))


def walk_held(
    run: Run,
    shape: FullOrderConstants,
    hold: float,
    ticked: Ticked,
    *,
    walks: int,
    ticks: int,
    seed: int = 0,
) -> HeldWalks:
    """Walk from states of the set.

    Args:
        run: of the theorem.
        shape: of the set.
        hold: length of a tick without a touchdown [s].
        ticked: `ticker` of this run and set.
        walks: how many.
        ticks: of each walk.
        seed: of the starts.
    """
    z, eta = states_of(model_of(run, shape.bandwidth, shape.weights), shape, walks, seed)
    x = quick_jit(jax.vmap(run.zero_dynamics.phi_inv))(z, eta)
    inside = np.ones(walks, dtype=bool)
    error, slack, touchdowns = 0.0, np.inf, np.zeros(walks, dtype=int)
    for _ in range(ticks):
        x, seen = ticked(x, hold)
        inside &= np.asarray(seen.inside) >= -1e-9
        error, slack = max(error, float(seen.error.max())), min(slack, float(seen.slack.min()))
        touchdowns += np.asarray(seen.landed)
    return HeldWalks(1.0 - float(inside.mean()), error, slack, int(touchdowns.min()))


class _Seen(NamedTuple):
    inside: Scalar
    error: Scalar
    slack: Scalar
    landed: Scalar


def _ticked(
    run: Run, model: FullOrderModel, edges: Edges, x: States, hold: Scalar, free_clock: bool
) -> tuple[States, _Seen]:
    """One hold of each walk, or as much of it as there is before a touchdown, and what is then."""
    zd, n = run.zero_dynamics, run.robot.n
    torque = jax.vmap(lambda x: _point(run, model, x).torque)(x)
    whole = jax.vmap(lambda x, torque: _moved(run, x, torque, hold))(x, torque)
    phase = jax.vmap(lambda x: run.gait.phase(zd.phi(x)[1][0]))(whole)
    foot = jax.vmap(lambda x: dynamics.swing_foot(run.robot, x[:n])[1])(whole)
    landed = (foot < 0.0) & (phase > 0.5)
    # Where a step ends takes far longer than a hold: it is looked for where some walk lands.
    touched, time = jax.lax.cond(
        landed.any(),
        lambda: jax.vmap(lambda x, torque: _touchdown(run, x, torque, hold))(x, torque),
        lambda: (whole, jnp.zeros(len(x))),
    )
    if free_clock:
        relabel = jnp.asarray(run.robot.relabel)[1:, 1:]
        renamed = jnp.where(landed[:, None], torque @ relabel.T, torque)
        after = jax.vmap(lambda x: jnp.concatenate(run.robot.impact(x[:n], x[n:])[:2]))(touched)
        rest = jax.vmap(lambda x, torque, time: _moved(run, x, torque, hold - time))
        end = jnp.where(landed[:, None], rest(after, renamed, time), whole)
        return jax.vmap(
            lambda end, torque, landed: _seen(
                run, model, edges, end, torque, landed, at_impact=False
            )
        )(end, renamed, landed)
    end = jnp.where(landed[:, None], touched, whole)
    return jax.vmap(partial(_seen, run, model, edges))(end, torque, landed)


def _moved(run: Run, x: State, torque: Torque, time: Scalar) -> State:
    """The state after a time under held torques."""
    robot, n = run.robot, run.robot.n

    def rate(x):
        return jnp.concatenate([x[n:], dynamics.acceleration(robot, x[:n], x[n:], torque)])

    def step(x, _):
        h = time / STEPS_OF_TICK
        a = rate(x)
        b = rate(x + 0.5 * h * a)
        c = rate(x + 0.5 * h * b)
        d = rate(x + h * c)
        return x + h / 6.0 * (a + 2.0 * b + 2.0 * c + d), None

    return jax.lax.scan(step, x, None, length=STEPS_OF_TICK)[0]


def _touchdown(run: Run, x: State, torque: Torque, hold: Scalar) -> tuple[State, Scalar]:
    """The state in which the swing foot is on the ground, for a walk that lands within a hold.

    And when.
    """

    def foot(time):
        return dynamics.swing_foot(run.robot, _moved(run, x, torque, time)[: run.robot.n])[1]

    def secant(carry, _):
        early, late = carry
        first, second = foot(early), foot(late)
        apart = jnp.where(second == first, 1.0, second - first)
        return (late, late - second * jnp.where(second == first, 0.0, (late - early) / apart)), None

    (_, time), _ = jax.lax.scan(secant, (0.0 * hold, hold), None, length=SECANTS)
    return _moved(run, x, torque, time), time


def _seen(
    run: Run,
    model: FullOrderModel,
    edges: Edges,
    end: State,
    torque: Torque,
    landed: Scalar,
    at_impact: bool = True,
) -> tuple[State, _Seen]:
    """The state that a walk goes on from, and what is at the end of a hold."""
    robot, n = run.robot, run.robot.n
    point = _point(run, model, end, torque)
    lack = point.output_acceleration + model.bandwidth**2 * point.output
    error = jnp.linalg.norm(
        weighted(model.weights, lack + 2.0 * model.bandwidth * point.output_rate)
    )
    forces = model.in_step(point)
    slack = jnp.minimum(forces["contact"].min(), forces["torque"].min())
    eta = jnp.concatenate([point.output, point.output_rate])
    inside = jnp.min(distances_inside(model, edges, point.z, eta))
    found = _Seen(inside, error, slack, landed)
    if not at_impact:
        return end, found
    q, dq, _ = robot.impact(end[:n], end[n:])
    return jnp.where(landed, jnp.concatenate([q, dq]), end), found


def _point(run: Run, model: FullOrderModel, x: State, torque=None) -> FullPoint:
    """A state under these torques; under those of exact linearisation if there are none."""
    robot, n = run.robot, run.robot.n
    eta, z = run.zero_dynamics.phi(x)
    if torque is None:
        return FullPoint(robot, run.gait.policy, z, eta, model.bandwidth)
    rate = jnp.concatenate([x[n:], dynamics.acceleration(robot, x[:n], x[n:], torque)])
    moved = jax.jvp(lambda x: run.zero_dynamics.phi(x)[0], (x,), (rate,))[1]
    return FullPoint(robot, run.gait.policy, z, eta, model.bandwidth, moved[n - 1 :])
