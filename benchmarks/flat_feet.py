"""Flat feet against point feet of the same robot, and gaits of four robots on flat feet.

    python benchmarks/flat_feet.py [SEEDS] [LAW]
    python benchmarks/flat_feet.py robots [SEEDS]

AMBER-3M on point feet and on feet of 10 cm, each with its default gait of each seed, walks 20 times
25 steps from random states of its gait's region: under each of the eighteen standard disturbances,
on floors that differ by 2.5 cm, and pushed back by 16 N s. One compiled loop a gait.

Robots: each of the four is trained with each seed, proved, its proof checked by the C++ checker,
and walks 1000 steps under `pd` and `fblin`.
"""

import subprocess
import sys
import tempfile
import time
from pathlib import Path

import jax

jax.config.update("jax_enable_x64", True)

from common import show  # noqa: E402

import neuralgaits as ng  # noqa: E402
from neuralgaits.simulation.setup.disturbance_set import DISTURBANCE_SET  # noqa: E402

ROBOTS = ("amber3m", "amber3m-feet")
WALKS, STEPS = 20, 25
REPOSITORY = Path(__file__).parents[1]
FILES = REPOSITORY / "examples" / "robots"
ON_FEET = {
    "amber3m-feet": "amber3m-feet",
    "walker2d": FILES / "walker2d-flat-feet.xml",
    "dm_control's walker": FILES / "dm-walker-flat-feet.xml",
    "H1-like section": FILES / "h1-section.xml",
}
LAWS, LONG = ("pd", "fblin"), 1000
MOST_SATURATED, LONGEST_CHECK_S = 0.01, 60.0


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


def robots(seeds: range) -> None:
    """Print what each robot with each seed comes to, asked beside found."""
    subprocess.run(["make", "--silent", "proofcheck"], cwd=REPOSITORY, check=True)
    found = [
        gait(f"{name}, seed {seed}", source, seed)
        for name, source in ON_FEET.items()
        for seed in seeds
    ]
    show("gaits with all of this", f"{sum(found)} of {len(found)}", f"asked: all {len(found)}")


def gait(name: str, source: str | Path, seed: int) -> bool:
    """Train, prove, check and walk one robot. Returns: whether all that is asked was found."""
    with tempfile.TemporaryDirectory() as folder:
        run = ng.train(source, seed=seed, out=Path(folder) / "run")
        proof = ng.certify(run).summary
        show(f"{name}: verdict, level", f"{proof.verdict}, {proof.proved_level}", "asked: 3")
        file, start = run.path / "certificate" / "proof.json", time.perf_counter()
        check = subprocess.run(
            [REPOSITORY / "build" / "proofcheck", file], capture_output=True, text=True, check=False
        )
        taken = time.perf_counter() - start
        word = (check.stdout.splitlines() or ["nothing"])[-1].split()[0]
        show(f"{name}: C++ checker", f"{word}, {taken:.1f} s", "asked: proved, 60 s at most")
        good = proof.proved_level == 3 and word == "proved" and taken <= LONGEST_CHECK_S
        for law in LAWS:
            walk = ng.simulate(run, controller=law, steps=LONG).summary
            saturated = walk.saturated_fraction or 0.0
            steps, speed = walk.steps_walked[0], walk.speed_m_s or 0.0
            words = f"{steps} steps, {speed:.2f} m/s, {100.0 * saturated:.2f} %"
            show(f"{name}: {law}, at torque limits", words, "asked: 1000 steps, 1 % at most")
            good &= not any(walk.fell) and saturated <= MOST_SATURATED
    return good


def main() -> None:
    """Print a row for each disturbance, and the sums."""
    if sys.argv[1:2] == ["robots"]:
        robots(range(int(sys.argv[2]) if len(sys.argv) > 2 else 3))
        return
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
