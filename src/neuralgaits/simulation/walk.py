"""Walk at full order: robot, policies and starts in, results of each episode out."""

from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass

import numpy as np

from neuralgaits._called_with import called_with
from neuralgaits._checks import check_walked
from neuralgaits._environment import cores
from neuralgaits._types import Array, Float
from neuralgaits.control import AbstractLaw, Controller
from neuralgaits.control.joint_model import JointModel
from neuralgaits.control.law_by_name import law_named
from neuralgaits.control.measurement import SensedRobot
from neuralgaits.errors import InputError
from neuralgaits.gait import AbstractPolicy
from neuralgaits.gait.commands import Commands, place_of
from neuralgaits.gait.reset_residual import ResetCorrection
from neuralgaits.robots import PlanarBiped
from neuralgaits.simulation.episode_loop import EpisodeLoop
from neuralgaits.simulation.linked.remote import Remote
from neuralgaits.simulation.native.compiled_walk import Library
from neuralgaits.simulation.native.native_scene import knows
from neuralgaits.simulation.setup.command_schedule import CommandSchedule
from neuralgaits.simulation.setup.course import Courses
from neuralgaits.simulation.setup.disturbance import PlantChanges
from neuralgaits.simulation.setup.drives import law_of_drives
from neuralgaits.simulation.setup.episode_inputs import EpisodeInputs
from neuralgaits.simulation.setup.plant import PERIOD_S, Plant, build, rolling_foot
from neuralgaits.simulation.setup.push import Push
from neuralgaits.simulation.setup.uneven_floor import UnevenFloor
from neuralgaits.simulation.simulators import MUJOCO, Simulator, check_simulator
from neuralgaits.simulation.ticks.lockstep import EpisodeBatch, Watch


@dataclass(frozen=True)
class Walk:
    """Settings and results of a simulated walk.

    Attributes:
        robot: the controller's model.
        plant: plant that walked.
        law: control law.
        engine: loop that ran: `native` or `jax`.
        simulator: simulator of the plant: `mujoco` or `drake`.
        episodes: outcome of every episode.
        commands: commands of the gait.
        courses: courses of blocks; None for floors.
    """

    robot: PlanarBiped
    plant: Plant
    law: AbstractLaw
    engine: str
    simulator: Simulator
    episodes: EpisodeBatch
    commands: Commands = ()
    courses: Courses | None = None


@dataclass(frozen=True, kw_only=True)
class WalkOptions:
    """Options that walks have from any start, of policies or of a trained gait."""

    plant: SensedRobot | None = None
    """Robot to simulate, the controller's model if None; it must have the same joints."""
    controller: str | AbstractLaw = "pd"
    """`pd`, `fblin`, `paper`, `clf-qp`, or a law; `scheduled-pd` as `law_for` fits it to a gait."""
    steps: int = 50
    """Number of walking steps of an episode."""
    disturbance: PlantChanges | None = None
    """Disturbance of the plant."""
    push: float = 0.0
    """Forward impulse at the pitch axis of the root (N s); see `simulation.setup.push`."""
    seed: int = 0
    """Seed of everything random."""
    threads: int | None = None
    """Threads that step MuJoCo, all cores if None."""
    library: Library | None = None
    """Library compiled for this robot and one policy, which then walks natively; else the loop is
    in JAX, as with `remote`, `watch`, Drake, or a law that is not of this package."""
    schedule: CommandSchedule | None = None
    """Commands of policies that take some; the middle of the ranges if None."""
    joints: JointModel | None = None
    """Rotors and friction that torques are for, those of the controller's model if None."""
    courses: Courses | None = None
    """Courses of blocks in place of floors, one for each episode; they give the schedule."""
    adapt: tuple[str, ...] = ()
    """Commands that are adapted, see `control.speed_adapter` and `control.command_belief`."""
    simulator: Simulator = MUJOCO
    """`drake` in MuJoCo's place; needs the extra of that name."""


