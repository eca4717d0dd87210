"""One function for each verb: call the workflow, judge the answer, choose how to show it."""

import sys
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from neuralgaits._environment import render_without_screen
from neuralgaits.cli import brief, proof_screen, robot_screen, screen
from neuralgaits.cli.arguments import (
    CertifyOptions,
    CheckDeployOptions,
    CheckProofOptions,
    DemoOptions,
    DoctorOptions,
    EpisodesOptions,
    ExportOptions,
    FitOptions,
    ImportGaitOptions,
    InspectOptions,
    OptimiseOptions,
    RefineOptions,
    ReportOptions,
    RobotsOptions,
    SimulateOptions,
    SweepOptions,
    TrainOptions,
    ViewOptions,
)
from neuralgaits.cli.argv_parser import Verb, given, verb_name
from neuralgaits.cli.brief_check import brief_check
from neuralgaits.cli.family_outcome import outcome_of_family
from neuralgaits.cli.given_verbs import carry_out_import, carry_out_optimise
from neuralgaits.cli.learning_verbs import carry_out_episodes, carry_out_fit, carry_out_refine
from neuralgaits.cli.outcome import Outcome
from neuralgaits.cli.report_verb import carry_out_report
from neuralgaits.cli.seeds_verb import carry_out_seeds
from neuralgaits.cli.sweep_verb import carry_out_sweep
from neuralgaits.cli.viewer_verbs import carry_out_demo, carry_out_view
from neuralgaits.errors import InputError, Interrupted
from neuralgaits.settings import (
    CertifySettings,
    CheckDeploySettings,
    CheckProofSettings,
    ExportSettings,
    SimulateSettings,
    TrainSettings,
    Watch,
)
from neuralgaits.settings.options import words_of

if TYPE_CHECKING:
    from neuralgaits.workflows.simulation import Simulation


def carry_out(verb: Verb) -> Outcome:
    """Carry out a verb: call its workflow, and judge the result."""
    if not verb.output.json:
        _say_which_is_latest(verb)
    if (of_family := outcome_of_family(verb, verb_name(type(verb)))) is not None:
        return of_family
    return _CARRY_OUT[type(verb)](verb)


def _say_which_is_latest(verb: Verb) -> None:
    """Print to stderr which run `latest` is: a failed training leaves it unchanged."""
    from neuralgaits.runs.latest import LATEST, about_latest

    if getattr(verb, "run", None) == LATEST and (sentence := about_latest()) is not None:
        print(sentence, file=sys.stderr)


def _train(verb: TrainOptions) -> Outcome:
    if verb.seeds is not None:
        return carry_out_seeds(verb)
    from neuralgaits.cli.progress import TrainingProgress
    from neuralgaits.workflows.train import train

    resume = None if verb.resume is None else _run_to_resume(verb.resume, verb.output.json)
    with TrainingProgress(quiet=verb.output.json) as progress:
        watch = Watch(progress.proved, progress.round_ended, progress.say, progress.begun)
        others = {"resume": resume, "progress": progress, "watch": watch}
        run = train(**given(verb, TrainSettings, **others))
    summary = run.summary
    # What failed, and what may mend it, is shown whole.
    show = None if summary.broken else brief.brief_training
    return Outcome(
        summary,
        good=summary.proved,
        table=screen.show_training,
        undecided=not summary.proved,
        brief=show,
    )


def _run_to_resume(run: str | Path, quiet: bool) -> Path:
    """Return the run folder to resume; print which one `latest` means to stderr, unless `quiet`.

    Raises: RunError if the run does not exist.
    """
    from neuralgaits.runs import resolve_unfinished
    from neuralgaits.runs.latest import LATEST

    folder = resolve_unfinished(run)
    if run == LATEST and not quiet:
        print(f"resuming {folder.path}", file=sys.stderr)
    return folder.path


def _simulate(verb: SimulateOptions) -> Outcome:
    if verb.video is not None:
        # Before MuJoCo is imported, which looks at it then.
        render_without_screen()
    from neuralgaits.cli.progress import WorkProgress
    from neuralgaits.workflows.simulate import simulate

    with WorkProgress("walking", quiet=verb.output.json) as progress:
        walks = simulate(**given(verb, SimulateSettings, begun=progress.begun))
    notes = [walks.plant_note]
    if not verb.output.json:
        notes += [walks.summary.engine_note, _replaced(walks)]
    for note in filter(None, notes):
        print(note, file=sys.stderr)
    stayed_up = not any(walks.summary.fell)
    return Outcome(walks.summary, good=stayed_up, table=screen.show_walks, brief=brief.brief_walks)


def _replaced(walks: "Simulation") -> str | None:
    """Return a note if disturbed walks replaced undisturbed ones; None otherwise."""
    if not walks.replaces_undisturbed:
        return None
    from neuralgaits.runs.shell_words import command, named

    again = command("simulate", named(walks.summary.run))
    return (
        f"this replaces the run's undisturbed walk, which reports show; `{again}` brings that back"
    )


