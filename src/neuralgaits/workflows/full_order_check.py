"""The full-order theorem checked by force: walks from its set, of the model and in MuJoCo.

Sampled evidence, not part of the proof: it would show a wrong formula that proof and theorem share.
"""

import time
from collections.abc import Mapping
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Float, ZeroState
from neuralgaits.certificate.full_order import (
    FullOrderModel,
    output_coordinates,
    scaled_coordinates,
)
from neuralgaits.certificate.full_order_conclusion import tightening
from neuralgaits.certificate.full_order_theorem import FullOrder
from neuralgaits.control import Fblin
from neuralgaits.gait.full_order import FullPoint
from neuralgaits.simulation.full_order import ExactOutputs, walk_exactly
from neuralgaits.simulation.starts import momentum_range
from neuralgaits.simulation.tick import Record
from neuralgaits.simulation.walk import walk
from neuralgaits.workflows.full_order import model_of
from neuralgaits.workflows.run import Run

WALKS, STEPS = 10_000, 3
"""Walks of the model, and impacts in each."""
EPISODES, MUJOCO_STEPS = 100, 5
"""Episodes in MuJoCo, and walking steps of each."""
SETTLING_S = 0.01
"""MuJoCo's contact is compliant: an impact takes milliseconds there, not an instant [s]."""
ROUNDING = 1e-9
"""A number this little below zero is rounding, in its own unit."""


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


def check_by_force(
    run: Run, shape: FullOrder, *, walks: int = WALKS, steps: int = STEPS, seed: int = 0
) -> ForceCheck:
    """Walk the rigid model in continuous time from states of the set; none may leave it."""
    began = time.perf_counter()
    model = model_of(run, shape.bandwidth)
    system = ExactOutputs(run.robot, run.gait, shape.bandwidth)
    z, eta = states_of(model, shape, walks, seed)

    def observe(point: FullPoint) -> Float[Array, " k"]:
        found = _numbers(model, shape, point)
        return jnp.concatenate([found[name] for name in sorted(found)])

    walked = jax.jit(jax.vmap(lambda z, eta: walk_exactly(system, observe, z, eta, steps)))(z, eta)
    least = np.asarray(walked.least)
    sizes = jax.eval_shape(lambda: _numbers(model, shape, system.point(z[0], eta[0])))
    ends = np.cumsum([part.size for part in sizes.values()])[:-1]
    parts = np.split(least.min(axis=0), ends)
    return ForceCheck(
        walks=len(least),
        steps=steps,
        left=int(np.sum(~np.all(least >= -ROUNDING, axis=1))),
        least={name: float(part.min()) for name, part in zip(sizes, parts, strict=True)},
        foot=float(walked.foot.max()),
        wall_s=time.perf_counter() - began,
    )


def check_in_mujoco(
    run: Run,
    shape: FullOrder,
    *,
    episodes: int = EPISODES,
    steps: int = MUJOCO_STEPS,
    seed: int = 1,
) -> MujocoCheck:
    """Walk in MuJoCo from states of the set, under sampled input-output linearisation."""
    model = model_of(run, shape.bandwidth)
    z, eta = states_of(model, shape, episodes, seed)
    starts = jax.jit(jax.vmap(run.zero_dynamics.phi_inv))(z, eta)
    inside = jax.jit(jax.vmap(lambda z, eta: jnp.min(_of_set(model, shape, z, eta)) >= 0.0))
    always, settled = np.ones(episodes, dtype=bool), np.ones(episodes, dtype=bool)
    ticks = np.zeros(2, dtype=int)

    def watch(record: Record, active: np.ndarray) -> None:
        found = record.command
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
    model: FullOrderModel, shape: FullOrder, count: int, seed: int
) -> tuple[Float[np.ndarray, "B 2"], Float[np.ndarray, "B two_m"]]:
    """Random states of the set, many of them on its faces.

    A third has the largest outputs that the phase allows, two thirds of the rest lie on a fence's
    face. Returns: z [B, 2] and eta [B, 2m].
    """
    draw = np.random.default_rng(seed)
    keep = jax.jit(jax.vmap(lambda z, eta: _numbers_of_set(model, shape, z, eta)))
    place = jax.jit(
        jax.vmap(lambda u, xi: (model.gait.z(u), output_coordinates(xi, shape.bandwidth)))
    )
    found: list[tuple[np.ndarray, np.ndarray]] = []
    while sum(len(z) for z, _ in found) < count:
        z, eta = place(*_draw(model, shape, 2 * count, draw))
        good = np.all(np.asarray(keep(z, eta)) >= 0.0, axis=1)
        found.append((np.asarray(z)[good], np.asarray(eta)[good]))
    z, eta = (np.concatenate(part)[:count] for part in zip(*found, strict=True))
    return z, eta


