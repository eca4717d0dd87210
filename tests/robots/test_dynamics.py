"""The closed form against MuJoCo, and against the laws of mechanics."""

import equinox as eqx
import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from neuralgaits._types import Array
from neuralgaits.errors import InputError
from neuralgaits.robots import PlanarBiped, dynamics
from support.batched import batched
from support.floating_base import FloatingBase, motor_controls

STATES = 1000
TOLERANCE = 1e-9


def random_states(robot: PlanarBiped, count: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    return rng.uniform(-1.5, 1.5, (count, robot.n)), rng.normal(0.0, 3.0, (count, robot.n))


def assert_close(ours: np.ndarray, reference: np.ndarray, scale: float | None = None) -> None:
    largest = np.max(np.abs(reference)) if scale is None else scale
    assert np.max(np.abs(ours - reference)) <= TOLERANCE * largest


@batched
def in_mujoco(robot: PlanarBiped, q: Array, dq: Array) -> tuple[Array, ...]:
    """What MuJoCo knows as well."""
    return (
        robot.mass_matrix(q),
        robot.bias(q, dq),
        robot.swing_foot(q),
        robot.centre_of_mass(q),
        dynamics.swing_foot_velocity(robot, q, dq),
        dynamics.centre_of_mass_velocity(robot, q, dq),
        dynamics.angular_momentum(robot, q, dq),
    )


@batched
def forced(robot: PlanarBiped, q: Array, dq: Array, torque: Array) -> tuple[Array, Array]:
    """Acceleration, and the ground's force with it."""
    ddq = robot.acceleration(q, dq, torque)
    return ddq, robot.ground_reaction_force(q, dq, ddq)


@batched
def held_and_slope(robot: PlanarBiped, q: Array) -> tuple[Array, Array]:
    """The bias at rest, and the slope of potential energy."""
    return robot.bias(q, jnp.zeros(robot.n)), jax.grad(robot.potential_energy)(q)


mass_matrix = batched(PlanarBiped.mass_matrix)


@batched
def power(robot: PlanarBiped, position: Array, rate: Array) -> tuple[Array, Array]:
    """What dD/dt gives and what the bias takes."""
    _, mass_rate = jax.jvp(robot.mass_matrix, (position,), (rate,))
    return rate @ (mass_rate @ rate), 2.0 * rate @ robot.bias(position, rate)


def test_agrees_with_mujoco(robot: PlanarBiped) -> None:
    q, dq = random_states(robot, STATES)
    mass, bias, foot, com, foot_rate, com_rate, momentum = in_mujoco(robot, q, dq)
    base = FloatingBase.of(robot)
    for i in range(STATES):
        stance = i % 2
        pinned = base.pinned(q[i], dq[i], stance)
        assert_close(mass[i], pinned.mass_matrix)
        assert_close(bias[i], pinned.bias)
        position, jacobian, _ = base.foot(1 - stance)
        speed = np.max(np.abs(dq[i])) * robot.leg_length
        assert_close(foot[i], position, robot.leg_length)
        assert_close(foot_rate[i], jacobian @ base.data.qvel, speed)
        reference, reference_rate = base.com()
        assert_close(com[i], reference, robot.leg_length)
        assert_close(com_rate[i], reference_rate, speed)
        about_foot = base.angular_momentum(np.zeros(2))
        assert_close(momentum[i], np.array(about_foot), np.sum(np.abs(mass[i][0] * dq[i])))


def test_forward_dynamics_and_ground_force_solve_the_floating_base(robot: PlanarBiped) -> None:
    count = 50
    q, dq = random_states(robot, count, seed=1)
    torque = np.random.default_rng(2).normal(0.0, 30.0, (count, robot.n - 1))
    ddq, force = forced(robot, q, dq, torque)
    base = FloatingBase.of(robot)
    # The file's own torque limits are not what is tested here.
    base.model.actuator_ctrllimited[:] = 0
    base.model.actuator_forcelimited[:] = 0
    ctrl = motor_controls(robot, base.states, torque, np.arange(count) % 2)
    for i in range(count):
        stance = i % 2
        pinned = base.pinned(q[i], dq[i], stance)
        acceleration = pinned.embedding @ ddq[i] + pinned.drift
        base.data.ctrl[:] = ctrl[i]
        needed = base.mass_matrix() @ acceleration + base.resistance()
        pushed = actuator_force(base) + base.foot(stance)[1].T @ force[i]
        assert_close(pushed, needed)


def actuator_force(base: FloatingBase) -> np.ndarray:
    mujoco.mj_fwdActuation(base.model, base.data)
    return base.data.qfrc_actuator.copy()


def test_mass_matrix_is_symmetric_positive_definite(robot: PlanarBiped) -> None:
    q, _ = random_states(robot, 200)
    mass = mass_matrix(robot, q)
    assert np.max(np.abs(mass - mass.transpose(0, 2, 1))) <= 1e-14 * np.max(mass)
    assert np.min(np.linalg.eigvalsh(mass)) > 0.0


def test_coriolis_terms_do_no_work(robot: PlanarBiped) -> None:
    """The power dq . (dD/dt - 2 C) dq is 0, with C dq the bias without gravity and friction."""
    bare = eqx.tree_at(lambda r: (r.gravity, r.damping), robot, (np.zeros(()), np.zeros(robot.n)))
    q, dq = random_states(robot, 100)
    assert_close(*power(bare, q, dq))


def test_gravity_is_the_slope_of_potential_energy(robot: PlanarBiped) -> None:
    q, _ = random_states(robot, 100)
    assert_close(*held_and_slope(robot, q))


def test_energy_is_conserved_and_the_step_has_order_four(few: PlanarBiped) -> None:
    free = eqx.tree_at(lambda r: r.damping, few, np.zeros(few.n))
    q, dq = (value[0] * 0.3 for value in random_states(few, 1, seed=3))
    start = jnp.concatenate([jnp.asarray(q), jnp.asarray(dq)])

    def energy(state: jax.Array) -> jax.Array:
        position, rate = jnp.split(state, 2)
        return free.kinetic_energy(position, rate) + free.potential_energy(position)

    def flow(state: jax.Array) -> jax.Array:
        position, rate = jnp.split(state, 2)
        ddq = free.acceleration(position, rate, jnp.zeros(free.n - 1))
        return jnp.concatenate([rate, ddq])

    @jax.jit
    def drift(step: jax.Array, count: int) -> jax.Array:
        def advance(_: int, x: jax.Array) -> jax.Array:
            k1 = flow(x)
            k2 = flow(x + 0.5 * step * k1)
            k3 = flow(x + 0.5 * step * k2)
            return x + step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + flow(x + step * k3))

        return energy(jax.lax.fori_loop(0, count, advance, start)) - energy(start)

    scale = float(free.kinetic_energy(*jnp.split(start, 2))) + float(free.mass * free.gravity)
    coarse, fine = (abs(float(drift(jnp.asarray(0.3 / c), c))) for c in (200, 400))
    assert fine <= 1e-9 * scale
    # Order four leaves at most a sixteenth; near rounding there is nothing left to compare.
    assert fine <= coarse / 12.0 or fine <= 1e-14 * scale


