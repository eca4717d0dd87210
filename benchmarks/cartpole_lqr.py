"""The proved set of a cart-pole beside the largest that the same search proves for linear feedback.

Asked: more than 1.5 times the volume, over z = (x, theta, s) and over the full state. The linear
force is that of a linear-quadratic regulator with the best of many weights, and its set the
ellipsoid of its own Riccati matrix. In its favour: nothing but V' < 0 is asked of it, where ours
has to decay at a rate; and its weights are chosen for the volume. A second row has gains and
ellipsoid of a linear force trained as ours are, for the same rate.

SEEDS=1 takes fewer gaits, DRAWS=100 fewer weights.
"""

from collections.abc import Mapping
from functools import partial
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import optax
from common import ROOT, seeds, show, whole
from scipy.linalg import solve_continuous_are

from neuralgaits.certificate.search.root_turns import explore
from neuralgaits.programs.tracing.tracer import trace
from neuralgaits.systems.cartpole.cartpole_model import CartPole
from neuralgaits.systems.cartpole.cartpole_training import RECIPE
from neuralgaits.systems.cartpole.cartpole_verbs import SYSTEM
from neuralgaits.systems.equilibrium.ellipsoid import Ball, direction
from neuralgaits.systems.equilibrium.ellipsoid_regions import AXES, CORE
from neuralgaits.systems.family_certificate import certify_family, condition_problems
from neuralgaits.systems.family_run import FamilyRun, open_family_run
from neuralgaits.systems.family_training import train_family

DRAWS = 400
GAIN = 0.03
RATE = SYSTEM.rate
SHRINK = 0.995
ASKED = "asked: more than 1.5"


def rates(robot: CartPole, gains, state):
    """Rates of (x, theta, x', theta') under the force -gains . state, and that force."""
    _, theta, velocity, turning = state
    force = -gains @ state
    coupling, sine = robot.moment * jnp.cos(theta), jnp.sin(theta)
    torque = robot.moment * robot.gravity * sine - robot.pole_damping * turning
    cart = force + robot.moment * sine * turning * turning - robot.cart_damping * velocity
    determinant = robot.mass * robot.inertia - coupling * coupling
    acceleration = (robot.inertia * cart - coupling * torque) / determinant
    angular = (robot.mass * torque - coupling * cart) / determinant
    return jnp.stack([velocity, turning, acceleration, angular]), force


def margins(robot: CartPole, gains, rate, ball: Ball, radius, normal) -> Mapping[str, jax.Array]:
    """Margins by their names in the table of the family."""

    def moved(distance):
        found, force = rates(robot, gains, ball.state(distance, normal))
        return ball.rate(normal, found), force

    (speed, force), (slope, _) = jax.jvp(moved, (radius,), (jnp.ones_like(radius),))
    y = ball.state(radius, normal)
    limits = {
        "force": force / robot.force_limit,
        "rail": y[0] / robot.rail,
        "upright": y[1] / robot.lean,
    }
    found = {"inward": -2.0 * speed, "descent": -speed / radius - rate, "settling": -slope - rate}
    return found | {k: jnp.stack([1.0 - share, 1.0 + share]) for k, share in limits.items()}


def sampled(robot: CartPole, gains, rate, shape, key) -> Mapping[str, jax.Array]:
    """Margins at random states of the regions, most of them on a face."""
    first, second = jax.random.split(key)
    normal = jax.random.normal(first, (RECIPE.samples, 4))
    normal = normal / jnp.linalg.norm(normal, axis=1, keepdims=True)
    share = jax.random.uniform(second, (RECIPE.samples,))
    share = jnp.where(jnp.arange(RECIPE.samples) % 2 == 0, 1.0, share)
    found = {}
    ends = {"face": (1.0, 1.0), "ring": (CORE, 1.0), "core": (0.0, CORE), "set": (0.0, 1.0)}
    for region, (low, high) in ends.items():
        rows = jax.vmap(partial(margins, robot, gains, rate, Ball(shape)))(
            low + (high - low) * share, normal
        )
        found |= {
            name: rows[name].reshape(-1)
            for name, r in SYSTEM.table.conditions.items()
            if r == region
        }
    return found


