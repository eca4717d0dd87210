"""Side by side on one robot: gaits of this package, the paper's recipe, optimised gaits, PPO.

    python benchmarks/peers.py                  makes every row that can be made here, and the table
    python benchmarks/peers.py walking ppo      these rows alone; the others are as they were kept
    WALKS=1 SAMPLES=50000 python benchmarks/peers.py ppo

Every row is found by running it here; what cannot be run is a row that says why. Falls are counted
as `sweep` counts them: WALKS walks (20; of PPO TRIALS, 2) of 25 steps under each of the eighteen
disturbances. Times are of a processor, of the whole command, with nothing compiled before; of PPO
to its first walk of 50 steps, and what counts as a fall undisturbed is one before step 25. PPO
learns with SEEDS seeds (1); `ppo` reads those that are in runs/bench/peers/ppo already, of as many
samples and trials, and learns the others.
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from clf_qp import tick_times
from common import ROOT, whole
from ppo_row import row as row_of_seeds
from ppo_row import which

from neuralgaits.analysis.run import Run, open_run
from neuralgaits.certificate.run_certificate.verified_summary import read_certificate
from neuralgaits.errors import NeuralGaitsError
from neuralgaits.simulation.setup.disturbance_set import DISTURBANCE_SET
from neuralgaits.workflows.certify import certify
from neuralgaits.workflows.demo import TOLD
from neuralgaits.workflows.simulate import simulate

ROBOT, STEPS = "amber3m", 25
WALKS, SEED = whole("WALKS", 20), whole("SEED", 0, least=0)
SAMPLES, TRIALS = whole("SAMPLES", 300_000), whole("TRIALS", 2)
"""Environment steps of PPO, of 20 ms each, and its walks of each kind: of every seed."""
SEEDS = whole("SEEDS", 1)
SHARE = whole("SHARE", 8)
"""The paper's batch of 4096 is divided by this: the whole takes minutes of a processor."""
FEWER = """from dataclasses import replace

from neuralgaits.barriers import specs


def fewer(robot):
    spec = specs.load("{spec}", robot)
    samples = {{name: count // {share} for name, count in spec.recipe.samples.items()}}
    return replace(spec, recipe=replace(spec.recipe, samples=samples))
"""
PLACE = ROOT / "peers"
PPO = Path(__file__).parents[1] / "examples" / "ppo.py"
ASKED = 0.7
"""Of PPO's policy, in the trials of its script [m/s]."""
NOTHING, LEARNED = "-", "learned.json"


