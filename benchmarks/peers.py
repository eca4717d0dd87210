"""Side by side on one robot: gaits of this package, the paper's recipe, optimised gaits, PPO.

    python benchmarks/peers.py                  makes every row that can be made here, and the table
    python benchmarks/peers.py walking ppo      these rows alone; the others are as they were kept
    WALKS=1 SAMPLES=50000 python benchmarks/peers.py ppo

Every row is found by running it here; what cannot be run is a row that says why. Falls are counted
as `sweep` counts them: WALKS walks (4) of 25 steps under each of the eighteen disturbances.
Times are of a processor, waiting left out.
"""

import json
import os
import re
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from clf_qp import tick_times
from common import ROOT

from neuralgaits.analysis.run import Run, open_run
from neuralgaits.errors import NeuralGaitsError
from neuralgaits.robots import load_robot
from neuralgaits.simulation.setup.disturbance_set import DISTURBANCE_SET
from neuralgaits.workflows.certify import certify
from neuralgaits.workflows.simulate import simulate
from neuralgaits.workflows.train import train

ROBOT, STEPS = "amber3m", 25
WALKS, SEED = int(os.environ.get("WALKS", 4)), int(os.environ.get("SEED", 0))
SAMPLES = int(os.environ.get("SAMPLES", 400_000))
"""Environment steps of PPO, of 20 ms each."""
SHARE = int(os.environ.get("SHARE", 16))
"""The paper's batch of 4096 is divided by this: the whole takes minutes of a processor."""
FEWER = """from dataclasses import replace

from neuralgaits.barriers import specs


def paper_walks(robot):
    spec = specs.paper_walks(robot)
    samples = {{name: count // {share} for name, count in spec.recipe.samples.items()}}
    return replace(spec, recipe=replace(spec.recipe, samples=samples))
"""
PLACE = ROOT / "peers"
PPO = Path(__file__).parents[1] / "examples" / "ppo.py"
NOTHING = "-"


@dataclass(frozen=True)
class Row:
    """What is said of one way to make a robot walk. Numbers that do not exist are None.

    Attributes:
        commands: lines that repeat it.
        learn_s: processor time up to the first walk [s].
        samples: that learning looked at, with what they are.
        speed, cost: of walks that nothing disturbs [m/s], mechanical [1].
        fell, walks: under the eighteen disturbances, all together.
        undisturbed: falls without a disturbance, of as many walks as under each.
        range: of commands.
        tick_us: processor time of a control tick in C, p50 and p99 [us].
        proved: what is.
        note: what else must be known.
    """

    commands: tuple[str, ...]
    learn_s: float | None = None
    samples: str = NOTHING
    speed: float | None = None
    cost: float | None = None
    fell: int | None = None
    walks: int | None = None
    undisturbed: str = NOTHING
    range: str = "none"
    tick_us: tuple[float, float] | None = None
    proved: str = "nothing"
    note: str = ""


def of_gait(
    line: str, controller: str, level: int | None, name: str = "walking", **how: Any
) -> Row:
    """A gait that `train` makes, kept under a name."""
    folder = PLACE / f"{name}-{SEED}"
    kept = folder / "learned.json"
    before = time.process_time()
    if kept.is_file():
        run = open_run(folder)
    else:
        run = train(load_robot(ROBOT), seed=SEED, out=folder, root=PLACE, **how)
        first = simulate(run, controller=controller, steps=STEPS)
        kept.write_text(json.dumps([time.process_time() - before, first.summary.stayed]))
    learn_s, stayed = json.loads(kept.read_text())
    recipe = run.spec.recipe
    points = sum(recipe.samples.values()) * run.summary.steps
    row = walked(run, controller)
    proved = NOTHING if level is None else proved_of(run, level)
    command = f"simulate latest --controller {controller} --disturb ..."
    return Row(
        commands=(line, command, *(() if level is None else (f"certify latest --level {level}",))),
        learn_s=learn_s if stayed else None,
        samples=f"{points / 1e6:.2g} M points of the region",
        proved="nothing" if level is None else proved,
        **row,
    )


