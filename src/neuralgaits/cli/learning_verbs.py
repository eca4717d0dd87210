"""Verbs that learn from logs, and the disturbance bounds that they and `certify` take."""

import sys
from pathlib import Path
from typing import Literal

from neuralgaits.cli import episodes_screen, learning_screen, screen
from neuralgaits.cli.arguments import EpisodesOptions, FitOptions, RefineOptions
from neuralgaits.cli.argv_parser import options
from neuralgaits.cli.brief import brief_fit, brief_training
from neuralgaits.cli.outcome import Outcome
from neuralgaits.errors import InputError

LEARNED: Literal["learned"] = "learned"
"""Word that stands for the two bounds of the run's residual."""


def carry_out_fit(verb: FitOptions) -> Outcome:
    """Carry out `fit`. Good if the residual beats the model alone on unseen strides."""
    from neuralgaits.cli.progress import TrainingProgress
    from neuralgaits.workflows.fit import fit

    with TrainingProgress(quiet=verb.output.json) as progress:
        done = fit(**options(verb), progress=progress).summary
    return Outcome(done, done.better, learning_screen.show_fit, brief=brief_fit)


def carry_out_refine(verb: RefineOptions) -> Outcome:
    """Carry out `refine`. Undecided if a proof was requested but not found."""
    from neuralgaits.cli.progress import TrainingProgress
    from neuralgaits.workflows.proof_rounds import Watch
    from neuralgaits.workflows.refine import refine

    given = verb.disturbance
    disturbance = LEARNED if given == LEARNED else None if given is None else _pair(given)
    with TrainingProgress(quiet=verb.output.json) as progress:
        run = refine(
            verb.run,
            residual=verb.residual,
            seed=verb.seed,
            steps=verb.steps,
            disturbance=disturbance,
            certify=verb.certify,
            budget=verb.budget,
            out=verb.out,
            progress=progress,
            watch=Watch(progress.proved, progress.round_ended),
        )
    done = run.summary
    shown = None if done.broken else brief_training
    return Outcome(done, done.proved, screen.show_training, undecided=not done.proved, brief=shown)


def carry_out_episodes(verb: EpisodesOptions) -> Outcome:
    """Carry out `episodes`. Good unless the last policy fell."""
    from neuralgaits.cli.progress import TrainingProgress
    from neuralgaits.robots import load_robot
    from neuralgaits.workflows.episodes import episodes

    names = ("disturb", "controller", "logs", "columns", "seed", "out", "plant")
    given = {name: value for name in names if (value := getattr(verb, name)) is not None}
    robot = None if verb.robot is None else load_robot(verb.robot)
    resume = None if verb.resume is None else _found(verb.resume, verb.output.json)
    with TrainingProgress(quiet=verb.output.json) as progress:
        done = episodes(
            robot,
            rounds=verb.rounds,
            resume=resume,
            progress=progress,
            tell=progress.stage,
            **given,
        )
    return Outcome(done.summary, done.walks is not False, episodes_screen.show_episodes)


def _found(resume: str, quiet: bool) -> str | Path:
    """Return the episodes to resume; print which ones `latest` means to stderr, unless `quiet`."""
    from neuralgaits.episode_rounds.episode_folder import EpisodeFolder
    from neuralgaits.runs import RUNS_ROOT
    from neuralgaits.runs.latest import LATEST

    folder = EpisodeFolder.find(LATEST, RUNS_ROOT) if resume == LATEST else None
    if folder is None:
        return resume
    if not quiet:
        print(f"resuming {folder.path}", file=sys.stderr)
    return folder.path


def disturbance_bounds(text: str | None, run: str) -> tuple[float, float]:
    """Read `A,B`, or the bounds that a run has learned. Raises: InputError on anything else."""
    if text is None:
        return 0.0, 0.0
    if text != LEARNED:
        return _pair(text)
    from neuralgaits.analysis.run import open_run

    learned = open_run(run).learned
    if learned is None:
        raise InputError(
            f"expected --disturbance {LEARNED} for a run with a residual, found one without in "
            f"{run}: refine a run first, or write A,B"
        )
    first, second = learned.error_bound
    return float(first), float(second)


def _pair(text: str) -> tuple[float, float]:
    try:
        first, second = (float(word) for word in text.split(","))
    except ValueError:
        raise InputError(
            f"expected --disturbance as two numbers A,B (m/s, N m) or {LEARNED}, found {text!r}: "
            "write 0.01,0.3"
        ) from None
    return first, second
