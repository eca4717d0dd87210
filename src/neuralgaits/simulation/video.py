"""Make a video of one episode, at real-time speed. Needs the `video` extra and OpenGL."""

import gc
import importlib.util
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Iterable
from pathlib import Path

import mujoco
import numpy as np

from neuralgaits._types import Float
from neuralgaits.errors import InputError
from neuralgaits.robots.link_rods import Bone, bones
from neuralgaits.runs import write_bytes
from neuralgaits.simulation.setup.foot_planes import SECOND_FLOOR_GROUP
from neuralgaits.simulation.setup.plant import PERIOD_S, Plant

FRAMES_PER_S = 50
SIZE = (480, 640)
"""Height and width of a frame [pixels]; a robot file's own off-screen size may cut it."""
_SUFFIX = ".mp4"


def check(path: Path) -> None:
    """Refuse a video that cannot be made, before an episode is simulated.

    Raises: InputError with the remedy, if the extra or OpenGL is missing or the file is no MP4.
    """
    if path.suffix != _SUFFIX:
        raise InputError(f"video {path}: expected a file name that ends in {_SUFFIX}")
    if importlib.util.find_spec("imageio_ffmpeg") is None:
        raise InputError(
            "video needs imageio-ffmpeg, which is not installed: pip install 'neuralgaits[video]'"
        )
    trial()


def trial() -> None:
    """Render an empty picture in the way that a film's pictures are rendered.

    Raises: InputError with the remedy, if OpenGL fails.
    """
    model = mujoco.MjModel.from_xml_string("<mujoco/>")
    renderer = _renderer(model)
    try:
        renderer.update_scene(mujoco.MjData(model))
        renderer.render()
    except Exception as error:
        raise _no_opengl(error) from None
    finally:
        renderer.close()


def write(
    path: Path,
    plant: Plant,
    states: Float[np.ndarray, "T s"],
    floors: Float[np.ndarray, "T 2"],
) -> None:
    """Render an episode to an MP4 file, in one piece or not at all.

    Args:
        path: path of the file.
        plant: simulated plant.
        states: time, qpos and qvel, one a control tick.
        floors: level under each foot (m), one a control tick; not read on a course.

    Raises: InputError with the remedy, if OpenGL or ffmpeg fails.
    """
    ticks = round(1.0 / (FRAMES_PER_S * PERIOD_S))
    renderer = _renderer(plant.model)
    moments = zip(states[::ticks], floors[::ticks], strict=True)
    skeleton = bones(plant.model, plant.robot.layout)
    frames = (_frame(renderer, plant, skeleton, state, levels) for state, levels in moments)
    try:
        with tempfile.TemporaryDirectory() as folder:
            film = Path(folder) / f"film{_SUFFIX}"
            _encode(film, frames)
            write_bytes(path, film.read_bytes())
    finally:
        renderer.close()


def _encode(film: Path, frames: Iterable[np.ndarray]) -> None:
    """Pipe frames through ffmpeg, and not through imageio, which forks JAX's threads."""
    import imageio_ffmpeg

    height, width = SIZE
    raw = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}"]
    coded = ["-an", "-c:v", "libx264", "-pix_fmt", "yuv420p"]
    rate = ["-r", str(FRAMES_PER_S)]
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-y", "-loglevel", "error", *raw, *rate]
    with subprocess.Popen(
        [*command, "-i", "-", *coded, str(film)], stdin=subprocess.PIPE, stderr=subprocess.PIPE
    ) as coder:
        assert coder.stdin is not None
        assert coder.stderr is not None
        try:
            for frame in frames:
                coder.stdin.write(frame.tobytes())
            coder.stdin.close()
        except BrokenPipeError:
            # What went wrong is on the coder's own stderr.
            pass
        complaint = coder.stderr.read().decode(errors="replace")
    if coder.returncode:
        raise InputError(f"video: ffmpeg failed: {' '.join(complaint.split())[:200]}")


