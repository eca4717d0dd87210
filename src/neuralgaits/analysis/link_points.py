"""Points of the robot's links from their absolute angles, as a line through all of them."""

import numpy as np

from neuralgaits._types import Float

TORSO_SHARE = 0.6
"""Length of a drawn torso, in leg lengths; robot files say where its mass is, not its top."""


def skeleton(
    theta: Float[np.ndarray, "K n"], foot: Float[np.ndarray, " n"], torso: int | None
) -> Float[np.ndarray, "K points 2"]:
    """Return points from the stance foot over the hip to the swing foot.

    One line goes through all of them: with a torso it runs from the hip to its top and back.

    Args:
        theta: absolute link angles, 0 upright, positive backwards [rad].
        foot: length of each link, negative for the swing leg's, 0 for the torso [m].
        torso: its index among the links, None if there is none.

    Returns: positions from the stance foot, (forward, up) [m].
    """
    lengths = np.array(foot, dtype=np.float64)
    if torso is not None:
        lengths[torso] = 0.0
    along = np.stack([-np.sin(theta), np.cos(theta)], axis=-1)
    points = np.cumsum(lengths[:, None] * along, axis=-2)
    start = np.zeros((*points.shape[:-2], 1, 2))
    if torso is None:
        return np.concatenate([start, points], axis=-2)
    hip = points[..., torso - 1 : torso, :]
    size = TORSO_SHARE * float(np.sum(lengths[:torso]))
    top = hip + size * along[..., torso : torso + 1, :]
    parts = [start, points[..., :torso, :], top, hip, points[..., torso + 1 :, :]]
    return np.concatenate(parts, axis=-2)


def hip_index(points: int, torso: bool) -> int:
    """Return the index of the hip among the points."""
    return (points - 3) // 2 if torso else (points - 1) // 2
