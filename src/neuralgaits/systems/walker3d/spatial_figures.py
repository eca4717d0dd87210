"""Figures of a gait in three dimensions: a step from two sides, and the tube of steps."""

import jax
import jax.numpy as jnp
import numpy as np
from matplotlib.figure import Figure

from neuralgaits._types import Float
from neuralgaits.report.drawing import style
from neuralgaits.systems.walker3d.spatial_gait import SpatialGait
from neuralgaits.systems.walker3d.spatial_pose import SpatialPose, pose_of_outputs
from neuralgaits.systems.walker3d.spatial_walker import SpatialWalker

SHOWN = 5
"""Phases at which the robot is drawn."""
VIEWS = ((0, "from the right", "forward [m]"), (1, "from behind, poses beside each other", "[m]"))


@style.styled
def draw_step(robot: SpatialWalker, gait: SpatialGait) -> Figure:
    """Draw poses of a step along the tube's middle from the side and from behind."""
    figure = Figure(figsize=(8.0, 3.6), layout="constrained")
    poses = [_pose(robot, gait, t) for t in np.linspace(0.0, 1.0, SHOWN)]
    for axes, (across, words, label) in zip(figure.subplots(1, 2, sharey=True), VIEWS, strict=True):
        for count, pose in enumerate(poses):
            # The hips' middle moves by a step; from behind poses stand beside each other.
            aside = 0.0 if across == 0 else 0.45 * count
            faint = 0.35 + 0.65 * count / (SHOWN - 1)
            for line, color in _lines(robot, pose):
                axes.plot(
                    aside - line[:, 1] if across else line[:, 0],
                    line[:, 2],
                    color=color,
                    alpha=faint,
                    lw=1.6,
                    marker="o",
                    markersize=2.5,
                )
        axes.axhline(0.0, color=style.GREY, lw=0.8)
        axes.set(title=words, xlabel=label, aspect="equal")
    figure.axes[0].set(ylabel="up [m]")
    return figure


@style.styled
def draw_spatial_tube(gait: SpatialGait) -> Figure:
    """Draw the tube's extent over a step, and its sections at start, middle and end."""
    figure = Figure(figsize=(8.0, 5.0), layout="constrained")
    rows = figure.subplots(2, 3)
    t = np.linspace(0.0, 1.0, 101)
    centre, axes = gait.tube.sections(t)
    half = np.linalg.norm(axes, axis=2)
    words = ("y [mm]", "L_y [kg m^2/s]", "n [kg m^2/s]")
    for k, (place, label) in enumerate(zip(rows[0], words, strict=True)):
        size = 1e3 if k == 0 else 1.0
        place.fill_between(
            t, size * (centre - half)[:, k], size * (centre + half)[:, k], color=style.ALLOWED
        )
        place.plot(t, size * centre[:, k], color=style.BLUE)
        place.set(xlabel="phase", ylabel=label)
    turn = np.linspace(0.0, 2.0 * np.pi, 181)
    pairs = ((0, 2), (0, 1), (1, 2))
    for place, (one, other) in zip(rows[1], pairs, strict=True):
        for number, color in ((0, style.BLUE), (50, style.ORANGE), (100, style.RED)):
            line = _outline(axes[number][[one, other]], turn)
            line[:, 0] *= 1e3 if one == 0 else 1.0
            place.plot(*line.T, color=color, label=f"phase {t[number]:.1f}")
        place.set(xlabel=f"deviation of {words[one]}", ylabel=f"deviation of {words[other]}")
    figure.legend(*rows[1][0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def _pose(robot: SpatialWalker, gait: SpatialGait, t: float) -> SpatialPose:
    """Return the pose at a phase, in the tube's middle."""
    z = gait.state_at(jnp.array([t, 0.5, 0.5, 0.5]))
    return jax.tree.map(np.asarray, pose_of_outputs(robot, z[:2], gait.policy(z)))


def _lines(robot: SpatialWalker, pose: SpatialPose) -> list[tuple[np.ndarray, str]]:
    """Return the robot as lines with colours: stance leg, swing leg, hips and torso."""
    legs = [np.stack([pose.feet[k], pose.knees[k], pose.hips[k]]) for k in (0, 1)]
    middle = pose.hips.mean(axis=0)
    top = middle + 2.0 * robot.torso_centre[1] * pose.torso[2]
    return [
        (legs[0], style.BLUE),
        (legs[1], style.ORANGE),
        (np.asarray(pose.hips), style.BLACK),
        (np.stack([middle, top]), style.BLACK),
    ]


def _outline(rows: Float[np.ndarray, "2 3"], turn: Float[np.ndarray, " p"]) -> np.ndarray:
    """Return the outline of the ellipsoid's shadow on a plane. [p, 2].

    Args:
        rows: of the half axes.
        turn: angles.
    """
    values, vectors = np.linalg.eigh(rows @ rows.T)
    sides = vectors * np.sqrt(np.maximum(values, 0.0))
    return np.stack([np.cos(turn), np.sin(turn)], axis=1) @ sides.T