def _frame(
    renderer, plant: Plant, skeleton: list[Bone], state: np.ndarray, levels: np.ndarray
) -> np.ndarray:
    model = plant.model
    data = mujoco.MjData(model)
    data.qpos[:] = state[1 : 1 + model.nq]
    option = mujoco.MjvOption()
    if plant.course is None:
        data.mocap_pos[:] = plant.floor_positions(levels[None])[0].reshape(-1, 3)
        option.geomgroup[SECOND_FLOOR_GROUP] = bool(levels[0] != levels[1])
    mujoco.mj_forward(model, data)
    renderer.update_scene(data, _camera(plant, data), option)
    for bone in skeleton:
        _draw(renderer.scene, bone, data)
    frame = renderer.render()
    if not np.any(model.tex_type == mujoco.mjtTexture.mjTEXTURE_SKYBOX):
        # Colour where nothing is drawn, of a robot whose file has no sky.
        sky = np.array([222, 231, 240], dtype=np.uint8)
        frame = np.where((frame == 0).all(axis=-1, keepdims=True), sky, frame)
    return frame


def _draw(scene, bone: Bone, data) -> None:
    """Add a rod to the rendered scene, because the simulated model has none."""
    body = data.body(bone.body)
    ends = body.xpos + bone.ends @ body.xmat.reshape(3, 3).T
    geom = scene.geoms[scene.ngeom]
    capsule, nowhere = mujoco.mjtGeom.mjGEOM_CAPSULE, np.zeros(3)
    colour = np.array(bone.colour, dtype=np.float32)
    mujoco.mjv_initGeom(geom, capsule, nowhere, nowhere, np.eye(3).ravel(), colour)
    mujoco.mjv_connector(geom, capsule, bone.radius, *ends)
    scene.ngeom += 1


def _camera(plant: Plant, data):
    """Return the file's own camera, or else one that follows the robot from its side.

    On a course it is always the latter, which goes up and down with the ground.
    """
    if plant.model.ncam and plant.course is None:
        return 0
    camera = mujoco.MjvCamera()
    height = plant.robot.layout.leg_length
    root = int(plant.model.joint(plant.robot.layout.root_joints[2]).bodyid[0])
    level = 0.0 if plant.course is None else plant.course.height(float(data.xpos[root][0]))
    camera.lookat[:] = (data.xpos[root][0], 0.0, level + 0.78 * height)
    camera.distance, camera.azimuth, camera.elevation = 3.0 * height, 90.0, -8.0
    return camera


def _renderer(model):
    height, width = SIZE
    if not model.nlight:
        # A file without lights is lit from the camera, brightly enough to see it.
        model.vis.headlight.ambient[:], model.vis.headlight.diffuse[:] = 0.75, 0.4
    planes = (model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE) & (model.geom_matid < 0)
    # MuJoCo's colour of a shape whose file names none: lit by few lights, it is nearly black.
    unpainted = (0.5, 0.5, 0.5, 1.0)
    plain = planes & np.isclose(model.geom_rgba, unpainted).all(axis=1)
    model.geom_rgba[plain] = (0.93, 0.95, 0.97, 1.0)
    # A robot file that says nothing about its off-screen buffer gets one that is large enough.
    visual = model.vis.global_
    visual.offheight, visual.offwidth = max(height, visual.offheight), max(width, visual.offwidth)
    # Each OpenGL back end fails in its own way, and MuJoCo's half-made contexts complain again
    # when they are destroyed: here, while nobody listens.
    listener, sys.unraisablehook = sys.unraisablehook, lambda _: None
    try:
        with warnings.catch_warnings():
            # The reason goes into one line below.
            warnings.simplefilter("ignore")
            return mujoco.Renderer(model, height=height, width=width)
    except Exception as error:
        refusal = _no_opengl(error)
    finally:
        gc.collect()
        sys.unraisablehook = listener
    raise refusal


def _no_opengl(error: Exception) -> InputError:
    reason = " ".join(str(error).split())[:120]
    return InputError(
        f"video needs OpenGL, which does not start ({reason}): on a machine without a screen "
        "install Mesa (libegl1 on Debian), and set MUJOCO_GL=egl or osmesa outside of the command "
        "line"
    )
