"""A robot in MuJoCo, stepped tick by tick with torques from outside; environments drive it.

It uses plain NumPy. A tick and its thresholds are those of `simulate`: 1 ms, two MuJoCo steps,
the same touchdowns, falls, pushes and floors.
"""

from collections import deque
from collections.abc import Callable

import mujoco
import numpy as np
from numpy.typing import ArrayLike

from neuralgaits._types import Float
from neuralgaits.control.measurement import SensedRobot, leg_joints
from neuralgaits.control.touchdown import TouchdownThresholds, touches_down
from neuralgaits.robots.mjcf_state import Sensors
from neuralgaits.simulation.setup.plant import PERIOD_S, SUBSTEPS, Plant, rolling_foot
from neuralgaits.simulation.setup.push import Push
from neuralgaits.simulation.setup.streams import Stream, generator
from neuralgaits.simulation.setup.uneven_floor import UnevenFloor
from neuralgaits.simulation.ticks.falls import ENDLESS, Ending, ending

Joints = Float[np.ndarray, " m"]
Torques = Callable[[Joints, Joints], Joints]
"""Function from measured joint angles and rates (rad, rad/s) to torques (N m). All [m]."""


class Body:
    """A simulated robot, its stance leg and the work it has done.

    Joints are in the order leg 0 from the lowest up, then leg 1; the single hip of a robot without
    a torso appears once. Angles have the signs of the theory.

    Attributes:
        plant: the current plant.
        data: MuJoCo's state.
        leg: stance leg, 0 or 1.
        since: time since the last touchdown, or since the start [s].
        steps: touchdowns so far.
        weight: weight of the robot [N].
        work: mechanical work so far, the integral of sum |torque rate| [J].
    """

    def __init__(self, robot: SensedRobot, plant: Plant):
        """Compile the plant; `stand` puts the robot onto a leg."""
        self._robot = robot
        self._stance = TouchdownThresholds()
        self.weight = float(robot.mass * robot.gravity)
        # Once each: the hip of a robot without a torso is in the rows of both legs.
        actuators = plant.state_map.actuators.ravel()
        self._motor_order = np.sort(np.unique(actuators, return_index=True)[1])
        by_leg = leg_joints(robot.layout, np.arange(robot.n - 1.0), np.asarray(0))
        self._order = np.asarray(by_leg).ravel()[self._motor_order].astype(int)
        self._rng = np.random.default_rng(0)
        self._take(plant)

    def _take(self, plant: Plant) -> None:
        self.plant, state_map = plant, plant.state_map
        self.data = mujoco.MjData(plant.model)
        self._addresses = state_map.joints.ravel()[self._motor_order]
        self._motors = state_map.actuators.ravel()[self._motor_order]
        self._signs = np.array(state_map.layout.leg_joint_signs).ravel()[self._motor_order]
        self._offsets = np.array(state_map.layout.leg_joint_offsets).ravel()[self._motor_order]
        self._gears = np.array(state_map.layout.gears).ravel()[self._motor_order]
        self.limit = self.by_joint(np.minimum(self._robot.torque_limit, plant.torque_limit))
        self._feet = [plant.model.geom(name).id for name in state_map.layout.feet]
        self._touch = [int(plant.model.sensor(f"_touch_{leg}").adr[0]) for leg in (0, 1)]

    @property
    def joints(self) -> int:
        """Return the number of motors, m."""
        return len(self._motor_order)

    def by_joint(self, actuated: ArrayLike) -> Joints:
        """Reorder the actuated coordinates of a robot on leg 0 into the order of the joints."""
        return np.asarray(actuated)[self._order]

    def stand(
        self,
        plant: Plant,
        q: Float[np.ndarray, " n"],
        dq: Float[np.ndarray, " n"],
        leg: int,
        *,
        push: float,
        seed: int,
    ) -> None:
        """Restart on one leg, its foot rolling on the floor at x = 0.

        Args:
            plant: the disturbed robot.
            q: coordinates (rad). [n]
            dq: rates (rad/s). [n]
            leg: stance leg.
            push: forward impulse of the single push, see `simulation.setup.push` (N s).
            seed: seed of pushes, floors and sensor noise.
        """
        if plant is not self.plant:
            self._take(plant)
        mujoco.mj_resetData(plant.model, self.data)
        lift = float(plant.robot.foot_radius) * np.hypot(1.0, plant.slope)
        foot, rolling = (0.0, float(lift)), rolling_foot(plant.robot, dq)
        self.data.qpos[:], self.data.qvel[:] = plant.state_map.to_mjcf(q, dq, leg, foot, rolling)
        mujoco.mj_forward(plant.model, self.data)
        disturbance = plant.disturbance
        self._rng = generator(seed, 0, Stream.NOISE)
        self._push = Push(push, ENDLESS, seed, 1)
        self._terrain = UnevenFloor(disturbance.floor_height, seed, 1)
        self._waiting = deque([np.zeros(self.joints)] * plant.delay_ticks)
        self.leg = leg
        self.steps = 0
        self.since = 0.0
        self.work = 0.0
        self._landed = False

    def tick(self, torques: Torques) -> bool:
        """Advance by one tick. Returns: whether the swing foot touched down."""
        data, plant = self.data, self.plant
        demand = torques(*self._measured_joints())
        torque = np.minimum(np.maximum(demand, -self.limit), self.limit)
        self._waiting.append(torque)
        torque = self._waiting.popleft()
        data.ctrl[self._motors] = torque / self._gears
        if self._push.force:
            force = self._push.at(data.time, np.array([self._landed]), np.array([self.steps]))
            data.qfrc_applied[plant.state_map.root[0]] = force[0]
        rates = self._signs * data.qvel[self._addresses]
        # As in `simulate`, where every tick is a rollout of its own: the same walk to a bit.
        data.qacc_warmstart[:] = 0.0
        mujoco.mj_step(plant.model, data, SUBSTEPS)
        self.work += PERIOD_S * float(np.abs(torque) @ np.abs(rates))
        self.since += PERIOD_S
        self._landed = self._touched_down()
        if self._landed:
            self.leg = 1 - self.leg
            self.since = 0.0
            self.steps = self.steps + 1
        if self._terrain.uneven:
            self._lay()
        return self._landed

    def _touched_down(self) -> bool:
        """Return whether the swing foot touched down, by the rules of `control.touchdown`."""
        data = self.data
        config = self._stance
        swing = 1 - self.leg
        force = data.sensordata[self._touch[swing]]
        if not force:
            # In the air, as in most ticks.
            return False
        ahead = data.geom_xpos[self._feet[swing]][0] - data.geom_xpos[self._feet[self.leg]][0]
        unlocked = not self.steps or self.since >= config.lockout_s
        return bool(touches_down(config, self._robot, force, ahead, unlocked))

    def _lay(self) -> None:
        """Move the floor under the swing foot to its next level, when one is due."""
        stance, swing = (self.data.geom_xpos[self._feet[leg]] for leg in (self.leg, 1 - self.leg))
        across = swing - stance
        changed = self._terrain.advance(
            np.array([self._landed]),
            np.array([self.leg]),
            np.array([self.hip[0] - stance[0]]),
            np.array([across[2] - self.plant.slope * across[0]]),
        )
        if changed:
            positions = self.plant.floor_positions(self._terrain.levels)
            self.data.mocap_pos[:] = positions.reshape(-1, 3)

    @property
    def _sensors(self) -> Sensors:
        return self.plant.state_map.sensors(self.data.qpos, self.data.qvel)

    @property
    def hip(self) -> Float[np.ndarray, "2"]:
        """Return the position of the hip in the world, (x, z) (m). [2]."""
        sensors, layout = self._sensors, self.plant.state_map.layout
        return sensors.base + layout.hip_arm(sensors.pitch - layout.root_angle, np)[0]

    @property
    def pitch(self) -> float:
        """Return the angle of the root link, without noise (rad)."""
        return float(self._sensors.pitch)

    def _measured_joints(self) -> tuple[Joints, Joints]:
        angles = self._signs * self.data.qpos[self._addresses] + self._offsets
        rates = self._signs * self.data.qvel[self._addresses]
        return self._measured(angles), self._measured_rates(rates)

    def _measured(self, angles: np.ndarray) -> np.ndarray:
        disturbance = self.plant.disturbance
        if disturbance.encoder_noise:
            draws = self._rng.standard_normal(angles.shape)
            angles = angles + disturbance.encoder_noise * draws
        if disturbance.encoder_step:
            angles = disturbance.encoder_step * np.round(angles / disturbance.encoder_step)
        return angles

    def _measured_rates(self, rates: np.ndarray) -> np.ndarray:
        deviation = self.plant.disturbance.rate_noise
        return rates + deviation * self._rng.standard_normal(rates.shape) if deviation else rates

    def measured(self) -> Float[np.ndarray, " s"]:
        """Return the readings of the robot's sensors.

        Returns: pitch and its rate (rad, rad/s); joint angles [m], rates [m]; velocity of the hip,
        (x, z) (m/s); normal force on foot 0 and 1 in weights. [2 m + 6]
        """
        sensors = self._sensors
        layout = self.plant.state_map.layout
        arm_slope = layout.hip_arm(sensors.pitch - layout.root_angle, np)[1]
        angles, rates = self._measured_joints()
        return np.concatenate(
            [
                self._measured(np.atleast_1d(sensors.pitch)),
                self._measured_rates(np.atleast_1d(sensors.dpitch)),
                angles,
                rates,
                sensors.base_velocity + arm_slope * sensors.dpitch,
                self.data.sensordata[self._touch] / self.weight,
            ]
        )

    def ending(self) -> Ending:
        """Return how the walk ended, if it did, by the rules of `simulation.ticks.falls`."""
        states = (self.data.qpos, self.data.qvel)
        # MuJoCo puts a state that diverged back to its file's and counts that.
        diverged = self.data.warning.number.any()
        hip = self.hip
        floor = self._terrain.levels[0, self.leg] + self.plant.slope * hip[0]
        reason = ending(
            self._robot,
            hip_height=hip[1] - floor,
            pitch=self.pitch,
            since_touchdown=self.since,
            steps_left=ENDLESS,
            in_gap=False,
            finite=not diverged and all(np.isfinite(s).all() for s in states),
            xp=np,
        )
        return Ending(int(reason))
