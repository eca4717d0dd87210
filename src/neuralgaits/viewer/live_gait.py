"""The gait of a live page: it walks, responds to disturbances and jumps, and has margins."""

import math
from collections.abc import Mapping

import numpy as np

from neuralgaits._commands import ADAPTABLE
from neuralgaits._types import Float
from neuralgaits.analysis.point_evaluator import PlaneChart, PointEvaluator
from neuralgaits.analysis.run import Run
from neuralgaits.control.command_belief import SETTLED
from neuralgaits.errors import InputError
from neuralgaits.gait.commands import LEAN, SLOPE, command_named, place_of
from neuralgaits.gait.zero_coordinates import momentum_of, position_of
from neuralgaits.robots.mjcf_state import Sensors
from neuralgaits.simulation.live import LiveWalk
from neuralgaits.simulation.native_walk import engine_of_trained
from neuralgaits.simulation.setup.command_schedule import CommandSchedule
from neuralgaits.simulation.setup.live_course import LiveCourse
from neuralgaits.simulation.setup.plant import PERIOD_S
from neuralgaits.simulation.setup.starts import controlled_gait
from neuralgaits.simulation.setup.terrain_kinds import commands_from_terrain
from neuralgaits.simulation.ticks.falls import Ending
from neuralgaits.viewer.believed_lean import lean_of
from neuralgaits.viewer.live_monitor import LiveMonitor
from neuralgaits.viewer.plant_changes import changed_settings, off_proof_words
from neuralgaits.viewer.plant_sliders import AHEAD, command_slider, plant_sliders
from neuralgaits.viewer.slider import Slider
from neuralgaits.viewer.state_margins import StateMargins
from neuralgaits.viewer.step_speed import StepSpeed
from neuralgaits.viewer.trail import Trail
from neuralgaits.viewer.walker import Margins, WalkFrame

_LEAN = 5e-5
"""Difference of leans that is not shown [m]."""


