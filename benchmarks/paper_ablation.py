"""What Table 1 of the paper lacks for walking: the code's further conditions added one at a time.

Each variant is trained from the same posture and walked in MuJoCo from five places of its region
under each law. VARIANTS=table1,authors,... or all chooses them: `table1+A+B` is Table 1 with
additions, `authors-A` the code without one. `table1+sum-guard` is the spec `paper-walks`. Seeds are
FROM to SEEDS. SHARE=1 trains with the paper's batch of 4096; the default is a sixteenth of it.
INIT=random starts as the paper does. ROBOT is the model, PLANT another robot to walk on, WALK the
steps of a walk, LAWS=paper,paper-z2,stiff,pd,fblin some of the laws below, TIMESTEP_MS=2 the step
of MuJoCo. LONG=1000 walks so many steps from one place and does nothing else. What is found is kept
in runs/bench/paper_ablation.jsonl, a line a gait, and not found again.
"""

import json
import os
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import equinox as eqx
import jax
import numpy as np
from common import ROOT, show

from neuralgaits.simulation.setup import plant as mujoco_plant

TIMESTEP_MS = float(os.environ.get("TIMESTEP_MS", 0.5))
# Before anything reads them. A tick is 1 ms, or one step that is longer.
mujoco_plant.TIMESTEP_S = 1e-3 * TIMESTEP_MS
mujoco_plant.SUBSTEPS = max(1, round(1.0 / TIMESTEP_MS))
mujoco_plant.PERIOD_S = mujoco_plant.SUBSTEPS * mujoco_plant.TIMESTEP_S

# ruff: noqa: E402
from neuralgaits.barriers import DiscreteBarrier, Gait, GaitSpec, functions, specs
from neuralgaits.control import PAPER, AbstractLaw, Fblin, Pd
from neuralgaits.gait import ZeroDynamics, posture_path
from neuralgaits.robots import PlanarBiped, load_robot
from neuralgaits.simulation.metrics import summary
from neuralgaits.simulation.setup.starts import momentum_range
from neuralgaits.simulation.walk import walk
from neuralgaits.training import Trainer, start_from_posture

SEEDS = range(int(os.environ.get("FROM", 0)), int(os.environ.get("SEEDS", 3)))
SHARE = int(os.environ.get("SHARE", 16))
STEPS = int(os.environ.get("STEPS", 1000))
WALK = int(os.environ.get("WALK", 20))
LONG = int(os.environ.get("LONG", 0))
INIT = os.environ.get("INIT", "posture")
ROBOT = os.environ.get("ROBOT", "amber3m")
PLANT = os.environ.get("PLANT", ROBOT)
KEPT = ROOT / "paper_ablation.jsonl"
GAITS = ROOT / "paper_ablation"
RESULTS = ("loss", "laws", "model")
FRESH_SEED = 10**6
STARTS = np.array([[0.5, 0.5], [0.3, 0.4], [0.7, 0.4], [0.3, 0.7], [0.7, 0.7]])
"""Places of the chart (phase, level) that walks begin at: energies 0.4 to 0.7 m^2/s^2."""
LAWS: dict[str, AbstractLaw] = {
    "paper": PAPER,
    "paper-z2": replace(PAPER, measure_z2=True),
    "stiff": replace(PAPER, stiffness=(1500.0,), damping=(50.0,)),
    "pd": Pd(),
    "fblin": Fblin(),
}

CHOSEN = os.environ.get("LAWS", "paper,pd,fblin").split(",")

Addition = Callable[[GaitSpec, GaitSpec], GaitSpec]
"""From a spec, and that of the authors' code, to the spec with one more part of the code."""


def _taken(*names: str, regions: tuple[str, ...] = ()) -> Addition:
    """Take conditions by name from the code, in place of those of the same name."""

    def add(spec: GaitSpec, code: GaitSpec) -> GaitSpec:
        new = [c for c in code.conditions if c.name in names]
        kept = [c for c in spec.conditions if c.name not in names]
        samples = dict(spec.recipe.samples) | {r: code.recipe.samples[r] for r in regions}
        weights = dict(spec.weights) | {n: code.weights[n] for n in names if n in code.weights}
        return replace(
            spec,
            conditions=(*kept, *new),
            regions=dict(spec.regions) | {r: code.regions[r] for r in regions},
            recipe=replace(spec.recipe, samples=samples),
            weights=weights,
        )

    return add


def _sum_at_guard(spec: GaitSpec, code: GaitSpec) -> GaitSpec:
    """The code's condition in the paper's region: no further samples."""
    (found,) = (c for c in code.conditions if c.name == "reset-hip-sum")
    weights = dict(spec.weights) | {found.name: code.weights[found.name]}
    return replace(spec.with_conditions(replace(found, region="guard")), weights=weights)


