"""Train a gait and leave a run folder that can be resumed, checked and simulated."""

import math
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from neuralgaits._checks import SEEDS
from neuralgaits.analysis.poincare_map import poincare
from neuralgaits.analysis.run import Run, open_parts
from neuralgaits.analysis.untrained_gait import untrained
from neuralgaits.certificate.traced import after_impact, trace_spec
from neuralgaits.errors import Interrupted, NonFiniteError, RunError
from neuralgaits.gait.policies.commanded_gait import CommandedGait
from neuralgaits.records.trained import TrainingProof, TrainingSummary, Violations, measured_hashes
from neuralgaits.records.training_config import config_of
from neuralgaits.runs import finish, resolve_unfinished
from neuralgaits.runs.atomic import refuse_unwritable
from neuralgaits.runs.names import ROBOT, STATE, TRAINING_SUMMARY, WEIGHTS
from neuralgaits.runs.only_writer import only_writer
from neuralgaits.runs.shell_words import LATEST, resuming
from neuralgaits.settings import TrainSettings, Watch, called_with
from neuralgaits.systems.family_tasks import task_of
from neuralgaits.systems.system_family import ProgressCallbacks
from neuralgaits.training.calibration import calibrated
from neuralgaits.training.session import Session, take_all_steps
from neuralgaits.training.trainer import Trainer
from neuralgaits.training.training_loop import Progress
from neuralgaits.workflows.new_training import new_training
from neuralgaits.workflows.planarise import robot_from
from neuralgaits.workflows.proof_rounds import ProofRounds


@called_with(TrainSettings)
def train(settings: TrainSettings) -> Run:
    """Train a policy for a robot.

    The robot may be one of `load_robot`, the spec a `GaitSpec`: its run can be opened again only
    if a file defines it, or if a built-in of its name has the same conditions. Ranges are pairs
    in SI units, slopes in radians; a box of robots maps kinds to half widths.

    Returns: `Run`.

    Raises: InputError on bad settings; NonFiniteError if the loss or a margin is not finite;
        Interrupted for KeyboardInterrupt.
    """
    if (task := task_of("train", settings)) is not None:
        watch = settings.watch or Watch()
        callbacks = ProgressCallbacks(
            trained=settings.progress, proved=watch.proved, begun=watch.begun
        )
        return task(callbacks).returned
    start_time = time.perf_counter()
    watch, root = settings.watch, settings.root
    if settings.resume is not None:
        run = _resumed(settings, settings.resume)
    else:
        warn = None if watch is None else watch.doubted
        place = None if settings.out is None else Path(settings.out)
        certify, budget = settings.certify, settings.budget
        new = new_training(settings, settings.seed or 0, warn, certify=certify, budget=budget)
        run = new.begun(root, place)
    return train_to_the_end(
        run, progress=settings.progress, watch=watch, root=root, start_time=start_time
    )


def train_to_the_end(
    run: Run,
    *,
    progress: Progress | None,
    watch: Watch | None,
    root: Path,
    start_time: float,
    trainer: Trainer | None = None,
) -> Run:
    """Train from the last checkpoint, or from a run's untrained gait, and finish its folder.

    Args:
        run: unfinished run; its gait is the untrained one.
        progress: see `train`.
        watch: see `train`.
        root: folder of the runs.
        start_time: start time of the command, or of this seed of many (s, of `time.perf_counter`).
        trainer: see `take_all_steps`.

    Raises: NonFiniteError; Interrupted for KeyboardInterrupt; InputError if another command trains
        this run.
    """
    with only_writer(run.path):
        if watch is not None and watch.begun is not None:
            watch.begun()
        try:
            session = take_all_steps(run, progress, trainer)
            gait, proof = session.gait, None
            if isinstance(gait, CommandedGait):
                gait = calibrated(gait, run)
            if run.config.certify is None:
                run.folder.write_tree(WEIGHTS, gait)
            else:
                rounds = ProofRounds(run, session.steps, watch or Watch())
                gait, proof = rounds.run(session.trainer, gait, run.config.certify.budget_s)
            trained = replace(run, trained=gait)
            finish(
                run.folder, summary_of(trained, session, start_time=start_time, proof=proof), root
            )
            return trained
        except KeyboardInterrupt as stop:
            raise Interrupted(resuming(run.path)) from stop


