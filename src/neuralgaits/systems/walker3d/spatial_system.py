"""Bipeds in three dimensions as a family: robot files, gaits and what is measured of them."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jax
import numpy as np

from neuralgaits.errors import InputError, RunError
from neuralgaits.systems.system_family import Screen, SystemFamily
from neuralgaits.systems.trained_system import TrainedSystem, TrainingProgress
from neuralgaits.systems.walker3d import FAMILY
from neuralgaits.systems.walker3d.orbit_search import exact_period, find_orbit
from neuralgaits.systems.walker3d.spatial_gait import SpatialGait, empty_gait, gait_of
from neuralgaits.systems.walker3d.spatial_mjcf import read_spatial
from neuralgaits.systems.walker3d.spatial_orbit import OrbitAims
from neuralgaits.systems.walker3d.spatial_records import SpatialConfig, SpatialFacts, SpatialTrained
from neuralgaits.systems.walker3d.spatial_start import section_scale
from neuralgaits.systems.walker3d.spatial_step import step_of_orbit
from neuralgaits.systems.walker3d.step_samples import sampled_steps

FRESH_SEED, FRESH = 2**31, 1024
"""Seed and number of the starts at which the summary is measured; no run can have that seed."""
ITERATIONS = 250
"""Largest number of iterations of the search for a gait."""


@dataclass(frozen=True)
class SpatialSystem(TrainedSystem):
    """The family's own part."""

    family: SystemFamily = FAMILY
    config: type[Any] = SpatialConfig
    summary: type[Any] = SpatialTrained
    spec_files: tuple[Path, ...] = (
        Path(__file__).parent / "spatial_orbit.py",
        Path(__file__).parent / "step_samples.py",
    )
    steps: int = ITERATIONS
    robot_file: Path = Path(__file__).parent / "walker3d.xml"

    def read(self, text: str, name: str) -> tuple[Any, Any]:
        """Read model and file. Raises: RobotError with all that is wrong."""
        robot = read_spatial(text, name)
        return robot.walker, robot

    def robot_facts(self, robot: Any, data: Any) -> SpatialFacts:
        """Describe a robot file."""
        del data
        return SpatialFacts(
            robot=robot.name,
            mass_kg=robot.mass,
            torso_kg=robot.torso_mass,
            thigh_kg=robot.thigh.mass,
            shin_kg=robot.shin.mass,
            thigh_m=robot.thigh.length,
            shin_m=robot.shin.length,
            hip_width_m=robot.hip_width,
            armature_kg_m2=robot.armature,
            torque_limits_nm=robot.torque_limits,
            gravity_m_s2=robot.gravity,
            unactuated=2,
        )

    def robot_screen(self, facts: SpatialFacts) -> Screen:
        """Return a robot's numbers for a person."""
        roll, pitch, knee = facts.torque_limits_nm
        masses = f"torso {facts.torso_kg:.4g}, thighs {facts.thigh_kg:.4g}, shins "
        return Screen(
            facts=[
                ("robot", f"{facts.robot}, {self.family.words}"),
                ("mass", f"{facts.mass_kg:.4g} kg: {masses}{facts.shin_kg:.4g} kg each"),
                ("legs", f"thigh {facts.thigh_m:.4g} m, shin {facts.shin_m:.4g} m, point feet"),
                ("hips", f"{facts.hip_width_m:.4g} m apart, roll before pitch"),
                ("motors", f"hip roll {roll:.4g}, hip pitch {pitch:.4g}, knee {knee:.4g} N m"),
                ("unactuated", "2 of 8 degrees of freedom on a foot, the yaw held"),
            ]
        )

    def new_config(
        self, *, seed: int, steps: int, hidden: tuple[int, ...] | None, robot: str
    ) -> SpatialConfig:
        """Return the configuration of a training. Raises: InputError on bad settings."""
        if hidden is not None:
            raise InputError("hidden: expected none, found some: this policy has no network")
        return SpatialConfig(robot=robot, seed=seed, steps=steps, speed_m_s=0.0, step_s=0.0)

    def untrained(self, config: Any) -> SpatialGait:
        """Return a gait of zeros, to read arrays into."""
        del config
        return empty_gait()

    def refuse_controller(self, controller: SpatialGait, file: Path) -> None:
        """Refuse arrays that no training leaves. Raises: RunError naming their file."""
        begin, end = controller.policy.ends
        diagonal = np.diag(np.asarray(controller.inlet))
        if not begin < 0.0 < end or not np.all(diagonal > 0.0):
            raise RunError(
                f"expected a step from behind to ahead of the foot and an inlet with a volume in "
                f"{file}, found others: the file was changed; train again"
            )

    def train(self, robot: Any, config: Any, progress: TrainingProgress | None) -> SpatialGait:
        """Find a periodic gait, and the inlet about its orbit."""
        orbit = find_orbit(robot, OrbitAims.of(robot), config.steps, progress)
        return gait_of(orbit, section_scale(robot, orbit.policy.pendulum))

    def measured(self, run: Any) -> dict[str, Any]:
        """Return what one step from random starts of the inlet needs, and the orbit's figures."""
        robot, gait = run.robot, run.controller
        found = sampled_steps(robot, gait, jax.random.key(FRESH_SEED), FRESH)
        scale = section_scale(robot, gait.policy.pendulum)
        _, section = exact_period(robot, gait.policy, gait.start, scale)
        duration = step_of_orbit(robot, gait.policy, gait.start)
        length = float(gait.policy.ends[1] - gait.policy.ends[0])
        widths = np.linalg.norm(gait.inlet, axis=1)
        multipliers = np.sort(np.abs(np.linalg.eigvals(section)))[::-1]
        return {
            "margins": found.margins,
            "samples": FRESH,
            "speed_m_s": length / duration,
            "step_m": length,
            "step_s": duration,
            "multipliers": tuple(float(x) for x in multipliers),
            "friction": found.friction,
            "peak_torque_nm": found.torque,
            "yaw_nm": found.yaw,
            "inlet_m": float(widths[0]),
            "inlet_momenta": tuple(float(x / gait.start[1]) for x in widths[1:]),
            "missed_m": found.missed,
        }
