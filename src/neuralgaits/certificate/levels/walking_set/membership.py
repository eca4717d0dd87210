"""Margins of membership in the walking set T of level 2, for states (q, dq) of the robot.

T is a set of zero dynamics states z. The outputs of a state are not looked at: level 2 is about
those that are zero.
"""

import jax.numpy as jnp

from neuralgaits._types import Array, Float, Scalar, ZeroState
from neuralgaits.barriers import Barrier, Gait
from neuralgaits.certificate.levels.walking_set.theorem import WalkingSetConstants
from neuralgaits.gait import ZeroDynamics
from neuralgaits.gait.zero_coordinates import momentum_of, position_of

ENDS = ("phase-start", "phase-end", "direction")
"""Names of the margins of a step's ends: of its phases, and of z2 > 0."""
WALLS = ("level-lower", "level-upper")
"""Names of the margins between the fences."""


def ends(gait: Gait, phases: tuple[float, float], z: ZeroState) -> list[Scalar]:
    """Return the margins of `ENDS`: two in phases, z2 in units of the tube's."""
    phase, (first, last) = gait.phase(position_of(z)), phases
    return [phase - first, last - phase, momentum_of(z) / jnp.sqrt(2.0 * gait.tube.unit)]


def walking_membership(
    gait: Gait,
    zd: ZeroDynamics,
    constants: WalkingSetConstants,
    unproved: tuple[Barrier, ...],
    z: ZeroState,
) -> dict[str, Float[Array, "..."]]:
    """Return margins that are not negative exactly in the set that level 2 is about.

    Args:
        gait: gait of the step.
        zd: its zero dynamics.
        constants: constants of the set.
        unproved: barriers that are not proved on all of T; the set is then its part on which they
            are not negative.
        z: state (m, kg m^2/s). [2]

    Returns: `ends`, see `ENDS`; `walls`, levels from both fences in tube widths, then the unproved
        barriers in their own units.
    """
    level = gait.level(z)
    walls = [jnp.ravel(barrier.function(zd.point(z))) for barrier in unproved]
    return {
        "ends": jnp.stack(ends(gait, constants.ends, z)),
        "walls": jnp.concatenate([jnp.stack([level, 1.0 - level]), *walls]),
    }
