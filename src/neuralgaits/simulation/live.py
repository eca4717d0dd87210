"""Walk one robot until it is stopped; it is pushed, tilted, loaded and moved meanwhile.

Control tick and plant are those of an episode, one tick at a call. Nothing here knows of wall
clocks, threads or screens: time passes only in `tick`.
"""

from collections.abc import Mapping
from dataclasses import replace

import mujoco
import numpy as np

from neuralgaits._types import Float
from neuralgaits.control import Controller
from neuralgaits.errors import InputError
from neuralgaits.simulation.jax_tick import JaxTick
from neuralgaits.simulation.live_commands import LiveCommands
from neuralgaits.simulation.live_floor import Floor
from neuralgaits.simulation.live_push import LivePush
from neuralgaits.simulation.live_tick import LiveTick, MeasuredTick
from neuralgaits.simulation.native.compiled_walk import Library
from neuralgaits.simulation.native_tick import NativeTick
from neuralgaits.simulation.setup.course import Course
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.simulation.setup.live_course import LiveCourse
from neuralgaits.simulation.setup.plant import PERIOD_S, build, rolling_foot
from neuralgaits.simulation.setup.terrain_kinds import Size
from neuralgaits.simulation.ticks.falls import Ending
from neuralgaits.simulation.ticks.tick import TickOutcome, TickRecord

CHANGEABLE = ("friction", "torque_limit", "slope_deg", "mass_scale", "torso_shift_m")
"""Disturbances that may change while the robot walks; on blocks the slope may not."""
_TILT_TICKS = 10
"""Ticks between two small turns of the floor."""