def of_paper() -> Row:
    """The paper's Table 1 and the one condition that it lacks, under the paper's law."""
    spec = "paper-walks"
    if SHARE != 1:
        file = PLACE / "fewer.py"
        file.write_text(FEWER.format(share=SHARE))
        spec = f"{file}:paper_walks"
    row = of_gait(f"train {ROBOT} --spec {spec}", "paper", None, "paper-walks", spec=spec)
    return replace(row, note=f"{row.note}; 1/{SHARE} of the paper's batch")


def of_optimised(controller: str) -> Row:
    """A gait that `optimise` makes, where this version has that verb."""
    line = f"optimise {ROBOT} --speed 0.7"
    folder = PLACE / f"optimised-{SEED}"
    before = resource_s()
    if not (folder / "summary.json").is_file():
        made = verb(*line.split(), "--out", str(folder))
        if made.returncode != 0:
            return Row((line,), note=f"not made: {' '.join(made.stderr.split())[:120]}")
        (folder / "learned.json").write_text(json.dumps(resource_s() - before))
    run = open_run(folder)
    row = walked(run, controller)
    return Row(
        commands=(
            line,
            f"simulate latest --controller {controller} --disturb ...",
            "certify latest",
        ),
        learn_s=json.loads((folder / "learned.json").read_text()),
        samples="no samples: an optimisation",
        proved=proved_of(run, 3),
        **row,
    )


def walked(run: Run, controller: str) -> dict[str, Any]:
    """Falls, speed, cost and time of a tick."""
    settings: dict[str, Any] = {"controller": controller, "steps": STEPS, "start": "region"}
    settings |= {"seed": SEED, "episodes": WALKS}
    free = simulate(run, **settings).summary
    found = [
        simulate(run, disturb=disturbance, **settings).summary
        for disturbance in DISTURBANCE_SET.values()
    ]
    told = run.summary.commands
    try:
        tick = tuple(float(t) for t in np.percentile(tick_times(run, controller), [50, 99]))
    except (AssertionError, NeuralGaitsError):
        tick = None
    return {
        "speed": free.speed_m_s,
        "cost": free.cost_of_transport,
        "fell": sum(sum(one.fell) for one in found),
        "walks": sum(len(one.fell) for one in found),
        "undisturbed": f"{sum(free.fell)} of {len(free.fell)}",
        "range": ", ".join(f"{name} {c.low:g} to {c.high:g}" for name, c in told.items()) or "none",
        "tick_us": tick,
    }


def proved_of(run: Run, level: int) -> str:
    """What `certify` says."""
    try:
        found = certify(run, level=level, budget=600.0).summary
    except NeuralGaitsError as error:
        return f"cannot be: {error}"
    return f"level {found.proved_level} of {level}"


def of_ppo() -> Row:
    """Reinforcement learning, from what `examples/ppo.py` prints."""
    line = f"examples/ppo.py --samples {SAMPLES} --steps {STEPS} --seed {SEED}"
    words = [sys.executable, str(PPO), *line.split()[1:], "--out", str(PLACE / "ppo")]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        said = (done.stderr.strip().splitlines() or ["it failed"])[-1]
        return Row((line,), note=f"not made: {said[:120]}")
    trials = re.compile(
        r"(\d+) of (\d+) walked \d+ steps, up ([\d.]+) s on average"
        r"(?:, (\S+) m/s, cost of transport (\S+))?"
    )
    learned_s, first, free, fell, walks = 0.0, None, None, 0, 0
    for text in done.stdout.splitlines():
        found = trials.search(text)
        if found is None:
            continue
        stayed, count = int(found[1]), int(found[2])
        if (begun := re.match(r"\s*(\d+) samples,\s+(\d+) s of a processor", text)) is not None:
            learned_s = float(begun[2])
            if first is None and stayed:
                first = learned_s
        elif text.startswith("none "):
            free = found
        else:
            fell, walks = fell + count - stayed, walks + count
    if free is None:
        return Row((line,), note="not made: it printed no trials")
    stayed, count, up = int(free[1]), int(free[2]), float(free[3])
    return Row(
        commands=(line,),
        learn_s=first,
        samples=f"{SAMPLES / 1e6:.2g} M environment steps of 20 ms",
        speed=None if free[4] is None else float(free[4]),
        cost=None if free[5] is None else float(free[5]),
        fell=fell,
        walks=walks,
        undisturbed=f"{count - stayed} of {count}",
        range="speed 0.5 to 0.9 m/s in training",
        note=f"learned for {learned_s:.0f} s; up for {up:.1f} s on average, from its own starts",
    )