def _discrete(spec: GaitSpec, code: GaitSpec) -> GaitSpec:
    """Eq. 8 on the buffered guard, of the region's own ends: h(Delta(z)) >= 0."""
    del code
    low, high = (functions.at_least, functions.at_most)
    return spec.with_conditions(
        DiscreteBarrier("stay-lower", "guard", 1.0, low(functions.hip_state, -0.2), 1.0),
        DiscreteBarrier("stay-upper", "guard", 1.0, high(functions.hip_state, 0.2), 1.0),
    )


def _schedule(spec: GaitSpec, code: GaitSpec) -> GaitSpec:
    return replace(spec, recipe=replace(spec.recipe, milestones=code.recipe.milestones))


ADDITIONS: dict[str, Addition] = {
    "torso": _taken("torso-lower"),
    "torso-after": _taken("torso-lower-after", "torso-upper-after"),
    "circle": _taken("foot-circle-upper"),
    "sum": _taken("reset-hip-sum", regions=("ends",)),
    "sum-guard": _sum_at_guard,
    "discrete": _discrete,
    "ends": _taken("symmetry", "foot-on-guard", regions=("ends",)),
    "late": _taken("impact-lower", "impact-upper", "symmetry-late", regions=("late",)),
    "schedule": _schedule,
}
"""torso: -0.2 in place of -pi/10. torso-after: the torso's bounds after the impact as well.
circle: up to 0.8 in place of 0.3. sum: z1 after the impact = -z1 at both ends of a step; sum-guard:
at the later one alone. ends: symmetry and foot on the ground at the start of a step, too. late:
impact mapping from z1 = 0.15 on, and symmetry there as a barrier. schedule: the rate drops earlier.
Not of the code: discrete, z1 after the impact within +-0.2, where z is sampled."""


CODE = tuple(part for part in ADDITIONS if part not in ("sum-guard", "discrete"))
"""All of them together are the code."""


