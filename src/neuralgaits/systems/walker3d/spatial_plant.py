"""Many bipeds in MuJoCo at once, seen by a law as robots on their right foot."""

from dataclasses import dataclass, field
from typing import NamedTuple

import jax
import jax.numpy as jnp
import mujoco
import numpy as np

from neuralgaits._quick_jit import quick_jit
from neuralgaits._types import Array, Bool, Float
from neuralgaits.robots.mjcf.model_contents import at_zero
from neuralgaits.simulation.live_floor import Floor
from neuralgaits.simulation.setup.uneven_floor import UnevenFloor
from neuralgaits.systems.walker3d.free_yaw import along_heading
from neuralgaits.systems.walker3d.spatial_changes import TICK_S, SpatialChanges
from neuralgaits.systems.walker3d.spatial_gait import SpatialGait
from neuralgaits.systems.walker3d.spatial_ground import (
    SpatialGround,
    disturbed_model,
    plant_tree,
    slope_of,
    terrain_under,
)
from neuralgaits.systems.walker3d.spatial_impact import SIGNS, SWAPPED
from neuralgaits.systems.walker3d.spatial_laws import Measured, exact_reading, hips_of
from neuralgaits.systems.walker3d.spatial_mjcf import SpatialRobot
from neuralgaits.systems.walker3d.spatial_motion import UP
from neuralgaits.systems.walker3d.spatial_policy import SpatialPolicy
from neuralgaits.systems.walker3d.spatial_pose import MIRROR
from neuralgaits.systems.walker3d.spatial_tree import SpatialTree
from neuralgaits.systems.walker3d.spatial_walker import SpatialWalker


def reflected(found: Measured, left: Array) -> Measured:
    """Return readings of robots with those on their left foot reflected, legs swapped. [N, ...]."""
    joints, rates, velocity = map(np.asarray, found)
    on_left = left[:, None]
    return Measured(
        jnp.asarray(np.where(on_left, SIGNS * joints[:, SWAPPED], joints)),
        jnp.asarray(np.where(on_left, SIGNS * rates[:, SWAPPED], rates)),
        jnp.asarray(np.where(on_left, velocity * MIRROR, velocity)),
    )


LOWEST_HIPS = 0.7
"""Height of a hip below which a robot has fallen, in legs: the shipped robot's gait has 0.93."""
LARGEST_LEAN = 0.5
"""Roll or pitch of a torso that has fallen [rad]: the shipped robot's gait has up to 0.31."""


class Standing(NamedTuple):
    """A robot on its right foot, or many of them.

    Attributes:
        joints, rates: angles and rates in the order of `JOINTS` [rad], [rad/s]. [8], [8]
        place, velocity: of the middle of the hips, the stance foot at the origin [m], [m/s].
    """

    joints: Float[Array, "*rows 8"]
    rates: Float[Array, "*rows 8"]
    place: Float[Array, "*rows 3"]
    velocity: Float[Array, "*rows 3"]


def standing(robot: SpatialWalker, policy: SpatialPolicy, z: Float[Array, "4"]) -> Standing:
    """Return the robot in a state of the zero dynamics, with exact outputs."""
    reading = exact_reading(robot, policy, z)
    place = hips_of(robot, reading.joints)[1]
    return Standing(reading.joints, reading.rates, place, reading.velocity)


