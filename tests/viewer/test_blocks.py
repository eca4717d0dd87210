"""What is drawn of a course: closed blocks below its tops."""

from typing import Any

import numpy as np
import pytest
import trimesh

from neuralgaits.viewer.blocks import Blocks, mesh

TOPS = np.array([[-0.1, 0.0, 0.1, 0.0], [0.3, 0.05, 0.5, 0.05], [0.5, 0.05, 1.5, 0.15]])


def test_each_block_is_closed_and_faces_outwards():
    vertices, faces = mesh(TOPS)
    drawn = trimesh.Trimesh(vertices, faces, process=False)
    blocks = drawn.split()
    assert len(blocks) == len(TOPS)
    # Outward faces enclose a positive volume; upright sides make it width by depth by side.
    for block, (x0, _, x1, _) in zip(blocks, TOPS, strict=True):
        assert block.is_watertight
        assert block.volume == pytest.approx((x1 - x0) * 0.25 * 0.6, rel=1e-5)


def test_tops_are_where_the_course_has_them():
    vertices, _ = mesh(TOPS)
    for corners, (x0, z0, x1, z1) in zip(vertices.reshape(-1, 8, 3), TOPS, strict=True):
        for x, z in ((x0, z0), (x1, z1)):
            above = corners[np.isclose(corners[:, 0], x)]
            assert above[:, 2].max() == pytest.approx(z, abs=1e-6)
            np.testing.assert_allclose(np.unique(above[:, 1]), [-0.3, 0.3], atol=1e-6)


def test_they_move_under_the_robot_and_are_drawn_anew_where_they_changed(server):
    blocks = Blocks(server)
    blocks.show(None, 1.0, 0.2)
    assert np.all(np.array(blocks._frame.position) == 0.0)
    blocks.show(TOPS, 1.0, 0.2)
    np.testing.assert_allclose(blocks._frame.position, [-1.0, 0.0, -0.2])
    nodes: Any = server.scene._handle_from_node_name
    first = nodes["/course/0"]
    blocks.show(TOPS, 1.1, 0.2)
    assert nodes["/course/0"] is first
    blocks.show(TOPS[:1], 1.1, 0.2)
    assert nodes["/course/0"] is not first
    left = {name: node.vertices for name, node in nodes.items() if "/course/" in name}
    assert len(left.pop("/course/0")) == 8
    assert all(len(vertices) == 0 for vertices in left.values())
