"""Walk at full order: robot, policies and starts in, results of each episode out."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from neuralgaits._checks import check_walked
from neuralgaits._environment import cores
from neuralgaits._types import Array, Float
from neuralgaits.control import AbstractLaw, Controller
from neuralgaits.control.laws import law_named
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
from neuralgaits.simulation.setup.episode_inputs import EpisodeInputs
from neuralgaits.simulation.setup.plant import SUBSTEPS, TIMESTEP_S, Plant, build
from neuralgaits.simulation.setup.push import Push
from neuralgaits.simulation.setup.terrain import Terrain
from neuralgaits.simulation.simulators import MUJOCO, Simulator, check_simulator
from neuralgaits.simulation.ticks.falls import FallConfig
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


def walk(
    robot: PlanarBiped,
    policies: AbstractPolicy | Sequence[AbstractPolicy],
    starts: Float[np.ndarray, "B two_n"],
    *,
    plant: PlanarBiped | None = None,
    robots: Sequence[PlanarBiped] | None = None,
    controller: str | AbstractLaw = "pd",
    steps: int = 50,
    z2_range: tuple[float, float] | None = None,
    disturbance: PlantChanges | None = None,
    push: float = 0.0,
    seed: int = 0,
    falls: FallConfig | None = None,
    record: bool = False,
    longest: int = 0,
    watch: Watch | None = None,
    threads: int | None = None,
    remote: Remote | None = None,
    library: Library | None = None,
    orders: CommandSchedule | None = None,
    reset_residual: ResetCorrection = None,
    courses: Courses | None = None,
    first: int = 0,
    simulator: Simulator = MUJOCO,
) -> Walk:
    """Walk from each start.

    Args:
        robot: the controller's model.
        policies: one for all episodes, or one of the same structure for each.
        starts: full states x = (q, dq), standing on leg 0 (rad, rad/s). [B, 2n]
        plant: robot to simulate, `robot` if None; it must have the same joints.
        robots: robots in its place, one for each episode, of the same joints and feet; without
            courses.
        controller: `pd`, `fblin`, `paper`, `clf-qp`, or a law.
        steps: number of walking steps of an episode.
        z2_range: momenta of the policies' training (kg m^2/s); wide bounds if None.
        disturbance: disturbance of the plant.
        push: forward impulse at the pitch axis of the root (N s); see `simulation.setup.push`.
        seed: seed of everything random.
        falls: thresholds of a fall.
        record: keep records and states of episode 0.
        longest: keep records of the first so many ticks of every episode.
        watch: called after each control tick, see `lockstep`.
        threads: threads that step MuJoCo, all cores if None.
        remote: controller processes in place of the law; all episodes then share a policy.
        library: library compiled for this robot and one policy, which then walks natively; else the
            loop is in JAX, as with `remote`, `watch`, Drake, or a law that is not of this package.
        orders: commands of policies that take some; the middle of the ranges if None.
        reset_residual: corrects the impact that their steps begin with.
        courses: courses of blocks in place of floors, one for each episode; they give the orders.
        first: number of the first episode, on which random numbers depend.
        simulator: `drake` in MuJoCo's place; needs the extra of that name.

    Raises: InputError if settings do not fit, or Drake is not installed.
    """
    starts = _checked_starts(robot, starts)
    for one in (plant, *(robots or ())):
        _check_same_joints(robot, one)
    _positive_whole("steps", steps)
    _finite_impulse(push)
    check_simulator(simulator)
    law, count = law_named(controller), len(starts)
    shared = isinstance(policies, AbstractPolicy)
    each = [policies] if shared else _as_many(policies, count)
    if robots is None:
        plants = _plants(robot if plant is None else plant, disturbance, courses)
    else:
        plants = [build(one, disturbance) for one in robots]
    one_plant = plants[0]
    orders = _orders(each[0].commands, orders, courses)
    told = None if courses is not None else _told_height(orders)
    loop = EpisodeLoop(
        plants=plants,
        controllers=[
            _controller(robot, policy, law, one_plant, z2_range, reset_residual) for policy in each
        ],
        shared=shared,
        states=plant_states(one_plant, starts),
        given=EpisodeInputs(
            Terrain(one_plant.disturbance.floor_height, seed, count, told, first),
            Push(push, steps, seed, count, first),
            orders,
            courses,
            seed=seed,
            noisy=not _silent(one_plant),
            first=first,
            record=record,
            longest=longest,
        ),
        steps=steps,
        falls=FallConfig() if falls is None else falls,
        threads=cores() if threads is None else threads,
    )
    compiled = shared and remote is None and watch is None and simulator == MUJOCO and knows(law)
    if library is not None and compiled:
        engine, episodes = "native", loop.run_native(library)
    else:
        engine, episodes = "jax", loop.run_jax(simulator, watch, remote)
    law = loop.controllers[0].law
    return Walk(robot, one_plant, law, engine, simulator, episodes, orders.commands, courses)


def _orders(
    commands: Commands, orders: CommandSchedule | None, courses: Courses | None
) -> CommandSchedule:
    """Return the commands of the episodes: those of courses come before those that are given."""
    if courses is not None:
        return courses.orders
    return CommandSchedule.constant(commands) if orders is None else orders


def _told_height(orders: CommandSchedule) -> float | None:
    """Return the first commanded height of a foothold (m); None without such a command."""
    height = place_of(orders.commands, "step_height")
    return None if height is None else float(orders.first[height])


def _controller(
    robot: PlanarBiped,
    policy: AbstractPolicy,
    law: AbstractLaw,
    field: Plant,
    z2_range: tuple[float, float] | None,
    reset_residual: ResetCorrection,
) -> Controller:
    return Controller.init(
        robot,
        policy,
        law,
        z2_range=z2_range,
        torque_limit=np.minimum(robot.torque_limit, field.torque_limit),
        period_s=SUBSTEPS * TIMESTEP_S,
        reset_residual=reset_residual,
    )


def _plants(
    robot: PlanarBiped, disturbance: PlantChanges | None, courses: Courses | None
) -> list[Plant]:
    """Return the plant of all episodes, or that of each on its course."""
    if courses is None:
        return [build(robot, disturbance)]
    made: dict[int, Plant] = {}
    for course in courses.each:
        if id(course) not in made:
            made[id(course)] = build(robot, disturbance, course)
    return [made[id(course)] for course in courses.each]


def _silent(plant: Plant) -> bool:
    disturbance = plant.disturbance
    return not (disturbance.noise_of_pitch or disturbance.rate_noise)


def plant_states(plant: Plant, starts: Float[np.ndarray, "B two_n"]) -> np.ndarray:
    """Return MuJoCo states of the starts, the stance foot resting on the floor at x = 0."""
    q, dq = np.split(starts, 2, axis=1)
    # On a slope the sphere touches beside its lowest point.
    height = plant.robot.foot_radius * np.sqrt(1.0 + plant.slope**2)
    qpos, qvel = plant.state_map.to_mjcf(q, dq, 0, (0.0, float(height)))
    return np.concatenate([np.zeros((len(starts), 1)), qpos, qvel], axis=1)


def _checked_starts(robot: PlanarBiped, starts: Array) -> Float[np.ndarray, "B two_n"]:
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


def _check_same_joints(robot: PlanarBiped, plant: PlanarBiped | None) -> None:
    if plant is not None and (plant.n, plant.torso) != (robot.n, robot.torso):
        raise InputError(
            f"plant {plant.name} has {plant.n} links, the policy's robot {robot.name} has "
            f"{robot.n}: take a plant with the same joints"
        )


def _positive_whole(name: str, value: int) -> None:
    if not isinstance(value, int | np.integer) or value < 1:
        raise InputError(f"{name}: expected a whole number of at least 1, found {value!r}")
    check_walked(name, int(value))


def _finite_impulse(push: float) -> None:
    if not np.isfinite(push):
        raise InputError(f"push: expected a finite impulse in N s, found {push}")
