"""Many bipeds in MuJoCo at once, seen by a law as robots on their right foot."""

# pyright: reportAttributeAccessIssue=false
# MuJoCo ships no type stubs.

from dataclasses import dataclass

import jax
import jax.numpy as jnp
import mujoco
import numpy as np

from neuralgaits._quick_jit import quick_jit
from neuralgaits._types import Array, Float
from neuralgaits.robots.mjcf.compiled import compile_text
from neuralgaits.systems.walker3d.spatial_dynamics import flow
from neuralgaits.systems.walker3d.spatial_gait import SpatialGait
from neuralgaits.systems.walker3d.spatial_impact import SIGNS, SWAPPED
from neuralgaits.systems.walker3d.spatial_laws import Measured, hips_of
from neuralgaits.systems.walker3d.spatial_mjcf import SpatialRobot
from neuralgaits.systems.walker3d.spatial_motion import UP
from neuralgaits.systems.walker3d.spatial_pose import MIRROR, joints_of_pose

TICK_S = 0.001
"""Time between two ticks of the controller."""


@dataclass
class SpatialPlants:
    """Plants of many walks.

    Attributes:
        robot: the file.
        model: MuJoCo's.
        worlds: one a walk.
        left: whether each stands on its left foot.
        first: where the root's slide forward starts [m]. [N]
    """

    robot: SpatialRobot
    model: mujoco.MjModel
    worlds: list[mujoco.MjData]
    left: Array
    first: Array

    @classmethod
    def started(cls, robot: SpatialRobot, gait: SpatialGait, states: Array) -> "SpatialPlants":
        """Put robots on the floor in states of the zero dynamics, with exact outputs. [N, 4]."""
        model = compile_text(robot.text, robot.walker.name)
        radius = float(model.geom_size[robot.tree.feet[0], 0])

        def full(z: Array) -> tuple[Array, Array, Array, Array]:
            now = flow(robot.walker, gait.policy, z)
            q = joints_of_pose(robot.walker, now.pose)
            place, speed = jax.jvp(lambda a: hips_of(robot.walker, a)[1], (q,), (now.joints,))
            return q, now.joints, place, speed

        found = quick_jit(jax.vmap(full))(jnp.asarray(states))
        plants = cls(robot, model, [], np.zeros(len(states), bool), np.zeros(0))
        rest = mujoco.MjData(model)
        rest.qpos[:] = 0.0
        mujoco.mj_kinematics(model, rest)
        hips = [rest.xanchor[leg[0]] for leg in robot.tree.joints]
        base = 0.5 * (hips[0] + hips[1])
        for q, dq, place, speed in zip(*map(np.asarray, found), strict=True):
            world = mujoco.MjData(model)
            world.qpos[:3], world.qpos[3:] = place - base + radius * UP, q
            world.qvel[:3], world.qvel[3:] = speed, dq
            mujoco.mj_forward(model, world)
            plants.worlds.append(world)
        plants.first = np.array([world.qpos[0] for world in plants.worlds])
        return plants

    def times(self) -> Float[np.ndarray, " N"]:
        """Return the time of each world [s]."""
        return np.array([world.time for world in self.worlds])

    @property
    def ticks(self) -> int:
        """Steps of MuJoCo from one tick of the controller to the next."""
        return max(1, round(TICK_S / self.model.opt.timestep))

    def measured(self) -> Measured:
        """Return what the sensors say, reflected where a robot stands on its left foot."""
        q = np.array([world.qpos[3:] for world in self.worlds])
        dq = np.array([world.qvel[3:] for world in self.worlds])
        velocity = np.array([world.qvel[:3] for world in self.worlds])
        left = self.left[:, None]
        return Measured(
            jnp.asarray(np.where(left, SIGNS * q[:, SWAPPED], q)),
            jnp.asarray(np.where(left, SIGNS * dq[:, SWAPPED], dq)),
            jnp.asarray(np.where(left, velocity * MIRROR, velocity)),
        )

    def landed(self) -> Array:
        """Return whether the swing foot of each robot touches the floor. [N]."""
        feet = np.array(self.robot.tree.feet)
        radius = float(self.model.geom_size[feet[0], 0])
        swing = feet[1 - self.left.astype(int)]
        heights = [w.geom_xpos[foot, 2] for w, foot in zip(self.worlds, swing, strict=True)]
        return np.array(heights) <= radius

    def apply(self, one: int, torques: Float[np.ndarray, "6"], push: float) -> None:
        """Hold torques, and a push to the left on the torso [N], until the next tick."""
        world, model = self.worlds[one], self.model
        own = SIGNS[2:] * torques[SWAPPED[2:] - 2] if self.left[one] else torques
        motors = np.concatenate(self.robot.tree.motors)
        gains = model.actuator_gear[motors, 0] * model.actuator_gainprm[motors, 0]
        world.ctrl[motors] = np.clip(
            own / gains, model.actuator_ctrlrange[motors, 0], model.actuator_ctrlrange[motors, 1]
        )
        world.xfrc_applied[self.robot.tree.bodies[0], 1] = push
        for _ in range(self.ticks):
            mujoco.mj_step(model, world)

    def fallen(self, one: int) -> bool:
        """Return whether a robot has fallen: low hips, or a torso that leans aside by half."""
        walker, world = self.robot.walker, self.worlds[one]
        heights = [world.xanchor[leg[0], 2] for leg in self.robot.tree.joints]
        low = 0.7 * (walker.thigh.length + walker.shin.length)
        upright = np.all(np.isfinite(world.qpos)) and np.abs(world.qpos[3:5]).max() < 0.5
        return not upright or min(heights) < low
