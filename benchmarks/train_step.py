"""One gradient step of each spec, beside the bare network forward and backward.

Asked: `authors` (2-256-256-4 ReLU, batch 4096, all its terms) at most 0.7 s a step, 0.25 s if it
comes without a second derivative rule; the default at most 3 ms. The ratios travel from machine
to machine, the times do not. SPECS=walking,paper chooses the specs.
"""

import os
import time
from itertools import pairwise

import jax
import jax.numpy as jnp
import numpy as np
from common import show

from neuralgaits.barriers import specs
from neuralgaits.barriers.paper import BATCH
from neuralgaits.robots import load_robot
from neuralgaits.robots.mjcf.parameters import model_of
from neuralgaits.training import Trainer
from neuralgaits.training.trainer import samplers_of

CASES = {
    "walking": ("amber3m", 400, "<= 3 ms"),
    "paper": ("amber3m-paper", 12, ""),
    "authors": ("amber3m-paper", 12, "<= 700 ms (250 ms)"),
}
WIDTHS = (2, 256, 256, 4)


def main() -> None:
    """Print step and compile times and their ratios."""
    chosen = os.environ.get("SPECS", ",".join(CASES)).split(",")
    bare = network_ms()
    show(f"bare network 2-256-256-4, batch {BATCH}: forward + backward ms", bare)
    taken = {}
    for name in chosen:
        robot_name, steps, asked = CASES[name]
        robot = load_robot(robot_name)
        spec = specs.load(name, robot)
        gait = spec.new_gait(jax.random.key(0), "posture", None)
        start_time = time.perf_counter()
        model = model_of(robot, spec.parameters)
        trainer = Trainer.build(model, spec, gait, steps=spec.recipe.steps, seed=0)
        state = trainer.init(gait)
        jax.block_until_ready(trainer.step(state))
        compiled = time.perf_counter() - start_time
        times = []
        for _ in range(steps):
            start_time = time.perf_counter()
            state, loss = trainer.step(state)
            jax.block_until_ready((state, loss))
            times.append(1e3 * (time.perf_counter() - start_time))
        taken[name] = float(np.median(times))
        rows = len(samplers_of(spec)[0].low)
        show(f"{name}: rows a step, conditions", f"{rows}, {len(spec.conditions)}")
        show(f"{name}: first step, tracing and compiling (or cache) s", compiled)
        show(f"{name}: gradient step ms, median of {steps}", taken[name], asked)
        show(f"{name}: fastest step ms", min(times))
    for name in ("paper", "authors"):
        if name in taken:
            show(f"{name} step / bare network", taken[name] / bare)
    if {"walking", "authors"} <= set(taken):
        show("authors step / walking step", taken["authors"] / taken["walking"])
    if {"paper", "authors"} <= set(taken):
        show("authors step / paper step", taken["authors"] / taken["paper"])


def network_ms(repeats: int = 30) -> float:
    """Plain JAX: the authors' network on their batch, value and gradient, float32 (ms)."""
    rng = np.random.default_rng(0)
    layers = [
        (rng.normal(0.0, i**-0.5, (o, i)).astype(np.float32), np.zeros(o, np.float32))
        for i, o in pairwise(WIDTHS)
    ]
    inputs = rng.uniform(-1.0, 1.0, (BATCH, 2)).astype(np.float32)

    @jax.jit
    @jax.value_and_grad
    def loss(layers):
        x = inputs
        for weight, bias in layers[:-1]:
            x = jax.nn.relu(x @ weight.T + bias)
        weight, bias = layers[-1]
        return jnp.mean(jax.nn.sigmoid(x @ weight.T + bias) ** 2)

    jax.block_until_ready(loss(layers))
    times = []
    for _ in range(repeats):
        start_time = time.perf_counter()
        jax.block_until_ready(loss(layers))
        times.append(1e3 * (time.perf_counter() - start_time))
    return float(np.median(times))


if __name__ == "__main__":
    main()
