"""Verbs on cart-poles: which commands are about one, and what they do there."""

from collections.abc import Callable
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any

from neuralgaits.cli import cartpole_screen as screen
from neuralgaits.cli.arguments import (
    CertifyOptions,
    CheckProofOptions,
    ExportOptions,
    InspectOptions,
    ReportOptions,
    RobotsOptions,
    SimulateOptions,
    TrainOptions,
)
from neuralgaits.cli.outcome import Outcome
from neuralgaits.cli.proof_screen import show_proof
from neuralgaits.errors import InputError, RunError
from neuralgaits.runs import RunFolder, resolve
from neuralgaits.systems.families import CARTPOLE, family_of

ALWAYS = ("output", "robot", "run")
"""Fields of every verb that has them."""
OWN: dict[type, tuple[str, ...]] = {
    TrainOptions: ("seed", "steps", "hidden", "out", "certify", "budget"),
    CertifyOptions: ("level", "budget"),
    SimulateOptions: ("episodes", "seed"),
    ExportOptions: ("out", "force"),
    ReportOptions: ("out",),
    InspectOptions: (),
    RobotsOptions: ("out",),
}
"""Options that each verb has for a cart-pole; all others are a walker's."""


def outcome(verb: Any) -> Outcome | None:
    """Carry out a verb about a cart-pole; None if it is about something else."""
    if not _is_about_one(verb):
        return None
    if type(verb) not in OWN:
        raise InputError(
            "expected a walker's run for this verb, found a cart-pole's: cart-poles have train, "
            "certify, check-proof, simulate, export, report and inspect"
        )
    _refuse_others(verb)
    found: dict[type, Callable[[Any], Outcome]] = {
        TrainOptions: _train,
        CertifyOptions: _certify,
        SimulateOptions: _simulate,
        ExportOptions: _export,
        ReportOptions: _report,
        InspectOptions: _inspect,
        RobotsOptions: _robots,
    }
    return found[type(verb)](verb)


def _is_about_one(verb: Any) -> bool:
    if isinstance(verb, CheckProofOptions):
        return False  # A proof file says itself what it is about.
    run = getattr(verb, "run", None) or getattr(verb, "resume", None)
    if run is not None and not isinstance(run, bool):
        folder = _folder(run)
        return folder is not None and family_of(folder.config) == CARTPOLE
    robot = getattr(verb, "robot", None)
    if robot is None or not isinstance(verb, TrainOptions | InspectOptions | RobotsOptions):
        return False
    from neuralgaits.systems.cartpole.mjcf import is_cartpole

    return is_cartpole(robot)


def _folder(run: str | Path) -> RunFolder | None:
    try:
        return resolve(run, finished=False)
    except (RunError, OSError, ValueError):
        return None  # Who opens it says what is wrong.


def _refuse_others(verb: Any) -> None:
    """Refuse options that mean nothing for a cart-pole. Raises: InputError."""
    known = (*ALWAYS, *OWN[type(verb)])
    given = []
    for field in fields(verb):
        if field.name in known or field.default is MISSING:
            continue  # Those without a default are never a walker's alone.
        if getattr(verb, field.name) != field.default:
            given.append(f"--{field.name.replace('_', '-')}")
    if given:
        own = ", ".join(f"--{name}" for name in OWN[type(verb)]) or "none"
        raise InputError(
            f"expected options of a cart-pole ({own}), found {', '.join(given)}: leave it out"
        )


def _train(verb: TrainOptions) -> Outcome:
    from neuralgaits.cli.progress import TrainingProgress
    from neuralgaits.systems.cartpole.cartpole_certify import certify_cartpole
    from neuralgaits.systems.cartpole.cartpole_train import STEPS, train_cartpole

    if verb.hidden is not None and len(verb.hidden) != 1:
        raise InputError(
            f"expected one hidden layer, found {len(verb.hidden)}: give one width, as in "
            "--hidden 16"
        )
    assert verb.robot is not None
    with TrainingProgress(quiet=verb.output.json) as progress:
        total = verb.steps or STEPS
        run = train_cartpole(
            str(verb.robot),
            seed=verb.seed or 0,
            steps=verb.steps,
            width=None if verb.hidden is None else verb.hidden[0],
            out=None if verb.out is None else Path(verb.out),
            root=verb.root,
            progress=lambda step, loss: progress(step, total, loss),
        )
        if verb.certify:
            certify_cartpole(run, budget=verb.budget, progress=progress.proved)
    done = run.summary
    return Outcome(done, done.holds, screen.show_training)


def _certify(verb: CertifyOptions) -> Outcome:
    from neuralgaits.cli.progress import ProofProgress
    from neuralgaits.systems.cartpole.cartpole_certify import HIGHEST, certify_cartpole
    from neuralgaits.systems.cartpole.cartpole_run import open_cartpole

    level = HIGHEST if verb.level is None else verb.level
    if level > HIGHEST:
        raise InputError(
            f"expected a level from 1 to {HIGHEST}, found {level}: a cart-pole's levels 2 and 3 "
            "are about the full order already"
        )
    run = open_cartpole(str(verb.run))
    with ProofProgress(quiet=verb.output.json) as progress:
        done = certify_cartpole(run, level=level, budget=verb.budget, progress=progress)
    undecided = done.verdict == "undecided"
    return Outcome(done, done.verdict == "proved", show_proof, undecided, screen.brief_proof)


def _simulate(verb: SimulateOptions) -> Outcome:
    from neuralgaits.cli.progress import waiting
    from neuralgaits.systems.cartpole.cartpole_run import open_cartpole
    from neuralgaits.systems.cartpole.cartpole_simulate import simulate_cartpole

    run = open_cartpole(str(verb.run))
    with waiting("balancing", quiet=verb.output.json) as progress:
        progress.begun()
        done = simulate_cartpole(run, episodes=verb.episodes, seed=verb.seed)
    return Outcome(done, done.stayed == done.episodes, screen.show_episodes)


def _export(verb: ExportOptions) -> Outcome:
    from neuralgaits.systems.cartpole.cartpole_export import export_cartpole
    from neuralgaits.systems.cartpole.cartpole_run import open_cartpole

    done = export_cartpole(open_cartpole(str(verb.run)), verb.out, force=verb.force)
    return Outcome(done, done.checked, screen.show_export, undecided=not done.checked)


def _report(verb: ReportOptions) -> Outcome:
    from neuralgaits.systems.cartpole.cartpole_report import report_cartpole
    from neuralgaits.systems.cartpole.cartpole_run import open_cartpole

    done = report_cartpole(open_cartpole(str(verb.run)), verb.out)
    return Outcome(done, True, screen.show_report)


def _inspect(verb: InspectOptions) -> Outcome:
    from neuralgaits.systems.cartpole.cartpole_inspect import inspect_cartpole

    return Outcome(inspect_cartpole(verb.robot), True, screen.show_robot)


def _robots(verb: RobotsOptions) -> Outcome:
    from neuralgaits.cli.screen import show_written
    from neuralgaits.systems.cartpole.cartpole_inspect import write_cartpole

    assert verb.robot is not None
    return Outcome(write_cartpole(verb.out), True, show_written)
