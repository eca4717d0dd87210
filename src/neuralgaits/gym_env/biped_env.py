"""A planar biped that follows a speed command, as a Gymnasium environment."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, SupportsFloat, get_args

import gymnasium
import jax
import numpy as np
from gymnasium import spaces

from neuralgaits._printable import shown
from neuralgaits._types import Float
from neuralgaits.control import Pd
from neuralgaits.errors import InputError
from neuralgaits.gait.first_states import FirstStates
from neuralgaits.gait.joint_inertia import JointResponse
from neuralgaits.gait.posture import walking_posture
from neuralgaits.gym_env.body import Body, Joints
from neuralgaits.gym_env.reward import Reward, reward_of
from neuralgaits.robots.mjcf.loader import load_robot
from neuralgaits.robots.robot_source import RobotSource
from neuralgaits.simulation.setup.disturbance import PlantChanges, parse
from neuralgaits.simulation.setup.plant import PERIOD_S, build
from neuralgaits.simulation.ticks.falls import Ending

Action = Literal["target", "torque"]
Disturbed = str | Mapping[str, float] | PlantChanges
TICKS = 20
"""Control ticks of a decision: 50 decisions a second."""
LARGEST_SPEED = 3.0
"""Largest speed that a walk may be asked for [m/s]."""


class BipedEnv(gymnasium.Env):
    """Gymnasium environment of a biped that walks at a commanded speed without falling.

    The plant is that of `simulate`, with its disturbances, pushes, floors, touchdowns and falls.
    An episode ends with a fall; standing still for long counts as one. `gymnasium.make` cuts it
    after 10 s.

    Observation, float32 [2 m + 9], m motors: pitch (rad) and its rate (rad/s); joint angles [m] and
    rates [m], leg 0 from the lowest up and then leg 1; velocity of the hip, (x, z) (m/s); normal
    force on foot 0 and 1 (weights); the stance leg, -1 or 1; time since its touchdown (s); the
    commanded speed (m/s).

    Action, [m] in -1..1, joints as above. `target`: joint angles between the bounds of a walking
    posture, 0 its mid-step, held by the gains of `control.Pd` without feed-forward. `torque`:
    shares of the limits.

    Reward: `Reward`; its parts are in `info["reward"]`. `info` has also `speed` (m/s), `steps`
    (touchdowns so far) and `ending` (why it fell, or None).
    """

    metadata = {"render_modes": []}  # noqa: RUF012

    def __init__(
        self,
        robot: RobotSource = "amber3m",
        *,
        action: Action = "target",
        speed: float | tuple[float, float] = (0.5, 0.9),
        disturb: Disturbed | Sequence[Disturbed | None] | None = None,
        push: float | tuple[float, float] = 0.0,
        reward: Reward | dict[str, float] | None = None,
        ticks: int = TICKS,
        render_mode: str | None = None,
    ):
        """Build the plant.

        Args:
            robot: name, file, or loaded robot.
            action: meaning of the actions, `target` or `torque`.
            speed: commanded speed (m/s), or a range that each episode draws from.
            disturb: disturbance of the plant, as for `simulate`; each episode draws one of several.
            push: forward impulse of the one push of an episode (N s), or a range to draw from.
            reward: weights, see `Reward`.
            ticks: control ticks of 1 ms in a decision.
            render_mode: only None is supported.

        Raises: InputError, RobotError with one line.
        """
        _refuse_impossible(action, render_mode, ticks)
        self.render_mode = render_mode
        self._speed = _range("speed", speed, 0.0, LARGEST_SPEED)
        self._push = _range("push", push, -1e3, 1e3)
        self._reward = reward_of(reward)
        self._ticks = ticks
        self._torques = action == "torque"
        disturbances = _disturbances(disturb)
        if not isinstance(robot, RobotSource):
            raise InputError(f"robot: expected a name, a path or a robot, found {shown(robot)}")
        # A robot's numbers are double precision, whatever a learner has told JAX.
        with jax.enable_x64(True):
            self.robot = load_robot(robot) if isinstance(robot, str | Path) else robot
            self._plants = [build(self.robot, one) for one in disturbances]
            self.body = Body(self.robot, self._plants[0])
            self._first = FirstStates(self.robot)
            law = Pd().with_gains_for(JointResponse(self.robot))
            posture = walking_posture(self.robot)
        self._stiffness = self.body.by_joint(np.asarray(law.stiffness))
        self._damping = self.body.by_joint(np.asarray(law.damping))
        self._low = self.body.by_joint(posture.lower)
        self._high = self.body.by_joint(posture.upper)
        # Between both legs of mid-step, the same for either.
        q, _ = self._first.at(0.5, 0.0)
        self._middle = self.body.by_joint(0.5 * (q + self.robot.relabel @ q)[1:])
        m = self.body.joints
        self.action_space = spaces.Box(-1.0, 1.0, (m,), np.float32)
        self.observation_space = _observations(m)
        self._requested_speed, self._begun = self._speed[0], False
        self._before = np.zeros(m)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Start an episode at a random place of a rough step.

        Args:
            seed: seed of everything random.
            options: `speed`, the command (m/s), and `state`, the initial x = (q, dq) of a robot on
                leg 0 (rad, rad/s) [2n]; both are drawn at random if missing.

        Returns: observation, info.
        """
        super().reset(seed=seed)
        if not isinstance(options, Mapping | None):
            raise InputError(f"reset options: expected a mapping, found {shown(options)}")
        options, draw = dict(options or {}), self.np_random
        if stray := sorted(map(str, set(options) - {"speed", "state"})):
            raise InputError(f"reset options: expected speed, state, found {stray}")
        self._requested_speed = draw.uniform(*self._speed)
        if "speed" in options:
            self._requested_speed = _range("speed", options["speed"], 0.0, LARGEST_SPEED)[0]
        push = draw.uniform(*self._push)
        plant = self._plants[int(draw.integers(len(self._plants)))]
        slowest = 0.5  # As a share of the commanded speed.
        leg = int(draw.integers(2))
        share = draw.uniform()
        pace = draw.uniform(slowest, 1.0)
        q, dq = self._first.at(share, pace * self._requested_speed)
        if "state" in options:
            leg, (q, dq) = 0, np.split(self._checked_state(options["state"]), 2)
        seed_of_body = int(draw.integers(2**31))
        self.body.stand(plant, q, dq, leg, push=push, seed=seed_of_body)
        self._before, self._begun = np.zeros(self.body.joints), True
        return self._observed(), self._info(Ending.RUNNING, {}, 0.0)

    def step(
        self, action: np.ndarray
    ) -> tuple[np.ndarray, SupportsFloat, bool, bool, dict[str, Any]]:
        """Carry out one decision.

        Returns: observation, reward, terminated, truncated (always False here), info.
        """
        action = _numbers("action", action)
        if not self._begun:
            raise InputError("step: expected an episode that has begun, found none: call reset")
        if action.shape != self.action_space.shape or not np.isfinite(action).all():
            raise InputError(
                f"action: expected {self.body.joints} finite numbers, found {action.tolist()}"
            )
        action = np.clip(action, -1.0, 1.0)
        law = self._law(action)
        hip, work = self.body.hip[0], self.body.work
        for _ in range(self._ticks):
            self.body.tick(law)
        time, ending = self._ticks * PERIOD_S, self.body.ending()
        speed, power = (self.body.hip[0] - hip) / time, (self.body.work - work) / time
        finite = ending is not Ending.NOT_FINITE
        parts = self._reward.parts(
            speed=float(speed) if finite else 0.0,
            requested_speed=float(self._requested_speed),
            power=float(power) / self.body.weight if finite else 0.0,
            pitch=self.body.pitch if finite and self.robot.torso is not None else 0.0,
            change=float(np.mean((action - self._before) ** 2)),
            fell=ending.fell,
        )
        self._before = action
        info = self._info(ending, parts, float(speed))
        return self._observed(), sum(parts.values()), ending.fell, False, info

    def _law(self, action: Joints):
        """Return the torques of an action, as a function of measured angles and rates."""
        if self._torques:
            constant = action * self.body.limit
            return lambda angles, rates: constant
        reach = np.where(action < 0.0, self._middle - self._low, self._high - self._middle)
        target = self._middle + action * reach
        return lambda angles, rates: self._stiffness * (target - angles) - self._damping * rates

    def _observed(self) -> np.ndarray:
        body = self.body
        phase_and_command = [2.0 * body.leg - 1.0, body.since, self._requested_speed]
        observation = np.nan_to_num(np.concatenate([body.measured(), phase_and_command]))
        space = self.observation_space
        assert isinstance(space, spaces.Box)
        return np.clip(observation, space.low, space.high).astype(np.float32)

    def _info(self, ending: Ending, parts: dict[str, float], speed: float) -> dict[str, Any]:
        return {
            "reward": parts,
            "speed": speed,
            "steps": self.body.steps,
            "ending": ending.reason,
        }

    def _checked_state(self, state: Any) -> Float[np.ndarray, " two_n"]:
        x = _numbers("reset options: state", state)
        if x.shape != (2 * self.robot.n,) or not np.isfinite(x).all():
            raise InputError(
                f"reset options: expected a finite state of {2 * self.robot.n} numbers, "
                f"found shape {x.shape}"
            )
        return x


