"""The full-order theorem checked by force: walks from its set, of the model and in MuJoCo.

Sampled evidence, not part of the proof: it would show a wrong formula that proof and theorem share.
"""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._quick_jit import quick_jit
from neuralgaits._types import Array, Float, ZeroState
from neuralgaits.analysis.run import Run
from neuralgaits.certificate.levels.full_order.inequalities import tightening
from neuralgaits.certificate.levels.full_order.model import (
    FullOrderModel,
    output_coordinates,
    scaled_coordinates,
)
from neuralgaits.certificate.levels.full_order.theorem import FENCES, FullOrderConstants
from neuralgaits.control import Fblin
from neuralgaits.errors import InputError
from neuralgaits.gait.full_order import FullPoint
from neuralgaits.simulation.setup.starts import momentum_range
from neuralgaits.simulation.ticks.tick import TickRecord
from neuralgaits.simulation.walk import walk
from support.full_order_walk import ExactOutputs, ExactWalk, walk_exactly

WALKS, STEPS = 10_000, 3
"""Walks of the model, and impacts in each."""
EPISODES, MUJOCO_STEPS = 100, 5
"""Episodes in MuJoCo, and walking steps of each."""
SETTLING_S = 0.01
"""MuJoCo's contact is compliant: an impact takes milliseconds there, not an instant [s]."""
ROUNDS = 50
"""Batches that are drawn at most until there are as many states as asked for."""
ROUNDING = 1e-9
"""A number this little below zero is rounding, in its own unit."""


class Edges(NamedTuple):
    """The set's numbers as arrays: what is compiled for one set serves others."""

    radius: np.ndarray
    floor: np.ndarray
    shrink: np.ndarray
    tightening: np.ndarray
    """Of each barrier."""
    sigma: np.ndarray
    """Of each barrier."""

    @classmethod
    def of(cls, shape: FullOrderConstants) -> "Edges":
        """Of a set."""
        tight = [float(tightening(barrier).upper()) for barrier in shape.barriers]
        sigma = [barrier.sigma for barrier in shape.barriers]
        numbers = (shape.radius, shape.least_radius, shape.shrink, tight, sigma)
        return cls(*(np.asarray(part, dtype=np.float64) for part in numbers))


def model_of(run: Run, bandwidth: float, weights: tuple[float, ...] = ()) -> FullOrderModel:
    """Robot, gait and spec of a run at full order; weights of the norm."""
    return FullOrderModel(run.robot, run.gait, run.spec, bandwidth, weights)


Walker = Callable[[Edges, Float[np.ndarray, "B 2"], Float[np.ndarray, "B two_m"]], ExactWalk]
"""Walks of a batch of states z and eta."""


@dataclass(frozen=True)
class ForceCheck:
    """What walks from the set came to.

    Attributes:
        walks, steps: how many, and impacts in each.
        left: walks during which a number of the set, or of the theorem, fell below zero.
        least: smallest value of each number seen in any walk, by name.
        foot: largest |foot height| at which an impact was found [m].
        wall_s: seconds taken, compilation included.
    """

    walks: int
    steps: int
    left: int
    least: Mapping[str, float]
    foot: float
    wall_s: float


@dataclass(frozen=True)
class MujocoCheck:
    """What MuJoCo made of starts in the set, with sampled control and compliant contact.

    Attributes:
        episodes, steps: how many, and walking steps of each.
        walked: share of episodes that made all steps.
        stayed: share in the set, the foot's height left aside, at every control tick.
        stayed_settled: the same without the first `SETTLING_S` after each touchdown.
        ticks: share of all control ticks in the set.
    """

    episodes: int
    steps: int
    walked: float
    stayed: float
    stayed_settled: float
    ticks: float


def walker(
    run: Run, bandwidth: float, steps: int = STEPS, weights: tuple[float, ...] = ()
) -> Walker:
    """Walks of a run's rigid model, compiled for any set in this norm."""
    model = model_of(run, bandwidth, weights)
    system = ExactOutputs(run.robot, run.gait, bandwidth)

    def one(edges: Edges, z: ZeroState, eta: Float[Array, " two_m"]) -> ExactWalk:
        def observe(point: FullPoint) -> Float[Array, " k"]:
            found = _numbers(model, edges, point)
            return jnp.concatenate([found[name] for name in sorted(found)])

        return walk_exactly(system, observe, z, eta, steps)

    return quick_jit(jax.vmap(one, in_axes=(None, 0, 0)))