def summary_of(
    run: Run, session: Session, *, start_time: float, proof: TrainingProof | None = None
) -> TrainingSummary:
    """Return the summary of a training, with the hash of its conditions as a Program.

    Args:
        run: run with its trained gait.
        session: its training.
        start_time: start time of the command, or of this seed of many (s, of `time.perf_counter`).
        proof: result of the requested proof; None without one.

    Raises: NonFiniteError if its loss or a margin is NaN or infinity.
    """
    config = run.config
    seed = SEEDS  # Of the samples on which the summary is measured; no run can have it.
    report = session.trainer.report(run.trained, seed=seed)
    aimed = report
    if run.spec.aims:
        # Aims concern the middle of the tubes, which calibration replaces by the orbit.
        aimed = session.trainer.report(session.gait, seed=seed)
    aims = {aim.name: violations(aimed.margins[aim.name], aim.scale) for aim in run.spec.aims}
    conditions = {
        condition.name: violations(report.margins[condition.name], condition.scale)
        for condition in run.spec.conditions
    }
    program = None
    if config.not_provable_because is None:
        program = trace_spec(run.spec, run.robot, run.trained, run.residuals)
    summary = TrainingSummary(
        run=str(run.path),
        robot=config.robot,
        spec=config.spec,
        seed=config.seed,
        steps=int(session.state.step) + (0 if proof is None else proof.repair_steps),
        loss=aimed.loss,
        conditions=conditions,
        provable=program is not None,
        program_hash=None if program is None else program.hash,
        after_impact=after_impact(run.robot, run.trained, run.residuals),
        certificate=proof,
        commands=config.commands,
        aims=aims,
        orbit_speeds_m_s=_orbit_speeds(run),
        step_size=round(float(session.state.rate), 6),
        sha256=measured_hashes(run.path),
        compile_s=session.compile_s,
        train_s=session.train_s,
        wall_s=time.perf_counter() - start_time,
    )
    refuse_non_finite(summary)
    return summary


def _orbit_speeds(run: Run) -> tuple[float, float] | None:
    """Return the orbits' mean speeds at both ends of the range of `speed` (m/s), or None."""
    commands = run.config.commands
    if "speed" not in commands:
        return None
    middle = {name: 0.5 * (c.low + c.high) for name, c in commands.items()}
    speeds = []
    for speed in (commands["speed"].low, commands["speed"].high):
        member = run.at(**(middle | {"speed": speed}))
        speeds.append(poincare(member.zero_dynamics, member.gait.z(np.array([0.5, 0.5]))).speed_m_s)
    return (speeds[0], speeds[1]) if np.isfinite(speeds).all() else None


def refuse_non_finite(summary: TrainingSummary) -> None:
    """Refuse a trained gait with a loss, margin or error that is NaN or infinity.

    Raises: NonFiniteError, which names all of them.
    """
    numbers = {"loss": math.inf if summary.loss is None else summary.loss}
    numbers |= {
        name: one.min_margin for name, one in {**summary.conditions, **summary.aims}.items()
    }
    numbers |= summary.after_impact or {}
    bad = [name for name, number in numbers.items() if not math.isfinite(number)]
    if bad:
        raise NonFiniteError(
            f"expected a trained gait with a finite loss and margins, found NaN or infinity in "
            f"{', '.join(bad)}: train again with more --steps, with narrower ranges of commands "
            f"or parameters, or with another --seed; {summary.run} stays unfinished"
        )


def violations(margins: np.ndarray, scale: float) -> Violations:
    """Summarise the margins of samples, given in the unit of a condition with this scale."""
    shares = np.asarray(margins) / scale
    below = np.maximum(-shares, 0.0)
    least = float(np.min(shares))
    return Violations(float(np.mean(below)), float(np.max(below)), least, float(scale))


def _resumed(settings: TrainSettings, resumed: str | Path) -> Run:
    """Open an unfinished run, with the robot and spec it started with, and its untrained gait."""
    robot = None if settings.robot is None else robot_from(settings.robot)
    folder = resolve_unfinished(resumed, settings.root)
    config = config_of(folder)
    files = (folder.path / file for file in (STATE, WEIGHTS, TRAINING_SUMMARY))
    refuse_unwritable(*files, settings.root / LATEST, own=True)
    if robot is not None and folder.copy(ROBOT) != robot.layout.xml:
        raise RunError(
            f"expected the robot the run started with ({config.robot}), found another "
            f"robot file ({robot.name}): leave it out, `{resuming(folder.path)}`"
        )
    own, spec = open_parts(folder)
    return Run(folder, own, spec, untrained(folder, spec))
