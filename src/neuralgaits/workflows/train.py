"""Train a gait and leave a run folder that can be continued, checked and simulated."""

import time
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import jax
import numpy as np

from neuralgaits._settings import check_proof_budget, check_seed, check_steps
from neuralgaits.analysis.orbit import poincare
from neuralgaits.analysis.run import Run, open_parts, untrained
from neuralgaits.barriers import GaitSpec, specs, user_code
from neuralgaits.barriers.commanded import Interval, commands_of
from neuralgaits.barriers.regions import AnyGait, CommandedGait
from neuralgaits.barriers.spec import Init
from neuralgaits.certificate.provable import refuse_many_axes, refuse_untraceable, why_not_provable
from neuralgaits.certificate.traced import after_impact, trace_spec
from neuralgaits.errors import InputError, Interrupted, RunError
from neuralgaits.gait.commands import Commands
from neuralgaits.records.asked import Asked, Proving, Range, asked_of
from neuralgaits.records.trained import Trained, TrainingProof, Violations
from neuralgaits.robots import PlanarBiped
from neuralgaits.robots.parameter_box import checked_box
from neuralgaits.runs import RUNS_ROOT, RunFolder, finish, resolve_unfinished
from neuralgaits.runs.commands import command, resuming
from neuralgaits.runs.names import ROBOT, SPEC, WEIGHTS
from neuralgaits.training.calibration import calibrated
from neuralgaits.training.gradient_steps import Progress
from neuralgaits.training.session import Session, take_all_steps
from neuralgaits.workflows.parts.proof_rounds import ProofRounds, Watch

FRESH_SAMPLES_SEED = 2**31
"""Seed of the samples the summary is measured on; no run can have it."""