class LiveGait:
    """Live walk of a run's gait; implements `viewer.walker.Walker`.

    Attributes:
        run: run whose gait walks; for a family, at the initial command of its walks.
        chart: chart of its tube.
        live: the walk.
    """

    period_s = PERIOD_S

    def __init__(self, run: Run, terrain: str | None = None):
        """Put the robot into the middle of its region, without compiling anything yet.

        Args:
            run: run of the gait.
            terrain: blocks in place of the floor, as in `simulate`; a family of gaits is then
                shown at the initial command of its walks.

        Raises: InputError if the gait does not take the commands that the terrain needs.
        """
        ground = None
        self._on = terrain
        if terrain is not None:
            base = CommandSchedule.constant(run.trained.commands)
            ground = LiveCourse(terrain, run.robot, run.gait.policy, base)
            names = (c.name for c in run.trained.commands)
            first = map(float, ground.courses.schedule.first)
            run = run.at(**dict(zip(names, first, strict=True)))
        self.run = run
        self.chart = PlaneChart(run.gait, run.spec)
        zd = run.zero_dynamics
        self._onto = PointEvaluator(lambda z: {"x": zd.phi_inv(z)})
        self._middle = self.chart.z(*np.full((2, 1), 0.5))[0]
        self.live = LiveWalk(
            controlled_gait(run).under("pd"),
            self._state(self._middle),
            library=engine_of_trained(run).library,
            ground=ground,
        )
        self.live.control.adapt(self.adapts_at_first)
        self._first = self.live.commands
        self._margins = StateMargins(run.spec, self.chart)
        self._monitor: LiveMonitor | None = None
        self._beliefs_within: float | None = None
        self._proved_of = ""
        self._z = self._middle
        self._begun = 0.0
        self._pace, self._trail = StepSpeed(), Trail()

    def look_with(self, evaluate: PointEvaluator) -> None:
        """Enable live evaluation of margins by this evaluator."""
        self._margins.evaluate = evaluate

    def watch_with(
        self,
        monitor: LiveMonitor | None,
        beliefs_within: float | None = None,
        proved_of: str = "",
    ) -> None:
        """Show what is proved from now on.

        Args:
            monitor: counts the ticks in the proved sets; None if there are none.
            beliefs_within: distance of a belief up to which something is proved (m).
            proved_of: robot and floor that the proof is about, in words; "" if nothing is proved.
        """
        self._monitor, self._beliefs_within = monitor, beliefs_within
        self._proved_of = proved_of

    @property
    def settings(self) -> Mapping[str, Slider]:
        """Return the settings of the plant that can be changed, well beyond what gaits tolerate."""
        robot = self.run.robot
        values = plant_sliders(float(robot.friction), float(np.max(robot.torque_limit)))
        if robot.torso is None:
            del values[AHEAD]
        if self._on is not None:
            del values["slope_deg"]
        return values

    @property
    def commands(self) -> Mapping[str, Slider]:
        """Return the commands that a visitor may give at each touchdown, with their ranges."""
        own = () if self._on is None else commands_from_terrain(self._on)
        return {c.name: command_slider(c) for c in self.run.trained.commands if c.name not in own}

    @property
    def sizes(self) -> Mapping[str, Slider]:
        """Return the sizes of the blocks ahead that a visitor may change, with their ranges."""
        return {name: Slider(f"{name} [m]", *size) for name, size in self.live.sizes.items()}

    def resize(self, name: str, size: float) -> None:
        """Change a size of the blocks that the robot has not seen yet (m)."""
        self.live.resize(name, size)

    def tell(self, name: str, value: float) -> None:
        """Request a command, which takes effect at the next touchdown."""
        command = command_named(self.run.trained.commands, name)
        if command is not None:
            # Degrees are rounded.
            value = min(max(value, command.low), command.high)
        self.live.tell(**{name: value})
        if name == SLOPE:
            self.live.disturb(slope_deg=math.degrees(value))

    @property
    def adaptable(self) -> tuple[str, ...]:
        """Return the gait's commands that can be adapted."""
        names = [command.name for command in self.run.trained.commands]
        return tuple(name for name in ADAPTABLE if name in names)

    @property
    def adapts_at_first(self) -> bool:
        """Return whether they are adapted from the start: beliefs are, except on blocks."""
        return self._on is None and any(name in SETTLED for name in self.adaptable)

    def adapt(self, active: bool) -> None:
        """Adapt these commands to what the robot does from now on, or no longer."""
        self.live.control.adapt(active)

    def tick(self) -> bool:
        """Advance by one control tick. Returns: False once the robot has fallen."""
        walks = self.live.tick()
        monitor, measured = self._monitor, self.live.measured
        if self.steps != self._pace.steps:
            if monitor is not None:
                monitor.touch_down()
            self._pace.touch_down(self.steps, self.live.time, float(self._sensors().base[0]))
        if measured is not None:
            self._z = measured.z
            self._trail.add(self._z, self.steps)
            if walks and monitor is not None:
                monitor.add(measured)
        return walks

    def shown(self) -> WalkFrame:
        """Return the present moment of the walk."""
        live = self.live
        sensors = self._sensors()
        mean = self._pace.mean
        ending: Ending = live.ending
        lean = lean_of(
            self.run.trained.commands,
            live.commands[1],
            live.plant.disturbance.torso_shift_m,
            self._beliefs_within,
            doubted=LEAN in live.control.doubted,
        )
        near = lean is not None and (lean.covered or abs(lean.true - lean.believed) < _LEAN)
        # The proof is about robots that lean as they believe, or so nearly.
        changes = self._changes(torso=not near)
        # The line of a belief says by itself when the proof is about no such torso.
        said = self._changes(torso=False) if lean is not None and lean.proved_within else changes
        return WalkFrame(
            time=live.time,
            walked=live.time - self._begun,
            qpos=live.data.qpos.copy(),
            hip=sensors.base,
            slope=live.floor.slope,
            ground=live.height(float(sensors.base[0])),
            z=self._z,
            trail=self._trail.states,
            steps=self.steps,
            speed=float(sensors.base_velocity[0]) if mean is None else mean,
            force=live.pushing,
            fall=ending.reason,
            upright=ending.upright,
            tops=None if live.course is None else live.course.tops,
            laps=live.laps,
            speeds=live.control.speeds,
            lean=lean,
            memberships=() if self._monitor is None else self._monitor.memberships(),
            off_proof=off_proof_words(said, self._proved_of),
            changed=bool(changes),
        )

    def _changes(self, *, torso: bool) -> tuple[str, ...]:
        """Return how robot and floor differ from those of margins and proof; () if they do not.

        Args:
            torso: whether a torso whose centre of mass was moved is a difference.
        """
        settings = dict(self.settings)
        if not torso:
            settings.pop(AHEAD, None)
        place = place_of(self.run.trained.commands, SLOPE)
        slope = None if place is None else float(self.live.commands[1][place])
        return changed_settings(settings, self.live.plant.disturbance, slope)

    @property
    def steps(self) -> int:
        """Return the number of touchdowns since the last start."""
        outcome = self.live.outcome
        return 0 if outcome is None else int(outcome.steps[0])

    def _sensors(self) -> Sensors:
        live = self.live
        return live.plant.state_map.sensors(live.data.qpos, live.data.qvel)

    def margins(self, z: Float[np.ndarray, "2"]) -> Margins:
        """Return margins of all conditions at a state, or at the nearest state where they apply.

        For a family, they belong to the gait on the chart; there are none at other commands.
        """
        if self._elsewhere:
            return self._margins.none("the robot gets another command than the gait on the chart")
        return self._margins.at(z)

    @property
    def _elsewhere(self) -> bool:
        """Return whether the robot's command differs from that of the gait on the chart."""
        return not np.allclose(self.live.commands, self._first, atol=1e-9)

    def push(self, impulse: Float[np.ndarray, "2"]) -> None:
        """Push along x and z (N s)."""
        self.live.push(impulse)

    def disturb(self, name: str, value: float) -> None:
        """Change a setting of the plant; a value out of range changes nothing."""
        self.live.disturb(**{name: value})

    def jump(self, z: Float[np.ndarray, "2"]) -> str | None:
        """Put the robot onto the zero dynamics at z, standing on leg 0.

        Returns: the reason, if z is outside of the region or has no pose; None on success.
        """
        z = np.asarray(z, dtype=np.float64)
        if not np.all(np.isfinite(z)):
            return "That is no state of the gait."
        with np.errstate(all="ignore"):
            phase, level = (float(value[0]) for value in self.chart.chart(z[None]))
        if not (0.0 <= phase <= 1.0 and 0.0 <= level <= 1.0 and momentum_of(z) > 0.0):
            return (
                f"z = ({position_of(z):.3f} m, {momentum_of(z):.1f} kg m²/s) is outside of the "
                "region: click between the two thick curves."
            )
        if not self._restart(z):
            return "The policy has no pose for that state."
        return None

    def reset(self) -> None:
        """Put the robot back into the middle of the region; the plant keeps its settings."""
        self._restart(self._middle)

    def _state(self, z: Float[np.ndarray, "2"]) -> Float[np.ndarray, " two_n"]:
        """Return the full state on the zero dynamics (rad, rad/s). [2n]."""
        return self._onto(z[None])["x"][0]

    def _restart(self, z: Float[np.ndarray, "2"]) -> bool:
        """Put the robot onto z. Returns: False, with nothing changed, if z has no pose."""
        try:
            self.live.place(self._state(z))
        except InputError:
            return False
        self._z = z
        self._begun = self.live.time
        self._pace, self._trail = StepSpeed(), Trail()
        if self._monitor is not None:
            self._monitor.restart()
        return True
