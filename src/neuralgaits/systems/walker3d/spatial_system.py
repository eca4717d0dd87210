"""Bipeds in three dimensions as a family: robot files, gaits and what is measured of them."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from typing_extensions import override

from neuralgaits._digits import percent
from neuralgaits._types import Array, Float
from neuralgaits.certificate.chart import Axis
from neuralgaits.errors import RunError
from neuralgaits.records.certified import Conclusion
from neuralgaits.settings.forms import Interval
from neuralgaits.simulation.setup.command_schedule import schedule_of
from neuralgaits.systems.condition_table import ConditionTable
from neuralgaits.systems.controller_header import ControllerHeader
from neuralgaits.systems.family_run import FamilyRun
from neuralgaits.systems.proof_model import trace_conditions
from neuralgaits.systems.proved_system import ExportedSystem
from neuralgaits.systems.system_family import Screen
from neuralgaits.systems.trained_system import TrainingProgress
from neuralgaits.systems.walker3d import FAMILY, spatial_conditions, spatial_tube
from neuralgaits.systems.walker3d.orbit_search import exact_period, find_orbit
from neuralgaits.systems.walker3d.spatial_conditions import spatial_margins
from neuralgaits.systems.walker3d.spatial_export import header_of, law_of, random_states
from neuralgaits.systems.walker3d.spatial_figures import (
    draw_footprints,
    draw_sections,
    draw_slices,
    draw_step,
)
from neuralgaits.systems.walker3d.spatial_gait import AbstractSpatialGait, empty_gait
from neuralgaits.systems.walker3d.spatial_levels import TABLE, conclude, table_with, told_speeds
from neuralgaits.systems.walker3d.spatial_mjcf import SpatialRobot, read_spatial
from neuralgaits.systems.walker3d.spatial_orbit import OrbitAims
from neuralgaits.systems.walker3d.spatial_records import (
    SpatialConfig,
    SpatialFacts,
    SpatialTrained,
    refuse_speeds,
    speed_range,
)
from neuralgaits.systems.walker3d.spatial_screens import screen_of_walks
from neuralgaits.systems.walker3d.spatial_start import section_scale
from neuralgaits.systems.walker3d.spatial_step import step_of_orbit
from neuralgaits.systems.walker3d.spatial_trace import trace_walks
from neuralgaits.systems.walker3d.spatial_walker import SpatialWalker
from neuralgaits.systems.walker3d.spatial_walks import (
    STEPS,
    SpatialWalks,
    WalkPlan,
    simulate_walks,
    starts_of,
)
from neuralgaits.systems.walker3d.speed_fit import widest_speed_gait
from neuralgaits.systems.walker3d.speed_gait import empty_speed_gait
from neuralgaits.systems.walker3d.tube_fit import widest_gait
from neuralgaits.systems.walker3d.tube_samples import needs_in_tube, sampled_margins


class SpatialSystem(ExportedSystem):
    """Model, training, proofs and words of bipeds in three dimensions."""

    family, table = FAMILY, TABLE
    config, summary = SpatialConfig, SpatialTrained
    spec_files = tuple(Path(str(one.__file__)) for one in (spatial_conditions, spatial_tube))
    steps = 250
    highest = 3
    state_size = 20
    why_highest = "a walker's levels in three dimensions are about its hybrid zero dynamics"
    about_proofs = "the rigid model's projected hybrid zero dynamics, the yaw of the torso held"
    robot_file = Path(__file__).with_name("walker3d.xml")

    def read(self, text: str, name: str) -> tuple[SpatialWalker, SpatialRobot]:
        """Read model and file. Raises: RobotError with all that is wrong."""
        robot = read_spatial(text, name)
        return robot.walker, robot

    def robot_facts(self, robot: SpatialWalker, data: SpatialRobot) -> SpatialFacts:
        """Return masses, lengths and limits of a robot file for `inspect`."""
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
            friction=robot.friction,
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
                ("floor", f"friction {facts.friction:g}"),
                ("unactuated", "2 of 8 degrees of freedom on a foot, the yaw held"),
            ]
        )

    def new_config(
        self, *, seed: int = 0, steps: int | None = None, speed: float | Interval | None = None
    ) -> SpatialConfig:
        """Return the configuration of a training of a robot that is yet to be read.

        Args:
            seed: seed that the run keeps; nothing is drawn.
            steps: iterations at most; the usual number if None.
            speed: speed to walk at [m/s]; one that goes with the legs' length if None.

        Raises: InputError on bad settings.
        """
        if speed is not None:
            refuse_speeds(speed)
        told = speed_range(*speed) if isinstance(speed, tuple) else None
        return SpatialConfig(
            robot="",
            seed=seed,
            steps=self.steps if steps is None else steps,
            aimed_speed_m_s=None if isinstance(speed, tuple) else speed,
            speeds_m_s=told,
        )

    @override
    def untrained(self, config: Any) -> AbstractSpatialGait:
        return empty_gait() if config.command is None else empty_speed_gait(config.command)

    @override
    def table_of(self, config: SpatialConfig) -> ConditionTable:
        command = config.command
        return TABLE if command is None else table_with([Axis(*one) for one in command.axes])

    def refuse_controller(self, controller: AbstractSpatialGait, file: Path) -> None:
        """Refuse arrays that no training leaves. Raises: RunError naming their file."""
        gait = controller.typical
        begin, end = gait.policy.ends
        _, axes = gait.tube.sections(np.zeros(1))
        if not begin < 0.0 < end or not np.linalg.det(axes[0]) > 0.0:
            raise RunError(
                f"expected a step from behind to ahead of the foot and a tube with a volume in "
                f"{file}, found others: the file was changed; train again"
            )

    def train(
        self, robot: SpatialWalker, config: SpatialConfig, progress: TrainingProgress | None
    ) -> AbstractSpatialGait:
        """Find a periodic gait, or one for each speed of a range, and the tube of its steps."""
        if (command := config.command) is not None:
            table = self.table_of(config)
            return widest_speed_gait(robot, command, table, config.steps, progress)
        aims = OrbitAims.of(robot, config.aimed_speed_m_s)
        orbit = find_orbit(robot, aims, config.steps, progress)
        return widest_gait(robot, orbit)

    def measured(self, run: FamilyRun) -> dict[str, Any]:
        """Return margins at random points of the tube, and figures of the orbit."""
        robot, gait = run.robot, run.controller.typical
        scale = section_scale(robot, gait.policy.pendulum)
        _, section = exact_period(robot, gait.policy, gait.start, scale)
        duration = step_of_orbit(robot, gait.policy, gait.start)
        length = float(gait.policy.ends[1] - gait.policy.ends[0])
        widths = np.linalg.norm(gait.tube.sections(np.zeros(1))[1][0], axis=1)
        multipliers = np.sort(np.abs(np.linalg.eigvals(section)))[::-1]
        count = 2**15  # In each region.
        seed = 2**31  # No run can have it.
        return {
            "margins": sampled_margins(trace_conditions(run), count, seed, run.table),
            "samples": count,
            "speed_m_s": length / duration,
            "step_m": length,
            "step_s": duration,
            "multipliers": tuple(float(x) for x in multipliers),
            **needs_in_tube(robot, run.controller, run.table, count, seed),
            "inlet_m": float(widths[0]),
            "inlet_momenta": tuple(float(x / gait.start[1]) for x in widths[1:]),
        }

    def sizes(self, done: SpatialTrained) -> str:
        """Return speed, steps and the tube's section where a step starts in words."""
        forward, aside = done.inlet_momenta
        return (
            f"{done.speed_m_s:.2f} m/s, steps of {done.step_m:.3f} m; at their start within "
            f"{1e3 * done.inlet_m:.3g} mm aside, {percent(forward, 1)} of the momentum forward, "
            f"and {percent(aside, 1)} of it aside"
        )

    def margins(self, run: FamilyRun, u: Float[Array, "4"]) -> Mapping[str, Array]:
        """Return the margins at a point of the chart: phase, a point of the cube, commands."""
        return spatial_margins(run.robot, run.controller, u)

    def place(self, run: FamilyRun, u: Float[Array, "4"]) -> tuple[float, float]:
        """Return the hip's place at a point of the chart, forward and to the left."""
        z = run.controller.told(u[4:])[0].state_at(u)
        return float(z[0]), float(z[1])

    def place_in_words(self, place: tuple[float, float]) -> str:
        """Return the hip's place in words."""
        return f"hip {place[0]:.4g} m ahead of the foot and {place[1]:.4g} m to its left"

    def spec_numbers(self, config: SpatialConfig) -> Mapping[str, float]:
        """Return numbers of the configuration that conditions are about: none."""
        del config
        return {}

    @override
    def conclude(
        self, bounds: Mapping[str, float | None], config: SpatialConfig, level: int
    ) -> tuple[Conclusion, ...]:
        return conclude(bounds, level, told_speeds(self.table_of(config).chart) or "")

    @override
    def state_size_of(self, config: SpatialConfig) -> int:
        return self.state_size + (0 if config.command is None else 2)

    @override
    def header(self, run: FamilyRun) -> ControllerHeader:
        return header_of(run)

    def law(self, run: FamilyRun) -> Callable[[Float[Array, " n"]], dict[str, Array]]:
        """Return the law `pd` of a robot on its right foot."""
        return law_of(run)

    def states(self, run: FamilyRun, count: int, seed: int) -> Float[np.ndarray, "count n"]:
        """Return random states near those of the tube."""
        return random_states(run, count, seed)

    def episodes(self, run: FamilyRun, count: int, seed: int) -> tuple[SpatialWalks, bool]:
        """Walk in MuJoCo under `pd`. Returns: record, whether all took all their steps."""
        starts = starts_of(run.controller.typical, count, seed)
        step_s, command = run.summary.step_s, run.config.command
        told = None if command is None else schedule_of((command,))
        plan = WalkPlan(
            controller="pd", starts=starts, steps=STEPS, step_s=step_s, told=told, seed=seed
        )
        done = simulate_walks(run, plan)
        return done, done.walked == done.episodes

    def episodes_screen(self, done: SpatialWalks) -> Screen:
        """Return how many walks took all their steps."""
        return screen_of_walks(done)

    def page_lines(self, run: FamilyRun) -> list[str]:
        """Return the sentences at the head of a run's page, about gait, tube and limits."""
        done = run.summary
        multipliers = ", ".join(f"{one:.2f}" for one in done.multipliers)
        return [
            f"Gait and tube: {self.sizes(done)}.",
            *run.config.about_command,
            f"Multipliers of the orbit: {multipliers} in magnitude, computed in floating point.",
            f"Sampled in the tube: friction up to {done.friction:.2f} of {run.robot.friction:g}, "
            f"torque up to {done.peak_torque_nm:.0f} N m, {done.yaw_nm:.0f} N m to hold the yaw.",
        ]

    def page_figures(self, run: FamilyRun) -> Sequence[tuple[Figure, str]]:
        """Draw a step of the orbit from two sides, walks in MuJoCo from above, and the tube."""
        gait = run.controller.typical
        steps = 10
        pushes = (0.0, 5.0)  # [N s]
        traces = trace_walks(run, steps, pushes)
        titles = [
            f"{'pushed by ' + format(push, 'g') + ' N s to the left' if push else 'not pushed'}"
            f"{', fell' if trace.fell else ''}"
            for push, trace in zip(pushes, traces, strict=True)
        ]
        return (
            (
                draw_step(run.robot, gait),
                "A step of the periodic orbit from the right and from behind",
            ),
            (
                draw_footprints(traces, titles),
                f"{steps} steps in MuJoCo under pd from above, simulated and not proved",
            ),
            (
                draw_slices(gait, traces[0]),
                "The tube less its middle over a step, and the walk not pushed: no proof is about "
                "a state outside of a band. y is how far the hip is to the left of the stance "
                "foot, L_y and n are the momentum about it, forward and sideways",
            ),
            (draw_sections(gait), "Sections of the tube, less its middle: shadows of ellipsoids"),
        )


SYSTEM = SpatialSystem()
