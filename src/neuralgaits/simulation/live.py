"""One robot that walks until told otherwise: pushed, tilted, loaded and moved while it goes.

The same control tick and plant as in an episode, one tick at a call. Nothing here knows of wall
clocks, threads or screens: time passes only in `tick`.
"""

# pyright: reportAttributeAccessIssue=false
# MuJoCo ships no type stubs.

import math
from dataclasses import replace
from typing import NamedTuple

import mujoco
import numpy as np

from neuralgaits._types import Float
from neuralgaits.control import AbstractLaw, Controller
from neuralgaits.errors import InputError
from neuralgaits.gait import AbstractPolicy
from neuralgaits.gait.commands import Limits, values
from neuralgaits.gait.reset_residual import Reset
from neuralgaits.robots import PlanarBiped
from neuralgaits.simulation.live_tick import JaxTick, LiveTick, NativeTick
from neuralgaits.simulation.native.library import Library
from neuralgaits.simulation.setup.plant import SUBSTEPS, TIMESTEP_S, build
from neuralgaits.simulation.setup.push import DURATION_S
from neuralgaits.simulation.ticks.falls import Ending, FallConfig
from neuralgaits.simulation.ticks.tick import Record, Verdict

PERIOD_S = SUBSTEPS * TIMESTEP_S
"""Time that passes in a tick [s]."""
CHANGEABLE = ("friction", "torque_limit", "slope_deg", "mass_scale")
"""Disturbances that may change while the robot walks."""
TILT_DEG_S = 20.0
"""How fast the floor tilts [deg/s]: a swing foot ahead of the robot is met at 0.1 m/s or so."""
_TILT_TICKS = 10
"""Ticks between two small turns of the floor."""


class Floor(NamedTuple):
    """A plane through (0, level), the same under both feet."""

    slope: float
    """Rise per metre forward."""
    level: float
    """Height at x = 0 [m]."""

    def height(self, x: float) -> float:
        """Height at x (m)."""
        return self.level + self.slope * x


