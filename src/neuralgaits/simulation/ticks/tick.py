"""One control tick of one episode, plant readings in, controls and verdict out: compiled once.

`batch` vmaps it over episodes. Numbers are arguments, so policies and plants of the same
structure share one compilation; addresses and the shape of the controller are constants.
"""

from typing import NamedTuple, cast

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from neuralgaits._types import Array, Bool, Float, Int, Planar, Scalar, ZeroState
from neuralgaits.control import (
    Command,
    Controller,
    ControllerState,
    Measurement,
    start,
    step,
    tell,
)
from neuralgaits.control.estimator import Estimator, Known, estimate
from neuralgaits.control.estimator import start as nothing_known
from neuralgaits.control.measurement import coordinates, stance_foot_velocity
from neuralgaits.control.momentum import zero_state
from neuralgaits.gait.commands import Limits, place_of
from neuralgaits.robots import MjcfLayout, PlanarBiped
from neuralgaits.robots.dynamics import hip_position, swing_foot
from neuralgaits.robots.mjcf_state import StateMap
from neuralgaits.simulation.setup.plant import Plant
from neuralgaits.simulation.ticks import gauge as gauges
from neuralgaits.simulation.ticks.falls import FallConfig, ending
from neuralgaits.simulation.ticks.gauge import Gauge
from neuralgaits.simulation.ticks.wiring import controls, measure


class Carry(NamedTuple):
    """What an episode takes from tick to tick."""

    controller: ControllerState
    gauge: Gauge
    age: Scalar
    """Time since the last touchdown, or since the start of the episode [s]."""
    known: Known | None = None
    """What an estimator remembers."""
    believed: Float[Array, " d"] | None = None
    """Its last hip speeds, the newest first, as many as torques are late and one more [m/s]."""


class Reading(NamedTuple):
    """The plant as one tick finds it."""

    state: Float[Array, " s"]
    """Time, qpos and qvel."""
    touch: Float[Array, "2"]
    """Normal force on each foot [N]."""
    floor: Float[Array, "2"]
    """Floor level under each foot at x = 0 [m]; on a course, of the foothold each had last."""
    noise: Float[Array, "2 j"]
    """Standard normal noise of angles and rates: pitch first, then the joints of both legs."""
    wanted: Float[Array, " p"]
    """What the next touchdown is to latch."""


class Verdict(NamedTuple):
    """What the loop outside must know after a tick."""

    controls: Float[Array, " u"]
    """Actuator controls."""
    ending: Int[Array, ""]
    """An `Ending`."""
    touchdown: Bool[Array, ""]
    """Whether a step has just ended."""
    steps: Int[Array, ""]
    """Touchdowns so far."""
    leg: Int[Array, ""]
    """Stance leg."""
    z1: Scalar
    """Measured z1 [m]."""
    clearance: Scalar
    """Swing foot above the floor through the stance foothold [m]."""
    stride: Float[Array, " r"]
    """Of a touchdown: a row of `strides.Strides`; zeros at other ticks."""
    feet: Float[Array, "2 2"]
    """Stance foot and swing foot in the world, (x, z) of their spheres [m]."""
    rise: Scalar
    """What the robot is told of the height of the next foothold [m]; 0 for nothing."""


class Record(NamedTuple):
    """What a log holds of a tick."""

    time: Scalar
    command: Command
    pitch: Scalar
    dpitch: Scalar
    z_plant: ZeroState
    """z with the plant's own masses, without noise (m, kg m^2/s). [2]"""


