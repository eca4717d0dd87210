"""The part of the page about the learned residual and the episodes."""

from neuralgaits.records.episode_records import EpisodesSummary
from neuralgaits.records.fitted import FitSummary
from neuralgaits.report.page import phrases
from neuralgaits.report.page.markup import Html, facts, number, paragraph, section, table
from neuralgaits.report.page.saved import RunContents
from neuralgaits.runs.names import RESIDUAL


def learning(saved: RunContents) -> Html:
    """Return the section on residual and episodes; nothing if the run has neither."""
    carries = RESIDUAL in saved.folder.copies
    if not (carries or saved.residual or saved.episodes):
        return Html("")
    parts = []
    if carries:
        parts.append(
            paragraph(
                "This policy was refined on corrected dynamics: a small network, learned from logs "
                "of walks, adds what the model misses. Whatever is proved of this run is about the "
                "corrected dynamics, and the correction itself is learned, not proved."
            )
        )
    if saved.residual:
        parts += _residual(saved.residual)
    if saved.episodes:
        parts += _rounds(saved, saved.episodes)
    return section("learning", "What was learned from walking", *parts)


def _residual(summary: FitSummary) -> list[Html]:
    nominal, left = summary.nominal_heldout_error, summary.heldout_error
    share = ""
    if nominal and left is not None:
        share = f": {number(100.0 * left / nominal, 2)} % of the model's own error is left"
    strides = summary.strides
    rows = [
        ("logs", number(len(summary.logs))),
        ("walked", f"{number(summary.walked_s)} s"),
        ("strides to learn from, to test on", f"{strides.train}, {strides.heldout}"),
        ("error of the model on strides not learned from", number(nominal)),
        ("error with what was learned", number(left)),
        (
            "what may still be off in dz",
            "({} m/s, {} N m)".format(*(number(bound) for bound in summary.error_bound)),
        ),
    ]
    return [
        paragraph(f"From the logs of this run a further correction was learned{share}."),
        facts("What was learned from this run's logs", rows),
    ]


def _rounds(saved: RunContents, episodes: EpisodesSummary) -> list[Html]:
    rows = []
    for entry in episodes.rounds:
        steps, share = entry.steps_walked, entry.share_that_walks
        span = " to ".join(str(n) for n in sorted({min(steps), max(steps)})) if steps else "–"
        stayed = "–" if share is None else f"{number(100.0 * share)} %"
        own = entry.round == _round_of(saved)
        name = f"{entry.round} (this run)" if own else str(entry.round)
        rows.append((name, span, stayed, number(entry.speed_m_s), number(entry.loss)))
    where = episodes.plant or f"a robot with logs in {episodes.logs}"
    changed = ", ".join(["", *phrases.changes(episodes.disturb)])
    sentence = (
        f"The model is {episodes.robot}; what walks is {where}{changed}. "
        "In each round the policy walks, what the model missed is learned from the logs, and the "
        "policy is trained on."
    )
    head = ("round", "steps walked", "stayed up", "speed [m/s]", "loss")
    return [
        paragraph(sentence),
        table(
            "Episodes, a row a round; round 0 knows the model alone", head, rows, numbers=" nnnn"
        ),
    ]


def _round_of(saved: RunContents) -> int | None:
    """Return the number of the round that this run belongs to, or None."""
    name = saved.folder.path.resolve().name
    number_of = name.removeprefix("round-")
    return int(number_of) if number_of.isdecimal() else None