def _draw(
    model: FullOrderModel, shape: FullOrder, count: int, draw: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Chart points and xi; the foot may still be below the ground."""
    first, last = shape.ends
    phase, level = draw.uniform(first, last, count), draw.uniform(size=count)
    xi = draw.normal(size=(count, model.size))
    xi /= np.linalg.norm(xi, axis=1, keepdims=True)
    rim = draw.random(count) < 1.0 / 3.0
    share = np.where(rim, 1.0 - 1e-9, draw.random(count) ** (1.0 / model.size))
    length = share * shape.radius * np.exp(-shape.shrink * phase**2)
    sigma = [barrier.sigma * length**2 * (1.0 + 1e-9) for barrier in shape.barriers[:2]]
    face = draw.integers(0, 3, count)
    level = np.where(face == 0, sigma[0] + 1e-12, np.where(face == 1, 1.0 - sigma[1], level))
    return np.stack([phase, level - 1e-12 * (face == 1)], axis=1), xi * length[:, None]


def _of_set(
    model: FullOrderModel, shape: FullOrder, z: ZeroState, eta: Float[Array, " two_m"]
) -> Float[Array, " k"]:
    """h_i - t_i - sigma_i V of every barrier, and how far sqrt(V) is below its bound [rad]."""
    xi = scaled_coordinates(eta, shape.bandwidth)
    size = xi @ xi
    tight = np.array([float(tightening(barrier).upper()) for barrier in shape.barriers])
    sigma = np.array([barrier.sigma for barrier in shape.barriers])
    phase = model.gait.phase(z[0])
    bound = shape.radius * jnp.exp(-shape.shrink * phase * phase)
    below = bound - jnp.sqrt(size + 1e-300)
    return jnp.concatenate([model.barriers(z) - tight - sigma * size, below[None]])


def _numbers_of_set(
    model: FullOrderModel, shape: FullOrder, z: ZeroState, eta: Float[Array, " two_m"]
) -> Float[Array, " k"]:
    """All that must not be negative in the set, the foot's height included."""
    point = FullPoint(model.robot, model.gait.policy, z, eta, shape.bandwidth)
    return jnp.concatenate([_of_set(model, shape, z, eta), point.foot[1:]])


def _numbers(model: FullOrderModel, shape: FullOrder, point: FullPoint) -> Mapping[str, Array]:
    """What must not be negative along a walk, by name: the set, and what the theorem says."""
    eta = jnp.concatenate([point.output, point.output_rate])
    found = model.in_step(point)
    parts = _of_set(model, shape, point.z, eta)
    numbers = {f"{b.name} - t - sigma V": parts[k, None] for k, b in enumerate(shape.barriers)}
    numbers |= {"radius - sqrt V [rad]": parts[-1:], "foot height [m]": found["foot"]}
    for k, barrier in enumerate(shape.barriers):
        if barrier.reading:
            numbers[f"{barrier.name} on the robot"] = model.readings(point)[k, None]
    return numbers | {
        "pace [1/s]": found["pace"],
        "contact [weights]": found["contact"],
        "torque slack [limits]": found["torque"],
    }
