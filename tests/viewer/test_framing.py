"""The camera sees the whole scene in windows of all shapes, on every load."""

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
import viser

from neuralgaits.viewer import page_style
from neuralgaits.viewer.framing import FOV, Framing

TOP, WIDE = 3.6, 2.6
FRAMING = Framing(TOP, WIDE)


def seen(pose, window, point):
    """Where a point of the scene is in the window: shares from its lower left corner."""
    eye, target = (np.asarray(place) for place in pose)
    ahead = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(ahead, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    up = np.cross(right, ahead)
    way = np.array([point[0], 0.0, point[1]]) - eye
    scale = 0.5 / np.tan(0.5 * FOV) / (way @ ahead)
    return 0.5 + scale * (way @ right) * window[1] / window[0], 0.5 + scale * (way @ up)


# The second is the first one's window on a screen with three pixels for each of the page's.
WINDOWS = [(390, 844), (1170, 2532), (320, 568), (426, 900), (800, 900), (1440, 900)]


@pytest.mark.parametrize("window", WINDOWS)
def test_all_of_the_scene_is_in_view(window):
    pose = FRAMING.of_window(*window)
    for x in (-0.45 * WIDE, 0.45 * WIDE):
        for z in (0.0, 0.9 * TOP):
            across, up = seen(pose, window, (x, z))
            assert 0.0 < across < 1.0
            # Controls lie over the lower part of a phone's window.
            assert (page_style.SCENE_SHARE if window[0] < 0.6 * window[1] else 0.0) < up < 1.0


def test_a_window_of_unknown_size_has_the_usual_view():
    assert FRAMING.of_window(0, 0) == FRAMING.of_window(1200, 1000)


class _Server:
    """What `follow` needs of a server, and one visitor."""

    def __init__(self):
        self.initial_camera = SimpleNamespace()

    def on_client_connect(self, call):
        self.connect = call

    def visit(self, **camera):
        camera = _Camera(**camera)
        self.connect(SimpleNamespace(camera=camera))
        return camera


class _Camera(SimpleNamespace):
    def on_update(self, call):
        self.report = lambda: call(self)


@pytest.fixture
def server():
    made = _Server()
    FRAMING.follow(cast(viser.ViserServer, made))
    return made


@pytest.mark.parametrize("begun", ["own", "server's"])
def test_a_page_that_goes_to_another_view_of_its_own_is_framed_again(server, begun):
    first = np.array(server.initial_camera.position if begun == "server's" else (3.0, 3.0, 3.0))
    camera = server.visit(position=first, look_at=(0, 0, 0), image_width=390, image_height=844)
    framed = FRAMING.of_window(390, 844)
    assert camera.position == framed[0]
    # The server's first view comes to the page after the visitor's own.
    camera.position = np.array(server.initial_camera.position)
    camera.report()
    assert (camera.position, camera.look_at) == framed


def test_a_turned_window_is_framed_anew_until_the_visitor_moves(server):
    camera = server.visit(position=(3, 3, 3), look_at=(0, 0, 0), image_width=390, image_height=844)
    camera.image_width, camera.image_height = 844, 390
    camera.report()
    assert camera.position == FRAMING.of_window(844, 390)[0]
    camera.position = (1.0, -2.0, 1.0)
    camera.report()
    camera.image_width, camera.image_height = 390, 844
    camera.report()
    assert camera.position == (1.0, -2.0, 1.0)
