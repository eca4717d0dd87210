"""Carry out `fit`, `refine` and `episodes`, which learn from logs."""

import sys
from pathlib import Path

from neuralgaits.cli import episodes_screen, learning_screen, screen
from neuralgaits.cli.arguments import EpisodesOptions, FitOptions, RefineOptions
from neuralgaits.cli.argv_parser import given
from neuralgaits.cli.brief import brief_fit, brief_training
from neuralgaits.cli.outcome import Outcome
from neuralgaits.errors import InputError
from neuralgaits.settings import EpisodesSettings, FitSettings, RefineSettings, Watch


def carry_out_fit(verb: FitOptions) -> Outcome:
    """Carry out `fit`. Good if what is learned beats the model alone on unseen strides."""
    if verb.joints:
        return _fit_joints(verb)
    if verb.write is not None:
        raise InputError("--write: expected --joints beside it, found none: add that")
    from neuralgaits.cli.progress import TrainingProgress
    from neuralgaits.workflows.fit import fit

    with TrainingProgress(quiet=verb.output.json) as progress:
        summary = fit(**given(verb, FitSettings, progress=progress)).summary
    return Outcome(summary, good=summary.better, table=learning_screen.show_fit, brief=brief_fit)


def _fit_joints(verb: FitOptions) -> Outcome:
    from neuralgaits.cli.joints_screen import show_joints
    from neuralgaits.cli.progress import WorkProgress
    from neuralgaits.workflows.fit_joints import fit_joints

    usual = FitSettings(verb.run, verb.logs)
    for name in ("optimizer", "seed"):
        if getattr(verb, name) != getattr(usual, name):
            raise InputError(
                f"--{name}: expected it without --joints, found both: joints are identified by "
                f"least squares, leave --{name} out"
            )
    with WorkProgress("identifying", quiet=verb.output.json):
        result = fit_joints(verb.run, verb.logs, columns=verb.columns, write=verb.write)
    return Outcome(result, good=result.better, table=show_joints)


def carry_out_refine(verb: RefineOptions) -> Outcome:
    """Carry out `refine`. Undecided if a proof was requested but not found."""
    from neuralgaits.cli.progress import TrainingProgress
    from neuralgaits.workflows.refine import refine

    with TrainingProgress(quiet=verb.output.json) as progress:
        watch = Watch(progress.proved, progress.round_ended, begun=progress.begun)
        run = refine(**given(verb, RefineSettings, progress=progress, watch=watch))
    summary = run.summary
    show = None if summary.broken else brief_training
    return Outcome(
        summary,
        good=summary.proved,
        table=screen.show_training,
        undecided=not summary.proved,
        brief=show,
    )


def carry_out_episodes(verb: EpisodesOptions) -> Outcome:
    """Carry out `episodes`. Good unless the last policy fell."""
    from neuralgaits.cli.progress import TrainingProgress
    from neuralgaits.workflows.episodes import episodes

    resume = None if verb.resume is None else _episodes_to_resume(verb.resume, verb.output.json)
    with TrainingProgress(quiet=verb.output.json) as progress:
        others = {"resume": resume, "progress": progress, "tell": progress.stage}
        summary = episodes(**given(verb, EpisodesSettings, **others))
    walks = summary.walks is not False
    return Outcome(summary.summary, good=walks, table=episodes_screen.show_episodes)


def _episodes_to_resume(resume: str | Path, quiet: bool) -> str | Path:
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
