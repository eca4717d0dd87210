"""One function for each verb: call the workflow, judge the answer, choose how to show it."""

import math
import sys
from pathlib import Path
from typing import Any

from neuralgaits._environment import render_without_screen
from neuralgaits.cli import brief, proof_screen, screen
from neuralgaits.cli.arguments import (
    CertifyOptions,
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
from neuralgaits.cli.argv_parser import Verb, options
from neuralgaits.cli.given_verbs import carry_out_import, carry_out_optimise
from neuralgaits.cli.learning_verbs import (
    carry_out_episodes,
    carry_out_fit,
    carry_out_refine,
    disturbance_bounds,
)
from neuralgaits.cli.outcome import Outcome
from neuralgaits.cli.report_verb import carry_out_report
from neuralgaits.cli.seeds_verb import carry_out_seeds
from neuralgaits.cli.sweep_verb import carry_out_sweep
from neuralgaits.cli.viewer_verbs import carry_out_demo, carry_out_view
from neuralgaits.errors import InputError, Interrupted

_COMMANDS = {"speed": "m/s", "step_length": "m", "step_height": "m", "slope": "degrees"}
"""Options for ranges of commands, with their units."""
_TRAINING = (
    "spec",
    "seed",
    "seeds",
    "init",
    "hidden",
    "steps",
    "certify",
    "budget",
    "out",
    *_COMMANDS,
    "parameters",
)
"""Settings of a training, which a resumed run already has."""


def carry_out(verb: Verb) -> Outcome:
    """Carry out a verb: call its workflow, and judge the result."""
    if not verb.output.json:
        _say_which_is_latest(verb)
    match verb:
        case TrainOptions():
            return _train(verb)
        case OptimiseOptions():
            return carry_out_optimise(verb)
        case ImportGaitOptions():
            return carry_out_import(verb)
        case SimulateOptions():
            return _simulate(verb)
        case CertifyOptions():
            return _certify(verb)
        case CheckProofOptions():
            return _check_proof(verb)
        case FitOptions():
            return carry_out_fit(verb)
        case RefineOptions():
            return carry_out_refine(verb)
        case EpisodesOptions():
            return carry_out_episodes(verb)
        case SweepOptions():
            return carry_out_sweep(verb)
        case ExportOptions():
            return _export(verb)
        case ReportOptions():
            return carry_out_report(verb)
        case ViewOptions():
            return carry_out_view(verb)
        case DemoOptions():
            return carry_out_demo(verb)
        case InspectOptions():
            return _inspect(verb)
        case RobotsOptions():
            return _robots(verb)
        case DoctorOptions():
            return _doctor()


def _say_which_is_latest(verb: Verb) -> None:
    """Print to stderr which run `latest` is: a failed training leaves it unchanged."""
    from neuralgaits.runs.latest import LATEST, about_latest

    if getattr(verb, "run", None) == LATEST and (told := about_latest()) is not None:
        print(told, file=sys.stderr)


def _train(verb: TrainOptions) -> Outcome:
    asked = {name: getattr(verb, name) for name in _TRAINING}
    given: dict[str, Any] = {
        name: value for name, value in asked.items() if value is not None and value is not False
    }
    if "hidden" in given:
        given["hidden"] = _widths(given["hidden"])
    for name in _COMMANDS:
        if name in given:
            given[name] = _interval(name, given[name])
    if "parameters" in given:
        from neuralgaits.robots.parameter_box import parse_box

        given["parameters"] = parse_box(given["parameters"])
    if verb.resume is not None:
        given = {"resume": _unfinished(verb.resume, given, verb.output.json)}
    if "seeds" in given:
        return carry_out_seeds(verb.robot, given, quiet=verb.output.json)
    from neuralgaits.cli.progress import TrainingProgress
    from neuralgaits.workflows.planarise import load_or_advise
    from neuralgaits.workflows.proof_rounds import Watch
    from neuralgaits.workflows.train import train

    robot = None if verb.robot is None else load_or_advise(verb.robot)
    with TrainingProgress(quiet=verb.output.json) as progress:
        watch = Watch(progress.proved, progress.round_ended, progress.say)
        run = train(robot, progress=progress, watch=watch, **given)
    done = run.summary
    # What failed, and what may mend it, is shown whole.
    shown = None if done.broken else brief.brief_training
    return Outcome(done, done.proved, screen.show_training, undecided=not done.proved, brief=shown)


def _interval(name: str, text: str) -> float | tuple[float, float]:
    """Read a number, or LOW:HIGH, of an option; degrees become radians.

    Raises: InputError.
    """
    flag, single = f"--{name.replace('_', '-')}", name == "speed"
    form = "a number or LOW:HIGH" if single else "LOW:HIGH"
    try:
        values = [float(part) for part in text.split(":")]
    except ValueError:
        values = []
    allowed = (1, 2) if single else (2,)
    if len(values) not in allowed or not all(map(math.isfinite, values)):
        raise InputError(f"{flag}: expected {form} in {_COMMANDS[name]}, found {text!r}")
    if name == "slope":
        values = [math.radians(value) for value in values]
    return values[0] if len(values) == 1 else (values[0], values[1])


def _ranges(text: str | None) -> dict[str, tuple[float, float]]:
    """Read `NAME=LOW:HIGH,...` as ranges; degrees become radians. Raises: InputError."""
    found: dict[str, tuple[float, float]] = {}
    for part in [] if text is None else text.split(","):
        name, _, ends = (word.strip() for word in part.partition("="))
        try:
            low, high = (float(end) for end in ends.split(":"))
        except ValueError:
            low = high = math.nan
        if not name or name in found or not math.isfinite(high - low):
            raise InputError(
                f"expected --within as NAME=LOW:HIGH,... with each name once, found {text!r}: "
                "write speed=0.70:0.72"
            )
        found[name] = (math.radians(low), math.radians(high)) if name == "slope" else (low, high)
    return found


def _unfinished(run: str, given: dict[str, Any], quiet: bool) -> Path:
    """Return the run folder to resume; print which one `latest` means to stderr, unless `quiet`.

    Raises: InputError if the command line has settings that the run already has, RunError if the
        run does not exist.
    """
    if given:
        flags = ", ".join(f"--{name.replace('_', '-')}" for name in given)
        raise InputError(
            f"expected --resume alone, found it with {flags}: a run goes on with its own "
            "settings; drop them, or train anew without --resume"
        )
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
    from neuralgaits.cli.progress import waiting
    from neuralgaits.workflows.simulate import simulate

    with waiting("walking", quiet=verb.output.json):
        done = simulate(
            **options(verb, "parameters"),
            parameters=_box(verb.parameters),
            workers=verb.pool.workers,
            ray=verb.pool.ray,
        )
    notes = [done.plant_note, None if verb.output.json else done.summary.engine_note]
    for note in filter(None, notes):
        print(note, file=sys.stderr)
    walked = not any(done.summary.fell)
    return Outcome(done.summary, walked, screen.show_walks, brief=brief.brief_walks)


def _certify(verb: CertifyOptions) -> Outcome:
    from neuralgaits.certificate.search.schedule import SearchInterrupted
    from neuralgaits.cli.progress import ProofProgress
    from neuralgaits.workflows.certify import certify

    with ProofProgress(quiet=verb.output.json) as progress:
        try:
            done = certify(
                verb.run,
                level=verb.level,
                disturbance=disturbance_bounds(verb.disturbance, verb.run),
                budget=verb.budget,
                resume=verb.resume,
                progress=progress,
                within=_ranges(verb.within),
                parameters=_box(verb.parameters),
                workers=verb.pool.workers,
                ray=verb.pool.ray,
                bandwidth=verb.bandwidth,
            )
        except SearchInterrupted as stop:
            raise Interrupted(_resumed_proof(verb)) from stop
    verdict = done.verdict
    return Outcome(
        done.summary,
        verdict == "proved",
        proof_screen.show_proof,
        verdict == "undecided",
        brief.brief_proof,
    )


def _box(text: str | None) -> dict[str, float] | None:
    """Read a box of robots; None if the option is missing, empty for `none`. Raises: InputError."""
    if text is None or text == "none":
        return None if text is None else {}
    from neuralgaits.robots.parameter_box import parse_box

    return parse_box(text)


def _resumed_proof(verb: CertifyOptions) -> str:
    """Return the command that resumes an interrupted search for the same statement."""
    from neuralgaits.runs.shell_words import command

    line: list[Any] = ["certify", verb.run, "--resume"]
    given = {
        "--level": verb.level,
        "--disturbance": verb.disturbance,
        "--bandwidth": verb.bandwidth,
        "--parameters": verb.parameters,
        "--within": verb.within,
        "--budget": verb.budget,
        "--workers": verb.pool.workers,
        "--ray": verb.pool.ray,
    }
    for flag, value in given.items():
        line += [] if value is None else [flag, value]
    return command(*line)


def _check_proof(verb: CheckProofOptions) -> Outcome:
    from neuralgaits.cli.progress import CheckProgress
    from neuralgaits.workflows.check_proof import check_proof

    with CheckProgress(quiet=verb.output.json) as progress:
        result = check_proof(verb.file, run=verb.run, progress=progress)
    verdict = result.verdict
    good = verdict in ("proved", "consistent")
    undecided = verdict == "undecided"
    return Outcome(result, good, proof_screen.show_check, undecided, brief.brief_check)


def _export(verb: ExportOptions) -> Outcome:
    from neuralgaits.cli.export_screen import show_export
    from neuralgaits.cli.progress import waiting
    from neuralgaits.workflows.export import export_controller

    with waiting("writing it, comparing it with Python", quiet=verb.output.json):
        done = export_controller(verb.run, verb.out, format=verb.format, force=verb.force)
    return Outcome(done.summary, done.checked, show_export, undecided=not done.checked)


def _inspect(verb: InspectOptions) -> Outcome:
    if verb.planarise is not None:
        from neuralgaits.workflows.planarise import planarise_file

        return Outcome(planarise_file(verb.robot, verb.planarise), True, screen.show_planarised)
    from neuralgaits.workflows.inspect import inspect
    from neuralgaits.workflows.planarise import load_or_advise

    return Outcome(inspect(load_or_advise(verb.robot)), True, screen.show_robot)


def _robots(verb: RobotsOptions) -> Outcome:
    from neuralgaits.workflows.robots import robots, write_built_in

    if verb.robot is None and verb.out is not None:
        raise InputError(
            "expected a robot to write, found none: write `neuralgaits robots ROBOT --out FILE.xml`"
        )
    if verb.robot is not None:
        return Outcome(write_built_in(verb.robot, verb.out), True, screen.show_written)
    return Outcome(robots(), True, screen.show_names)


def _doctor() -> Outcome:
    render_without_screen()
    from neuralgaits.workflows.doctor import doctor

    result = doctor()
    return Outcome(result, result.ok, screen.show_findings)


def _widths(text: str) -> tuple[int, ...]:
    """Read `N,N` as layer widths. Raises: InputError unless every N is a positive whole number."""
    words = [word.strip() for word in text.split(",")]
    if not all(word.isdecimal() and int(word) > 0 for word in words):
        raise InputError(
            f"expected --hidden as positive whole numbers N,N, found {text!r}: write 32,32"
        )
    return tuple(int(word) for word in words)