def _numbers(name: str, value: Any) -> Float[np.ndarray, "..."]:
    """Read an array of numbers. Raises: InputError in one line."""
    try:
        return np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{name}: expected finite numbers, found {shown(value)}") from None


def _range(name: str, value: Any, lowest: float, highest: float) -> tuple[float, float]:
    """Read one value, or (low, high), as a range."""
    # Python takes True for 1, and NumPy "0.5" for 0.5.
    odd = isinstance(value, str | bytes | bool)
    values = np.zeros(0) if odd else _numbers(name, value).reshape(-1)
    if values.size not in (1, 2) or not (
        np.isfinite(values).all() and lowest <= values[0] <= values[-1] <= highest
    ):
        raise InputError(
            f"{name}: expected a number or (low, high) within {lowest:g} to {highest:g}, "
            f"found {shown(value)}"
        )
    return float(values[0]), float(values[-1])


def _refuse_impossible(action: str, render_mode: str | None, ticks: int) -> None:
    """Refuse settings of an environment. Raises: InputError."""
    if action not in get_args(Action):
        raise InputError(f"action: expected one of {', '.join(get_args(Action))}, found {action!r}")
    if render_mode is not None:
        raise InputError(f"render_mode: expected None, found {render_mode!r}: it draws nothing")
    if not isinstance(ticks, int | np.integer) or isinstance(ticks, bool) or not 1 <= ticks <= 1000:
        raise InputError(f"ticks: expected a whole number from 1 to 1000, found {shown(ticks)}")