@dataclass
class SpatialPlants:
    """Plants of many walks.

    Attributes:
        robot: the file.
        changes: changes of the robot, its motors and sensors.
        model: MuJoCo's.
        tree: where the robot's parts are in it.
        worlds: one a walk.
        left: whether each stands on its left foot.
        terrain: levels of the floor under each foot.
        slope: rise of the floor per metre forward.
        first: where the root's slide forward starts [m]. [N]
    """

    robot: SpatialRobot
    changes: SpatialChanges
    model: mujoco.MjModel
    tree: SpatialTree
    worlds: list[mujoco.MjData]
    left: Array
    terrain: UnevenFloor
    slope: float
    first: Array = field(default_factory=lambda: np.zeros(0))

    @classmethod
    def started(
        cls,
        robot: SpatialRobot,
        gait: SpatialGait,
        states: Array,
        changes: SpatialChanges | None = None,
        seed: int = 0,
    ) -> "SpatialPlants":
        """Put robots on the floor in states of the zero dynamics, with exact outputs.

        Args:
            robot: the file.
            gait: gait whose outputs they have.
            states: on the right foot. [N, 4]
            changes: changes of the plant; none if None.
            seed: seed of the floor's random steps.
        """
        changes = SpatialChanges() if changes is None else changes
        length = float(gait.policy.ends[1] - gait.policy.ends[0])
        plants = cls.in_the_air(robot, len(states), length, changes, seed)
        stand = quick_jit(jax.vmap(lambda z: standing(robot.walker, gait.policy, z)))
        plants.put(stand(jnp.asarray(states)))
        return plants

    @classmethod
    def in_the_air(
        cls, robot: SpatialRobot, count: int, length: float, changes: SpatialChanges, seed: int
    ) -> "SpatialPlants":
        """Return so many robots that are to be put on a floor, for steps of this length [m]."""
        model = disturbed_model(robot, changes)
        terrain = terrain_under(changes, count, seed, -length)
        worlds = [mujoco.MjData(model) for _ in range(count)]
        left = np.zeros(count, bool)
        tree = plant_tree(robot, changes)
        return cls(robot, changes, model, tree, worlds, left, terrain, slope_of(changes))

    def put(self, standing: Standing) -> None:
        """Put the robots on the floor where walks start. Fields of `standing` have N rows."""
        rest = at_zero(self.model)
        hips = [rest.xanchor[leg[0]] for leg in self.tree.joints]
        base = 0.5 * (hips[0] + hips[1])
        height = self.radius * np.hypot(1.0, self.slope)
        rows, at = map(np.asarray, standing), self.tree.coordinates
        for world, q, dq, place, speed in zip(self.worlds, *rows, strict=True):
            world.qpos[:] = world.qvel[:] = 0.0
            world.qpos[at] = np.concatenate([place - base + height * UP, q])
            world.qvel[at] = np.concatenate([speed, dq])
        self.lay_floors()
        for one in range(len(self.worlds)):
            self.settle(one)
        self.first = np.array([world.qpos[0] for world in self.worlds])

    def change(self, changes: SpatialChanges) -> None:
        """Go on in a plant that is compiled anew; the floor stays as it lies."""
        self.changes, self.model = changes, disturbed_model(self.robot, changes)
        for number, last in enumerate(self.worlds):
            world = mujoco.MjData(self.model)
            world.time = last.time
            for name in ("qpos", "qvel", "ctrl", "mocap_pos", "mocap_quat"):
                getattr(world, name)[:] = getattr(last, name)
            self.worlds[number] = world
            self.settle(number)

    def turn_floor(self, floor: Floor) -> None:
        """Put both planes of every robot into this one."""
        self.slope, self.terrain.levels[:] = floor.slope, floor.level
        for world in self.worlds:
            world.mocap_quat[:2] = floor.quaternion
        self.lay_floors()

    def times(self) -> Float[np.ndarray, " N"]:
        """Return the time of each world [s]."""
        return np.array([world.time for world in self.worlds])

    @property
    def ticks(self) -> int:
        """Steps of MuJoCo from one tick of the controller to the next."""
        return max(1, round(TICK_S / self.model.opt.timestep))

    @property
    def limits(self) -> Float[np.ndarray, "6"]:
        """Return the torque limits of the motors, stance leg first or not [N m]."""
        own = self.robot.walker.limits
        most = self.changes.torque_limit
        return own if most is None else np.minimum(own, most)

    def readings(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return joints, rates and velocity of the hips as they are: [N, 8], [N, 8], [N, 3].

        The velocity is forward, to the left and up of the robot, wherever it heads.
        """
        at = self.tree.coordinates
        q = np.array([world.qpos[at[3:]] for world in self.worlds])
        dq = np.array([world.qvel[at] for world in self.worlds])
        return q, dq[:, 3:], along_heading(dq[:, :3], self.yaws())

    def yaws(self) -> Float[np.ndarray, " N"]:
        """Return where robots head, from the x axis to the left [rad]; 0 with the yaw held."""
        if self.tree.yaw is None:
            return np.zeros(len(self.worlds))
        return np.array([world.qpos[self.tree.yaw] for world in self.worlds])

    def measured(self) -> Measured:
        """Return what exact sensors say, reflected where a robot stands on its left foot."""
        return reflected(Measured(*self.readings()), self.left)

    @property
    def ground(self) -> SpatialGround:
        """Return the floor under the feet."""
        return SpatialGround(self.slope, self.terrain.levels)

    def lay_floors(self) -> None:
        """Put the planes under the feet at their levels."""
        for world, levels in zip(self.worlds, self.terrain.levels, strict=True):
            world.mocap_pos[:2, 2] = levels

    def advance_floors(self, touch: Bool[np.ndarray, " N"], ahead: Float[np.ndarray, " N"]) -> None:
        """Move the floors on whose levels the robots will step.

        Args:
            touch: whether each has a touchdown at this tick. [N]
            ahead: the stance hip's place ahead of the stance foot [m].
        """
        if not self.terrain.uneven:
            return
        stance = np.asarray(self.left, dtype=int)
        feet = [self.foot_places(foot) for foot in (stance, 1 - stance)]
        reach = feet[1] - feet[0]
        clearance = reach[:, 2] - self.slope * reach[:, 0]
        if self.terrain.advance(touch, stance, ahead, clearance):
            self.lay_floors()

    def foot_places(self, foot: Array) -> Float[np.ndarray, "N 3"]:
        """Return the middle of a foot of each robot, 0 the right one [m]."""
        geoms = np.array(self.tree.feet)[foot]
        return np.array([w.geom_xpos[g] for w, g in zip(self.worlds, geoms, strict=True)])

    def landed(self) -> Array:
        """Return whether the swing foot of each robot touches the floor. [N]."""
        swing = 1 - self.left.astype(int)
        places, ground = self.foot_places(swing), self.ground
        return ground.touched(places[:, 2] - ground.under(swing, places[:, 0]), self.radius)

    @property
    def radius(self) -> float:
        """Radius of a foot [m]."""
        return float(self.model.geom_size[self.tree.feet[0], 0])

    def touching(self, one: int) -> tuple[bool, bool]:
        """Return whether the right and the left foot of a robot touch the floor."""
        places = self.worlds[one].geom_xpos[list(self.tree.feet)]
        heights = places[:, 2] - self.terrain.levels[one] - self.slope * places[:, 0]
        right, left = self.ground.touched(heights, self.radius)
        return bool(right), bool(left)

    def hips(self, one: int) -> Float[np.ndarray, "3"]:
        """Return the middle of the hips [m]."""
        return np.mean([self.worlds[one].xanchor[leg[0]] for leg in self.tree.joints], axis=0)

    def settle(self, one: int) -> None:
        """Compute what follows from positions and rates that were set."""
        mujoco.mj_forward(self.model, self.worlds[one])

    def own(self, torques: Float[np.ndarray, "N 6"]) -> Float[np.ndarray, "N 6"]:
        """Return torques of the motors, right leg first, of those of stance and swing leg."""
        return np.where(self.left[:, None], SIGNS[2:] * torques[:, SWAPPED[2:] - 2], torques)

    def drive(self, one: int, own: Float[np.ndarray, "6"], push: Float[np.ndarray, "2"]) -> None:
        """Hold torques of the motors, right leg first, and a push, for a tick."""
        world, model = self.worlds[one], self.model
        motors = np.concatenate(self.tree.motors)
        gains = model.actuator_gear[motors, 0] * model.actuator_gainprm[motors, 0]
        world.ctrl[motors] = np.clip(
            own / gains, model.actuator_ctrlrange[motors, 0], model.actuator_ctrlrange[motors, 1]
        )
        world.xfrc_applied[self.tree.bodies[0], :2] = push
        for _ in range(self.ticks):
            mujoco.mj_step(model, world)

    def fallen(self, one: int) -> bool:
        """Return whether a robot has fallen: low hips, a leaning torso, or no finite state."""
        walker, world = self.robot.walker, self.worlds[one]
        foot = int(self.left[one])
        place = self.tree.joints[foot][0]
        floor = self.terrain.levels[one, foot] + self.slope * world.xanchor[place, 0]
        heights = [world.xanchor[leg[0], 2] - floor for leg in self.tree.joints]
        low = LOWEST_HIPS * (walker.thigh.length + walker.shin.length)
        lean = world.qpos[list(self.tree.root[3:])]
        upright = np.all(np.isfinite(world.qpos)) and np.abs(lean).max() < LARGEST_LEAN
        return not upright or min(heights) < low
