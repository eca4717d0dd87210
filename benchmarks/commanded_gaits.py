"""Gaits that are told their speed, 0.55 to 0.90 m/s: training, margins on fresh points, proof.

Asked: trained in at most 90 s, cold and as a whole process; every margin at least 0.02 of its scale
on 10^6 fresh points of the chart, seeds 0-4; level 3 in at most 10 min on two cores. LEVEL=0 leaves
the proof out, LOW and HIGH are another range.
"""

import os
import tempfile
import time
from pathlib import Path

import numpy as np
from commands import seconds
from common import ROOT, seeds, show

from neuralgaits.analysis.run import Run, open_run
from neuralgaits.certificate.chart import Chart
from neuralgaits.certificate.search.problem import Problem
from neuralgaits.certificate.traced import trace_spec
from neuralgaits.programs.prune import prune
from neuralgaits.workflows.certify import certify

LOW, HIGH = os.environ.get("LOW", "0.55"), os.environ.get("HIGH", "0.90")
ROBOT, LEVEL = os.environ.get("ROBOT", "amber3m"), int(os.environ.get("LEVEL", 3))
POINTS, BATCH = 10**6, 2**15


def main() -> None:
    """Print three lines a seed."""
    for seed in seeds(5):
        run = ROOT / f"{ROBOT}-speed-{LOW}-{HIGH}-{seed}"
        if not (run / "summary.json").is_file():
            code = "from neuralgaits.cli.main import run; run()"
            told = ["--speed", f"{LOW}:{HIGH}", "--seed", str(seed), "--out", str(run.resolve())]
            with tempfile.TemporaryDirectory() as folder:
                taken = seconds(Path(folder), ["-c", code, "train", ROBOT, *told])
            show(f"seed {seed}: train, cold, whole process [s]", taken, "<= 90")
        opened = open_run(run)
        name, least = smallest(opened, seed)
        show(f"seed {seed}: smallest margin of {POINTS:.0e} points ({name})", least, ">= 0.02")
        if not LEVEL:
            continue
        start_time = time.perf_counter()
        found = certify(opened, level=LEVEL, workers=2).summary
        answer = f"{found.verdict}, {found.boxes:.2g} boxes"
        taken = time.perf_counter() - start_time
        show(f"seed {seed}: level {LEVEL}, {taken:.0f} s", answer, "proved, <= 600 s")


def smallest(run: Run, seed: int) -> tuple[str, float]:
    """The condition with the smallest margin in scales on admissible points of its region."""
    program, chart = trace_spec(run.spec, run.robot, run.trained), Chart.of(run.spec.commands)
    random = np.random.default_rng(10**6 + seed)
    sizes = {
        region: sum(float(np.prod(np.subtract(box.high, box.low))) for box in boxes)
        for region, boxes in run.spec.regions.items()
    }
    # A tenth of the points for the edges, which have no area.
    share = {
        name: 0.9 * size / sum(sizes.values()) + 0.1 / len(sizes) for name, size in sizes.items()
    }
    found: dict[str, float] = {}
    for region, boxes in run.spec.regions.items():
        conditions = [one for one in run.spec.conditions if one.region == region]
        names = tuple(one.name for one in conditions)
        scales = tuple(float(one.scale) for one in conditions)
        for box in boxes if conditions else ():
            low, high = chart.whole(box.low, box.high)
            problem = Problem(
                region,
                low,
                high,
                names,
                scales,
                prune(program, names),
                coupled_axes=chart.coupled_axes,
            )
            left = round(POINTS * share[region] / len(boxes))
            while left > 0:
                points = random.uniform(low, high, (BATCH, len(low)))
                for first, second, change in chart.coupled_axes:
                    moved = points[:, first] + random.uniform(-change, change, BATCH)
                    points[:, second] = np.clip(moved, low[second], high[second])
                values = problem.values(points)
                # A NaN is no margin.
                worst = np.where(np.isnan(values), -np.inf, values).min(axis=0)
                for name, value in zip(names, worst, strict=True):
                    found[name] = min(found.get(name, np.inf), float(value))
                left -= BATCH
    name = min(found, key=found.__getitem__)
    return name, found[name]


if __name__ == "__main__":
    main()
