"""Figures of a gait in three dimensions: a step from two sides, footprints, and the tube of steps.

They are narrow, so that a phone shows their words.
"""

from collections.abc import Sequence

import jax
import jax.numpy as jnp
import numpy as np
from matplotlib.figure import Figure

from neuralgaits._types import Float
from neuralgaits.report.drawing import style
from neuralgaits.systems.walker3d.spatial_gait import SpatialGait
from neuralgaits.systems.walker3d.spatial_pose import SpatialPose, pose_of_outputs
from neuralgaits.systems.walker3d.spatial_trace import WalkTrace
from neuralgaits.systems.walker3d.spatial_walker import SpatialWalker

WIDTH = 6.2
"""Width of the figures [in]."""
SLICES = (("$y$ [mm]", 1e3), ("$L_y$ [kg m²/s]", 1.0), ("$n$ [kg m²/s]", 1.0))
"""Words and factor of each deviation."""


@style.styled
def draw_step(robot: SpatialWalker, gait: SpatialGait) -> Figure:
    """Draw poses of a step along the tube's middle from the right and from behind."""
    apart = 0.45  # Distance of poses that are drawn beside each other [m].
    shown = 5  # Phases at which the robot is drawn.
    figure = Figure(figsize=(WIDTH, 3.0), layout="constrained")
    seen, ticks = 0.43, apart * np.arange(shown)
    across = float(ticks[-1]) + 0.5
    side, back = figure.subplots(1, 2, sharey=True, width_ratios=(2.0 * seen, across))
    for count, t in enumerate(np.linspace(0.0, 1.0, shown)):
        faint = 0.35 + 0.65 * count / (shown - 1)
        for line, color in _lines(robot, _pose(robot, gait, t)):
            drawn = {"color": color, "alpha": faint, "lw": 1.6, "marker": "o", "markersize": 2.5}
            side.plot(line[:, 0], line[:, 2], **drawn)
            back.plot(apart * count - line[:, 1], line[:, 2], **drawn)
    for axes in (side, back):
        axes.axhline(0.0, color=style.GREY, lw=0.8)
        axes.set(aspect="equal")
    side.set(title="from the right", xlabel="forward [m]", ylabel="up [m]", xlim=(-seen, seen))
    back.set(title="from behind", xlabel="phase", xlim=(-0.35, across - 0.35))
    back.set_xticks(ticks, [f"{t:.2f}" for t in np.linspace(0.0, 1.0, shown)])
    return figure


@style.styled
def draw_footprints(traces: Sequence[WalkTrace], words: Sequence[str]) -> Figure:
    """Draw walks from above, each in a panel: footprints, the hips, and where it was pushed."""
    figure = Figure(figsize=(WIDTH, 1.1 * len(traces) + 0.8), layout="constrained")
    panels = figure.subplots(len(traces), 1, sharex=True, sharey=True, squeeze=False)[:, 0]
    # Of right and left footprints.
    styles = ((style.BLUE, "o", "right foot"), (style.ORANGE, "s", "left foot"))
    for axes, trace, title in zip(panels, traces, words, strict=True):
        axes.plot(*trace.path.T, color=style.GREY, lw=1.2, label="hips")
        for left, (color, mark, name) in enumerate(styles):
            feet = np.array([(one.x, one.y) for one in trace.prints if one.left == left])
            axes.plot(*feet.T, mark, color=color, markersize=5, label=name)
        if np.all(np.isfinite(trace.pushed)):
            x, y = trace.pushed
            arrow = {"arrowstyle": "->", "color": style.RED, "lw": 1.8}
            axes.annotate("", (x, y + 0.02), (x, y - 0.16), arrowprops=arrow)
        axes.set(title=title, ylabel="left [m]", aspect="equal")
    panels[-1].set(xlabel="forward [m]")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


@style.styled
def draw_slices(gait: SpatialGait, trace: WalkTrace) -> Figure:
    """Draw the tube's extent over a step, less its middle, and a walk's states."""
    figure = Figure(figsize=(WIDTH, 5.2), layout="constrained")
    t = np.linspace(0.0, 1.0, 101)
    _, axes = gait.tube.sections(t)
    half = np.linalg.norm(axes, axis=2)
    panels = figure.subplots(3, 1, sharex=True)
    for k, (place, (label, size)) in enumerate(zip(panels, SLICES, strict=True)):
        band = size * half[:, k]
        place.fill_between(t, -band, band, color=style.ALLOWED, label="tube")
        place.axhline(0.0, color=style.BLUE, lw=1.0, label="periodic orbit")
        walked = size * trace.rows[:, 1 + k]
        place.plot(trace.rows[:, 0], walked, color=style.ORANGE, lw=1.0, label="MuJoCo, simulated")
        place.set(ylabel=label)
    panels[-1].set(xlabel="phase")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


@style.styled
def draw_sections(gait: SpatialGait) -> Figure:
    """Draw the outlines of the tube's sections at start, middle and end of a step."""
    figure = Figure(figsize=(WIDTH, 4.6), layout="constrained")
    panels = figure.subplots(2, 2).ravel()
    phases = np.array([0.0, 0.5, 1.0])
    _, axes = gait.tube.sections(phases)
    turn = np.linspace(0.0, 2.0 * np.pi, 181)
    looks = ((style.BLUE, "-"), (style.ORANGE, "--"), (style.RED, ":"))
    for place, (one, other) in zip(panels[:3], ((0, 2), (0, 1), (1, 2)), strict=True):
        for phase, section, (color, dash) in zip(phases, axes, looks, strict=True):
            sizes = np.array([SLICES[one][1], SLICES[other][1]])
            line = sizes * _outline(section[[one, other]], turn)
            place.plot(*line.T, dash, color=color, label=f"phase {phase:.1f}")
        place.set(xlabel=SLICES[one][0], ylabel=SLICES[other][0])
    panels[3].axis("off")
    panels[3].legend(*panels[0].get_legend_handles_labels(), loc="center")
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
        rows: rows of the half axes.
        turn: angles.
    """
    values, vectors = np.linalg.eigh(rows @ rows.T)
    sides = vectors * np.sqrt(np.maximum(values, 0.0))
    return np.stack([np.cos(turn), np.sin(turn)], axis=1) @ sides.T