def linear_system(robot: CartPole):
    """A and B of the state (x, theta, x', theta') at the upright."""
    a = jax.jacobian(lambda y: rates(robot, jnp.zeros(4), y)[0])(jnp.zeros(4))
    b = -jax.jacobian(lambda k: rates(robot, k, jnp.array([1.0, 0.0, 0.0, 0.0]))[0])(jnp.zeros(4))
    return np.asarray(a), np.asarray(b)[:, :1]


def regulator(robot: CartPole, logs: np.ndarray, least) -> tuple[np.ndarray, np.ndarray]:
    """Gains for the weights exp(logs), and the largest ellipsoid of their Riccati matrix."""
    a, b = linear_system(robot)
    matrix = solve_continuous_are(a, b, np.diag(np.exp(logs)), np.eye(1))
    gains = (b.T @ matrix)[0]
    inverse = np.linalg.inv(matrix)
    # Of the ellipsoid y' P y <= c, the largest force squared is c K P^-1 K'.
    limits = (robot.force_limit**2 / (gains @ inverse @ gains), robot.rail**2 / inverse[0, 0])
    size = min(*limits, robot.lean**2 / inverse[1, 1])
    shape = np.linalg.cholesky(size * inverse)
    while least(jnp.asarray(gains), jnp.asarray(shape)) < 0.0:
        shape = 0.97 * shape
    return gains, shape