def variant(name: str, robot: PlanarBiped) -> GaitSpec:
    """The spec of that name."""
    table, code = specs.paper(robot), specs.authors(robot)
    base, *added = name.split("+")
    if base.startswith("authors"):
        left_out = base.split("-", 1)[1:]
        added = [part for part in CODE if part not in left_out]
    spec = table
    for part in added:
        spec = ADDITIONS[part](spec, code)
    used = {c.region for c in spec.conditions}
    samples = {r: n // SHARE for r, n in spec.recipe.samples.items() if r in used}
    regions = {r: boxes for r, boxes in spec.regions.items() if r in used}
    return replace(spec, name=name, regions=regions, recipe=replace(spec.recipe, samples=samples))


def trained(robot: PlanarBiped, spec: GaitSpec, seed: int) -> tuple[Gait, float]:
    """A gait, trained now or before, and its loss on fresh samples."""
    key = jax.random.key(seed)
    gait = spec.new_gait(key, "posture", None)
    assert isinstance(gait, Gait)
    kept = GAITS / f"{robot.name}-{spec.name}-{INIT}-{SHARE}-{STEPS}-{seed}.eqx"
    trainer = Trainer.build(robot, spec, gait, steps=STEPS, seed=seed)
    if kept.is_file():
        best = eqx.tree_deserialise_leaves(kept, jax.tree.map(np.asarray, gait))
        return best, float(trainer.report(best, seed=FRESH_SEED).loss)
    if INIT == "posture":
        steps = spec.recipe.posture_steps
        gait = start_from_posture(
            partial(posture_path, robot), gait, steps, jax.random.fold_in(key, 1)
        )
    state = trainer.init(gait)
    while not trainer.done(state):
        state, _ = trainer.step(state)
        if int(state.step) % 100 == 0 or trainer.done(state):
            state = trainer.validate(state)
    best = trainer.gait(state.best)
    assert isinstance(best, Gait)
    kept.parent.mkdir(parents=True, exist_ok=True)
    eqx.tree_serialise_leaves(kept, jax.tree.map(np.asarray, best))
    return best, float(trainer.report(best, seed=FRESH_SEED).loss)


def model(robot: PlanarBiped, gait: Gait) -> dict[str, float]:
    """What the model says of a step, at a middle energy: at the guard, and just after its start."""
    zd = ZeroDynamics(robot, gait.policy)
    points = [zd.point(gait.z(np.array([phase, 0.5]))) for phase in (0.975, 0.025, 0.5)]
    guard, start, middle = points
    return {
        "z1 at the guard m": float(guard.z[0]),
        "z1 after it m": float(guard.z_after[0]),
        "step length m": float(guard.foot[0]),
        "foot at the guard m": float(guard.foot[1]),
        "foot at the start m": float(start.foot[1]),
        "foot in mid-step m": float(middle.foot[1]),
        "normal force in mid-step, weights": float(middle.force[1] / (robot.mass * robot.gravity)),
    }


def walked(robot: PlanarBiped, gait: Gait) -> dict[str, dict]:
    """What became of the walks under each law."""
    zd = ZeroDynamics(robot, gait.policy)
    starts = np.asarray(eqx.filter_jit(jax.vmap(lambda u: zd.phi_inv(gait.z(u))))(STARTS))
    bounds = momentum_range(gait)
    found = {}
    plant = load_robot(PLANT)
    for name in CHOSEN:
        result = walk(
            robot,
            gait.policy,
            starts,
            plant=plant,
            controller=LAWS[name],
            steps=WALK,
            z2_range=bounds,
            threads=1,
        )
        figures = summary(result)
        found[name] = {
            "up": sum(not ending.fell for ending in result.episodes.endings),
            "steps": [int(n) for n in result.episodes.gauge.steps],
            "why": [ending.name for ending in result.episodes.endings],
            "speed": figures["speed_m_s"],
            "cost": figures["cost_of_transport"],
        }
    return found


def long_walks(robot: PlanarBiped, names: list[str]) -> None:
    """From the middle of the region, all seeds of a variant side by side."""
    for name in names:
        spec = variant(name, robot)
        gaits, losses = zip(*(trained(robot, spec, seed) for seed in SEEDS), strict=True)
        zds = [ZeroDynamics(robot, gait.policy) for gait in gaits]
        middle = np.array([0.5, 0.5])
        starts = [zd.phi_inv(gait.z(middle)) for zd, gait in zip(zds, gaits, strict=True)]
        for law in CHOSEN:
            result = walk(
                robot,
                [gait.policy for gait in gaits],
                np.stack([np.asarray(start) for start in starts]),
                controller=LAWS[law],
                steps=LONG,
                z2_range=momentum_range(gaits[0]),
                threads=1,
            )
            figures = summary(result)
            up = sum(not ending.fell for ending in result.episodes.endings)
            show(f"{name}, {law}: seeds that walk {LONG} steps", f"{up} of {len(gaits)}")
            show("  losses", " ".join(f"{loss:.3g}" for loss in losses))
            show("  steps", " ".join(str(int(n)) for n in result.episodes.gauge.steps))
            show("  speed m/s, cost", f"{figures['speed_m_s']} {figures['cost_of_transport']}")


def main() -> None:
    """Train and walk what is not there yet; print all."""
    both = ["table1", "authors", "table1+sum-guard", "table1+discrete"]
    more = [f"table1+{part}" for part in CODE] + [f"authors-{part}" for part in CODE]
    asked = os.environ.get("VARIANTS", "table1,table1+sum-guard,authors")
    names = both + more if asked == "all" else asked.split(",")
    robot = load_robot(ROBOT)
    if LONG:
        return long_walks(robot, names)
    KEPT.parent.mkdir(parents=True, exist_ok=True)
    lines = KEPT.read_text().splitlines() if KEPT.is_file() else []
    there = {_key(row): row for row in map(json.loads, lines)}
    for seed in SEEDS:
        for name in names:
            settings = {
                "robot": ROBOT,
                "plant": PLANT,
                "variant": name,
                "seed": seed,
                "init": INIT,
                "share": SHARE,
                "training": STEPS,
                "walk": WALK,
                "under": CHOSEN,
                "timestep_ms": TIMESTEP_MS,
            }
            if _key(settings) not in there:
                gait, loss = trained(robot, variant(name, robot), seed)
                assert isinstance(gait, Gait)
                row = settings | {
                    "loss": loss,
                    "laws": walked(robot, gait),
                    "model": model(robot, gait),
                }
                with KEPT.open("a") as file:
                    file.write(json.dumps(row) + "\n")
                there[_key(row)] = row
            _print(there[_key(settings)])


def _key(row: dict) -> str:
    row = {"timestep_ms": 0.5} | row
    return json.dumps(
        {name: value for name, value in row.items() if name not in RESULTS}, sort_keys=True
    )


def _print(row: dict) -> None:
    show(f"{row['variant']}, seed {row['seed']}, {row['init']} start: loss", row["loss"])
    for law, found in row["laws"].items():
        speed = "-" if found["speed"] is None else f"{found['speed']:.2f} m/s"
        show(f"  {law}: steps of five walks", " ".join(map(str, found["steps"])), speed)


if __name__ == "__main__":
    main()
