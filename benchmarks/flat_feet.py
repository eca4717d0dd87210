"""Flat feet against point feet of the same robot: falls under the same disturbances.

    python benchmarks/flat_feet.py [SEEDS] [LAW]

AMBER-3M on point feet and on feet of 10 cm, each with its default gait of each seed, walks 20 times
25 steps from random states of its gait's region: under each of the eighteen standard disturbances,
on floors that differ by 2.5 cm, and pushed back by 16 N s. One compiled loop a gait.
"""

import sys
import tempfile
from pathlib import Path

import jax

jax.config.update("jax_enable_x64", True)

import neuralgaits as ng  # noqa: E402
from neuralgaits.simulation.setup.disturbance_set import DISTURBANCE_SET  # noqa: E402

ROBOTS = ("amber3m", "amber3m-feet")
WALKS, STEPS = 20, 25


def falls(run, law: str, disturb, push: float | None) -> int:
    """Count the walks that fell."""
    found = ng.simulate(
        run,
        controller=law,
        steps=STEPS,
        episodes=WALKS,
        start="region",
        disturb=disturb,
        push=push,
        seed=1,
    )
    return sum(found.summary.fell)


def main() -> None:
    """Print a row for each disturbance, and the sums."""
    seeds = range(int(sys.argv[1]) if len(sys.argv) > 1 else 1)
    law = sys.argv[2] if len(sys.argv) > 2 else "pd"
    rows = {"undisturbed": (None, None)} | {n: (d, None) for n, d in DISTURBANCE_SET.items()}
    rows |= {"floor +-2.5 cm": ("floor_height=0.025", None), "push -16 N s": (None, -16.0)}
    table = {name: dict.fromkeys(ROBOTS, 0) for name in rows}
    with tempfile.TemporaryDirectory() as folder:
        for robot in ROBOTS:
            for seed in seeds:
                run = ng.train(robot, seed=seed, out=Path(folder) / f"{robot}-{seed}")
                for name, (disturb, push) in rows.items():
                    table[name][robot] += falls(run, law, disturb, push)
    print(f"falls of {WALKS * len(seeds)} walks of {STEPS} steps under {law}")
    for name, row in table.items():
        print(f"{name:40s}", *(f"{row[robot]:5d}" for robot in ROBOTS))
    sums = [sum(row[robot] for row in table.values()) for robot in ROBOTS]
    print(f"{'all':40s}", *(f"{total:5d}" for total in sums))


if __name__ == "__main__":
    main()