def best_regulator(robot: CartPole, draws: int) -> tuple[np.ndarray, np.ndarray]:
    """Search the weights for the largest volume: at random, then near the best so far."""
    draw, key = np.random.default_rng(0), jax.random.key(0)

    @jax.jit
    def least(gains, shape):
        found = sampled(robot, gains, 0.0, shape, key)
        return jnp.minimum(found["descent"].min(), found["settling"].min())

    best, where = None, np.zeros(4)
    for number in range(draws):
        spread = 3.0 if number < draws // 2 else 0.5
        logs = where * (number >= draws // 2) + spread * draw.standard_normal(4)
        gains, shape = regulator(robot, logs, least)
        if best is None or np.linalg.det(shape) > np.linalg.det(best[1]):
            best, where = (gains, shape), logs
    assert best is not None
    return best


def trained_linear(robot: CartPole, gains: np.ndarray, shape: np.ndarray):
    """Train gains and ellipsoid of a linear force for the volume, from a regulator's."""
    lower = jnp.tril_indices(4, -1)
    start = {"gains": jnp.ones(4), "sizes": jnp.zeros(4), "slants": jnp.zeros(6)}

    def unpacked(weights):
        slants = jnp.eye(4) + jnp.zeros((4, 4)).at[lower].set(weights["slants"])
        return gains * weights["gains"], shape @ (jnp.exp(weights["sizes"])[:, None] * slants)

    def loss(weights, key):
        force, form = unpacked(weights)
        found = sampled(robot, force, SYSTEM.rate, form, key)
        short = [
            jax.lax.top_k(jax.nn.relu(RECIPE.targets.get(name, RECIPE.target) - row), RECIPE.worst)[
                0
            ]
            for name, row in found.items()
        ]
        return 2.0 * sum(jnp.mean(row) for row in short) - GAIN * jnp.sum(weights["sizes"])

    optimiser = optax.adam(optax.cosine_decay_schedule(0.02, SYSTEM.steps, 0.01))

    @jax.jit
    def step(weights, state, key):
        update, state = optimiser.update(jax.grad(loss)(weights, key), state)
        return optax.apply_updates(weights, update), state

    weights, state = start, optimiser.init(start)
    for number in range(SYSTEM.steps):
        weights, state = step(weights, state, jax.random.fold_in(jax.random.key(1), number))
    return tuple(map(np.asarray, unpacked(weights)))


def largest_proved(
    robot: CartPole, gains: np.ndarray, shape: np.ndarray, rate: float
) -> np.ndarray:
    """The ellipsoid, shrunk until the search proves every condition on it."""
    while True:
        ball = Ball(jnp.asarray(shape))
        program = trace(
            lambda u, ball=ball: margins(
                robot, jnp.asarray(gains), rate, ball, u[0], direction(u[1:])
            ),
            {"u": (len(AXES),)},
        )
        problems = condition_problems(program, SYSTEM.table, SYSTEM.claimed)
        states = explore(problems, [None] * len(problems), lambda name, u: None)
        if all(np.all(s.tree.lower[s.tree.is_leaf] >= 0.0) for s in states):
            return shape
        shape = SHRINK * shape


def projected(robot: CartPole, shape: np.ndarray) -> float:
    """Volume of the ellipsoid's image in z: for each (x, theta), the interval of s."""
    square = shape @ shape.T
    known, mixed = square[:2, :2], square[2:, :2]
    rest = square[2:, 2:] - mixed @ np.linalg.solve(known, mixed.T)
    root, total = np.linalg.cholesky(known), 0.0
    radii, turns = (np.arange(200) + 0.5) / 200, 2.0 * np.pi * (np.arange(200) + 0.5) / 200
    for turn in turns:
        theta = radii * (root[1] @ [np.cos(turn), np.sin(turn)])
        across = np.stack([robot.moment * np.cos(theta), np.full_like(theta, robot.inertia)])
        half = np.sqrt((1.0 - radii**2) * np.einsum("it,ij,jt->t", across, rest, across))
        total += np.sum(2.0 * half * radii) / 200 * 2.0 * np.pi / 200
    return float(np.linalg.det(root) * total)


def volumes_of(robot: CartPole, shape: np.ndarray) -> tuple[float, float]:
    """Volumes of an ellipsoid: of its image in z, and of the full state."""
    return projected(robot, shape), 0.5 * np.pi**2 * float(np.linalg.det(shape))


def opened(seed: int) -> FamilyRun:
    """The run of a seed, trained now or earlier."""
    folder = Path(ROOT) / f"cartpole-{seed}"
    if not (folder / "summary.json").is_file():
        config = SYSTEM.new_config(seed=seed, steps=None, hidden=None)
        train_family(SYSTEM, "cartpole", config, out=folder, root=ROOT)
    return open_family_run(SYSTEM, folder)


def main() -> None:
    """Print volumes of all sets, and their ratios."""
    runs = [opened(seed) for seed in seeds(3)]
    robot = runs[0].robot
    gains, shape = best_regulator(robot, whole("DRAWS", DRAWS))
    rows = {"LQR": (gains, largest_proved(robot, gains, shape, 0.0))}
    better = trained_linear(robot, gains, shape)
    rows["trained linear force"] = (
        better[0],
        largest_proved(robot, better[0], better[1], SYSTEM.rate),
    )
    volumes = {name: volumes_of(robot, found) for name, (_, found) in rows.items()}
    for name, (z, full) in volumes.items():
        gain = ", ".join(f"{x:.3g}" for x in rows[name][0])
        show(f"{name}: volume of z, of the full state", f"{z:.4g}, {full:.4g}", f"K = {gain}")
    for run in runs:
        verdict = certify_family(run)
        seed, (z, full) = run.config.seed, volumes_of(robot, np.asarray(run.controller.ball.shape))
        show(
            f"seed {seed}: verdict, level", f"{verdict.verdict}, {verdict.proved_level}", "asked: 3"
        )
        show(f"seed {seed}: volume of z, of the full state", f"{z:.4g}, {full:.4g}")
        for name, (other_z, other_full) in volumes.items():
            asked = ASKED if name == "LQR" else ""
            show(f"seed {seed}: ratio to {name}, z", z / other_z, asked)
            show(f"seed {seed}: ratio to {name}, full state", full / other_full, asked)


if __name__ == "__main__":
    main()