@dataclass(frozen=True)
class Row:
    """What is said of one way to make a robot walk. Numbers that do not exist are None.

    Attributes:
        commands: lines that repeat it.
        learn_s: processor time up to the gait, of PPO to the first walk of 50 steps [s].
        samples: that learning looked at, with what they are.
        speed, cost: of walks that nothing disturbs [m/s], mechanical [1].
        fell, walks: under the eighteen disturbances, all together.
        under: which of them it fell under, and how often.
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
    under: str = ""
    undisturbed: str = NOTHING
    range: str = "none"
    tick_us: tuple[float, float] | None = None
    proved: str = "nothing"
    note: str = ""


def of_gait(line: str, controller: str, level: int | None, name: str) -> Row:
    """A gait that a command makes, kept under a name that says all that decides it but the seed."""
    folder = PLACE / f"{name}-{SEED}"
    if said := made(line, folder):
        return Row((line,), note=f"not made: {said}")
    run = open_run(folder)
    points = sum(run.spec.recipe.samples.values()) * run.summary.steps
    commands = [line, f"simulate latest --controller {controller} --disturb ..."]
    if level is not None:
        commands.append(f"certify latest --level {level}")
    return Row(
        commands=tuple(commands),
        learn_s=json.loads((folder / LEARNED).read_text()),
        samples=f"{points / 1e6:.2g} M points of the region" if points else "no samples",
        proved="nothing" if level is None else proved_of(run, level),
        **walked(run, controller),
    )


def made(line: str, folder: Path) -> str:
    """Make a gait, unless it is there, as a process that finds nothing compiled.

    Returns: why there is none; nothing if there is.
    """
    kept = folder / LEARNED
    if kept.is_file():
        return ""
    shutil.rmtree(folder, ignore_errors=True)
    before = resource_s()
    with tempfile.TemporaryDirectory() as empty:
        # From there, so that the user's latest run stays the latest.
        words = [word.replace(str(PLACE), str(PLACE.absolute())) for word in line.split()]
        words = [sys.executable, "-m", "neuralgaits", *words, "--out", str(folder.absolute())]
        setting = {k: v for k, v in os.environ.items() if k != "JAX_COMPILATION_CACHE_DIR"}
        setting["XDG_CACHE_HOME"] = empty
        done = subprocess.run(
            words, capture_output=True, text=True, check=False, cwd=empty, env=setting
        )
    if done.returncode != 0:
        return last_line(done)
    kept.write_text(json.dumps(resource_s() - before))
    return ""


def last_line(done: subprocess.CompletedProcess[str]) -> str:
    """What a process that failed said at last."""
    lines = done.stderr.strip().splitlines()
    return lines[-1][:200] if lines else f"it ended with {done.returncode}"


def of_training(controller: str) -> Row:
    """What is trained if nothing else is asked for."""
    return of_gait(f"train {ROBOT} --seed {SEED}", controller, 3, "walking")


def of_paper(spec: str) -> Row:
    """The paper's Table 1, also with the one condition that it lacks, or its code; its own law."""
    file = PLACE / f"fewer_{spec.replace('-', '_')}.py"
    file.write_text(FEWER.format(spec=spec, share=SHARE))
    line = f"train {ROBOT} --spec {file}:fewer --seed {SEED}"
    row = of_gait(line, "paper", None, f"{spec}-{SHARE}")
    return replace(row, note=f"{row.note} 1/{SHARE} of the paper's batch".strip())


def of_optimised(controller: str) -> Row:
    """A gait that `optimise` makes."""
    return of_gait(f"optimise {ROBOT} --speed 0.7", controller, 3, "optimised")


def walked(run: Run, controller: str) -> dict[str, Any]:
    """Falls, speed, cost and time of a tick."""
    settings: dict[str, Any] = {"controller": controller, "steps": STEPS, "start": "region"}
    settings |= {"seed": SEED, "episodes": WALKS}
    free = simulate(run, **settings).summary
    found = {
        name: simulate(run, disturb=disturbance, **settings).summary.fell
        for name, disturbance in DISTURBANCE_SET.items()
    }
    try:
        tick = tuple(float(t) for t in np.percentile(tick_times(run, controller, 20.0), [50, 99]))
    except (AssertionError, NeuralGaitsError):
        tick = None
    return {
        "speed": free.speed_m_s,
        "cost": free.cost_of_transport,
        "fell": sum(map(sum, found.values())),
        "walks": sum(map(len, found.values())),
        "under": which({name: (sum(fell), len(fell)) for name, fell in found.items()}),
        "undisturbed": f"{sum(free.fell)} of {len(free.fell)}",
        "range": commanded(run, controller),
        "tick_us": tick,
    }


def commanded(run: Run, controller: str) -> str:
    """Ranges of what it may be told, and the mean speeds of walks that are told their ends."""
    texts = []
    for name, command in run.summary.commands.items():
        ends = [
            simulate(run, controller=controller, steps=STEPS, seed=SEED, command={name: end})
            for end in (command.low, command.high)
        ]
        speeds = [shown(end.summary.speed_m_s, "{:.2f}") for end in ends]
        texts.append(
            f"{name} {command.low:g} to {command.high:g}: {' to '.join(speeds)} m/s walked"
        )
    return "; ".join(texts) or "none"