@dataclass(frozen=True)
class WalkInputs(WalkOptions):
    """Everything that a walk is given."""

    robot: PlanarBiped
    """The controller's model."""
    policies: AbstractPolicy | Sequence[AbstractPolicy]
    """One for all episodes, or one of the same structure for each."""
    starts: Float[np.ndarray, "B two_n"]
    """Full states x = (q, dq), standing on leg 0 (rad, rad/s). [B, 2n]"""
    _: KW_ONLY
    robots: Sequence[SensedRobot] | None = None
    """Robots in place of `plant`, one for each episode, of the same joints and feet; without
    courses."""
    z2_range: tuple[float, float] | None = None
    """Momenta of the policies' training (kg m^2/s); wide bounds if None."""
    record: bool = False
    """Keep records and states of episode 0."""
    longest: int = 0
    """Keep records of the first so many ticks of every episode."""
    watch: Watch | None = None
    """Called after each control tick, see `lockstep`."""
    remote: Remote | None = None
    """Controller processes in place of the law; all episodes then share a policy."""
    reset_residual: ResetCorrection = None
    """Corrects the impact that their steps begin with."""
    first: int = 0
    """Number of the first episode, on which random numbers depend."""

    def __post_init__(self) -> None:
        for one in (self.plant, *(self.robots or ())):
            _check_same_joints(self.robot, one)
        if not isinstance(self.steps, int | np.integer) or self.steps < 1:
            raise InputError(
                f"--steps: expected a whole number of at least 1, found {self.steps!r}"
            )
        check_walked("steps", int(self.steps))
        if not np.isfinite(self.push):
            raise InputError(f"push: expected a finite impulse in N s, found {self.push}")
        check_simulator(self.simulator)
        if self.simulator != MUJOCO and self.disturbance and self.disturbance.has_drives:
            raise InputError(
                f"expected --simulator {MUJOCO} with the drives' own loops, found "
                f"{self.simulator}: leave one of them out"
            )


@called_with(WalkInputs)
def walk(inputs: WalkInputs) -> Walk:
    """Walk from each start.

    Returns: `Walk`.
    Raises: InputError if settings do not fit, or Drake is not installed.
    """
    robot = inputs.robot
    policies = inputs.policies
    disturbance = inputs.disturbance
    starts = _checked_starts(robot, inputs.starts)
    law, count = law_of_drives(law_named(inputs.controller), disturbance), len(starts)
    shared = isinstance(policies, AbstractPolicy)
    each = [policies] if shared else _as_many(policies, count)
    if inputs.robots is None:
        plants = _plants(inputs.plant or robot, disturbance, inputs.courses)
    else:
        plants = [build(one, disturbance) for one in inputs.robots]
    controllers = [_controller(inputs, policy, law, plants[0]) for policy in each]
    schedule = _schedule(each[0].commands, inputs.schedule, inputs.courses)
    loop = EpisodeLoop(
        plants=plants,
        controllers=controllers,
        shared=shared,
        states=plant_states(plants[0], starts),
        inputs=_inputs(inputs, plants[0], schedule, count),
        steps=inputs.steps,
        threads=cores() if inputs.threads is None else inputs.threads,
    )
    alone = inputs.remote is None and inputs.watch is None and inputs.simulator == MUJOCO
    if inputs.library is not None and shared and alone and knows(law):
        engine, episodes = "native", loop.run_native(inputs.library)
    else:
        engine, episodes = "jax", loop.run_jax(inputs.simulator, inputs.watch, inputs.remote)
    law = loop.controllers[0].law
    return Walk(
        robot, plants[0], law, engine, inputs.simulator, episodes, schedule.commands, inputs.courses
    )