def check_by_force(
    run: Run,
    shape: FullOrderConstants,
    *,
    walks: int = WALKS,
    steps: int = STEPS,
    seed: int = 0,
    walking: Walker | None = None,
) -> ForceCheck:
    """Walk the rigid model in continuous time from states of the set; none may leave it.

    Args:
        run: of the theorem.
        shape: of the set.
        walks: how many.
        steps: impacts in each.
        seed: of the starts.
        walking: `walker` of this run, bandwidth and number of steps, made here if it is not given.
    """
    start_time = time.perf_counter()
    model, edges = model_of(run, shape.bandwidth, shape.weights), Edges.of(shape)
    z, eta = states_of(model, shape, walks, seed)
    walking = walking or walker(run, shape.bandwidth, steps, shape.weights)
    walked = walking(edges, z, eta)
    least = np.asarray(walked.least)
    system = ExactOutputs(run.robot, run.gait, shape.bandwidth)
    sizes = jax.eval_shape(lambda: _numbers(model, edges, system.point(z[0], eta[0])))
    ends = np.cumsum([part.size for part in sizes.values()])[:-1]
    parts = np.split(least.min(axis=0), ends)
    return ForceCheck(
        walks=len(least),
        steps=steps,
        left=int(np.sum(~np.all(least >= -ROUNDING, axis=1))),
        least={name: float(part.min()) for name, part in zip(sizes, parts, strict=True)},
        foot=float(walked.foot.max()),
        wall_s=time.perf_counter() - start_time,
    )


def check_in_mujoco(
    run: Run,
    shape: FullOrderConstants,
    *,
    episodes: int = EPISODES,
    steps: int = MUJOCO_STEPS,
    seed: int = 1,
) -> MujocoCheck:
    """Walk in MuJoCo from states of the set, under sampled input-output linearisation."""
    model = model_of(run, shape.bandwidth, shape.weights)
    z, eta = states_of(model, shape, episodes, seed)
    starts = quick_jit(jax.vmap(run.zero_dynamics.phi_inv))(z, eta)
    edges = Edges.of(shape)
    inside = quick_jit(
        jax.vmap(lambda z, eta: jnp.min(distances_inside(model, edges, z, eta)) >= 0.0)
    )
    always, settled = np.ones(episodes, dtype=bool), np.ones(episodes, dtype=bool)
    ticks = np.zeros(2, dtype=int)

    def watch(record: TickRecord, active: np.ndarray) -> None:
        found = record.result
        errors = [found.q[:, 1:] - found.y_d, found.dq[:, 1:] - found.dy_d]
        here = np.asarray(inside(found.z, np.concatenate(errors, axis=1)))[active]
        always[active] &= here
        settled[active] &= here | (found.since_touchdown[active] < SETTLING_S)
        ticks[:] += here.sum(), here.size

    walked = walk(
        run.robot,
        run.gait.policy,
        np.asarray(starts),
        controller=Fblin(bandwidth=shape.bandwidth),
        steps=steps,
        z2_range=momentum_range(run.gait),
        watch=watch,
    )
    made = np.asarray(walked.episodes.gauge.steps) >= steps
    return MujocoCheck(
        episodes=episodes,
        steps=steps,
        walked=float(made.mean()),
        stayed=float((always & made).mean()),
        stayed_settled=float((settled & made).mean()),
        ticks=float(ticks[0] / ticks[1]),
    )