class LiveWalk:
    """A walking robot and everything that may be done to it.

    Attributes:
        plant: as it is disturbed at present.
        data: MuJoCo's state of it.
        floor: under the feet.
        verdict: of the last tick; None before the first.
        impulse_given: by pushes so far, along x and z (N s). [2]
    """

    def __init__(
        self,
        robot: PlanarBiped,
        policy: AbstractPolicy,
        law: AbstractLaw,
        start: Float[np.ndarray, " two_n"],
        *,
        z2_range: tuple[float, float] | None = None,
        falls: FallConfig | None = None,
        library: Library | None = None,
        reset_residual: Reset = None,
    ):
        """Put the robot on its left foot at x = 0.

        Args:
            robot: the model the controller believes in, and what walks.
            policy: desired outputs, or a family of them, told the middle of its ranges at first.
            law: of control.
            start: x = (q, dq) (rad, rad/s). [2n]
            z2_range: momenta the policy was trained on (kg m^2/s).
            falls: thresholds.
            library: compiled for robot and policy; else ticks are JAX.
            reset_residual: corrects the impact that the steps of a family begin with.
        """
        self.plant = build(robot)
        self.data = mujoco.MjData(self.plant.model)
        self.floor = Floor(0.0, 0.0)
        self.verdict: Verdict | None = None
        self.impulse_given = np.zeros(2)
        self._robot = robot
        controller = Controller.init(
            robot,
            policy,
            law,
            z2_range=z2_range,
            period_s=PERIOD_S,
            reset_residual=reset_residual,
        )
        self._commands = policy.commands
        falls = FallConfig() if falls is None else falls
        self._limit = np.asarray(controller.torque_limit)
        self._tick: LiveTick = (
            JaxTick(self.plant, controller, falls)
            if library is None
            else NativeTick(library, self.plant, controller, falls)
        )
        self._wanted = Limits.of(self._commands).middle
        self._ticks = 0
        self._push_ticks = 0
        self._force = np.zeros(2)
        self._start = np.asarray(start, dtype=np.float64)
        self._stand(self._start, 0.0)

    def compile(self) -> None:
        """Compile the control tick; until then `tick` waits for it itself."""
        self._tick.compile()

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return float(self.data.time)

    @property
    def ending(self) -> Ending:
        """Whether the robot still walks, or why it does not."""
        return Ending.RUNNING if self.verdict is None else Ending(int(self.verdict.ending[0]))

    @property
    def record(self) -> Record | None:
        """What a log would hold of the last tick, with a leading axis of one; None before it."""
        return self._tick.record

    @property
    def pushing(self) -> Float[np.ndarray, "2"]:
        """Force of the push under way, along x and z (N); zero without one. [2]."""
        return self._force if self._push_ticks else np.zeros(2)

    @property
    def hip(self) -> Float[np.ndarray, "2"]:
        """Pitch axis of the root, (x, z) (m). [2]."""
        return self.plant.wires.sensors(self.data.qpos, self.data.qvel).base

    def tick(self) -> bool:
        """Let one control tick pass. Returns: False, and nothing changes, once it has fallen."""
        if self.ending.fell:
            return False
        if self._ticks % _TILT_TICKS == 0:
            self._tilt()
        self._ticks += 1
        self.verdict = verdict = self._tick.decide(self.data, self.floor.level)
        if self.ending.fell:
            return False
        self.data.ctrl[:] = verdict.controls[0]
        self.data.qfrc_applied[self.plant.wires.root[:2]] = self.pushing
        # As in an episode, where every tick is a rollout of its own: the walk is the same to a bit.
        self.data.qacc_warmstart[:] = 0.0
        for _ in range(SUBSTEPS):
            mujoco.mj_step(self.plant.model, self.data)
        if self._push_ticks:
            self._push_ticks -= 1
            self.impulse_given += PERIOD_S * self._force
        return True

    def push(self, impulse: Float[np.ndarray, "2"]) -> None:
        """Push along x and z at the root's pitch axis, spread over `push.DURATION_S` (N s).

        What is left of an earlier push is dropped. Raises: InputError if it is not finite.
        """
        impulse = np.asarray(impulse, dtype=np.float64)
        if impulse.shape != (2,) or not np.all(np.isfinite(impulse)):
            raise InputError(f"push: expected a finite impulse along x and z, found {impulse}")
        self._push_ticks = round(DURATION_S / PERIOD_S)
        self._force = impulse / (self._push_ticks * PERIOD_S)

    def disturb(self, **changes: float | None) -> None:
        """Change the plant under the walking robot; see `Disturbance` and `CHANGEABLE`.

        The floor turns about the stance foot, at `TILT_DEG_S`; the rest changes at once.
        Raises: InputError for a disturbance that cannot change now or is out of its range.
        """
        if stray := sorted(set(changes) - set(CHANGEABLE)):
            raise InputError(f"expected changes of {', '.join(CHANGEABLE)}, found {stray}")
        plant = build(self._robot, replace(self.plant.disturbance, **changes))
        fresh = mujoco.MjData(plant.model)
        fresh.time = self.data.time
        for name in ("qpos", "qvel", "ctrl", "sensordata"):
            getattr(fresh, name)[:] = getattr(self.data, name)
        self.plant, self.data = plant, fresh
        self._limit = np.minimum(self._robot.torque_limit, plant.torque_limit)
        self._lay(self.floor)

    def tell(self, **commands: float) -> None:
        """Wish for commands from the next touchdown on; the others stay as they are.

        A change that is too fast for one step is spread over several.
        Raises: InputError for another name, or a value outside of its range.
        """
        now = dict(zip((c.name for c in self._commands), self._wanted.tolist(), strict=True))
        self._wanted = values(self._commands, now | commands)
        self._tick.tell(self._wanted)

    @property
    def told(self) -> Float[np.ndarray, "2 p"]:
        """What the robot was told, of the step before and of this one. [2, p]."""
        if self.record is None:
            middle = Limits.of(self._commands).middle
            return np.stack([middle, middle])
        return np.asarray(self.record.command.told)[0]

    def place(self, x: Float[np.ndarray, " two_n"]) -> None:
        """Start anew from a full state on leg 0 (rad, rad/s), where the robot is. [2n].

        Raises: InputError for another shape or numbers that are not finite.
        """
        x = np.asarray(x, dtype=np.float64)
        n = self._robot.n
        if x.shape != (2 * n,) or not np.all(np.isfinite(x)):
            raise InputError(f"expected a finite full state of {2 * n} numbers, found {x}")
        wires = self.plant.wires
        base = float(wires.sensors(*wires.to_mjcf(x[:n], x[n:], 0)).base[0])
        self._stand(x, float(self.hip[0]) - base)

    def reset(self) -> None:
        """Start anew from the first state; the plant stays as disturbed as it is."""
        self.place(self._start)

    def _stand(self, x: Float[np.ndarray, " two_n"], foot_x: float) -> None:
        """Put the stance foot onto the floor at `foot_x` (m), and forget what was."""
        q, dq = np.split(x, 2)
        lift = float(self._robot.foot_radius) * math.hypot(1.0, self.floor.slope)
        foot = (foot_x, self.floor.height(foot_x) + lift)
        self.data.qpos[:], self.data.qvel[:] = self.plant.wires.to_mjcf(q, dq, 0, foot)
        for name in ("ctrl", "qfrc_applied", "sensordata"):
            getattr(self.data, name)[:] = 0.0
        self.verdict = None
        self._tick.restart()
        self._push_ticks = 0
        self._lay(self.floor)

    def _tilt(self) -> None:
        """Turn the floor a little towards the slope asked for, about the stance foot."""
        wanted = self.plant.slope
        if self.floor.slope == wanted:
            return
        reach = math.radians(TILT_DEG_S * _TILT_TICKS * PERIOD_S)
        angle = math.atan(self.floor.slope)
        way = math.atan(wanted) - angle
        slope = wanted if abs(way) <= reach else math.tan(angle + math.copysign(reach, way))
        leg = 0 if self.verdict is None else int(self.verdict.leg[0])
        wires = self.plant.wires
        foot, _ = wires.foot(leg, wires.sensors(self.data.qpos, self.data.qvel))
        # The gap between sphere and plane stays, so no contact is pressed or torn apart.
        higher = math.hypot(1.0, slope) - math.hypot(1.0, self.floor.slope)
        beneath = self.floor.height(float(foot[0])) - float(self._robot.foot_radius) * higher
        level = beneath - slope * float(foot[0])
        self._lay(Floor(slope, float(level)))

    def _lay(self, floor: Floor) -> None:
        """Put both planes there, and tell the control tick."""
        self.floor = floor
        levels = np.full((1, 2), floor.level)
        self.data.mocap_pos[:] = self.plant.floor_positions(levels).reshape(-1, 3)
        half = 0.5 * math.atan(floor.slope)
        self.data.mocap_quat[:] = (math.cos(half), 0.0, -math.sin(half), 0.0)
        self._tick.change(self.plant, self._limit, floor.slope)