def test_rotors_add_inertia_but_no_momentum(amber: PlanarBiped) -> None:
    q, dq = (value[0] for value in random_states(amber, 1))
    bare = eqx.tree_at(lambda r: r.armature, amber, np.zeros(amber.n))
    difference = amber.mass_matrix(q) - bare.mass_matrix(q)
    np.testing.assert_allclose(difference, np.diag(amber.armature), atol=1e-14)
    row = -(amber.mass_matrix(q) @ dq)[0]
    np.testing.assert_allclose(dynamics.angular_momentum(amber, q, dq), row, rtol=1e-13)


@pytest.mark.parametrize(
    ("method", "wrong", "message"),
    [
        ("mass_matrix", (np.zeros(4),), r"q: expected shape \(5,\), found \(4,\)"),
        ("mass_matrix", (np.zeros((7, 5)),), r"q: .*found \(7, 5\); use jax.vmap"),
        ("bias", (np.zeros(5), np.zeros(())), r"dq: expected shape \(5,\), found \(\)"),
        ("impact", (np.zeros((2, 5)), np.zeros((2, 5))), r"q: .*use jax.vmap"),
        ("impact", (np.full(5, np.nan), np.zeros(5)), r"q: expected finite numbers, found \[nan,"),
        ("swing_foot", (np.zeros(3),), "q: expected shape"),
        ("centre_of_mass", (np.zeros(3),), "q: expected shape"),
        ("kinetic_energy", (np.zeros(5), np.full(5, np.inf)), "dq: expected finite numbers"),
        ("potential_energy", (np.zeros(3),), "q: expected shape"),
        ("acceleration", (np.zeros(5), np.zeros(5), np.zeros(5)), r"torque: .*\(4,\), found \(5,"),
        ("ground_reaction_force", (np.zeros(5), np.zeros(5), np.zeros(1)), "ddq: expected shape"),
    ],
)
def test_wrong_shapes_and_numbers_are_one_line(
    amber: PlanarBiped, method: str, wrong: tuple, message: str
) -> None:
    with pytest.raises(InputError, match=message) as refusal:
        getattr(amber, method)(*wrong)
    assert "\n" not in str(refusal.value)


def test_a_list_is_a_state_too(amber: PlanarBiped) -> None:
    assert amber.mass_matrix([0.0] * 5).shape == (5, 5)  # pyright: ignore[reportArgumentType]
