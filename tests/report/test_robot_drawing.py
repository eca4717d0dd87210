"""The line drawing of bipeds with two and three links a leg, with and without a torso."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from neuralgaits.analysis.link_points import TORSO_SHARE, hip_index, skeleton
from neuralgaits.report.drawing.robot_drawing import draw
from neuralgaits.robots import load_robot
from support.random_biped import random_biped


@pytest.mark.parametrize(("links", "torso"), [(1, False), (2, True), (2, False), (3, True)])
def test_the_line_goes_over_the_hip_to_the_swing_foot(links, torso, tmp_path):
    path = tmp_path / "biped.xml"
    path.write_text(random_biped(3, links, torso=torso))
    robot = load_robot(path)
    q = np.random.default_rng(0).uniform(-0.5, 0.5, (4, robot.n))
    theta = q @ np.asarray(robot.link_angles).T
    points = skeleton(theta, np.asarray(robot.foot), robot.torso)
    assert points.shape == (4, 2 * links + 1 + 2 * torso, 2)
    foot = np.stack([robot.swing_foot(row) for row in q])
    np.testing.assert_allclose(points[:, -1], foot, atol=1e-12)
    hip = hip_index(points.shape[1], torso)
    # The stance leg spans l (-sin, cos) for each of its links: where the hip must be.
    along = np.stack([-np.sin(theta), np.cos(theta)], axis=-1)
    expected = np.einsum("l,kld->kd", np.asarray(robot.hip), along)
    np.testing.assert_allclose(points[:, hip], expected, atol=1e-12)
    if torso:
        np.testing.assert_array_equal(points[:, hip], points[:, hip + 2])
        trunk = points[:, hip + 1] - points[:, hip]
        angle = np.arctan2(-trunk[:, 0], trunk[:, 1])
        np.testing.assert_allclose(angle, theta[:, robot.torso], atol=1e-12)


def test_both_legs_and_the_torso_are_drawn_once():
    lengths = np.array([0.4, 0.45, 0.0, -0.45, -0.4])
    points = skeleton(np.zeros((1, 5)), lengths, 2)[0]
    axes = Figure().add_subplot()
    draw(axes, points, True, shift=1.0)
    drawn = [line for line in axes.lines if line.get_linestyle() == "-"]
    lengths = [float(np.abs(np.diff(np.asarray(line.get_ydata()))).sum()) for line in drawn]
    trunk = TORSO_SHARE * 0.85
    assert sorted(lengths) == pytest.approx(sorted([0.85, 0.85, trunk]))
    assert all(np.allclose(np.asarray(line.get_xdata()), 1.0) for line in drawn)
