"""Train a gait and leave a run folder that can be continued, checked and simulated."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jax
import numpy as np

from neuralgaits.barriers import Gait, GaitSpec, specs
from neuralgaits.barriers.spec import Init
from neuralgaits.errors import InputError, NonFiniteError, RunError, SpecError
from neuralgaits.gait import ZeroDynamics
from neuralgaits.interpreters.tracer import trace
from neuralgaits.robots import PlanarBiped
from neuralgaits.runs import RUNS_ROOT, RunFolder, finish, resolve_unfinished
from neuralgaits.training import VALIDATE_EVERY, Loss, Trainer, TrainState, start_from_posture
from neuralgaits.workflows.run import (
    PROGRAM,
    ROBOT,
    SPEC,
    STATE,
    WEIGHTS,
    Run,
    open_parts,
    untrained,
)

Progress = Callable[[int, int, float], None]
CHECKPOINT_S = 2.0
"""Seconds between two checkpoints."""
FRESH_SAMPLES_SEED = 2**31 - 1
"""Seed of the samples the summary is measured on; training and validation never draw it."""
NAN_STATE = "nan.safetensors"


def train(
    robot: PlanarBiped,
    spec: str | GaitSpec = "walking",
    *,
    seed: int = 0,
    init: Init = "posture",
    hidden: tuple[int, ...] | None = None,
    steps: int | None = None,
    out: str | Path | None = None,
    resume: str | Path | None = None,
    progress: Progress | None = None,
    root: Path = RUNS_ROOT,
) -> Run:
    """Train a policy for a robot.

    Args:
        robot: of `load_robot`.
        spec: "walking", "paper", "authors", FILE.py:NAME, or a `GaitSpec`. A run of a `GaitSpec`
            that no file defines can be opened again only if a built-in of its name has the
            same conditions.
        seed: of weights and samples.
        init: "posture" or "random".
        hidden: widths of the hidden layers; the spec's if None.
        steps: gradient steps; the recipe's if None.
        out: the run folder; `runs/ROBOT/<UTC time>-<seed>` if None.
        resume: continue this run, or the `latest` unfinished one; other settings come from it.
        progress: called with (step, steps, loss) now and then.
        root: folder of the runs.

    Returns: `Run`.

    Raises: InputError on bad settings; NonFiniteError if the loss turned to NaN.
    """
    began = time.perf_counter()
    if resume is not None:
        folder, robot, loaded = _resumed(resume, robot, root)
        gait = untrained(folder, loaded)
    else:
        _check(seed, init, hidden, steps)
        loaded = specs.load(spec, robot) if isinstance(spec, str) else spec
        gait = loaded.new_gait(jax.random.key(seed), init, hidden)
        config = {
            "robot": robot.name,
            "spec": spec if isinstance(spec, str) else spec.name,
            "conditions": [condition.name for condition in loaded.conditions],
            "seed": seed,
            "init": init,
            "hidden": hidden,
            "steps": loaded.recipe.steps if steps is None else steps,
        }
        program, reason = _provable(loaded, robot, gait)
        config |= {"provable": program is not None, "not_provable_because": reason}
        config |= {"program_hash": None if program is None else program.hash}
        copies = {ROBOT: robot.layout.xml, SPEC: _source(spec)}
        copies |= {} if program is None else {PROGRAM: program.to_json()}
        place = None if out is None else Path(out)
        folder = RunFolder.create(config, copies, name=robot.name, seed=seed, root=root, out=place)
    gait = _Session(folder, robot, loaded, progress, began).run(root, gait)
    return Run(folder, robot, loaded, gait)


def _resumed(
    run: str | Path, robot: PlanarBiped, root: Path
) -> tuple[RunFolder, PlanarBiped, GaitSpec]:
    """An unfinished run with the robot and spec it started with."""
    folder = resolve_unfinished(run, root)
    _same_robot(folder, robot)
    return folder, *open_parts(folder)


@dataclass(frozen=True)
class _Session:
    """One training, from its folder to its summary."""

    folder: RunFolder
    robot: PlanarBiped
    spec: GaitSpec
    progress: Progress | None
    began: float

    def run(self, root: Path, gait: Gait) -> Gait:
        """Train from the last checkpoint, or from the untrained gait, to the end."""
        config = self.folder.config
        trainer = Trainer.build(
            self.robot, self.spec, gait, steps=config["steps"], seed=config["seed"]
        )
        state, rows = self._start(trainer, gait)
        compiling = time.perf_counter()
        trainer.validate(state)
        if not trainer.done(state):
            jax.block_until_ready(trainer.step(state))
        training = time.perf_counter()
        state = self._loop(trainer, state, rows)
        done = time.perf_counter()
        gait = trainer.gait(state.best)
        self.folder.write_tree(WEIGHTS, gait)
        report = trainer.report(gait, seed=FRESH_SAMPLES_SEED)
        summary = {
            "run": str(self.folder.path),
            "robot": config["robot"],
            "spec": config["spec"],
            "seed": config["seed"],
            "steps": int(state.step),
            "loss": report.loss,
            "conditions": {name: violations(margins) for name, margins in report.margins.items()},
            "provable": config["provable"],
            "compile_s": training - compiling,
            "train_s": done - training,
            "wall_s": time.perf_counter() - self.began,
        }
        finish(self.folder, summary, root)
        return gait

    def _start(self, trainer: Trainer, gait: Gait) -> tuple[TrainState, list[Mapping[str, float]]]:
        """The last checkpoint if there is one, else the beginning."""
        if (self.folder.path / STATE).is_file():
            state = self.folder.read_tree(STATE, trainer.init(gait))
            rows = [row for row in self.folder.read_metrics() if row["step"] <= int(state.step)]
            return state, list(rows)
        config, recipe = self.folder.config, self.spec.recipe
        if config["init"] == "posture" and recipe.posture_steps:
            key = jax.random.fold_in(jax.random.key(config["seed"]), 1)
            gait = start_from_posture(self.robot, gait, recipe.posture_steps, key)
        return trainer.init(gait), []

    def _loop(
        self, trainer: Trainer, state: TrainState, rows: list[Mapping[str, float]]
    ) -> TrainState:
        saved = time.perf_counter()
        kept = state
        while not trainer.done(state):
            state, loss = trainer.step(state)
            step = int(state.step)
            if step % VALIDATE_EVERY and not trainer.done(state):
                continue
            self._refuse_nan(trainer, kept, loss)
            state = trainer.validate(state)
            kept = state
            rows.append(self._row(step, loss, state))
            if self.progress is not None:
                self.progress(step, trainer.steps, float(loss.total))
            if time.perf_counter() - saved > CHECKPOINT_S or trainer.done(state):
                self.folder.write_metrics(rows)
                self.folder.write_tree(STATE, state)
                saved = time.perf_counter()
        return state

    def _row(self, step: int, loss: Loss, state: TrainState) -> dict[str, float]:
        names = [condition.name for condition in self.spec.conditions]
        terms = dict(zip(names, np.asarray(loss.terms).tolist(), strict=True))
        head = {
            "step": step,
            "loss": float(loss.total),
            "validation_loss": float(state.best_loss),
            "effort": float(loss.effort),
        }
        return head | terms

    def _refuse_nan(self, trainer: Trainer, kept: TrainState, loss: Loss) -> None:
        """Save the last good state, and walk on from it to the step that turned to NaN."""
        if np.isfinite(float(loss.total)):
            return
        self.folder.write_tree(STATE, kept)
        self.folder.write_tree(NAN_STATE, kept)
        state, loss = trainer.step(kept)
        while np.isfinite(float(loss.total)):
            state, loss = trainer.step(state)
        names = [condition.name for condition in self.spec.conditions]
        bad = [n for n, v in zip(names, np.asarray(loss.terms), strict=True) if not np.isfinite(v)]
        raise NonFiniteError(
            f"loss is {float(loss.total)} at step {int(state.step)} (conditions: "
            f"{', '.join(bad) or 'none, the sum'}); state of step {int(kept.step)} kept, reproduce "
            f"with `neuralgaits train {self.folder.config['robot']} --resume {self.folder.path}`"
        )


def violations(margins: np.ndarray) -> dict[str, float]:
    """Mean and largest violation of margins >= 0, and the smallest margin."""
    below = np.maximum(-margins, 0.0)
    return {
        "mean_violation": float(np.mean(below)),
        "max_violation": float(np.max(below)),
        "min_margin": float(np.min(margins)),
    }


def _check(seed: int, init: str, hidden: tuple[int, ...] | None, steps: int | None) -> None:
    if not 0 <= seed < 2**31:
        raise InputError(f"expected a seed from 0 to 2147483647, found {seed}")
    if init not in ("posture", "random"):
        raise InputError(f"expected init posture or random, found {init!r}")
    if hidden is not None and (not hidden or min(hidden) < 1):
        raise InputError(f"expected hidden widths of at least 1, found {hidden}")
    if steps is not None and steps < 1:
        raise InputError(f"expected at least 1 gradient step, found {steps}")


def _source(spec: str | GaitSpec) -> str:
    """The file that defines the spec, or the names that an object without a file has."""
    if isinstance(spec, str):
        return specs.source_path(spec).read_text()
    names = "".join(f"# {condition.name}\n" for condition in spec.conditions)
    return f"# A GaitSpec made in Python, {spec.name!r}, in no file. Its conditions:\n{names}"


def _same_robot(folder: RunFolder, robot: PlanarBiped) -> None:
    if folder.copy(ROBOT) != robot.layout.xml:
        raise RunError(
            f"expected the robot the run started with ({folder.config['robot']}), found another "
            f"robot file ({robot.name}): resume with {folder.path / ROBOT}"
        )


def _provable(spec: GaitSpec, robot: PlanarBiped, gait: Gait):
    """Trace the spec once: the Program all other readers use, or why there is none.

    Raises: SpecError if a condition cannot be traced; a ReLU network only marks the run.
    """
    zd = ZeroDynamics(robot, gait.policy)
    try:
        return trace(lambda u: spec.margins(gait, zd, u), {"u": (2,)}, parameters=gait), None
    except SpecError as error:
        network: Any = getattr(gait.policy, "network", None)
        if network is not None and network.activation == "relu":
            return None, f"the policy's activation is ReLU: {error}"
        raise