def states_of(
    model: FullOrderModel, shape: FullOrderConstants, count: int, seed: int
) -> tuple[Float[np.ndarray, "B 2"], Float[np.ndarray, "B two_m"]]:
    """Random states of the set, many of them on its faces.

    A third has the largest outputs that the phase allows, two thirds of the rest lie on a fence's
    face. Returns: z [B, 2] and eta [B, 2m]. Raises: InputError if the set is all but empty.
    """
    draw = np.random.default_rng(seed)
    edges = Edges.of(shape)
    keep = quick_jit(jax.vmap(lambda z, eta: _distances_inside(model, edges, z, eta)))
    place = quick_jit(
        jax.vmap(
            lambda u, xi: (model.gait.z(u), output_coordinates(xi, shape.bandwidth, shape.weights))
        )
    )
    found: list[tuple[np.ndarray, np.ndarray]] = []
    for _ in range(ROUNDS):
        z, eta = place(*_draw(model, shape, 2 * count, draw))
        good = np.all(np.asarray(keep(z, eta)) >= 0.0, axis=1)
        found.append((np.asarray(z)[good], np.asarray(eta)[good]))
        if sum(len(z) for z, _ in found) >= count:
            break
    else:
        raise InputError("expected a set with states, found next to none in it: see its constants")
    z, eta = (np.concatenate(part)[:count] for part in zip(*found, strict=True))
    return z, eta


def _draw(
    model: FullOrderModel, shape: FullOrderConstants, count: int, draw: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Chart points and xi; the foot may still be below the ground."""
    first, last = shape.ends
    phase, level = draw.uniform(first, last, count), draw.uniform(size=count)
    xi = draw.normal(size=(count, model.size))
    xi /= np.linalg.norm(xi, axis=1, keepdims=True)
    rim = draw.random(count) < 1.0 / 3.0
    share = np.where(rim, 1.0 - 1e-9, draw.random(count) ** (1.0 / model.size))
    falls = (shape.radius - shape.least_radius) * np.exp(-shape.shrink * phase**2)
    length = share * (shape.least_radius + falls)
    sigma = [barrier.sigma * length**2 * (1.0 + 1e-9) for barrier in shape.barriers[:2]]
    face = draw.integers(0, 3, count)
    level = np.where(face == 0, sigma[0] + 1e-12, np.where(face == 1, 1.0 - sigma[1], level))
    return np.stack([phase, level - 1e-12 * (face == 1)], axis=1), xi * length[:, None]


def distances_inside(
    model: FullOrderModel, edges: Edges, z: ZeroState, eta: Float[Array, " two_m"]
) -> Float[Array, " k"]:
    """h_i - t_i - sigma_i V of every barrier, and how far sqrt(V) is below its bound [rad]."""
    xi = scaled_coordinates(eta, model.bandwidth, model.weights)
    size = xi @ xi
    phase = model.gait.phase(z[0])
    falls = (edges.radius - edges.floor) * jnp.exp(-edges.shrink * phase * phase)
    bound = edges.floor + falls
    below = bound - jnp.sqrt(size + 1e-300)
    faces = model.barriers(z) - edges.tightening - edges.sigma * size
    return jnp.concatenate([faces, below[None]])


def _distances_inside(
    model: FullOrderModel, edges: Edges, z: ZeroState, eta: Float[Array, " two_m"]
) -> Float[Array, " k"]:
    """All that must not be negative in the set, the foot's height included."""
    point = FullPoint(model.robot, model.gait.policy, z, eta, model.bandwidth)
    return jnp.concatenate([distances_inside(model, edges, z, eta), point.foot[1:]])


def _numbers(model: FullOrderModel, edges: Edges, point: FullPoint) -> Mapping[str, Array]:
    """What must not be negative along a walk, by name: the set, and what the theorem says."""
    eta = jnp.concatenate([point.output, point.output_rate])
    found, readings = model.in_step(point), model.readings(point)
    parts = distances_inside(model, edges, point.z, eta)
    numbers = {f"{name} - t - sigma V": parts[k, None] for k, name in enumerate(model.names)}
    numbers |= {"radius - sqrt V [rad]": parts[-1:], "foot height [m]": found["foot"]}
    for k, name in enumerate(model.names):
        if name not in FENCES:
            numbers[f"{name} on the robot"] = readings[k, None]
    return numbers | {
        "pace [1/s]": found["pace"],
        "contact [weights]": found["contact"],
        "torque slack [limits]": found["torque"],
    }