class Scene(eqx.Module):
    """Everything a tick needs that stays fixed during a simulation.

    Attributes:
        controller: of all episodes; unless they share a policy, `policy` and `bounds` have a
            leading axis of episodes.
        plant_robot: the plant's own numbers, disturbances left out.
        slope: rise of the floor per metre forward.
        noise: standard deviation of angles, rates and pitch [rad], [rad/s], [rad]. [3]
        pitch_offset: of the pitch [rad].
        encoder_step: resolution of angles, 0 for exact ones [rad].
        steps: walking steps of an episode.
        first: command that episodes begin with. [p]
        gap_depth: how far below its stones a foot has missed them, infinite without any [m].
        layout: of the plant's file.
        sizes: of the plant's qpos and ctrl.
        estimator: of rates and hip velocity; None where they are measured.
        delay_ticks: from a reading to its torque.
        addresses: of root, joints and motors in the plant's arrays, as in `StateMap`.
        falls: thresholds of a fall.
    """

    controller: Controller
    plant_robot: PlanarBiped
    slope: Float[Array, ""]
    noise: Float[Array, "3"]
    pitch_offset: Float[Array, ""]
    encoder_step: Float[Array, ""]
    steps: Int[Array, ""]
    first: Float[Array, " p"]
    gap_depth: Float[Array, ""]
    layout: MjcfLayout = eqx.field(static=True)
    sizes: tuple[int, int] = eqx.field(static=True)
    addresses: tuple[tuple, tuple, tuple] = eqx.field(static=True)
    falls: FallConfig = eqx.field(static=True)
    on_course: bool = eqx.field(static=True)
    estimator: Estimator | None = eqx.field(static=True)
    delay_ticks: int = eqx.field(static=True)

    @classmethod
    def of(
        cls,
        plant: Plant,
        controller: Controller,
        steps: int,
        falls: FallConfig,
        first: Float[np.ndarray, " p"] | None = None,
        gap_depth: float = np.inf,
    ) -> "Scene":
        """The scene of a plant and a controller; `first` is the middle of the ranges if None."""
        if first is None:
            first = Limits.of(controller.policy.commands).middle
        wires, disturbance = plant.wires, plant.disturbance
        return cls(
            controller=controller,
            plant_robot=plant.robot,
            slope=np.asarray(plant.slope),
            noise=np.array(
                [disturbance.encoder_noise, disturbance.rate_noise, disturbance.noise_of_pitch]
            ),
            pitch_offset=np.asarray(disturbance.pitch_offset),
            encoder_step=np.asarray(disturbance.encoder_step),
            steps=np.asarray(steps, dtype=np.int32),
            first=first,
            gap_depth=np.asarray(gap_depth),
            layout=wires.layout,
            sizes=(wires.nq, wires.nu),
            addresses=(_frozen(wires.root), _frozen(wires.joints), _frozen(wires.actuators)),
            falls=falls,
            on_course=plant.course is not None,
            estimator=Estimator() if disturbance.estimator else None,
            delay_ticks=plant.delay_ticks if disturbance.estimator else 0,
        )

    @property
    def wires(self) -> StateMap:
        """Where the robot's coordinates live in the plant."""
        return StateMap(self.layout, *self.sizes, *(np.array(part) for part in self.addresses))

    @property
    def reading_size(self) -> int:
        """Length of a packed `Reading`."""
        return sum(int(np.prod(shape)) for shape in self._reading_shapes())

    def reading(self, packed: Float[Array, " r"]) -> Reading:
        """Unpack a `Reading`."""
        parts, at = [], 0
        for shape in self._reading_shapes():
            size = int(np.prod(shape))
            parts.append(packed[at : at + size].reshape(shape))
            at += size
        return Reading(*parts)

    def _reading_shapes(self) -> tuple[tuple[int, ...], ...]:
        nq, _ = self.sizes
        joints = sum(len(leg) for leg in self.addresses[1])
        return ((1 + 2 * nq,), (2,), (2,), (2, 1 + joints), self.first.shape)


def _frozen(addresses: np.ndarray) -> tuple:
    nested = addresses.tolist()
    return tuple(tuple(part) if isinstance(part, list) else part for part in nested)


def begin(scene: Scene, leg: Int[Array, ""]) -> Carry:
    """The carry of an episode that starts on `leg`."""
    first = Carry(start(scene.controller, leg, scene.first), Gauge.start(), jnp.zeros(()))
    if scene.estimator is None:
        return first
    known = nothing_known(scene.controller.robot)
    return first._replace(known=known, believed=jnp.zeros(scene.delay_ticks + 1))


def tick(scene: Scene, carry: Carry, reading: Reading) -> tuple[Carry, Verdict, Record]:
    """One tick of one episode. Returns: the next carry, the verdict, and the record."""
    seen = sense(scene, reading).seen
    if scene.estimator is not None:
        carry, seen = _estimated(scene, scene.estimator, carry, seen)
    state = tell(scene.controller, carry.controller, reading.wanted)
    state, command = step(scene.controller, state, seen)
    return account(scene, carry, reading, state, command)


def _estimated(
    scene: Scene, estimator: Estimator, carry: Carry, seen: Measurement
) -> tuple[Carry, Measurement]:
    """What the controller goes by where rates are not measured."""
    controller = scene.controller
    assert carry.known is not None and carry.believed is not None
    standing, period = carry.controller.stance, controller.period_s
    known = estimate(estimator, controller.robot, carry.known, seen, standing, period)
    speed = known.estimate.hip_velocity[:1]
    believed = jnp.concatenate([speed, carry.believed[:-1]])
    return carry._replace(known=known, believed=believed), known.estimate


class Sensed(NamedTuple):
    """What there is to measure, and what is measured of it."""

    truth: Measurement
    """Without noise."""
    seen: Measurement
    """As the controller is told."""
    hip: Planar
    """Hip position in the world, (x, z) [m]."""


def sense(scene: Scene, reading: Reading) -> Sensed:
    """Read the sensors of one episode."""
    wires = scene.wires
    time, qpos, qvel = reading.state[0], *jnp.split(reading.state[1:], 2)
    # Written for NumPy, but with nothing that JAX arrays cannot do.
    sensors = wires.sensors(cast(np.ndarray, qpos), cast(np.ndarray, qvel))
    arm, swept = wires.layout.hip_arm(sensors.pitch - wires.layout.root_angle, jnp)
    truth = measure(sensors, swept, time, reading.touch)
    shifted = truth._replace(pitch=truth.pitch + scene.pitch_offset)
    seen = _rounded(_noisy(shifted, reading.noise, scene.noise), scene.encoder_step)
    return Sensed(truth, seen, sensors.base + arm)


