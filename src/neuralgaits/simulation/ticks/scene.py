"""Constants of a walking episode, and the plant's readings at each tick."""

from typing import NamedTuple

import equinox as eqx
import numpy as np

from neuralgaits._types import Array, Float, Int
from neuralgaits.control import (
    Controller,
)
from neuralgaits.control.estimator_poles import Estimator
from neuralgaits.control.measurement import SensedRobot
from neuralgaits.gait.commands import CommandLimits
from neuralgaits.robots.layout import MjcfLayout
from neuralgaits.robots.mjcf_state import StateMap
from neuralgaits.simulation.setup.plant import Plant


class PlantReading(NamedTuple):
    """Readings of the plant at one tick."""

    state: Float[Array, " s"]
    """Time, qpos and qvel of the plant."""
    touch: Float[Array, "2"]
    """Normal force on each foot [N]."""
    floor: Float[Array, "2"]
    """Floor level under each foot at x = 0 [m]; on a course, of the foothold each had last."""
    noise: Float[Array, "2 j"]
    """Standard normal noise of angles and rates: pitch first, then the joints of both legs."""
    requested: Float[Array, " p"]
    """Commands that the next touchdown latches."""


class Scene(eqx.Module):
    """Everything that a tick needs and that stays constant during a simulation.

    Attributes:
        controller: controller of all episodes; unless they share a policy, `policy` and `bounds`
            have a leading axis of episodes.
        plant_robot: the plant's own numbers, disturbances left out.
        slope: rise of the floor per metre forward.
        noise: standard deviation of angles, rates and pitch [rad], [rad/s], [rad]. [3]
        pitch_offset: offset of the pitch [rad].
        encoder_step: resolution of angles, 0 for exact ones [rad].
        steps: walking steps of an episode.
        first: command that episodes begin with. [p]
        gap_depth: depth at which a foot has missed its stones, infinite without any [m].
        layout: layout of the plant's file.
        sizes: sizes of the plant's qpos and ctrl.
        estimator: estimator of rates and hip velocity; None where they are measured.
        delay_ticks: delay from a reading to its torque.
        has_drives, gains: whether drives close loops of their own, and with which stiffness
            [N m/rad] and damping [N m s/rad]. [2]
        addresses: addresses of root, joints and motors in the plant's arrays, as in `StateMap`.
    """

    controller: Controller
    plant_robot: SensedRobot
    slope: Float[Array, ""]
    noise: Float[Array, "3"]
    pitch_offset: Float[Array, ""]
    encoder_step: Float[Array, ""]
    steps: Int[Array, ""]
    first: Float[Array, " p"]
    gap_depth: Float[Array, ""]
    gains: Float[Array, "2"]
    layout: MjcfLayout = eqx.field(static=True)
    sizes: tuple[int, int] = eqx.field(static=True)
    addresses: tuple[tuple, tuple, tuple] = eqx.field(static=True)
    on_course: bool = eqx.field(static=True)
    estimator: Estimator | None = eqx.field(static=True)
    delay_ticks: int = eqx.field(static=True)
    has_drives: bool = eqx.field(static=True)

    @classmethod
    def of(
        cls,
        plant: Plant,
        controller: Controller,
        steps: int,
        first: Float[np.ndarray, " p"] | None = None,
        gap_depth: float = np.inf,
    ) -> "Scene":
        """Return the scene of a plant and a controller; `first` is the middle if None."""
        if first is None:
            first = CommandLimits.of(controller.policy.commands).middle
        state_map, disturbance = plant.state_map, plant.disturbance
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
            gains=np.array([disturbance.drive_stiffness, disturbance.drive_damping]),
            layout=state_map.layout,
            sizes=(state_map.nq, state_map.nu),
            addresses=(
                _static_key(state_map.root),
                _static_key(state_map.joints),
                _static_key(state_map.actuators),
            ),
            on_course=plant.course is not None,
            estimator=Estimator() if disturbance.estimator else None,
            delay_ticks=plant.delay_ticks if disturbance.estimator else 0,
            has_drives=disturbance.has_drives,
        )

    @property
    def state_map(self) -> StateMap:
        """Where the robot's coordinates live in the plant."""
        return StateMap(self.layout, *self.sizes, *(np.array(part) for part in self.addresses))

    @property
    def reading_size(self) -> int:
        """Length of a packed `PlantReading`, in numbers."""
        return sum(int(np.prod(shape)) for shape in self._reading_shapes())

    def reading(self, packed: Float[Array, " r"]) -> PlantReading:
        """Unpack a `PlantReading` from its array of numbers."""
        parts, at = [], 0
        for shape in self._reading_shapes():
            size = int(np.prod(shape))
            parts.append(packed[at : at + size].reshape(shape))
            at += size
        return PlantReading(*parts)

    def _reading_shapes(self) -> tuple[tuple[int, ...], ...]:
        nq, _ = self.sizes
        joints = sum(len(leg) for leg in self.addresses[1])
        return ((1 + 2 * nq,), (2,), (2,), (2, 1 + joints), self.first.shape)


def _static_key(addresses: np.ndarray) -> tuple:
    nested = addresses.tolist()
    return tuple(tuple(part) if isinstance(part, list) else part for part in nested)