def train(
    robot: PlanarBiped | None = None,
    spec: str | GaitSpec = "walking",
    *,
    seed: int = 0,
    init: Init = "posture",
    hidden: tuple[int, ...] | None = None,
    steps: int | None = None,
    out: str | Path | None = None,
    resume: str | Path | None = None,
    certify: bool = False,
    budget: float | None = None,
    speed: float | Interval | None = None,
    step_length: Interval | None = None,
    step_height: Interval | None = None,
    slope: Interval | None = None,
    parameters: Mapping[str, float] | None = None,
    progress: Progress | None = None,
    watch: Watch | None = None,
    root: Path = RUNS_ROOT,
) -> Run:
    """Train a policy for a robot.

    Args:
        robot: of `load_robot`; with `resume` it need not be given, the run has its own.
        spec: of `specs.DESCRIPTIONS` by name, FILE.py:NAME, or a `GaitSpec`. A run of a `GaitSpec`
            that no file defines can be opened again only if a built-in of its name has the
            same conditions.
        seed: of weights and samples.
        init: "posture" or "random".
        hidden: widths of the hidden layers; the spec's if None.
        steps: gradient steps; the recipe's if None.
        out: the run folder; `runs/ROBOT/<UTC time>-<seed>` if None.
        resume: continue this run, or the `latest` unfinished one; other settings come from it.
        certify: after training, prove the conditions (level 1); where that fails, train on with
            samples of the boxes that are left, until the proof stands.
        budget: seconds for proofs and further training; None for as long as it takes.
        speed: mean speed to walk at (m/s), or a range of them: one policy, told at each touchdown.
        step_length: range of footholds' distances to be told (m).
        step_height: range of their heights above the stance foot (m).
        slope: range of slopes of the ground (rad).
        parameters: box of robots that the gait is meant for, half widths by kind: shares of the
            file's mass, inertia and rotor, metres of com.
        progress: called with (step, steps, loss) now and then.
        watch: told how the proof goes on.
        root: folder of the runs.

    Returns: `Run`.

    Raises: InputError on bad settings; NonFiniteError if the loss turned to NaN; Interrupted
        for KeyboardInterrupt.
    """
    began = time.perf_counter()
    if resume is not None:
        folder, robot, loaded = _resumed(resume, robot, root)
        gait = untrained(folder, loaded)
    elif robot is None:
        raise InputError(
            "expected ROBOT, found none: name one, as in "
            f"`{command('train', 'amber3m')}`, or a run to go on with by --resume RUN"
        )
    else:
        _check(seed, init, hidden, steps)
        check_proof_budget(certify, budget)
        one, spread = (None, speed) if isinstance(speed, tuple) else (speed, None)
        told = commands_of(
            speed=spread, step_length=step_length, step_height=step_height, slope=slope
        )
        if one is not None and told:
            raise InputError(
                "expected one speed, or a range of it beside other commands, found --speed "
                f"{one:g} with {', '.join(c.name for c in told)}: give --speed LOW:HIGH"
            )
        if (told or one is not None or parameters) and not isinstance(spec, str):
            raise InputError(
                "expected a spec by name with a speed, commands or parameters, found a GaitSpec: "
                "build it with specs.commanded or specs.robust"
            )
        box = checked_box(parameters or {})
        loaded = specs.load(spec, robot, told, one, box) if isinstance(spec, str) else spec
        refuse_many_axes(loaded)
        with user_code.blamed():
            gait = loaded.new_gait(jax.random.key(seed), init, hidden)
        if not (isinstance(spec, str) and spec in specs.DESCRIPTIONS):
            # The built-in ones are traced by the tests.
            file = specs.source_path(spec) if isinstance(spec, str) else None
            refuse_untraceable(loaded, robot, gait, file)
        if certify and loaded.commands:
            raise InputError(
                "expected a gait without commands to train until it is proved, found one that is "
                f"told {', '.join(c.name for c in loaded.commands)}: its proof takes many minutes; "
                "train without --certify, then certify the run"
            )
        if certify and loaded.parameters:
            raise InputError(
                "expected a gait for one robot to train until it is proved, found --parameters: "
                "train without --certify, then certify the run"
            )
        unprovable = why_not_provable(gait)
        if certify and unprovable is not None:
            raise InputError(f"expected a gait that can be certified, found that {unprovable}")
        config = Asked(
            robot=robot.name,
            spec=spec if isinstance(spec, str) else spec.name,
            seed=seed,
            init=init,
            hidden=_widths(gait),
            steps=loaded.recipe.steps if steps is None else steps,
            described=loaded.describe(),
            not_provable_because=unprovable,
            certify=Proving(budget) if certify else None,
            commands=ranges_of(told),
            speed=one,
            parameters=box,
        )
        copies = {ROBOT: robot.layout.xml, SPEC: _source(spec)}
        place = None if out is None else Path(out)
        folder = RunFolder.create(config, copies, name=robot.name, seed=seed, root=root, out=place)
    run = Run(folder, robot, loaded, gait)
    return train_to_the_end(run, progress=progress, watch=watch, root=root, began=began)


def train_to_the_end(
    run: Run, *, progress: Progress | None, watch: Watch | None, root: Path, began: float
) -> Run:
    """Train from the last checkpoint, or from the untrained gait of a run, and finish its folder.

    Args:
        run: unfinished; its gait is the untrained one.
        progress: of `train`.
        watch: of `train`.
        root: folder of the runs.
        began: when the command did (s, of `time.perf_counter`).

    Raises: NonFiniteError; Interrupted for KeyboardInterrupt.
    """
    try:
        session = take_all_steps(run, progress)
        gait, proof = session.gait, None
        if isinstance(gait, CommandedGait):
            gait = calibrated(gait, run.robot, run.residuals)
        if run.asked.certify is None:
            run.folder.write_tree(WEIGHTS, gait)
        else:
            rounds = ProofRounds(run.folder, run.robot, run.spec, session.steps, watch or Watch())
            gait, proof = rounds.run(session.trainer, gait, run.asked.certify.budget_s)
        done = replace(run, trained=gait)
        finish(run.folder, _summary(done, session, proof, began), root)
        return done
    except KeyboardInterrupt as stop:
        raise Interrupted(resuming(run.path)) from stop


