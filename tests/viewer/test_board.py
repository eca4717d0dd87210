"""The board in the scene: what is on it is drawn, and what is off it only in words."""

import numpy as np

from neuralgaits.analysis.box_map import BoxAnswer, BoxMap
from neuralgaits.viewer.portrait import Portrait
from neuralgaits.viewer.stage import _Board

INSIDE, BELOW = np.array([0.5, 1.5]), np.array([0.5, 0.3])


def small_portrait():
    corners = np.array([[[0.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]])
    return Portrait(
        z1=np.linspace(-0.2, 1.2, 5),
        z2=np.linspace(0.8, 2.2, 4),
        dz=np.ones((4, 5, 2)),
        fence_z1=np.array([0.0, 1.0]),
        fence_z2=np.array([[1.0, 1.0], [2.0, 2.0]]),
        orbit=np.zeros((0, 2)),
        boxes=BoxMap(corners, np.array([BoxAnswer.PROVED]), np.array([0.5])),
        title="small",
    )


def test_a_state_off_the_board_has_no_point_and_breaks_the_trail(server):
    board = _Board(server, small_portrait(), 1.0, 0.0, lambda client, z: None)
    steps = np.array([[0.1, 1.5], [0.2, 1.5], BELOW, BELOW, [0.3, 1.5], [0.4, 1.5]])
    for _ in range(4):
        board.show(INSIDE, steps)
    assert board._point.visible and not board._beyond.visible
    # Two lines of five: those between states that are both on the board.
    assert board._line.points.shape == (2, 2, 3)
    board.show(BELOW, steps)
    assert not board._point.visible and board._beyond.visible
    assert board._beyond.text == "▼ below the chart"
    board.show(INSIDE, steps)
    assert board._point.visible and not board._beyond.visible