def verb(*words: str) -> subprocess.CompletedProcess[str]:
    """The program, as a process of its own."""
    line = [sys.executable, "-m", "neuralgaits", *words]
    return subprocess.run(line, capture_output=True, text=True, check=False)


def resource_s() -> float:
    """Processor time of processes that were waited for."""
    times = os.times()
    return times.children_user + times.children_system


ROWS: dict[str, Callable[[], Row]] = {
    "walking": lambda: of_gait(f"train {ROBOT}", "pd", 3),
    "walking-fblin": lambda: of_gait(f"train {ROBOT}", "fblin", 3),
    "walking-clf-qp": lambda: of_gait(f"train {ROBOT}", "clf-qp", 3),
    "speed": lambda: of_gait(
        f"train {ROBOT} --speed 0.55:0.90", "pd", None, "speed", speed=(0.55, 0.90)
    ),
    "paper-walks": of_paper,
    "hzd-pd": lambda: of_optimised("pd"),
    "hzd-clf-qp": lambda: of_optimised("clf-qp"),
    "ppo": of_ppo,
}


def table(rows: dict[str, Row]) -> str:
    """The rows as Markdown."""
    head = "row|first walk|samples|speed|cost|falls, undisturbed|falls under the 18|commands|tick"
    head += "|proved|"
    lines = ["|" + head, "|" + "---|" * (head.count("|"))]
    for name, row in rows.items():
        cells = (
            f"`{name}`",
            shown(row.learn_s, "{:.0f} s"),
            row.samples,
            shown(row.speed, "{:.2f} m/s"),
            shown(row.cost, "{:.3f}"),
            row.undisturbed,
            NOTHING if row.fell is None else f"{row.fell} of {row.walks}",
            row.range,
            NOTHING if row.tick_us is None else f"{row.tick_us[0]:.0f}, {row.tick_us[1]:.0f} us",
            row.proved,
        )
        lines.append("| " + " | ".join(cells) + " |")
    lines += [
        "",
        *(f"- `{name}`: {'; '.join(row.commands)}. {row.note}" for name, row in rows.items()),
    ]
    return "\n".join(lines)


def shown(value: float | None, form: str) -> str:
    """A number, or that there is none."""
    return NOTHING if value is None else form.format(value)


def main() -> None:
    """Make the rows that are named, or all of them; print all that are kept."""
    wanted = sys.argv[1:] or list(ROWS)
    if unknown := [name for name in wanted if name not in ROWS]:
        sys.exit(f"expected rows of {', '.join(ROWS)}, found {', '.join(unknown)}")
    PLACE.mkdir(parents=True, exist_ok=True)
    for name in wanted:
        row = ROWS[name]()
        (PLACE / f"row-{name}.json").write_text(json.dumps(asdict(row)))
        print(table({name: row}), flush=True)
    kept = {name: PLACE / f"row-{name}.json" for name in ROWS}
    rows = {name: Row(**json.loads(p.read_text())) for name, p in kept.items() if p.is_file()}
    print("\n" + table(rows))


if __name__ == "__main__":
    main()
