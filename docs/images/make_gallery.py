"""Make the moving pictures of README and gallery from films of the program's own.

    MUJOCO_GL=egl .venv/bin/python docs/images/make_gallery.py --scratch FOLDER [NAME ...]

FOLDER keeps the trained runs and the films; what is there is not made again. Needs the `video`
extra and Pillow.
"""

import argparse
import shutil
import subprocess
from pathlib import Path

import imageio_ffmpeg
import jax
import numpy as np
from gallery import HEAD, SCENES, SHIPPED, Scene
from PIL import Image

import neuralgaits as ng
from neuralgaits.simulation.video import FRAMES_PER_S, SIZE
from neuralgaits.workflows.demo import FOLDER as SHIPPED_RUN

FOLDER = Path(__file__).parent
EVERY = {HEAD.name: 2}
"""Frames of the film for one that is kept; three for the gallery."""
QUALITY = 50


def main() -> None:
    """Make all, or those that are named."""
    parser = argparse.ArgumentParser()
    parser.add_argument("names", nargs="*", help="of scenes; all if none is named")
    parser.add_argument("--scratch", type=Path, required=True, help="folder for runs and films")
    options = parser.parse_args()
    jax.config.update("jax_enable_x64", True)
    for scene in (HEAD, *SCENES):
        if scene.name in options.names or not options.names:
            out = save(scene, filmed(scene, options.scratch))
            print(f"{out.name}: {out.stat().st_size // 1000} kB")


def filmed(scene: Scene, scratch: Path) -> Path:
    """The film of a scene, walked if it is not there."""
    film = scratch / f"{scene.name}.mp4"
    if not film.is_file():
        run = trained(scene.robot, scratch)
        done = ng.simulate(run, steps=scene.steps, video=film, **scene.asked)
        print(f"{scene.name}: {done}, {done.summary['fall_reasons'][0] or 'no fall'}")
    return film


def trained(robot: str, scratch: Path) -> Path:
    """A run of a robot, trained if it is not there."""
    run = scratch / "runs" / Path(robot).stem
    if robot == SHIPPED and not run.is_dir():
        # A copy: a simulation is kept in its run.
        shutil.copytree(SHIPPED_RUN, run)
    if not run.is_dir():
        ng.train(ng.load_robot(robot), seed=0, out=run)
    return run


def save(scene: Scene, film: Path) -> Path:
    """What is shown of a film, small enough for a page, as a WebP that moves."""
    every = EVERY.get(scene.name, 3)
    frames = decoded(film)[round(scene.begin * FRAMES_PER_S) : round(scene.end * FRAMES_PER_S)]
    height, width = SIZE
    first, last = (round(share * height) for share in scene.rows)
    size = (scene.width, round(scene.width * (last - first) / width))
    pictures = [
        Image.fromarray(frame[first:last]).resize(size, Image.Resampling.LANCZOS)
        for frame in frames[::every]
    ]
    out = FOLDER / f"{scene.name}.webp"
    pictures[0].save(
        out,
        save_all=True,
        append_images=pictures[1:],
        duration=round(1000 * every / FRAMES_PER_S),
        loop=0,
        quality=QUALITY,
        method=3,
    )
    return out


def decoded(film: Path) -> np.ndarray:
    """All frames of a film. [T, height, width, 3]."""
    height, width = SIZE
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-loglevel", "error", "-i", str(film)]
    raw = subprocess.run(
        [*command, "-f", "rawvideo", "-pix_fmt", "rgb24", "-"], check=True, stdout=subprocess.PIPE
    ).stdout
    return np.frombuffer(raw, np.uint8).reshape(-1, height, width, 3)


if __name__ == "__main__":
    main()
