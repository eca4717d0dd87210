"""One biped that walks in MuJoCo until it is stopped; it is pushed, tilted and loaded meanwhile."""

from collections import deque
from collections.abc import Mapping
from dataclasses import replace

import jax
import jax.numpy as jnp
import mujoco
import numpy as np

from neuralgaits._quick_jit import quick_jit
from neuralgaits._types import Array, Float
from neuralgaits.simulation.live_floor import Floor
from neuralgaits.simulation.setup.push import DURATION_S
from neuralgaits.simulation.ticks.delay_line import DelayLine
from neuralgaits.systems.family_run import FamilyRun
from neuralgaits.systems.walker3d.live_controllers import LiveController
from neuralgaits.systems.walker3d.live_moment import Footprint, SpatialMoment
from neuralgaits.systems.walker3d.spatial_changes import TICK_S, SpatialChanges
from neuralgaits.systems.walker3d.spatial_gait import SpatialGait
from neuralgaits.systems.walker3d.spatial_ground import slope_of
from neuralgaits.systems.walker3d.spatial_plant import SpatialPlants, Standing, standing
from neuralgaits.systems.walker3d.spatial_walks import LONGEST
from neuralgaits.viewer.plant_sliders import command_slider, plant_sliders, torso_slider
from neuralgaits.viewer.slider import Slider
from neuralgaits.viewer.step_speed import StepSpeed

SAMPLE_TICKS = 16
"""Ticks between two samples of the trail."""
TOO_SLOW = "too slow to finish the step"
"""Why a walk ends of a robot that still stands upright."""


