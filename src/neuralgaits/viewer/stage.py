"""The scene: robot, floor or blocks, push, and the phase portrait on a board above them.

The robot stays in the middle and the ground moves under it, down as the robot climbs. So the
visitor controls the camera, and the board does not move.
"""

import math
from collections.abc import Callable

import mujoco
import numpy as np
import viser
from mjviser import ViserMujocoScene

from neuralgaits._types import Float
from neuralgaits.robots.constants import MjcfLayout
from neuralgaits.robots.link_rods import bones
from neuralgaits.viewer.blocks import Blocks
from neuralgaits.viewer.framing import Framing
from neuralgaits.viewer.portrait import HEIGHT_PX, WALK, WIDTH_PX, Portrait
from neuralgaits.viewer.push_arrow import RED, PushArrow
from neuralgaits.viewer.scenery import add_ground, lay_floor
from neuralgaits.viewer.walker import WalkFrame


class Stage:
    """Robot, ground, push and board in the scene."""

    def __init__(self, server: viser.ViserServer, layout: MjcfLayout):
        """Put the robot on the floor of the scene."""
        self._server = server
        self._leg = layout.leg_length
        self._model = _alone(layout)
        self._data = mujoco.MjData(self._model)
        self._floor = add_ground(server)
        self._robot = ViserMujocoScene(server, self._model, 1)
        self._robot.camera_tracking_enabled = False
        self._blocks = Blocks(server)
        self._arrow = PushArrow(server)
        self._board: _Board | None = None
        self._fallen, self._laps = False, 0
        board = self._board_width * HEIGHT_PX / WIDTH_PX
        Framing(1.12 * (self._board_bottom + board), 1.1 * self._board_width).follow(server)

    def hang(self, portrait: Portrait, clicked: Callable[[viser.ClientHandle, np.ndarray], None]):
        """Hang the portrait on the board; `clicked` gets the client that clicked and the state."""
        self._board = _Board(self._server, portrait, self._board_width, self._board_bottom, clicked)

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
            if self._board is not None:
                self._board.show(shown.z, shown.trail)
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

    @property
    def _board_width(self) -> float:
        return 2.7 * self._leg

    @property
    def _board_bottom(self) -> float:
        # Above the head of a robot with a torso as long as its thigh.
        return 1.85 * self._leg


class _Board:
    """The portrait in the scene, with the moving point on it."""

    def __init__(
        self,
        server: viser.ViserServer,
        portrait: Portrait,
        width: float,
        bottom: float,
        clicked: Callable[[viser.ClientHandle, np.ndarray], None],
    ):
        self._portrait = portrait
        self._size = np.array([width, width * HEIGHT_PX / WIDTH_PX])
        self._corner = np.array([-0.5 * width, bottom])
        self._count = 0
        middle = self._corner + 0.5 * self._size
        image = server.scene.add_image(
            "/board",
            portrait.draw(),
            *self._size,
            format="png",
            position=(middle[0], 0.0, middle[1]),
            # Picture's x to the right, its y down: it faces a visitor at -y.
            wxyz=(math.sqrt(0.5), -math.sqrt(0.5), 0.0, 0.0),
            cast_shadow=False,
            receive_shadow=False,
        )
        self._line = server.scene.add_line_segments(
            "/trail",
            np.zeros((1, 2, 3), dtype=np.float32),
            (int(WALK[1:3], 16), int(WALK[3:5], 16), int(WALK[5:7], 16)),
            thickness=0.004 * width,
        )
        self._beyond = server.scene.add_label("/beyond", "", visible=False)
        self._point = server.scene.add_icosphere(
            "/point", radius=0.014 * width, color=RED, cast_shadow=False, receive_shadow=False
        )

        @image.on_click
        def _(event: viser.SceneNodePointerEvent) -> None:
            origin, way = np.array(event.ray_origin), np.array(event.ray_direction)
            if abs(way[1]) < 1e-9:
                return
            hit = origin - origin[1] / way[1] * way
            place = (hit[[0, 2]] - self._corner) / self._size
            clicked(event.client, portrait.state(place))

    def show(self, z: Float[np.ndarray, "2"], trail: Float[np.ndarray, "K 2"]) -> None:
        """Move the point to a state, and draw the states before it.

        A state off the board has no point and no line, but a word at the board's edge.
        """
        if np.all(np.isfinite(z)):
            across, out, up = map(float, self._places(self._portrait.clip(z)))
            words = self._portrait.beyond(z)
            self._point.visible = words is None
            self._beyond.visible = words is not None
            if words is None:
                self._point.position = across, out, up
            else:
                self._beyond.text = words
                self._beyond.position = across, out, up
        self._count += 1
        # Lines are slow to redraw.
        if self._count % 4 == 0:
            points = self._places(trail)
            points[~self._portrait.in_view(trail)] = np.nan
            ends = np.stack([points[:-1], points[1:]], axis=1)
            ends = ends[np.isfinite(ends).all(axis=(1, 2))]
            self._line.visible = len(ends) > 0
            if len(ends):
                self._line.points = ends

    def _places(self, z: Float[np.ndarray, "... 2"]) -> Float[np.ndarray, "... 3"]:
        """Return places in the scene, in front of the board, where they can be seen."""
        across, up = np.moveaxis(self._corner + self._portrait.place(z) * self._size, -1, 0)
        return np.stack([across, np.full_like(across, -0.004), up], axis=-1).astype(np.float32)


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
