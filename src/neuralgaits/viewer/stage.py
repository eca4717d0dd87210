"""The scene: robot, floor or blocks, and push.

The robot stays in the middle and the ground moves under it, down as the robot climbs. So the
visitor controls the camera.
"""

import mujoco
import numpy as np
import viser
from mjviser import ViserMujocoScene

from neuralgaits.robots.layout import MjcfLayout
from neuralgaits.robots.link_rods import bones
from neuralgaits.viewer.blocks import Blocks
from neuralgaits.viewer.framing import Framing
from neuralgaits.viewer.push_arrow import PushArrow
from neuralgaits.viewer.scenery import add_ground, lay_floor
from neuralgaits.viewer.walker import WalkFrame


class Stage:
    """Robot, ground and push in the scene."""

    def __init__(self, server: viser.ViserServer, layout: MjcfLayout):
        """Put the robot on the floor of the scene."""
        self._server = server
        self._model = _alone(layout)
        self._data = mujoco.MjData(self._model)
        self._floor = add_ground(server)
        self._robot = ViserMujocoScene(server, self._model, 1)
        self._robot.camera_tracking_enabled = False
        self._blocks = Blocks(server)
        self._arrow = PushArrow(server)
        self._fallen, self._laps = False, 0
        # A torso as long as the thigh, and steps as long as the leg.
        Framing(2.1 * layout.leg_length, 1.6 * layout.leg_length).follow(server)

    def show(self, shown: WalkFrame) -> None:
        """Move everything to a moment of the walk."""
        if (self._fallen and shown.fall is None) or len(shown.laps) != self._laps:
            # Put back by itself: nobody said so.
            self.restart()
        self._fallen, self._laps = shown.fall is not None, len(shown.laps)
        x = float(shown.hip[0])
        ground = shown.ground
        with self._server.atomic():
            self._show_robot(shown, x, ground)
            # Through the origin, with its lines fixed to the ground.
            self._floor.visible = shown.tops is None
            lay_floor(self._floor, shown.slope, x)
            self._blocks.show(shown.tops, x, ground)
            self._show_push(shown, ground)
        self._server.flush()

    def restart(self) -> None:
        """Hide a push after the robot was moved; call it in the thread that calls `show`."""
        self._arrow.hide()

    def _show_robot(self, shown: WalkFrame, x: float, ground: float) -> None:
        self._data.qpos[:] = shown.qpos
        mujoco.mj_kinematics(self._model, self._data)
        moved = self._data.xpos - np.array([x, 0.0, ground])
        turned = self._data.xmat.reshape(1, -1, 3, 3)
        self._robot.update_from_arrays(moved[None], turned)

    def _show_push(self, shown: WalkFrame, ground: float) -> None:
        # In front of the robot, lest its body hide it.
        place = np.array([0.0, -0.16, shown.hip[1] - ground])
        self._arrow.show(place, np.array([shown.force[0], 0.0, shown.force[1]]), shown.time)


def _alone(layout: MjcfLayout):
    """Return the robot's model without its floor: the page has a floor of its own."""
    spec = mujoco.MjSpec.from_string(layout.xml)
    for geom in list(spec.geoms):
        if geom.type == mujoco.mjtGeom.mjGEOM_PLANE:
            spec.delete(geom)
    drawn = bones(spec.compile(), layout)
    bodies = {body.id: body for body in spec.bodies}
    for bone in drawn:
        bodies[bone.body].add_geom(
            type=mujoco.mjtGeom.mjGEOM_CAPSULE,
            fromto=bone.ends.ravel(),
            size=[bone.radius, 0.0, 0.0],
            rgba=bone.colour,
            mass=0.0,
        )
    return spec.compile()
