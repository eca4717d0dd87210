"""One step over time: joint angles, torques with their limits, ground force in its cone."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from neuralgaits.analysis.data import GaitData, MeasuredWalk
from neuralgaits.report.drawing.style import (
    ALLOWED,
    BLACK,
    BLUE,
    GREY,
    RED,
    new_figure,
    panel,
    series,
    styled,
)


def caption(walk: MeasuredWalk | None) -> str:
    """Return the caption of the figure, which mentions a measured step if there is one."""
    text = (
        "What the joints do in one step, the torques that takes and the force of the ground on the "
        "standing foot. Torques have to stay off the motors' limits, the ground can only push, and "
        "the horizontal force has to stay inside what friction can hold."
    )
    return text + (f" Thin dotted lines were measured ({walk.source})." if walk else "")


@styled
def draw(data: GaitData, walk: MeasuredWalk | None = None) -> Figure:
    """Draw the step on the periodic orbit, and a measured step beneath it."""
    figure = new_figure(7.4)
    angles, torques, forces = figure.subplots(3, 1, sharex=True)
    t = data["orbit/t"]
    names = [name.replace("_", " ") for name in data.joints]
    for axes, values in ((angles, data["orbit/q"][:, 1:]), (torques, data["orbit/torque"])):
        for number, name in enumerate(names):
            axes.plot(t, values[:, number], label=name, **series(number))
    if walk is not None:
        _measured(angles, torques, walk, float(t[-1]))
    _limits(torques, data["robot/torque_limit"])
    _forces(forces, data)
    angles.set_ylabel("joint angle [rad]")
    torques.set_ylabel("torque [N m]")
    forces.set(ylabel="ground force [N]", xlabel="time since the foot landed [s]")
    panel(angles, "a", "outputs: what the policy asks for, and gets on the orbit")
    panel(torques, "b", "joint torques and the motors' limits")
    panel(forces, "c", "ground force and the friction cone")
    for axes in (angles, torques, forces):
        axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5))
        axes.grid(True, color="0.93")
    forces.set_xlim(0.0, max(float(t[-1]), 1e-3))
    return figure


def _measured(angles: Axes, torques: Axes, walk: MeasuredWalk, until: float) -> None:
    rows = walk.last_step
    t = walk.t[rows] - walk.t[rows[0]]
    rows, t = rows[t <= 1.05 * until], t[t <= 1.05 * until]
    for axes, values in ((angles, walk.q), (torques, walk.torque)):
        for number in range(values.shape[1]):
            line = series(number) | {"linestyle": ":", "linewidth": 0.9}
            axes.plot(t, values[rows, number], **line)
        axes.plot([], [], ":", color=BLACK, linewidth=0.9, label="measured")


def _limits(axes: Axes, limits: np.ndarray) -> None:
    """Draw the limits of all motors, and hatch the torques beyond the strongest motor's limit."""
    most, different = float(limits.max()), np.unique(limits)
    for limit in (*-different, *different):
        axes.axhline(limit, color=BLACK, linewidth=1.4, linestyle=(0, (6, 2)))
    for side in (-most, most):
        axes.axhspan(side, 1.25 * side, facecolor="none", edgecolor=GREY, hatch="////", linewidth=0)
    label = "limit" if len(different) == 1 else "limits"
    label += f", {', '.join(f'{limit:.3g}' for limit in different)} N m"
    axes.plot([], [], color=BLACK, linestyle=(0, (6, 2)), label=label)
    axes.set_ylim(-1.25 * most, 1.25 * most)


def _forces(axes: Axes, data: GaitData) -> None:
    t, (along, normal) = data["orbit/t"], data["orbit/force"].T
    friction = float(data["robot/friction"])
    weight = float(data["robot/mass"] * data["robot/gravity"])
    label = f"friction can hold\n(μ = {friction:.2g})"
    axes.fill_between(t, -friction * normal, friction * normal, color=ALLOWED, label=label)
    for side in (-1.0, 1.0):
        axes.plot(t, side * friction * normal, color=BLUE, linewidth=0.8, linestyle="--")
    axes.plot(t, normal, color=BLACK, label="normal force")
    axes.plot(t, along, color=RED, linestyle="-.", label="horizontal force")
    axes.axhline(weight, color=GREY, linewidth=0.9, linestyle=":", label="weight")
    axes.axhline(0.0, color=GREY, linewidth=0.8)
