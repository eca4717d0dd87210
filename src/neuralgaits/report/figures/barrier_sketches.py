"""The conditions on the robot itself: torso, swing foot, contact force, hip and knees."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Wedge

from neuralgaits.analysis.data import GaitData
from neuralgaits.analysis.link_points import hip_index
from neuralgaits.report.drawing import robot_drawing
from neuralgaits.report.drawing.style import (
    ALLOWED,
    BLACK,
    BLUE,
    FORBIDDEN,
    GREEN,
    GREY,
    RED,
    new_figure,
    panel,
    say,
    styled,
)


@styled
def draw(data: GaitData) -> Figure:
    """Draw four sketches of a gait with a periodic orbit."""
    figure = new_figure(8.4)
    torso, foot, force, joints = figure.subplots(2, 2).flat
    _torso(torso, data)
    _foot(foot, data)
    _force(force, data)
    _joints(joints, data)
    return figure


def _torso(axes: Axes, data: GaitData) -> None:
    points = data["orbit/skeleton"][data.row_at(0.2)]
    robot_drawing.draw(axes, points, data.torso)
    low, high = data.limits("torso_angle")
    panel(axes, "a", "torso" if data.torso else "pose at mid-step")
    if data.torso:
        hip = points[hip_index(len(points), True)]
        top = points[hip_index(len(points), True) + 1]
        size = 1.12 * float(np.linalg.norm(top - hip))
        if low is not None and high is not None:
            # Up-angles are positive backwards: to the left.
            first, last = (90.0 + float(np.degrees(angle)) for angle in (low, high))
            style = {"facecolor": ALLOWED, "edgecolor": BLUE, "linewidth": 1.2, "zorder": 1}
            axes.add_patch(Wedge(tuple(hip), size, first, last, **style))
            for angle, where in ((low, "left"), (high, "right")):
                tip = hip + 1.03 * size * np.array([-np.sin(angle), np.cos(angle)])
                style = {"ha": where, "va": "bottom", "fontsize": 9, "color": BLUE}
                axes.text(tip[0], tip[1], lean_in_words(angle), **style)
        else:
            say(axes, "this spec has no condition on torso", 0.86)
    _frame(axes, points, 1.25)


def lean_in_words(angle: float) -> str:
    """Write an up-angle of the torso, positive backwards, as a lean [rad]."""
    return f"{abs(angle):.2f} rad {'forward' if angle < 0.0 else 'back'}"


def _foot(axes: Axes, data: GaitData) -> None:
    panel(axes, "b", "swing foot (heights enlarged)")
    x, y = data["orbit/foot"].T
    z1 = data["orbit/z"][:, 0]
    phase = (z1 - z1[0]) / (z1[-1] - z1[0])
    ceiling = data.limits("foot_height")[1]
    tall = 1.25 * max(float(y.max()), ceiling or 0.0)
    axes.plot(x, y, color=BLACK, label="path of the swing foot")
    floor = np.zeros_like(x)
    recognised = False
    for arc in data.bounds("foot_above_arc"):
        floor = arc["clearance"] * 4.0 * phase * (1.0 - phase)
        recognised = True
    for circle in data.bounds("foot_on_circle"):
        across, up = circle["centre"]
        square = circle["radius"] ** 2 - (x - across) ** 2
        floor = up + np.sqrt(np.maximum(square, 0.0))
        recognised = True
    for parabola in data.bounds("parabolic_clearance"):
        share = z1 / parabola["half_width"]
        floor = parabola["height"] * (1.0 - share**2) - parabola["slack"]
        recognised = True
    if recognised:
        style = {"facecolor": FORBIDDEN, "edgecolor": GREY, "hatch": "////", "linewidth": 0}
        axes.fill_between(x, -0.06 * tall, floor, label="too low", zorder=0.5, **style)
        axes.plot(x, floor, "--", color=RED, linewidth=1.2)
    else:
        say(axes, "this spec has no condition on foot clearance", 0.86)
    if ceiling is not None:
        axes.axhline(ceiling, color=BLUE, linestyle="-.", linewidth=1.4, label="ceiling")
    axes.axhline(0.0, color=BLACK, linewidth=1.0)
    axes.plot(0.0, 0.0, "o", color=BLACK, ms=7)
    style = {"textcoords": "offset points", "ha": "center", "va": "top", "fontsize": 9}
    axes.annotate("stance foot", (0.0, 0.0), (0, -9), **style)
    axes.set_ylim(-0.16 * tall, 1.45 * tall)
    axes.set(xlabel="swing foot ahead of the stance foot [m]", ylabel="height [m]")
    axes.legend(loc="upper left", ncols=2, fontsize=9, columnspacing=1.0, handlelength=1.6)


def _force(axes: Axes, data: GaitData) -> None:
    panel(axes, "c", "force of the ground on the stance foot")
    along, normal = data["orbit/force"].T
    coefficients = [
        cone["coefficient"]
        for name in ("friction_forward", "friction_backward")
        for cone in data.bounds(name)
    ]
    least = data.limits("normal_force")[0]
    top = 1.25 * float(normal.max())
    if coefficients:
        share = min(coefficients)
        bottom = least or 0.0
        corners = [
            (-share * bottom, bottom),
            (share * bottom, bottom),
            (share * top, top),
            (-share * top, top),
        ]
        label = f"asked for: |T| ≤ {share:.2g} × N" + (f", N ≥ {least:.0f} N" if least else "")
        axes.add_patch(Polygon(corners, facecolor=ALLOWED, edgecolor=BLUE, label=label, zorder=1))
    else:
        say(axes, "this spec has no condition on contact", 0.86)
    floor = float(data["robot/friction"])
    for side in (-1.0, 1.0):
        label = f"the floor's cone, μ = {floor:.2g}" if side > 0 else None
        axes.plot(
            [0.0, side * floor * top], [0.0, top], "--", color=RED, linewidth=1.4, label=label
        )
    for row in np.linspace(0, len(along) - 1, 9).round().astype(int):
        arrow = {"arrowstyle": "-|>", "color": GREY, "linewidth": 0.8, "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", (along[row], normal[row]), (0.0, 0.0), zorder=2, arrowprops=arrow)
    axes.plot(along, normal, color=BLACK, linewidth=2.0, label="tip, over one step", zorder=3)
    axes.set(xlabel="horizontal force T [N]", ylabel="normal force N [N]")
    axes.set_ylim(-0.03 * top, 1.85 * top)
    axes.legend(loc="upper center", fontsize=9)


def _joints(axes: Axes, data: GaitData) -> None:
    panel(axes, "d", "hip and knees")
    row = data.row_at(0.8)
    points, torso = data["orbit/skeleton"][row], data.torso
    hip_row = hip_index(len(points), torso)
    hip, tall = points[hip_row], float(points[:, 1].max())
    robot_drawing.draw(axes, points, torso)
    path = data["orbit/skeleton"][:, hip_row]
    axes.plot(*path.T, ":", color=BLACK, linewidth=1.2, label="path of the hip")
    slowest = data.limits("forward_rate")[0]
    speed = float(data["orbit/numbers"][3] / data["orbit/numbers"][2])
    size = 0.5 * tall
    arrow = {"arrowstyle": "-|>", "color": GREEN, "linewidth": 2.0}
    axes.annotate("", hip + np.array([size, 0.0]), hip, arrowprops=arrow)
    text = f"on average {speed:.2f} m/s"
    if slowest is not None:
        text += f"\nasked for: ≥ {slowest:.2f} m/s"
    at = hip + np.array([0.12 * tall, 0.03 * tall])
    axes.text(at[0], at[1], text, fontsize=9, color=GREEN, va="bottom", ha="left")
    joints = len(data.joints)
    for knees in data.bounds("knee_bend"):
        for joint, side in zip(knees["joints"], knees["sides"], strict=True):
            _knee(axes, data, points, int(joint), float(side), joints, row)
        label = f"straight leg: knees stay {knees['least']:.2g} rad off"
        axes.plot([], [], "--", color=RED, linewidth=1.2, label=label)
    _frame(axes, points, 1.6)
    axes.legend(loc="upper center", fontsize=9)


def _knee(
    axes: Axes, data: GaitData, points: np.ndarray, joint: int, side: float, count: int, row: int
) -> None:
    """Draw the line of a straight leg at a knee, and write the bend of the knee."""
    hip = hip_index(len(points), data.torso)
    swing = joint >= count / 2
    # Actuated joints run up the stance leg and down the swing leg; hips stand between.
    at = len(points) - 1 - (count - joint) if swing else joint + 1
    above = points[at - 1] if swing else points[at + 1]
    direction = (points[at] - above) / np.linalg.norm(points[at] - above)
    line = np.transpose([points[at], points[at] + 0.3 * points[hip, 1] * direction])
    axes.plot(*line, "--", color=RED, linewidth=1.2, zorder=2)
    bend = side * data["orbit/q"][row, joint + 1]
    offset = (8, 2) if swing else (-8, 2)
    style = {"textcoords": "offset points", "ha": "left" if swing else "right", "fontsize": 9}
    axes.annotate(f"{bend:.2f} rad", tuple(points[at]), offset, **style)


def _frame(axes: Axes, points: np.ndarray, share: float) -> None:
    """Frame the pose on its ground in true proportions, with space above it."""
    axes.axhline(0.0, color=GREY, linewidth=1.0, zorder=0)
    axes.set(xlabel="forward [m]", ylabel="up [m]")
    top = share * float(points[:, 1].max())
    middle = 0.5 * float(points[:, 0].min() + points[:, 0].max())
    axes.set_ylim(-0.05 * top, top)
    axes.set_xlim(middle - 0.6 * top, middle + 0.6 * top)
    axes.set_aspect("equal")