def of_shipped() -> Row:
    """The gait that is told its speed, as it comes with the package: what `demo --speed` shows."""
    folder = PLACE / TOLD.name
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(TOLD, folder)
    run, controller = open_run(folder), "pd"
    points = sum(run.spec.recipe.samples.values()) * run.summary.steps
    proof = read_certificate(run.folder).summary
    low, high = next((c.low, c.high) for c in run.summary.commands.values())
    return Row(
        commands=(f"train {ROBOT} --speed {low:g}:{high:g}", "certify latest --level 3"),
        samples=f"{points / 1e6:.2g} M points of the region",
        proved=f"level {proof.proved_level}, shipped" if proof else "nothing",
        note="not trained here: the run of `demo --speed`",
        **walked(run, controller),
    )


def proved_of(run: Run, level: int) -> str:
    """What `certify` says."""
    try:
        found = certify(run, level=level, budget=600.0).summary
    except NeuralGaitsError as error:
        return f"cannot be: {error}"
    return f"level {found.proved_level} of {level}"


def of_ppo() -> Row:
    """Reinforcement learning, as `examples/ppo.py` finds it."""
    line = f"examples/ppo.py --samples {SAMPLES} --trials {TRIALS} --seed {SEED}"
    if SEEDS > 1:
        line += f", and seeds to {SEED + SEEDS - 1}"
    place, found = PLACE / "ppo", []
    for seed in range(SEED, SEED + SEEDS):
        file = place / f"learned-{seed}.json"
        asked = {"samples": SAMPLES, "trials": TRIALS, "action": "target"}
        if not file.is_file() or json.loads(file.read_text()).get("asked") != asked:
            words = [sys.executable, str(PPO), "--samples", str(SAMPLES), "--seed", str(seed)]
            words += ["--trials", str(TRIALS), "--out", str(place)]
            done = subprocess.run(words, capture_output=True, text=True, check=False)
            if done.returncode != 0:
                return Row((line,), note=f"not made: {last_line(done)}")
        found.append(json.loads(file.read_text()))
    return Row((line,), **row_of_seeds(found, asked=ASKED, steps=STEPS))


def resource_s() -> float:
    """Processor time of processes that were waited for."""
    times = os.times()
    return times.children_user + times.children_system


ROWS: dict[str, Callable[[], Row]] = {
    "walking": lambda: of_training("pd"),
    "walking-fblin": lambda: of_training("fblin"),
    "walking-scheduled-pd": lambda: of_training("scheduled-pd"),
    "walking-clf-qp": lambda: of_training("clf-qp"),
    "speed": of_shipped,
    "paper": lambda: of_paper("paper"),
    "paper-walks": lambda: of_paper("paper-walks"),
    "authors": lambda: of_paper("authors"),
    "hzd-pd": lambda: of_optimised("pd"),
    "hzd-clf-qp": lambda: of_optimised("clf-qp"),
    "ppo": of_ppo,
}


def table(rows: dict[str, Row]) -> str:
    """The rows as Markdown."""
    head = "row|gait|samples|speed|cost|falls, undisturbed|falls under the 18|commands|tick"
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
        *(f"- `{name}`: {'; '.join(row.commands)}{said(row)}" for name, row in rows.items()),
    ]
    return "\n".join(lines)


def said(row: Row) -> str:
    """What must be known of a row beside its cells."""
    fell = f"fell: {row.under}" if row.under else ""
    return "".join(f"; {part}" for part in (row.note, fell) if part)


def shown(value: float | None, form: str) -> str:
    """A number, or that there is none."""
    return NOTHING if value is None else form.format(value)


def main() -> None:
    """Make the rows that are named, or all of them; print all that are kept."""
    wanted = sys.argv[1:] or list(ROWS)
    if unknown := [name for name in wanted if name not in ROWS]:
        print(f"expected rows of {', '.join(ROWS)}, found {', '.join(unknown)}", file=sys.stderr)
        sys.exit(2)
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
