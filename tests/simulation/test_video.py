import importlib.util
import os
import warnings

import mujoco
import pytest

from neuralgaits.errors import InputError
from neuralgaits.simulation import video
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