def _inputs(
    inputs: WalkInputs, plant: Plant, schedule: CommandSchedule, count: int
) -> EpisodeInputs:
    """Return what the episodes meet: ground, pushes, commands, noise."""
    seed = inputs.seed
    first = inputs.first
    courses = inputs.courses
    height = None if courses is not None else _told_height(schedule)
    return EpisodeInputs(
        UnevenFloor(plant.disturbance.floor_height, seed, count, height, first),
        Push(inputs.push, inputs.steps, seed, count, first),
        schedule,
        courses,
        seed=seed,
        noisy=plant.disturbance.is_noisy,
        first=first,
        record=inputs.record,
        longest=inputs.longest,
        adapt=inputs.adapt,
    )


def _schedule(
    commands: Commands, schedule: CommandSchedule | None, courses: Courses | None
) -> CommandSchedule:
    """Return the commands of the episodes: those of courses come before those that are given."""
    if courses is not None:
        return courses.schedule
    return CommandSchedule.constant(commands) if schedule is None else schedule


def _told_height(schedule: CommandSchedule) -> float | None:
    """Return the first commanded height of a foothold (m); None without such a command."""
    height = place_of(schedule.commands, "step_height")
    return None if height is None else float(schedule.first[height])


def _controller(
    inputs: WalkInputs, policy: AbstractPolicy, law: AbstractLaw, plant: Plant
) -> Controller:
    return Controller.init(
        inputs.robot,
        policy,
        law,
        z2_range=inputs.z2_range,
        torque_limit=np.minimum(inputs.robot.torque_limit, plant.torque_limit),
        period_s=PERIOD_S,
        reset_residual=inputs.reset_residual,
        joints=inputs.joints,
    )


def _plants(
    robot: SensedRobot, disturbance: PlantChanges | None, courses: Courses | None
) -> list[Plant]:
    """Return the plant of all episodes, or that of each on its course."""
    if courses is None:
        return [build(robot, disturbance)]
    plants: dict[int, Plant] = {}
    for course in courses.each:
        if id(course) not in plants:
            plants[id(course)] = build(robot, disturbance, course)
    return [plants[id(course)] for course in courses.each]


def plant_states(plant: Plant, starts: Float[np.ndarray, "B two_n"]) -> np.ndarray:
    """Return MuJoCo states of the starts, the stance foot on the floor at x = 0.

    A point foot rolls, a flat one lies on the floor's slope.
    """
    q, dq = np.split(starts, 2, axis=1)
    # On a slope the sphere touches beside its lowest point.
    height = plant.robot.foot_radius * np.sqrt(1.0 + plant.slope**2)
    foot, rolling = (0.0, float(height)), rolling_foot(plant.robot, dq)
    lying = float(np.arctan(plant.slope))
    qpos, qvel = plant.state_map.to_mjcf(q, dq, 0, foot, rolling, lying)
    return np.concatenate([np.zeros((len(starts), 1)), qpos, qvel], axis=1)


def _checked_starts(robot: SensedRobot, starts: Array) -> Float[np.ndarray, "B two_n"]:
    array = np.asarray(starts, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != 2 * robot.n or not len(array):
        raise InputError(
            f"starts: expected full states of shape [episodes, {2 * robot.n}], found {array.shape}"
        )
    if not np.all(np.isfinite(array)):
        raise InputError("starts: expected finite full states, found NaN or infinity")
    return array


def _as_many(policies: Sequence[AbstractPolicy], count: int) -> list[AbstractPolicy]:
    if len(policies) != count:
        raise InputError(f"expected one policy or {count}, one a start; found {len(policies)}")
    return list(policies)


def _check_same_joints(robot: SensedRobot, plant: SensedRobot | None) -> None:
    if plant is not None and (plant.n, plant.layout.torso) != (robot.n, robot.layout.torso):
        feet, plant_feet = ("point" if one.feet is None else "flat" for one in (robot, plant))
        other_feet = "" if feet == plant_feet else f", and {plant_feet} feet instead of {feet} ones"
        raise InputError(
            f"plant {plant.name} has {plant.n} links, the policy's robot {robot.name} has "
            f"{robot.n}{other_feet}: take a plant with the same joints"
        )
