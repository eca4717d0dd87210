"""Blocks that the robot walks on, in two alternating colours, moved under it as one mesh."""

import numpy as np
import viser

from neuralgaits._types import Float, Int


class Blocks:
    """Drawing of the blocks of a course; a floor has no blocks."""

    def __init__(self, server: viser.ViserServer):
        """Prepare the scene; nothing is drawn yet."""
        self._server = server
        self._frame = server.scene.add_frame("/course", show_axes=False)
        self._nodes: list[viser.MeshHandle] = []
        self._drawn: Float[np.ndarray, "K 4"] | None = None

    def show(self, tops: Float[np.ndarray, "K 4"] | None, x: float, ground: float) -> None:
        """Move the place `x` of the course (m) to the middle of the scene."""
        if tops is None:
            return
        if tops is not self._drawn:
            self._draw(tops)
        self._frame.position = (-x, 0.0, -ground)

    def _draw(self, tops: Float[np.ndarray, "K 4"]) -> None:
        for node in self._nodes:
            node.remove()
        self._nodes = [
            self._server.scene.add_mesh_simple(
                f"/course/{number}",
                *mesh(part),
                color=colour,
                flat_shading=True,
                cast_shadow=False,
            )
            for number, colour in enumerate(((158, 166, 176), (118, 128, 140)))
            if len(part := tops[number::2])
        ]
        self._drawn = tops


def mesh(tops: Float[np.ndarray, "K 4"]) -> tuple[Float[np.ndarray, "v 3"], Int[np.ndarray, "f 3"]]:
    """Return corners (m) and faces of blocks below these tops; outsides are counter-clockwise."""
    x0, z0, x1, z1 = tops.T
    depth = 0.25  # [m]
    to_side = 0.3  # Half of a block's width [m].
    # Around the side of a block, seen from -y.
    around = np.stack(
        [np.stack([x0, x1, x1, x0], 1), np.stack([z0 - depth, z1 - depth, z1, z0], 1)], axis=-1
    )
    sides = np.tile(around, (1, 2, 1))
    deep = np.broadcast_to(np.repeat([-to_side, to_side], 4), sides.shape[:2])
    corners = np.stack([sides[..., 0], deep, sides[..., 1]], axis=-1)
    # Of one block, by its eight corners, those at the near side first.
    ends = [(0, 1, 2), (0, 2, 3), (4, 6, 5), (4, 7, 6)]
    edges = ((0, 1), (1, 2), (2, 3), (3, 0))
    round_about = [face for a, b in edges for face in ((a, a + 4, b), (b, a + 4, b + 4))]
    faces = np.array(ends + round_about) + 8 * np.arange(len(tops))[:, None, None]
    return corners.reshape(-1, 3).astype(np.float32), faces.reshape(-1, 3).astype(np.uint32)
