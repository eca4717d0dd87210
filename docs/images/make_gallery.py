"""Make the moving pictures of README, gallery and commands from films of the program's own.

    MUJOCO_GL=egl .venv/bin/python docs/images/make_gallery.py --scratch FOLDER [NAME ...]

FOLDER keeps the trained runs and the films; what is there is not made again. Needs the `video`
extra and Pillow.
"""

import argparse
import csv
import shutil
import subprocess
from pathlib import Path

import imageio_ffmpeg
import jax
import numpy as np
from gallery import FASTER, HEAD, SCENES, SHIPPED, SHIPPED_SPEED, Scene
from PIL import Image, ImageDraw, ImageFont

import neuralgaits as ng
from neuralgaits.simulation.video import FRAMES_PER_S, SIZE
from neuralgaits.workflows.demo import FOLDER as SHIPPED_RUN
from neuralgaits.workflows.demo import TOLD as SHIPPED_SPEED_RUN

FOLDER = Path(__file__).parent
EVERY = {HEAD.name: 2, FASTER.name: 4}
"""Frames of the film for one that is kept; three for the gallery."""
QUALITY = 50
SHIPPED_RUNS = {SHIPPED: SHIPPED_RUN, SHIPPED_SPEED: SHIPPED_SPEED_RUN}


def main() -> None:
    """Make all, or those that are named."""
    parser = argparse.ArgumentParser()
    parser.add_argument("names", nargs="*", help="of scenes; all if none is named")
    parser.add_argument("--scratch", type=Path, required=True, help="folder for runs and films")
    options = parser.parse_args()
    jax.config.update("jax_enable_x64", True)
    for scene in (HEAD, FASTER, *SCENES):
        if scene.name in options.names or not options.names:
            out = save(scene, filmed(scene, options.scratch), options.scratch)
            print(f"{out.name}: {out.stat().st_size // 1000} kB")


def filmed(scene: Scene, scratch: Path) -> Path:
    """The film of a scene, walked if it is not there."""
    film = scratch / f"{scene.name}.mp4"
    if not film.is_file():
        run = trained(scene.robot, scratch)
        asked = dict(scene.asked)
        if scene.speeds:
            asked |= {"commands": commanded(scene, scratch), "log": scratch / f"{scene.name}.csv"}
        done = ng.simulate(run, steps=scene.steps, video=film, **asked)
        print(f"{scene.name}: {done}, {done.summary['fall_reasons'][0] or 'no fall'}")
    return film


def commanded(scene: Scene, scratch: Path) -> Path:
    """The file of a scene's speed commands, one row a step."""
    file = scratch / f"{scene.name}-commands.csv"
    rows = "".join(f"{step},{speed}\n" for step, speed in enumerate(scene.speeds))
    file.write_text(f"step,speed[m/s]\n{rows}", encoding="utf-8")
    return file


def trained(robot: str, scratch: Path) -> Path:
    """A run of a robot, trained if it is not there."""
    run = scratch / "runs" / Path(robot).stem
    if robot in SHIPPED_RUNS and not run.is_dir():
        # A copy: a simulation is kept in its run.
        shutil.copytree(SHIPPED_RUNS[robot], run)
    if not run.is_dir():
        ng.train(ng.load_robot(robot), seed=0, out=run)
    return run


def save(scene: Scene, film: Path, scratch: Path) -> Path:
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
    if scene.speeds:
        speeds = speed_of_frames(scene, scratch)[round(scene.begin * FRAMES_PER_S) :: every]
        for picture, speed in zip(pictures, speeds, strict=False):
            caption(picture, f"requested: {speed:.2f} m/s")
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


def speed_of_frames(scene: Scene, scratch: Path) -> list[float]:
    """The speed commanded of the step that each frame of the film shows [m/s]."""
    with (scratch / f"{scene.name}.csv").open(encoding="utf-8") as file:
        rows = [(float(row["t[s]"]), row["stance[-]"]) for row in csv.DictReader(file)]
    speeds, step, due = [], 0, rows[0][0]
    for (time, leg), (_, before) in zip(rows, [rows[0], *rows], strict=False):
        step += leg != before
        if time >= due - 1e-9:
            speeds.append(scene.speeds[min(step, len(scene.speeds) - 1)])
            due += 1.0 / FRAMES_PER_S
    return speeds


def caption(picture: Image.Image, words: str) -> None:
    """Write words at the top of a picture."""
    draw = ImageDraw.Draw(picture)
    draw.text(
        (8, 14),
        words,
        anchor="lm",
        fill="white",
        stroke_width=2,
        stroke_fill="black",
        font=ImageFont.load_default(size=18),
    )


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
