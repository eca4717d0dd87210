"""The compiled walk beside the loop in JAX, and beside MuJoCo alone over the same states.

Asked: one walk under pd at 0.7 or more of bare `rollout`, 64 walks on two threads at 0.6 or more;
the same outcome of 200 starts as the loop in JAX (REFERENCE=0 leaves that out: it takes minutes).
"""

import os
import tempfile
import time
from pathlib import Path

import mujoco
import numpy as np
from common import show
from mujoco import rollout

import neuralgaits
from neuralgaits.analysis.run import open_run
from neuralgaits.simulation.native_walk import engine_of_run
from neuralgaits.simulation.setup.starts import full_states, momentum_range
from neuralgaits.simulation.walk import Walk, walk

RUN = Path(neuralgaits.__file__).parent / "demo_run"
REPEATS, THREADS, WALKS, SEGMENT = 5, 2, 64, 100
"""Times that everything is timed; threads and walks at once; ticks between two starts of MuJoCo."""
REFERENCE = int(os.environ.get("REFERENCE", "200"))
STEPS = 100
"""Of each walk that is compared."""


def main() -> None:
    """Print every ratio."""
    run = open_run(RUN)
    with tempfile.TemporaryDirectory() as cache:
        os.environ["XDG_CACHE_HOME"] = cache
        start_time = time.perf_counter()
        library = engine_of_run(run, "native").library
        show("a gait written and compiled [s]", time.perf_counter() - start_time)
        start_time = time.perf_counter()
        engine_of_run(run, "native")
        show("the same from the cache [s]", time.perf_counter() - start_time)

    def walked(episodes: int, steps: int, law: str, **settings) -> Walk:
        starts = full_states(run.zero_dynamics, run.gait, "region", seed=1, episodes=episodes)
        limits = {"z2_range": momentum_range(run.gait)}
        return walk(
            run.robot,
            run.gait.policy,
            starts,
            controller=law,
            steps=steps,
            **limits,
            **settings,
        )

    for law in ("pd", "fblin"):
        one = walked(1, STEPS, law, record=True, library=library)
        alone = [bare(one, 1) for _ in range(REPEATS)]
        native = [rate(walked(1, STEPS, law, library=library)) for _ in range(REPEATS)]
        slow = rate(walked(1, 5, law))
        show(f"{law}, one walk: MuJoCo steps/s", median(native))
        show("  MuJoCo alone over the same states", median(alone))
        show("  ratio to MuJoCo alone", median(native) / median(alone), ">= 0.7")
        show("  ratio to the loop in JAX", median(native) / slow)
        settings = {"library": library, "threads": THREADS}
        many = [rate(walked(WALKS, 20, law, **settings)) for _ in range(REPEATS)]
        alone = [bare(one, THREADS) for _ in range(REPEATS)]
        show(f"{law}, {WALKS} walks on {THREADS} threads: MuJoCo steps/s", median(many))
        show("  ratio to MuJoCo alone on as many", median(many) / median(alone), ">= 0.6")
        start_time = time.perf_counter()
        stayed = walked(1, 1000, law, library=library).episodes
        show(
            f"{law}, {int(stayed.gauge.steps[0])} steps [s]",
            time.perf_counter() - start_time,
            "<= 10",
        )
    if REFERENCE:
        compare(walked(REFERENCE, STEPS, "pd"), walked(REFERENCE, STEPS, "pd", library=library))


def rate(found: Walk) -> float:
    """MuJoCo steps a second."""
    return found.episodes.plant_steps / found.episodes.wall_s


def median(values: list[float]) -> float:
    """Of some repeats."""
    return float(np.median(values))


def bare(found: Walk, threads: int) -> float:
    """MuJoCo steps a second without control: from recorded states, under recorded torques."""
    plant, record = found.plant, found.episodes.record
    assert record is not None
    state_map, model = plant.state_map, plant.model
    torque = np.asarray(record.result.torque)
    controls = np.zeros((len(torque), model.nu))
    controls[:, state_map.actuators] = torque / np.array(state_map.layout.gears)
    begins = np.arange(0, len(torque) - SEGMENT, SEGMENT)
    inputs = np.stack([np.repeat(controls[at : at + SEGMENT], 2, axis=0) for at in begins])
    states = found.episodes.states[begins]
    with rollout.Rollout(nthread=threads if threads > 1 else 0) as pool:
        data = [mujoco.MjData(model) for _ in range(threads)]
        start_time = time.perf_counter()
        pool.rollout([model] * len(begins), data, states, inputs, nstep=2 * SEGMENT)
        return 2 * SEGMENT * len(begins) / (time.perf_counter() - start_time)


def compare(slow: Walk, fast: Walk) -> None:
    """Whether every start ends alike."""
    one, two = slow.episodes, fast.episodes
    same = [
        a == b and int(m) == int(n)
        for a, b, m, n in zip(
            one.endings, two.endings, one.gauge.steps, two.gauge.steps, strict=True
        )
    ]
    up = sum(not ending.fell for ending in one.endings)
    show(f"starts with the same outcome, {STEPS} steps", f"{sum(same)} of {len(same)}", "all")
    show("  of them walk all steps", up)
    show("  time in JAX over time native", one.wall_s / two.wall_s)


if __name__ == "__main__":
    main()
