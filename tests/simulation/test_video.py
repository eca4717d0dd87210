import importlib.util
import os
import warnings
from typing import Any
from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest

from neuralgaits.errors import InputError
from neuralgaits.robots.mjcf.loader import robot_from_text
from neuralgaits.simulation import video
from neuralgaits.simulation.setup.plant import build
from neuralgaits.simulation.walk import walk


def test_a_video_is_an_mp4(tmp_path):
    with pytest.raises(InputError, match=r"expected a file name that ends in \.mp4"):
        video.check(tmp_path / "walk.gif")


def test_a_missing_extra_is_named(tmp_path, monkeypatch):
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"pip install 'neuralgaits\[video\]'"):
        video.check(tmp_path / "walk.mp4")


def test_without_opengl_there_is_one_line_and_no_warning(tmp_path, monkeypatch):
    pytest.importorskip("imageio_ffmpeg")

    def no_screen(*arguments, **settings):
        warnings.warn("X11: DISPLAY is missing", stacklevel=1)
        raise RuntimeError("no screen")

    monkeypatch.setattr(mujoco, "Renderer", no_screen)
    with pytest.raises(InputError, match=r"does not start \(no screen\)"):
        video.check(tmp_path / "walk.mp4")


def test_a_walk_becomes_a_video_or_one_clear_line(amber, slow, tmp_path):
    pytest.importorskip("imageio_ffmpeg")
    policy, x = slow
    walked = walk(amber, policy, x[None], controller="fblin", steps=1, record=True)
    path = tmp_path / "walk.mp4"
    episodes = walked.episodes
    try:
        video.write(path, walked.plant, episodes.states[:200], episodes.floors[:200])
    except InputError as error:
        assert "MUJOCO_GL" in str(error)
        assert not os.listdir(tmp_path)
    else:
        assert path.stat().st_size > 1000
        assert os.listdir(tmp_path) == ["walk.mp4"]


def plain_plant(amber):
    """A plant whose file names no colour of its floor, no light and no camera."""
    root = ElementTree.fromstring(amber.layout.xml)
    for parent in list(root.iter()):
        for child in list(parent):
            if child.tag in ("light", "camera", "asset"):
                parent.remove(child)
    for geom in root.iter("geom"):
        geom.attrib.pop("material", None)
        geom.attrib.pop("rgba", None)
    return build(robot_from_text(ElementTree.tostring(root, encoding="unicode"), "plain"))


def test_a_floor_without_a_colour_is_light_and_one_with_a_colour_keeps_it(amber, monkeypatch):
    monkeypatch.setattr(mujoco, "Renderer", lambda *_, **__: None)
    for plant, lit in ((plain_plant(amber), True), (build(amber), False)):
        model = plant.model
        before = model.geom_rgba.copy()
        video._renderer(model)
        floors = model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE
        assert np.any(floors) and np.all(model.geom_rgba[~floors] == before[~floors])
        assert np.all(model.geom_rgba[floors] > 0.9) == lit
        assert np.any(model.geom_rgba != before) == lit


def test_a_robot_without_a_camera_fills_most_of_the_height(amber):
    plant = plain_plant(amber)
    data = mujoco.MjData(plant.model)
    mujoco.mj_forward(plant.model, data)
    camera: Any = video._camera(plant, data)
    seen = 2.0 * camera.distance * np.tan(np.radians(0.5 * plant.model.vis.global_.fovy))
    leg = plant.robot.layout.leg_length
    low, high = camera.lookat[2] - 0.5 * seen, camera.lookat[2] + 0.5 * seen
    # From below the feet to above a torso as long as the leg.
    assert low < 0.0 and high > 1.95 * leg
    assert seen < 2.6 * leg