class LiveWalk:
    """A walking robot with all of its disturbances.

    Attributes:
        plant: plant with its present disturbances.
        data: MuJoCo's state of the plant.
        floor: floor under the feet.
        control: its control tick.
        outcome: outcome of the last tick; None before the first.
        laps: touchdowns of each walk to the end of a course, after which it begins again.
    """

    def __init__(
        self,
        controller: Controller,
        start: Float[np.ndarray, " two_n"],
        *,
        library: Library | None = None,
        ground: LiveCourse | None = None,
    ):
        """Put the robot on its left foot at x = 0.

        Args:
            controller: controller at 1 kHz of the robot that walks; the first commands of a family
                are the middle of its ranges, or those of the ground.
            start: x = (q, dq) (rad, rad/s). [2n]
            library: library compiled for robot and policy; without it, ticks are JAX.
            ground: blocks in place of a floor; they give the commands.
        """
        self._ground = ground
        self._robot = controller.robot
        self.plant = build(self._robot, None, self.course)
        self.data = mujoco.MjData(self.plant.model)
        self.floor = Floor(0.0, 0.0)
        self.outcome: TickOutcome | None = None
        self.laps: tuple[int, ...] = ()
        self._limit = np.asarray(controller.torque_limit)
        self._commands = LiveCommands(
            controller.policy.commands, ground and ground.courses.schedule
        )
        first = self._commands.first
        self.control: LiveTick = (
            JaxTick(self.plant, controller, first)
            if library is None
            else NativeTick(library, self.plant, controller, first)
        )
        self._levels = np.zeros((1, 2))
        self._ticks = 0
        self._push = LivePush()
        self._start = np.asarray(start, dtype=np.float64)
        self._stand(self._start, 0.0)

    def compile(self) -> None:
        """Compile the control tick; without this call the first `tick` compiles it."""
        self.control.compile()

    @property
    def course(self) -> Course | None:
        """Return the blocks that it walks on; None on a floor."""
        return None if self._ground is None else self._ground.course

    @property
    def sizes(self) -> Mapping[str, Size]:
        """Return the sizes of the blocks that may change while it walks."""
        return {} if self._ground is None else self._ground.sizes

    def height(self, x: float) -> float:
        """Return the height of the floor at a place, or of the line through stones' middles (m)."""
        return self.floor.height(x) if self.course is None else self.course.line(x)

    @property
    def time(self) -> float:
        """Simulated time since the start [s]."""
        return float(self.data.time)

    @property
    def ending(self) -> Ending:
        """Whether the robot still walks, or the reason why it does not."""
        return Ending.RUNNING if self.outcome is None else Ending(int(self.outcome.ending[0]))

    @property
    def record(self) -> TickRecord | None:
        """Record of the last tick, with a leading axis of one; None before it."""
        return self.control.record

    @property
    def measured(self) -> MeasuredTick | None:
        """State that the controller had at the last tick; None before it."""
        return self.control.measured

    @property
    def pushing(self) -> Float[np.ndarray, "2"]:
        """Return the force of the present push, along x and z (N); zero without one. [2]."""
        return self._push.force

    @property
    def impulse_given(self) -> Float[np.ndarray, "2"]:
        """Return the impulse of all pushes so far, along x and z (N s). [2]."""
        return self._push.impulse_given

    @property
    def hip(self) -> Float[np.ndarray, "2"]:
        """Return the pitch axis of the root, (x, z) (m). [2]."""
        return self.plant.state_map.sensors(self.data.qpos, self.data.qvel).base

    def tick(self) -> bool:
        """Advance one control tick. Returns: False, with no change, once the robot has fallen."""
        if self.ending.fell:
            return False
        if self._ticks % _TILT_TICKS == 0:
            self._tilt()
        self._ticks += 1
        self.outcome = outcome = self.control.decide(self.data, self._levels[0])
        if self.ending.fell:
            return False
        if self._ground is not None and self._walk_on(self._ground, outcome):
            return True
        self.data.ctrl[:] = outcome.controls[0]
        self.data.qfrc_applied[self.plant.state_map.root[:2]] = self.pushing
        # As in an episode, where every tick is a rollout of its own: the walk is the same to a bit.
        self.data.qacc_warmstart[:] = 0.0
        for _ in range(self.plant.substeps):
            mujoco.mj_step(self.plant.model, self.data)
        self._push.advance()
        return True

    def push(self, impulse: Float[np.ndarray, "2"]) -> None:
        """Push along x and z at the root's pitch axis, spread over `push.DURATION_S` (N s).

        The rest of an earlier push is dropped. Raises: InputError if it is not finite.
        """
        self._push.begin(impulse)

    def _walk_on(self, ground: LiveCourse, outcome: TickOutcome) -> bool:
        """Update the commands from the ground. Returns: whether the course ended and began anew."""
        steps, feet = int(outcome.steps[0]), np.asarray(outcome.feet)
        if ground.course.ends(steps, float(feet[0, 0, 0])):
            self.laps = (*self.laps, steps)
            ground.draw_anew()
            self.reset()
            return True
        ground.courses.look(self._commands.requested, 0, steps, feet[0, 1])
        self.control.tell(self._commands.requested)
        down, leg = np.asarray(outcome.touchdown), np.asarray(outcome.leg)
        ground.courses.stand(self._levels, down, leg, feet)
        return False

    def disturb(self, **changes: float | None) -> None:
        """Change the plant under the walking robot; see `PlantChanges` and `CHANGEABLE`.

        The floor turns about the stance foot, at `TILT_DEG_S`; the rest changes at once.
        Raises: InputError for a disturbance that cannot change now or is out of its range.
        """
        changeable = [n for n in CHANGEABLE if self._ground is None or n != "slope_deg"]
        if stray := sorted(set(changes) - set(changeable)):
            raise InputError(f"expected changes of {', '.join(changeable)}, found {stray}")
        self._rebuild(replace(self.plant.disturbance, **changes))

    def resize(self, name: str, size: float) -> None:
        """Change a size of the blocks ahead (m). Raises: InputError if unknown or out of range."""
        if self._ground is None:
            raise InputError(f"expected a course of blocks to change the {name} of, found a floor")
        steps = 0 if self.outcome is None else int(self.outcome.steps[0])
        self._ground.resize(name, size, steps)
        self._rebuild(self.plant.disturbance)

    def _rebuild(self, disturbance: PlantChanges) -> None:
        """Continue in a plant that is compiled anew."""
        plant = build(self._robot, disturbance, self.course)
        fresh = mujoco.MjData(plant.model)
        fresh.time = self.data.time
        for name in ("qpos", "qvel", "ctrl", "sensordata"):
            getattr(fresh, name)[:] = getattr(self.data, name)
        self.plant, self.data = plant, fresh
        self._limit = np.minimum(self._robot.torque_limit, plant.torque_limit)
        self._lay(self.floor)

    def tell(self, **commands: float) -> None:
        """Request commands from the next touchdown on; the others keep their values.

        A change that is too fast for one step is spread over several.
        Raises: InputError for another name, or a value outside of its range.
        """
        self._commands.request(commands)
        self.control.tell(self._commands.requested)

    @property
    def commands(self) -> Float[np.ndarray, "2 p"]:
        """Return the commands of the step before and of this one. [2, p]."""
        # Read once: a reset in the player's thread may take it away in between.
        measured = self.measured
        if measured is None:
            return np.stack([self._commands.first] * 2)
        return measured.commands

    def place(self, x: Float[np.ndarray, " two_n"]) -> None:
        """Restart from a full state on leg 0 (rad, rad/s), at the robot's place. [2n].

        On a course it restarts on the first foothold, with the first commands.
        Raises: InputError for another shape or numbers that are not finite.
        """
        x = np.asarray(x, dtype=np.float64)
        n = self._robot.n
        if x.shape != (2 * n,) or not np.all(np.isfinite(x)):
            raise InputError(f"expected a finite full state of {2 * n} numbers, found {x}")
        if self._ground is not None:
            self._ground.again()
            self._rebuild(self.plant.disturbance)
            self._stand(x, 0.0)
            return
        state_map = self.plant.state_map
        base = float(state_map.sensors(*state_map.to_mjcf(x[:n], x[n:], 0)).base[0])
        self._stand(x, float(self.hip[0]) - base)

    def reset(self) -> None:
        """Restart from the first state; the plant keeps its disturbances."""
        self.place(self._start)

    def _stand(self, x: Float[np.ndarray, " two_n"], foot_x: float) -> None:
        """Put the stance foot onto the floor at `foot_x` (m), and clear the controller's memory."""
        q, dq = np.split(x, 2)
        foot = (foot_x, self.floor.resting(foot_x, float(self._robot.foot_radius)))
        state = self.plant.state_map.to_mjcf(q, dq, 0, foot, rolling_foot(self._robot, dq))
        self.data.qpos[:], self.data.qvel[:] = state
        for name in ("ctrl", "qfrc_applied", "sensordata"):
            getattr(self.data, name)[:] = 0.0
        self.outcome = None
        self.control.restart()
        self._push.drop()
        if self._ground is not None:
            self._levels[:] = self._ground.courses.first_levels()
        self._lay(self.floor)

    def _tilt(self) -> None:
        """Turn the floor a little towards the requested slope, about the stance foot."""
        if self.floor.slope == self.plant.slope:
            return
        leg = 0 if self.outcome is None else int(self.outcome.leg[0])
        state_map = self.plant.state_map
        foot, _ = state_map.foot(leg, state_map.sensors(self.data.qpos, self.data.qvel))
        radius, passed = float(self._robot.foot_radius), _TILT_TICKS * PERIOD_S
        self._lay(self.floor.turned(self.plant.slope, float(foot[0]), radius, passed))

    def _lay(self, floor: Floor) -> None:
        """Put both planes in place, if there are any, and update the control tick."""
        self.floor = floor
        if self._ground is None:
            self._levels[:] = floor.level
            self.data.mocap_pos[:] = self.plant.floor_positions(self._levels).reshape(-1, 3)
            self.data.mocap_quat[:] = floor.quaternion
        self.control.change(self.plant, self._limit, floor.slope)
