"""Draw the picture of the README: a step and a half of a trained gait, pose by pose.

    MUJOCO_GL=egl .venv/bin/python docs/images/make_gait.py [RUN] [--out FILE.png]

The gait walks in MuJoCo from the middle of its region. Once it is steady, poses at equal times
are set side by side, further apart than they were walked, so that none hides another.
"""

import argparse
from pathlib import Path

import jax
import mujoco
import numpy as np
from PIL import Image

from neuralgaits.analysis.run import open_run
from neuralgaits.robots import load_robot
from neuralgaits.simulation.setup.plant import Plant
from neuralgaits.simulation.setup.starts import full_states
from neuralgaits.simulation.walk import walk

WIDTH, HEIGHT, FINER = 1200, 400, 2
"""Size of the picture in pixels; it is rendered FINER times larger and scaled down."""
POSES, APART_M = 7, 0.65
"""Poses drawn, and metres between their hips."""
STEADY_STEPS, STEPS_SHOWN = 8, 1.5
VIEW_M, CAMERA_M = 1.56, 14.0
"""Height of the view at the robot, and distance of the camera: far, so all poses look alike."""


def main() -> None:
    """Walk, choose the poses, render, save."""
    parser = argparse.ArgumentParser()
    parser.add_argument("run", nargs="?", default="latest", help="run folder, or latest")
    parser.add_argument("--out", type=Path, default=Path(__file__).with_name("gait.png"))
    options = parser.parse_args()
    jax.config.update("jax_enable_x64", True)
    plant, poses = walked(options.run)
    picture = Image.fromarray(strip(plant, poses)).resize((WIDTH, HEIGHT), Image.Resampling.LANCZOS)
    picture.quantize(256, dither=Image.Dither.FLOYDSTEINBERG).save(options.out, optimize=True)
    print(f"{options.out}: {options.out.stat().st_size // 1000} kB")


def walked(run: str) -> tuple[Plant, np.ndarray]:
    """Walk the run's gait on the robot of today's file. Returns: plant, qpos of the poses."""
    trained = open_run(run)
    steps = STEADY_STEPS + 3
    done = walk(
        trained.robot,
        trained.gait.policy,
        full_states(trained.zero_dynamics, trained.gait, "centre", seed=0, episodes=1),
        plant=load_robot("amber3m"),
        steps=steps,
        record=True,
    )
    states, model = done.episodes.states, done.plant.model
    record = done.episodes.record
    assert record is not None
    touchdowns = np.flatnonzero(record.result.touchdown)
    begin, end = touchdowns[STEADY_STEPS - 2], touchdowns[STEADY_STEPS - 1]
    shown = begin + np.linspace(0.0, STEPS_SHOWN, POSES) * (end - begin)
    return done.plant, states[shown.round().astype(int), 1 : 1 + model.nq]


def strip(plant: Plant, poses: np.ndarray) -> np.ndarray:
    """All poses in one scene, one floor and one light. Returns: [height, width, 3]."""
    model = plant.model
    model.vis.global_.fovy = np.degrees(2.0 * np.arctan(0.5 * VIEW_M / CAMERA_M))
    model.vis.global_.offwidth, model.vis.global_.offheight = WIDTH * FINER, HEIGHT * FINER
    # One light for the whole row.
    model.vis.map.shadowclip = 0.6 * APART_M * len(poses) / model.stat.extent
    option, around = mujoco.MjvOption(), mujoco.MjvPerturb()
    camera = mujoco.MjvCamera()
    camera.lookat[:] = (0.0, 0.0, 0.5 * VIEW_M - 0.11)
    camera.distance, camera.azimuth, camera.elevation = CAMERA_M, 86.0, -4.0
    renderer = mujoco.Renderer(model, height=HEIGHT * FINER, width=WIDTH * FINER)
    places = APART_M * (np.arange(len(poses)) - 0.5 * (len(poses) - 1))
    # The one in the middle comes first: the light follows it.
    for i in np.argsort(np.abs(places)):
        data = mujoco.MjData(model)
        data.qpos[:] = poses[i]
        data.qpos[0] = places[i]
        mujoco.mj_forward(model, data)
        if renderer.scene.ngeom == 0:
            renderer.update_scene(data, camera, option)
            option.geomgroup[0] = False  # The floor is drawn once.
        else:
            moving = mujoco.mjtCatBit.mjCAT_DYNAMIC
            mujoco.mjv_addGeoms(model, data, option, around, moving, renderer.scene)
    return renderer.render()


if __name__ == "__main__":
    main()
