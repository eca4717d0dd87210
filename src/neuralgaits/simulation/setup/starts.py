"""Starts of episodes: on the zero dynamics manifold of a gait, standing on leg 0."""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np

from neuralgaits._blocks import in_blocks
from neuralgaits._quick_jit import quick_filter_jit
from neuralgaits._types import Array, Float
from neuralgaits.analysis.poincare_map import poincare
from neuralgaits.analysis.run import Run
from neuralgaits.barriers import Gait
from neuralgaits.control.controlled_gait import ControlledGait
from neuralgaits.control.joint_model import JointModel
from neuralgaits.errors import InputError
from neuralgaits.gait import Orbit, ZeroDynamics
from neuralgaits.gait.commands import CommandLimits, Commands, Pair
from neuralgaits.gait.policies.commanded_gait import AnyGait, CommandedGait
from neuralgaits.simulation.setup.streams import Stream, generator

KINDS = ("centre", "region", "fixed-point")


def full_states(
    zd: ZeroDynamics, gait: Gait, kind: str, *, seed: int, episodes: int, first: int = 0
) -> Float[np.ndarray, "B two_n"]:
    """Return full states x = (q, dq) to start from (rad, rad/s).

    Args:
        zd: zero dynamics of the gait's robot under its policy, with residuals if there are any.
        gait: policy and region.
        kind: `centre` of the region; `region`: anywhere in it, by seed and episode number;
            `fixed-point` of the Poincare map, at mid-step.
        seed: seed of `region`.
        episodes: number of states.
        first: number of the first episode.

    Raises: InputError for another kind, or if there is no periodic orbit.
    """
    if kind == "centre":
        charts = np.full((episodes, 2), 0.5)
    elif kind == "region":
        numbers = range(first, first + episodes)
        charts = np.array([generator(seed, i, Stream.START).uniform(size=2) for i in numbers])
    elif kind == "fixed-point":
        orbit = periodic_orbit(zd, gait)
        if orbit.result != "found":
            raise InputError(f"start fixed-point: {orbit.result}; start from the centre instead")
        x = zd.phi_inv(jnp.asarray(orbit.fixed_point))
        return np.tile(np.asarray(x), (episodes, 1))
    else:
        raise InputError(f"unknown start {kind!r}: expected one of {', '.join(KINDS)}")
    # In equal parts, so that a state does not depend on how many others there are.
    return in_blocks(partial(_lifted, zd, gait), 16, charts)


def periodic_orbit(zd: ZeroDynamics, gait: Gait) -> Orbit:
    """Return the gait's periodic orbit, from a search that starts at the centre of its region."""
    return poincare(zd, gait.z(jnp.array([0.5, 0.5])))


def controlled_gait(run: Run, joints: JointModel | None = None) -> ControlledGait:
    """Return the gait of a run for its controllers; a family takes its commands.

    Args:
        run: the run.
        joints: rotors and friction that torques are for, those of the run's robot if None.
    """
    trained = run.trained
    return ControlledGait(run.robot, trained, momentum_range(trained), run.residuals.reset, joints)


def momentum_range(gait: AnyGait) -> tuple[float, float]:
    """Return the smallest and largest z2 of a gait's region (kg m^2/s).

    For a family it is over all of its steps.
    """
    # Phases at which the fences are read to find the momenta of a tube.
    phases = np.linspace(0.0, 1.0, 101)
    if isinstance(gait, CommandedGait):
        momenta = np.asarray(_momenta(gait, phases, _pairs(gait.commands)))
        return float(momenta.min()), float(momenta.max())
    charts = np.stack(np.meshgrid(phases, [0.0, 1.0]), axis=-1).reshape(-1, 2)
    momenta = np.asarray(_z_of(gait, charts))[:, 1]
    return float(momenta.min()), float(momenta.max())


def _pairs(commands: Commands) -> Pair:
    """Return a grid of the pairs of commands that may follow each other. [N, p] each."""
    limits = CommandLimits.of(commands)
    count = 100  # Of pairs, roughly.
    ends = np.linspace(0.0, 1.0, max(2, round(count ** (0.5 / len(commands)))))
    grid = np.stack(np.meshgrid(*[ends] * (2 * len(commands))), axis=-1)
    first, change = np.split(grid.reshape(-1, 2 * len(commands)), 2, axis=1)
    before = limits.low + first * (limits.high - limits.low)
    after = before + (2.0 * change - 1.0) * limits.change
    return Pair(before, np.clip(after, limits.low, limits.high))


# Gaits are arguments, so that all of one structure share a compilation, today's and yesterday's.
@quick_filter_jit
def _lifted(zd: ZeroDynamics, gait: Gait, charts: Array) -> Array:
    return jax.vmap(lambda u: zd.phi_inv(gait.z(u)))(charts)


@quick_filter_jit
def _momenta(family: CommandedGait, phases: Array, pairs: Pair) -> Array:
    def of_step(pair: Pair) -> Array:
        tube = family.tube.at(Pair(*map(family.policy.scaled, pair)))
        return jnp.sqrt(2.0 * jax.vmap(tube.fences)(phases))

    return jax.vmap(of_step)(pairs)


@quick_filter_jit
def _z_of(gait: Gait, charts: Array) -> Array:
    return jax.vmap(gait.z)(charts)
