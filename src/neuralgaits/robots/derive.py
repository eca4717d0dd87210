"""The constants of `PlanarBiped`, computed from links by role.

A link's centre of mass, seen from its lower joint, is a complex multiple of its direction
e(theta): real when it lies on the line through the joints. Complex coefficients become a
modulus and a phase, which is all the dynamics need.
"""

from dataclasses import dataclass

import numpy as np

from neuralgaits._types import Float


@dataclass(frozen=True)
class LegData:
    """One leg's numbers, in its own order: links lowest first, joints lowest first, hip last.

    Attributes:
        length: distance from lower joint (or foot centre) to upper joint [m]. [k]
        com: centre of mass from the lower joint over the link direction [m]. complex [k]
        mass: [kg]. [k]
        inertia: [kg m^2]. [k]
        armature: rotor inertia at the joints [kg m^2]. [k]
        damping: viscous friction of the joints [N m s/rad]. [k]
        torque_limit: [N m]. [k]
        lower: joint ranges in the coordinates of `PlanarBiped` [rad]. [k]
        upper: like lower. [k]
        foot_radius: radius of a point foot's sphere, or height of the ankle above a sole [m]. [1]
        friction: friction coefficient of the foot. [1]
        sole: how far a flat foot, the lowest link, reaches behind and ahead of the ankle [m]. [2];
            of a point foot [0].
    """

    length: np.ndarray
    com: np.ndarray
    mass: np.ndarray
    inertia: np.ndarray
    armature: np.ndarray
    damping: np.ndarray
    torque_limit: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    foot_radius: np.ndarray
    friction: np.ndarray
    sole: np.ndarray

    @property
    def fixed_links(self) -> int:
        """Number of links of a stance leg that do not move: a flat foot, or none."""
        return 1 if self.sole.size else 0


@dataclass(frozen=True)
class TorsoData:
    """The torso: mass [kg], inertia [kg m^2], and centre of mass seen from the hip [m]."""

    mass: float
    inertia: float
    com: complex


def link_angles(links: int) -> Float[np.ndarray, "n n"]:
    """T, absolute link angles from coordinates, theta = T q.

    Coordinates up to the stance hip add to the angle; those after it lead down the swing leg
    and subtract. Without a torso (`links` even) the one hip joint counts as the stance hip.

    Returns: [n, n] of 0 and +-1.
    """
    turn = np.tril(np.ones((links, links)))
    turn[:, links // 2 + 1 :] *= -1.0
    return turn


def relabelling(turn: Float[np.ndarray, "n n"]) -> Float[np.ndarray, "n n"]:
    """R, the coordinates after the legs swapped roles: q+ = R q.

    The first coordinate becomes the angle of the old swing leg's lowest link, the joints
    are read from the other end. A single hip joint (no torso) also changes sign.

    Returns: [n, n], R R = 1.
    """
    links = len(turn)
    relabel = np.zeros_like(turn)
    relabel[0] = turn[-1]
    for i in range(1, links):
        relabel[i, links - i] = 1.0
    if links % 2 == 0:
        relabel[links // 2] *= -1.0
    return relabel


def centre_coefficients(
    leg: LegData, torso: TorsoData | None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Coefficients of e(theta) in the links' centres of mass, the hip and the swing foot.

    Returns: complex [n, n], [n], [n] (m).
    """
    k = len(leg.length)
    n = 2 * k + (torso is not None)
    hip = np.zeros(n)
    hip[:k] = leg.length
    foot = hip.copy()
    foot[n - k :] = -leg.length[::-1]
    centre = np.zeros((n, n), dtype=complex)
    for i in range(k):
        centre[i, :i] = leg.length[:i]
        centre[i, i] = leg.com[i]
        swing = n - 1 - i
        centre[swing, :swing] = foot[:swing]
        centre[swing, swing] = leg.com[i] - leg.length[i]
    if torso is not None:
        centre[k] = hip
        centre[k, k] = torso.com
    return centre, hip, foot


def modulus_and_phase(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Split complex coefficients; those that are real keep their sign and have phase zero.

    Returns: modulus (signed where real), phase [rad]; shapes of `values`.
    """
    real = np.abs(np.imag(values)) <= 1e-12 * np.max(np.abs(values))
    modulus = np.where(real, np.real(values), np.abs(values))
    return modulus, np.where(real, 0.0, np.angle(values))


def joint_row(values: np.ndarray, *, torso: bool) -> np.ndarray:
    """Joint values of one leg in the order of the actuated coordinates. [k] -> [m]."""
    return np.concatenate([values, values[::-1] if torso else values[:-1][::-1]])


def link_row(values: np.ndarray, torso: float | None) -> np.ndarray:
    """Link values of one leg and the torso in the order of the links. [k] -> [n]."""
    middle = [] if torso is None else [torso]
    return np.concatenate([values, middle, values[::-1]])