def _disturbances(disturb: Disturbed | Sequence[Disturbed | None] | None) -> list[PlantChanges]:
    """Return the disturbances that episodes draw from. Raises: InputError."""
    if disturb is None or isinstance(disturb, str | Mapping | PlantChanges):
        disturb = [disturb]
    if not isinstance(disturb, Sequence):
        raise InputError(
            f"disturb: expected NAME=VALUE,..., a mapping or several, found {shown(disturb)}"
        )
    disturbances = [parse(one) for one in disturb]
    if any(
        one.estimator or one.pitch_noise or one.pitch_offset or one.has_drives
        for one in disturbances
    ):
        raise InputError(
            "disturb: expected no estimator, pitch_noise, pitch_offset, drive_stiffness or "
            "drive_damping, found one: what acts here is no controller of this package; leave it "
            "out"
        )
    if not disturbances:
        raise InputError("disturb: expected at least one disturbance to draw, found none")
    return disturbances


def _observations(m: int) -> spaces.Box:
    """Return the space of observations of a robot with m motors."""
    # Far beyond what a walk needs, but finite, as learners want them.
    angle = np.pi  # [rad]
    rate = 50.0  # [rad/s]
    velocity = 10.0  # [m/s]
    force = 20.0  # In weights of the robot.
    time = 10.0  # [s]
    sizes = [angle, rate] + [angle] * m + [rate] * m + [velocity] * 2
    leg = 1.0
    high = [*sizes, force, force, leg, time, LARGEST_SPEED]
    low = [-size for size in sizes] + [0.0, 0.0, -leg, 0.0, 0.0]
    return spaces.Box(np.array(low, np.float32), np.array(high, np.float32), dtype=np.float32)