def account(
    scene: Scene, carry: Carry, reading: Reading, state: ControllerState, command: Command
) -> tuple[Carry, Verdict, Record]:
    """What becomes of an episode under a command, whoever decided it.

    Returns: the next carry, the verdict, and the record.
    """
    controller, wires = scene.controller, scene.wires
    robot, period = controller.robot, controller.period_s
    truth, _, hip = sense(scene, reading)
    time = truth.time
    age = jnp.where(command.touchdown, 0.0, carry.age + period)
    gauge = gauges.update(
        carry.gauge,
        command,
        time=time,
        hip=hip[0],
        normal_force=reading.touch,
        period_s=period,
        speed_error=_speed_error(carry, truth),
    )
    ahead, up = swing_foot(robot, command.q)
    stance = hip - hip_position(robot, command.q)
    feet = jnp.stack([stance, stance + jnp.stack([ahead, up])])
    height = place_of(controller.policy.commands, "step_height")
    rise = jnp.zeros(()) if height is None else command.told[1, height]
    floor = reading.floor[command.leg]
    if scene.on_course:
        # What stands there now has not been heard of yet.
        floor = jnp.where(command.touchdown, stance[1] - scene.plant_robot.foot_radius, floor)
    verdict = ending(
        scene.falls,
        robot,
        hip_height=hip[1] - floor - scene.slope * hip[0],
        pitch=truth.pitch,
        since_touchdown=age,
        steps_left=scene.steps - gauge.steps,
        in_gap=_in_gap(scene, feet, floor, reading.floor[1 - command.leg], rise),
        finite=jnp.all(jnp.isfinite(reading.state)) & jnp.all(jnp.isfinite(command.torque)),
    )
    # At a touchdown the swing foot is the old stance foot.
    numbers = jnp.stack([time, hip[0], -ahead, -up, stance[0]])
    stride = jnp.concatenate([numbers, command.told[0]])
    return (
        carry._replace(controller=state, gauge=gauge, age=age),
        Verdict(
            controls=controls(wires, command.torque),
            ending=verdict,
            touchdown=command.touchdown,
            steps=gauge.steps,
            leg=command.leg,
            z1=command.z[0],
            clearance=up - scene.slope * ahead,
            stride=jnp.where(command.touchdown, stride, 0.0),
            feet=feet,
            rise=rise,
        ),
        Record(
            time,
            command,
            truth.pitch,
            truth.dpitch,
            true_z(scene.plant_robot, truth, command.leg),
        ),
    )


def _speed_error(carry: Carry, truth: Measurement) -> Scalar | float:
    """How far the hip speed that torques are for is from the one that they meet (m/s)."""
    if carry.believed is None:
        return 0.0
    error = carry.believed[-1] - truth.hip_velocity[0]
    return jnp.where(carry.gauge.ticks >= carry.believed.size - 1, error, 0.0)


def _in_gap(
    scene: Scene, feet: Float[Array, "2 2"], level: Scalar, left: Scalar, rise: Scalar
) -> Bool[Array, ""]:
    """Whether a foot is below its stones.

    Args:
        scene: of the episode.
        feet: stance and swing foot (m).
        level: of the stance foothold (m).
        left: of the one that the swing foot has left (m).
        rise: of the one that it is on its way to, above the stance foothold (m).
    """
    stance, swing = feet[:, 1] - scene.plant_robot.foot_radius
    lowest = jnp.minimum(left, level + rise)
    return (swing < lowest - scene.gap_depth) | (stance < level - scene.gap_depth)


def _noisy(
    truth: Measurement, draws: Float[Array, "2 j"], deviation: Float[Array, "3"]
) -> Measurement:
    angles, rates = deviation[:2, None] * draws
    shape = truth.angles.shape
    return truth._replace(
        pitch=truth.pitch + deviation[2] * draws[0, 0],
        dpitch=truth.dpitch + rates[0],
        angles=truth.angles + angles[1:].reshape(shape),
        rates=truth.rates + rates[1:].reshape(shape),
    )


def _rounded(measured: Measurement, resolution: Scalar) -> Measurement:
    """Angles as an encoder counts them."""
    exact = resolution == 0.0
    unit = jnp.where(exact, 1.0, resolution)

    def counted(angle):
        return jnp.where(exact, angle, unit * jnp.round(angle / unit))

    return measured._replace(pitch=counted(measured.pitch), angles=counted(measured.angles))


def true_z(robot: PlanarBiped, truth: Measurement, leg: Int[Array, ""]) -> ZeroState:
    """Z of a robot standing on `leg` (m, kg m^2/s). Returns: [2]."""
    q, dq = coordinates(robot, truth, leg)
    z, _ = zero_state(robot, q, dq, stance_foot_velocity(robot, q, dq, truth))
    return z