class SpatialLive:
    """A walking robot on a page; implements `viewer.player.PlayableRobot`.

    Attributes:
        run: run whose gait walks.
        plants: the robot in MuJoCo.
    """

    period_s = TICK_S

    def __init__(self, run: FamilyRun):
        """Put the robot into the tube's middle, where it stands until it has a controller."""
        self.run = run
        self._command = command = run.config.command
        self._requested = 0.0 if command is None else command.middle
        gait, walker = run.controller, run.robot
        # A module's method has no hash.
        self._step = quick_jit(lambda pair: gait.step(pair))

        def stand(pair: Float[Array, "2"]) -> Standing:
            step, begin = gait.step(pair), jnp.zeros(())
            middle = step.state(begin, step.tube.section(begin).centre)
            return jax.tree.map(lambda row: row[None], standing(walker, step.policy, middle))

        self._stand = quick_jit(stand)
        self.plants = SpatialPlants.in_the_air(
            run.data, 1, run.summary.step_m, SpatialChanges(), run.config.seed
        )
        self._controller: LiveController | None = None
        self._longest = LONGEST * run.summary.step_s
        self.reset()

    @property
    def _world(self) -> mujoco.MjData:
        """The robot's state; another object after a change of the plant."""
        return self.plants.worlds[0]

    @property
    def settings(self) -> Mapping[str, Slider]:
        """Return the settings of the plant that can be changed, by disturbance."""
        robot = self.run.robot
        late = Slider("motor delay [ms]", 0.0, 12.0, 0.0, 1.0, "from a reading to its torque")
        return {
            **plant_sliders(float(robot.friction), float(max(robot.torque_limits))),
            "torso_shift_left_m": torso_slider("to the left"),
            "delay_ms": late,
        }

    def disturb(self, name: str, value: float) -> None:
        """Change a setting of the plant under the walking robot; the floor turns slowly.

        Raises: InputError for a value out of range.
        """
        changes = replace(self.plants.changes, **{name: value})
        if name == "delay_ms":
            self.plants.changes = changes
            self._delay(self._asked)
        elif name == "slope_deg":
            self.plants.changes = changes
        else:
            self.plants.change(changes)

    @property
    def commands(self) -> Mapping[str, Slider]:
        """Return the sliders of what the gait is told, by name: one, or none."""
        told = self._command
        return {} if told is None else {told.name: command_slider(told)}

    def tell(self, name: str, value: float) -> None:
        """Request a value of a command, which touchdowns go to."""
        del name
        self._requested = value
        if self._controller is not None:
            self._controller.tell(value)

    def control_with(self, controller: LiveController) -> None:
        """Walk under this controller from now on."""
        self._controller = controller
        self._start_controller()

    def _start_controller(self) -> None:
        if self._controller is not None:
            self._controller.start(None if self._command is None else self._requested)

    def _follow(self, pair: Float[np.ndarray, "2"]) -> None:
        """Compare with the tube of a step that was told these speeds from now on."""
        self._pair = pair
        self._gait: SpatialGait = jax.tree.map(np.asarray, self._step(pair))

    def reset(self) -> None:
        """Put the robot into the middle of its tube, on its right foot, told what is requested."""
        self._follow(np.full(2, self._requested))
        # Level, lest the foot behind be born inside; a slope comes back as the robot walks.
        self.plants.turn_floor(Floor(0.0, 0.0))
        self.plants.put(self._stand(self._pair))
        self._delay(np.zeros(6))
        self._start_controller()
        world = self._world
        self._begun = self._touched = float(world.time)
        self._left = False
        self._steps = 0
        self._pace = StepSpeed()
        self._pushed_until, self._force = -1.0, np.zeros(2)
        self._fall: str | None = None
        self._z = np.full(4, np.nan)
        self._ticks = 0
        self._inside = 0
        self._pending: list[np.ndarray] = []
        self._place = 0.0, np.full(3, np.nan), np.nan
        samples = 130  # Of the trail that are kept: some four steps.
        self._trail: deque[np.ndarray] = deque(maxlen=samples)
        self._path: deque[np.ndarray] = deque(maxlen=2 * samples)
        self._prints: deque[Footprint] = deque([self._print(left=False)], maxlen=14)

    def push(self, impulse: Float[np.ndarray, "2"]) -> None:
        """Push the torso forward and to the left [N s], for `DURATION_S`."""
        self._force = np.asarray(impulse, dtype=np.float64) / DURATION_S
        self._pushed_until = float(self._world.time) + DURATION_S - 0.5 * TICK_S

    def margins(self, z: object) -> None:
        """Return none: the page of this robot has no bars."""
        del z

    def tick(self) -> bool:
        """Advance by one control tick. Returns: False after a fall, or without a controller."""
        if self._controller is None or self._fall is not None:
            return False
        done = self._controller.tick(self.plants)
        if done.left != self._left:
            self._touch_down(done.left)
            if not np.array_equal(done.pair, self._pair):
                self._follow(done.pair)
        self._z = done.z
        self._ticks += 1
        self._pending.append(done.z)
        if self._ticks % SAMPLE_TICKS == 0:
            self._path.append(self._world.qpos[:2].copy())
        if not np.all(np.isfinite(done.torques)):
            self._fall = "the gait has no pose here"
            return False
        self._asked = done.torques
        self._turn_floor()
        self.plants.drive(0, self._late.due(done.torques[None])[0], self._pushing)
        if self.plants.fallen(0):
            self._fall = "the hips are low, or the torso leans"
        elif self._world.time - self._touched > self._longest:
            self._fall = TOO_SLOW
        return self._fall is None

    def _delay(self, torques: Float[np.ndarray, "6"]) -> None:
        """Delay torques as the plant is told, these being under way."""
        ticks = self.plants.changes.delay_ticks
        self._asked, self._late = torques, DelayLine(ticks, 1, 6)
        for _ in range(ticks):
            self._late.due(torques[None])

    @property
    def _floor(self) -> Floor:
        """The plane under both feet."""
        return Floor(self.plants.slope, float(self.plants.terrain.levels[0, 0]))

    def _turn_floor(self) -> None:
        """Turn the floor a little towards the requested slope, about the stance foot."""
        plants, requested = self.plants, slope_of(self.plants.changes)
        tilt_ticks = 10  # Ticks between two small turns of the floor.
        if plants.slope == requested or self._ticks % tilt_ticks:
            return
        foot = float(plants.foot_places(np.array([int(self._left)]))[0, 0])
        plants.turn_floor(self._floor.turned(requested, foot, plants.radius, tilt_ticks * TICK_S))

    @property
    def steps(self) -> int:
        """Touchdowns since the last start."""
        return self._steps

    def shown(self) -> SpatialMoment:
        """Return the present moment of the walk."""
        self._compare()
        world, mean = self._world, self._pace.mean
        phase, off, distance = self._place
        return SpatialMoment(
            time=float(world.time),
            walked=float(world.time) - self._begun,
            qpos=world.qpos.copy(),
            hips=self.plants.hips(0),
            z=self._z,
            phase=phase,
            off=off,
            distance=distance,
            share=self._inside / self._ticks if self._ticks else np.nan,
            trail=np.array(self._trail).reshape(-1, 5),
            prints=tuple(self._prints),
            path=np.array(self._path).reshape(-1, 2),
            steps=self._steps,
            speed=float(world.qvel[0]) if mean is None else mean,
            force=np.append(self._pushing, 0.0),
            gait=self._gait,
            told=float(self._pair[1]),
            requested=self._requested,
            slope=self.plants.slope,
            ground=self._floor.height(float(world.qpos[0])),
            fall=self._fall,
            upright=self._fall == TOO_SLOW,
        )

    @property
    def _pushing(self) -> Float[np.ndarray, "2"]:
        """Force of the push under way [N]; 0 without one."""
        return self._force if self._world.time < self._pushed_until else np.zeros(2)

    def _touch_down(self, left: bool) -> None:
        self._left = left
        self._steps = self._steps + 1
        self._touched = float(self._world.time)
        self._compare()
        self._trail.append(np.full(5, np.nan))
        self._pace.touch_down(self._steps, self._touched, float(self._world.qpos[0]))
        self._prints.append(self._print(left=left))

    def _print(self, *, left: bool) -> Footprint:
        place = self._world.geom_xpos[self.plants.tree.feet[int(left)]]
        x, y = float(place[0]), float(place[1])
        return Footprint(x, y, left, self._floor.height(x))

    def _compare(self) -> None:
        """Compare the ticks since the last comparison with the tube, all at once."""
        if not self._pending:
            return
        states, self._pending = np.array(self._pending), []
        phases, off, w = self._gait.deviations(states)
        distance = np.linalg.norm(w, axis=1)
        self._inside += int(np.count_nonzero(distance <= 1.0))
        rows = np.column_stack([phases, off, distance])
        self._trail.extend(rows[::SAMPLE_TICKS])
        self._place = float(phases[-1]), off[-1], float(distance[-1])