def _certify(verb: CertifyOptions) -> Outcome:
    from neuralgaits.certificate.search.root_turns import SearchInterrupted
    from neuralgaits.cli.progress import ProofProgress
    from neuralgaits.workflows.certify import certify

    with ProofProgress(quiet=verb.output.json) as progress:
        try:
            certificate = certify(**given(verb, CertifySettings, progress=progress))
        except SearchInterrupted as stop:
            raise Interrupted(_resumed_proof(verb)) from stop
    verdict = certificate.verdict
    return Outcome(
        certificate.summary,
        good=verdict == "proved",
        table=proof_screen.show_proof,
        undecided=verdict == "undecided",
        brief=brief.brief_proof,
    )


def _resumed_proof(verb: CertifyOptions) -> str:
    """Return the command that resumes an interrupted search for the same statement."""
    from neuralgaits.runs.shell_words import command

    return command("certify", *words_of(replace(verb, resume=True), CertifySettings))


def _check_proof(verb: CheckProofOptions) -> Outcome:
    from neuralgaits.cli.progress import MANY_BOXES, CheckProgress
    from neuralgaits.workflows.check_proof import check_proof

    with CheckProgress(verb.output.json, MANY_BOXES[verb.arithmetic]) as progress:
        result = check_proof(**given(verb, CheckProofSettings, progress=progress))
    verdict = result.verdict
    return Outcome(
        result,
        good=verdict in ("proved", "consistent"),
        table=proof_screen.show_check,
        undecided=verdict == "undecided",
        brief=brief_check,
    )


def _export(verb: ExportOptions) -> Outcome:
    from neuralgaits.cli.export_screen import show_export
    from neuralgaits.cli.progress import WorkProgress
    from neuralgaits.workflows.export import export_controller

    with WorkProgress("writing it, comparing it with Python", quiet=verb.output.json) as progress:
        exported = export_controller(**given(verb, ExportSettings, begun=progress.begun))
    checked = exported.checked
    return Outcome(exported.summary, good=checked, table=show_export, undecided=not checked)


def _check_deploy(verb: CheckDeployOptions) -> Outcome:
    from neuralgaits.cli.deploy_screen import show_deployment_check
    from neuralgaits.workflows.check_deploy import check_deploy

    checked = check_deploy(**given(verb, CheckDeploySettings))
    return Outcome(
        checked,
        good=checked.agrees and checked.complete,
        table=show_deployment_check,
        undecided=checked.agrees and not checked.complete,
    )


def _inspect(verb: InspectOptions) -> Outcome:
    if verb.planarise is not None:
        from neuralgaits.workflows.planarise import planarise_file

        planar = planarise_file(verb.robot, verb.planarise, verb.feet, verb.weld)
        return Outcome(planar, good=True, table=robot_screen.show_planarised)
    if verb.feet != "point":
        raise InputError("--feet: expected --planarise OUT.xml beside it, found none: add that")
    if verb.weld:
        raise InputError("--weld: expected --planarise OUT.xml beside it, found none: add that")
    from neuralgaits.workflows.inspect import inspect
    from neuralgaits.workflows.planarise import robot_from

    show = partial(robot_screen.show_inspected, robot=verb.robot)
    return Outcome(inspect(robot_from(verb.robot)), good=True, table=show)


def _robots(verb: RobotsOptions) -> Outcome:
    from neuralgaits.workflows.robots import robots, write_built_in

    if verb.robot is None and verb.out is not None:
        raise InputError(
            "expected a robot to write, found none: write `neuralgaits robots ROBOT --out FILE.xml`"
        )
    if verb.robot is not None:
        written = write_built_in(verb.robot, verb.out)
        return Outcome(written, good=True, table=robot_screen.show_written)
    return Outcome(robots(), good=True, table=robot_screen.show_names)


def _doctor(_: DoctorOptions) -> Outcome:
    render_without_screen()
    from neuralgaits.workflows.doctor import doctor

    result = doctor()
    return Outcome(result, good=result.ok, table=robot_screen.show_findings)


_CARRY_OUT: dict[type, Callable[..., Outcome]] = {
    TrainOptions: _train,
    OptimiseOptions: carry_out_optimise,
    ImportGaitOptions: carry_out_import,
    SimulateOptions: _simulate,
    CertifyOptions: _certify,
    CheckProofOptions: _check_proof,
    FitOptions: carry_out_fit,
    RefineOptions: carry_out_refine,
    EpisodesOptions: carry_out_episodes,
    SweepOptions: carry_out_sweep,
    ExportOptions: _export,
    CheckDeployOptions: _check_deploy,
    ReportOptions: carry_out_report,
    ViewOptions: carry_out_view,
    DemoOptions: carry_out_demo,
    InspectOptions: _inspect,
    RobotsOptions: _robots,
    DoctorOptions: _doctor,
}
"""Function of each verb, by the class of its options."""
