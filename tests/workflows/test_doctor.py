"""What `doctor` says of pictures is what `simulate --video` meets."""

import subprocess
import sys

import pytest

from neuralgaits.workflows import doctor as workflow
from neuralgaits.workflows.doctor import doctor


@pytest.fixture
def trial(monkeypatch):
    """Replace the trial by a program of one line."""

    def replace(program):
        monkeypatch.setattr(workflow, "_RENDER", program)

    return replace


def test_without_a_screen_it_says_what_a_video_would(monkeypatch):
    """A window's OpenGL: its context can be asked for, and still gives no picture."""
    monkeypatch.setenv("MUJOCO_GL", "glfw")
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    program = """
import mujoco
with mujoco.Renderer(mujoco.MjModel.from_xml_string("<mujoco/>"), 64, 64) as renderer:
    renderer.render()
"""
    works = subprocess.run([sys.executable, "-c", program], capture_output=True).returncode == 0
    found = doctor()["opengl"]
    assert found["ok"] is works
    assert works or found["fix"].startswith("for videos, ")


def test_a_crash_of_the_driver_is_a_finding(trial, monkeypatch):
    monkeypatch.setenv("MUJOCO_GL", "egl")
    trial("import os; os.abort()")
    found = doctor()
    assert found["opengl"]["found"] == "MUJOCO_GL=egl: no picture"
    assert "install Mesa" in found["opengl"]["fix"]
    # Only videos want it.
    assert found["ok"] or not all(found[name]["ok"] for name in ("python", "device", "x64"))


def test_the_way_that_works_is_named(trial, monkeypatch):
    monkeypatch.setenv("MUJOCO_GL", "glfw")
    trial("import os, sys; sys.exit(os.environ['MUJOCO_GL'] != 'osmesa')")
    assert doctor()["opengl"]["fix"] == "for videos, set MUJOCO_GL=osmesa, which renders here"


def test_a_missing_extra_is_a_finding(trial, monkeypatch):
    trial("pass")
    monkeypatch.setattr(workflow.importlib.util, "find_spec", lambda name: None)
    found = doctor()
    assert found["opengl"]["ok"] and found["opengl"]["fix"] is None
    for extra, what in {"hzd": "`optimise`", "drake": "`simulate --simulator drake`"}.items():
        assert found[extra]["fix"] == f"for {what}, pip install 'neuralgaits[{extra}]'"
        assert not found[extra]["needed"]
    assert found["video"]["fix"] == "for videos, pip install 'neuralgaits[video]'"
