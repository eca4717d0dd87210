"""Evidence of the feet that a person pressed: which channel answers, and which way."""

import numpy as np

from neuralgaits._types import Float
from neuralgaits.deployment.deployment_file import ContactChannel, DeploymentFile
from neuralgaits.deployment.hung_log import HungLog
from neuralgaits.records.deployed import DeploymentFinding


def pressed_feet(file: DeploymentFile, log: HungLog) -> tuple[list[DeploymentFinding], list[str]]:
    """Compare the channels that answer to feet that are pressed with the file's.

    Returns: contradictions, and what the log does not say.
    """
    findings: list[DeploymentFinding] = []
    unchecked: list[str] = []
    for one in file.contacts:
        windows = [rows for name, _, rows in log.windows() if name == one.foot]
        if not windows or not log.channels:
            unchecked.append(f"contact of {one.foot}: no row is labelled {one.foot}")
            continue
        answers = [_answering(log, rows) for rows in windows]
        if None in answers:
            unchecked.append(f"contact of {one.foot}: no channel answers to it")
            continue
        if len(set(answers)) > 1:
            words = ", ".join(
                f"channel {channel} {log.when(rows)}"
                for channel, rows in zip(answers, windows, strict=True)
            )
            unchecked.append(
                f"contact of {one.foot}: rows of the same label contradict each other ({words}): "
                "correct the labels, or record it again"
            )
            continue
        pressed = np.concatenate([log.contact[rows] for rows in windows])
        findings += _findings_of_foot(log, one, answers[0], pressed)
    return findings, unchecked


def _answering(log: HungLog, rows: slice) -> int | None:
    """Return the channel that answers to a foot that is pressed; None if none does."""
    # For most of the log no foot is pressed.
    span = np.abs(log.contact[rows] - np.median(log.contact, axis=0)).max(axis=0)
    # A reading that only trembles answers to nothing.
    least = 0.05 * np.abs(log.contact).max(initial=0.0)
    return log.channels[int(np.argmax(span))] if span.max() > least else None


def _findings_of_foot(
    log: HungLog, one: ContactChannel, actual: int | None, pressed: Float[np.ndarray, "p c"]
) -> list[DeploymentFinding]:
    """Return what a foot that is pressed says against the file."""
    if actual is None or actual != one.channel:
        problem = f"channel {actual} answers to {one.foot}, and the file has {one.channel}"
        return [DeploymentFinding(one.foot, "contact", problem, f"write channel: {actual}")]
    force = one.newton_per_unit * (pressed[:, log.channels.index(actual)] - one.zero_unit)
    if np.abs(force).max() > 0.0 and force[np.argmax(np.abs(force))] < 0.0:
        problem = f"the force on {one.foot} is negative while it is pressed"
        remedy = f"write newton_per_unit: {-one.newton_per_unit:g}, or another zero_unit"
        return [DeploymentFinding(one.foot, "contact", problem, remedy)]
    return []
