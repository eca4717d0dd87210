"""The scene of a biped's live page: robot, floor, footprints and push, to be turned by a visitor.

The robot stays in the middle and the floor moves under it. Aside the scene follows slowly, so that
one sees the robot give way to a push.
"""

import math

import mujoco
import numpy as np
import viser
from mjviser import ViserMujocoScene

from neuralgaits.robots.mjcf.model_contents import at_zero
from neuralgaits.systems.walker3d.live_moment import SpatialMoment
from neuralgaits.systems.walker3d.spatial_mjcf import SpatialRobot
from neuralgaits.viewer.framing import Direction, Framing
from neuralgaits.viewer.push_arrow import PushArrow
from neuralgaits.viewer.scenery import add_ground, lay_floor

VIEWS: dict[str, Direction] = {
    "turned": (0.6, -0.85, 0.3),
    "side": (0.0, -1.0, 0.06),
    "front": (1.0, 0.0, 0.06),
    "above": (-0.02, 0.0, 1.0),
}
"""Where a visitor may look from; the first is where everybody begins."""
RIGHT, LEFT = (26, 99, 184), (222, 120, 32)
"""Colours of the right and of the left leg, and of their footprints [RGB]."""


class SpatialStage:
    """Robot, floor, footprints and push in the scene."""

    def __init__(self, server: viser.ViserServer, robot: SpatialRobot):
        """Put the robot into the scene."""
        self._server = server
        self._model = _alone(robot)
        self._data = mujoco.MjData(self._model)
        self._floor = add_ground(server)
        self._robot = ViserMujocoScene(server, self._model, 1)
        self._robot.camera_tracking_enabled = False
        self._ground = server.scene.add_frame("/ground", show_axes=False)
        self._prints = server.scene.add_point_cloud(
            "/ground/prints",
            np.zeros((1, 3), dtype=np.float32),
            RIGHT,
            point_size=0.03,
            point_shape="circle",
            visible=False,
        )
        self._arrow = PushArrow(server)
        self._aside = 0.0
        self._time = 0.0
        self._count = 0
        leg = robot.walker.thigh.length + robot.walker.shin.length
        self._chest = robot.walker.torso_centre[1]
        self.framing = Framing(2.0 * leg, 2.4 * leg, VIEWS["turned"])
        self.framing.follow(server)

    def restart(self) -> None:
        """Hide a push after the robot was moved; call it in the thread that calls `show`."""
        self._arrow.hide()
        self._aside = math.nan

    def look(self, client: viser.ClientHandle, view: str) -> None:
        """Let a visitor look from one of `VIEWS`."""
        camera = client.camera
        framing = Framing(self.framing.top, self.framing.wide, VIEWS[view])
        pose = framing.of_window(camera.image_width, camera.image_height)
        with client.atomic():
            camera.position, camera.look_at = pose
            camera.up_direction = (0.0, 0.0, 1.0)

    def show(self, shown: SpatialMoment) -> None:
        """Move everything to a moment of the walk."""
        x, y = self._middle(shown)
        self._data.qpos[:] = shown.qpos
        mujoco.mj_kinematics(self._model, self._data)
        moved = self._data.xpos - np.array([x, y, shown.ground])
        with self._server.atomic():
            self._robot.update_from_arrays(moved[None], self._data.xmat.reshape(1, -1, 3, 3))
            lay_floor(self._floor, shown.slope, x, y)
            self._ground.position = (-x, -y, -shown.ground)
            self._show_prints(shown)
            place = np.array([0.0, shown.hips[1] - y, shown.hips[2] - shown.ground + self._chest])
            self._arrow.show(place, shown.force, shown.time)
        self._server.flush()

    def _middle(self, shown: SpatialMoment) -> tuple[float, float]:
        """Return the place of the floor in the scene's middle [m]."""
        x, y = float(shown.hips[0]), float(shown.hips[1])
        follows_s = 1.5  # Time constant with which the scene follows the robot aside [s].
        share = 1.0 - math.exp(-max(0.0, shown.time - self._time) / follows_s)
        self._time = shown.time
        self._aside = y if math.isnan(self._aside) else self._aside + share * (y - self._aside)
        return x, self._aside

    def _show_prints(self, shown: SpatialMoment) -> None:
        # Points are slow to redraw.
        if len(shown.prints) + shown.steps == self._count:
            return
        self._count = len(shown.prints) + shown.steps
        points = [(one.x, one.y, one.z + 0.004) for one in shown.prints]
        self._prints.points = np.array(points, dtype=np.float32)
        colors = [LEFT if one.left else RIGHT for one in shown.prints]
        self._prints.colors = np.array(colors, dtype=np.uint8)
        self._prints.visible = True


def _alone(robot: SpatialRobot) -> mujoco.MjModel:
    """Return the robot's model without its floor, with rods where the file has no shapes."""
    spec = mujoco.MjSpec.from_string(robot.text)
    for geom in list(spec.geoms):
        if geom.type == mujoco.mjtGeom.mjGEOM_PLANE:
            spec.delete(geom)
    if len(list(spec.geoms)) <= len(robot.tree.feet):
        _add_rods(spec, robot)
    model = spec.compile()
    _paint(model, robot)
    return model


def _paint(model: mujoco.MjModel, robot: SpatialRobot) -> None:
    """Give each leg a colour of its own, and the torso a third one, whatever the file has."""
    bodies = robot.tree.bodies
    colours = {bodies[0]: (120, 128, 138)} | dict.fromkeys(bodies[1:3], RIGHT)
    colours |= dict.fromkeys(bodies[3:5], LEFT)
    for geom in range(model.ngeom):
        body = int(model.body_weldid[model.geom_bodyid[geom]])
        if body in colours:
            model.geom_matid[geom] = -1
            model.geom_rgba[geom] = (*np.array(colours[body]) / 255.0, 1.0)


def _add_rods(spec: mujoco.MjSpec, robot: SpatialRobot) -> None:
    """Add rods along the links, from joint to joint."""
    walker, bodies = robot.walker, {body.id: body for body in spec.bodies}
    model = spec.compile()
    data = at_zero(model)
    hips = [data.xanchor[leg[0]] for leg in robot.tree.joints]
    top = 0.5 * (hips[0] + hips[1]) + np.array([0.0, 0.0, 2.0 * walker.torso_centre[1]])
    rods = [(robot.tree.bodies[0], hips[0], hips[1]), (robot.tree.bodies[0], sum(hips) / 2.0, top)]
    for side, leg in enumerate(robot.tree.joints):
        knee, foot = data.xanchor[leg[2]], data.geom_xpos[robot.tree.feet[side]]
        thigh, shin = robot.tree.bodies[1 + 2 * side : 3 + 2 * side]
        rods += [(thigh, hips[side], knee), (shin, knee, foot)]
    for body, *ends in rods:
        turn = data.xmat[body].reshape(3, 3)
        local = [(end - data.xpos[body]) @ turn for end in ends]
        bodies[body].add_geom(
            type=mujoco.mjtGeom.mjGEOM_CAPSULE,
            fromto=np.ravel(local),
            size=[0.05 * walker.thigh.length, 0.0, 0.0],
            rgba=(0.25, 0.4, 0.65, 1.0),
            mass=0.0,
        )