def _summary(run: Run, session: Session, proof: TrainingProof | None, began: float) -> Trained:
    """What a training says of itself, with the hash of its conditions as a Program."""
    asked, report = run.asked, session.trainer.report(run.trained, seed=FRESH_SAMPLES_SEED)
    # Aims are those of the middle of the tubes, which calibration leaves for the orbit.
    aimed = (
        session.trainer.report(session.gait, seed=FRESH_SAMPLES_SEED) if run.spec.aims else report
    )
    aims = {aim.name: violations(aimed.margins[aim.name], aim.scale) for aim in run.spec.aims}
    found = {
        condition.name: violations(report.margins[condition.name], condition.scale)
        for condition in run.spec.conditions
    }
    program = None
    if asked.not_provable_because is None:
        program = trace_spec(run.spec, run.robot, run.trained, run.residuals)
    return Trained(
        run=str(run.path),
        robot=asked.robot,
        spec=asked.spec,
        seed=asked.seed,
        steps=int(session.state.step) + (0 if proof is None else proof.repair_steps),
        loss=aimed.loss,
        conditions=found,
        provable=program is not None,
        program_hash=None if program is None else program.hash,
        after_impact=after_impact(run.robot, run.trained, run.residuals),
        certificate=proof,
        commands=asked.commands,
        aims=aims,
        orbit_speeds_m_s=_orbit_speeds(run),
        step_size=round(float(session.state.rate), 6),
        compile_s=session.compile_s,
        train_s=session.train_s,
        wall_s=time.perf_counter() - began,
    )


def _orbit_speeds(run: Run) -> tuple[float, float] | None:
    """Mean speeds of the orbits at both ends of the range of `speed` (m/s)."""
    told = run.asked.commands
    if "speed" not in told:
        return None
    middle = {name: 0.5 * (c.low + c.high) for name, c in told.items()}
    found = []
    for speed in (told["speed"].low, told["speed"].high):
        there = run.at(**(middle | {"speed": speed}))
        found.append(poincare(there.zero_dynamics, there.gait.z(np.array([0.5, 0.5]))).speed_m_s)
    return (found[0], found[1]) if np.isfinite(found).all() else None


def violations(margins: np.ndarray, scale: float) -> Violations:
    """What margins of samples, in the unit of a condition with this scale, say of it."""
    shares = np.asarray(margins) / scale
    below = np.maximum(-shares, 0.0)
    least = float(np.min(shares))
    return Violations(float(np.mean(below)), float(np.max(below)), least, float(scale))


def _resumed(
    run: str | Path, robot: PlanarBiped | None, root: Path
) -> tuple[RunFolder, PlanarBiped, GaitSpec]:
    """An unfinished run with the robot and spec it started with."""
    folder = resolve_unfinished(run, root)
    asked_of(folder)
    if robot is not None:
        _same_robot(folder, robot)
    return folder, *open_parts(folder)


def ranges_of(commands: Commands) -> dict[str, Range]:
    """Commands as a run's config has them."""
    return {c.name: Range(c.low, c.high, c.largest_change) for c in commands}


def _check(seed: int, init: str, hidden: tuple[int, ...] | None, steps: int | None) -> None:
    check_seed(seed)
    if init not in ("posture", "random"):
        raise InputError(f"expected init posture or random, found {init!r}")
    if hidden is not None and (not hidden or min(hidden) < 1):
        raise InputError(f"expected hidden widths of at least 1, found {hidden}")
    check_steps(steps)


def _widths(gait: AnyGait) -> tuple[int, ...] | None:
    """Widths of the hidden layers, None for a policy without a network."""
    network = getattr(gait.policy, "network", None)
    return None if network is None else tuple(len(bias) for bias in network.biases[:-1])


def _source(spec: str | GaitSpec) -> str:
    """The file that defines the spec, or the names that an object without a file has."""
    if isinstance(spec, str):
        return specs.source_path(spec).read_text()
    names = "".join(f"# {condition.name}\n" for condition in spec.conditions)
    return f"# A GaitSpec made in Python, {spec.name!r}, in no file. Its conditions:\n{names}"


def _same_robot(folder: RunFolder, robot: PlanarBiped) -> None:
    if folder.copy(ROBOT) != robot.layout.xml:
        raise RunError(
            f"expected the robot the run started with ({asked_of(folder).robot}), found another "
            f"robot file ({robot.name}): leave it out, `{resuming(folder.path)}`"
        )
