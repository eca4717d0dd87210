"""The part of the page about training: robot, spec, conditions with their numbers."""

import math
from typing import Any

from neuralgaits.records.certified import box_in_words
from neuralgaits.records.inspected import RobotFacts
from neuralgaits.records.trained import TrainingSummary, Violations
from neuralgaits.records.training_config import ConditionRecord, GaitOrigin
from neuralgaits.report.page import markup as html
from neuralgaits.report.page import phrases, repeat_commands
from neuralgaits.report.page.markup import Html
from neuralgaits.report.page.saved import Contents, RunContents
from neuralgaits.runs.shell_words import resuming


def training(contents: Contents) -> Html:
    """Return the section on robot, settings, and every condition with its measured values."""
    saved = contents.saved
    is_given = saved.config.as_given is not None
    return html.section(
        "training",
        heading(saved),
        _state(saved),
        html.tag("h3", "The robot"),
        *_robot(contents.robot),
        html.tag("h3", "The settings"),
        html.facts(f"How the policy was {'made' if is_given else 'trained'}", _settings(saved)),
        html.tag("h3", "The conditions"),
        *_conditions(saved),
    )


def heading(saved: RunContents) -> str:
    """Return the heading of this part."""
    return "What was trained" if saved.config.as_given is None else "What was made"


def _state(saved: RunContents) -> Html:
    summary = saved.summary
    if summary is None and saved.folder.ended_in_nan:
        return _ended_in_nan(saved)
    if summary is None:
        steps = int(saved.metrics[-1]["step"]) if saved.metrics else 0
        sentence = (
            f"The training has not ended: {html.number(steps)} of "
            f"{html.number(saved.config.steps)} "
            "gradient steps are in the last row of its course. It goes on, bit for bit, with"
        )
        return html.missing(sentence, line=resuming(saved.folder.path))
    if summary.left_out is not None:
        return html.missing(f"Its recorded figures are left out: {summary.left_out}.")
    if saved.config.as_given is not None:
        return html.paragraph(_not_trained(saved.config.as_given, summary))
    widths = " and ".join(map(str, saved.config.hidden or ()))
    network = f"hidden layers of {widths} units" if widths else "no network"
    sentence = (
        f"A policy with {network} was trained for "
        f"{html.number(summary.steps)} gradient steps to a loss of {html.number(summary.loss)} on "
        f"fresh samples, in {html.number(summary.wall_s)} s"
    )
    if saved.config.parent:
        sentence += f", starting from the weights of {saved.config.parent}"
    return html.paragraph(f"{sentence}.")


def _not_trained(origin: GaitOrigin, summary: TrainingSummary) -> str:
    """Describe the origin of a gait that was not trained."""
    sentence = (
        f"optimised for the least cost of transport at {html.number(origin.speed)} m/s"
        if origin.by == "optimise"
        else "read from a file"
    )
    return (
        f"Nothing was trained: Bézier polynomials of degree {origin.degree} in z1 were "
        f"{sentence}, and "
        "a tube was put around their periodic orbit, as wide as the robot's limits allow. On the "
        f"zero dynamics it walks at {html.number(summary.speed_m_s)} m/s with a mechanical cost of "
        f"transport of {html.number(summary.cost_of_transport)}."
    )


def _ended_in_nan(saved: RunContents) -> Html:
    sentence = (
        f"{saved.nan} It is no use to go on: the same steps would meet it again. Other random "
        "numbers may not"
    )
    line = repeat_commands.another_seed(saved.folder)
    return html.missing(f"{sentence}:" if line else f"{sentence}.", line=line)


def _robot(robot: RobotFacts) -> list[Html]:
    whole = (
        ("mass", f"{html.number(robot.mass_kg)} kg"),
        ("straight leg, foot to hip", f"{html.number(robot.hip_height_m)} m"),
        ("friction of the feet", html.number(robot.friction)),
        ("number of coordinates without a motor", html.number(robot.underactuation)),
    )
    links = [
        (
            link.name,
            html.number(link.length_m),
            html.number(link.mass_kg),
            html.number(link.inertia_kg_m2),
        )
        for link in robot.links
    ]
    motors = [
        (
            motor.joint,
            html.number(motor.torque_limit_nm),
            f"{html.number(motor.lower_rad)} to {html.number(motor.upper_rad)}",
            html.number(motor.armature_kg_m2),
        )
        for motor in robot.actuators
    ]
    head = ("motor at", "torque at most [N m]", "range [rad]", "rotor inertia [kg m²]")
    return [
        html.facts(f"{robot.robot}, as its file says", whole),
        html.table(
            "Links", ("link", "length [m]", "mass [kg]", "inertia [kg m²]"), links, numbers=" nnn"
        ),
        html.table("Joints", head, motors, numbers=" nnn"),
    ]


def _settings(saved: RunContents) -> list[tuple[str, Any]]:
    config = saved.config
    if config.as_given is not None:
        return [("spec", config.spec), ("polynomials of degree", config.as_given.degree)]
    rate = config.learning_rate
    rows: list[tuple[str, Any]] = [
        ("spec", config.spec),
        ("seed", config.seed),
        ("start", config.init),
        ("gradient steps", html.number(config.steps)),
        ("learning rate", None if rate is None else html.number(rate)),
    ]
    if config.parameters:
        rows.append(("for robots and floors off by", box_in_words(config.parameters)))
    if config.samples:
        samples = ", ".join(f"{count} in {name}" for name, count in config.samples.items())
        rows.append(("samples a step", samples))
    if config.disturbance:
        first, second = (html.number(bound) for bound in config.disturbance)
        rows.append(("borne in training", f"|d| ≤ ({first} m/s, {second} N m)"))
    if config.not_provable_because:
        rows.append(("cannot be proved, because", config.not_provable_because))
    return rows


def _conditions(saved: RunContents) -> list[Html]:
    measured, described = saved.measured, saved.config.conditions
    if not described:
        return [html.paragraph("The run does not say which conditions it is meant for.")]
    broken = [name for name, entry in measured.items() if entry.broken]
    unseen = " that training had not seen" if saved.config.as_given is None else ""
    recorded = f"Recorded when the gait was made, on random samples{unseen}:"
    if not measured and saved.summary is None:
        sentence = "What the gait is to satisfy; nothing is measured before the training ends."
    elif not measured:
        sentence = "What the gait is to satisfy; no figures of these weights were recorded."
    elif broken:
        sentence = (
            f"{recorded} {len(broken)} of {len(measured)} conditions were broken at some of them, "
            f"where their margin is negative.{_untied(saved)}"
        )
    else:
        sentence = (
            f"{recorded} all {len(measured)} held at all of them. This page has not measured them "
            f"again; what is proved stands further down.{_untied(saved)}"
        )
    least = {name: entry.min_margin for name, entry in measured.items()}
    ordered = sorted(described, key=lambda one: least.get(one.name, math.inf))
    rows = [_row(one, measured.get(one.name)) for one in ordered]
    head = ("condition", "where", "smallest margin recorded, in scales", "one scale is")
    about, numbers = f"of spec {saved.config.spec}", "  nn"
    if measured:
        table = html.tightest(about, head, rows, len(broken), numbers=numbers)
    else:
        all_of_them = f"All {len(rows)} conditions"
        whole = html.table(f"{all_of_them} {about}", head, rows, numbers=numbers, cards=True)
        table = html.folded(all_of_them, whole)
    return [html.paragraph(sentence), html.paragraph(_explain_terms(ordered)), table]


def _untied(saved: RunContents) -> str:
    """Say that nothing ties the figures to the run's weights; empty if their hashes agree."""
    if saved.summary is None or saved.summary.tied:
        return ""
    return (
        " The record does not say which weights it is of: an earlier version wrote it. It may be "
        "of others than the run's."
    )


def _explain_terms(conditions: list[ConditionRecord]) -> str:
    """Explain the terms of the table, only those that occur in it."""
    sentence = (
        "A margin is how far a condition is from failing. It is counted in scales: a scale is a "
        "typical size of what the condition looks at, so that a margin of a force and one of a "
        "length can be compared."
    )
    if any(one.region.startswith("fence") for one in conditions):
        sentence += (
            " The slow and the fast edge are the borders of the region: the least and the most "
            "momentum that the gait is made for, at each place of the step."
        )
    return sentence


def _row(one: ConditionRecord, measured: Violations | None) -> tuple[Any, ...]:
    size = phrases.scale(one.data, one.scale or 1.0)
    name = phrases.named(one.name, phrases.any_condition(one.data))
    where = phrases.region(one.region)
    if measured is None:
        return name, where, "–", size
    least = measured.min_margin
    verdict = "good" if least >= 0.0 else "bad"
    return name, where, html.tag("span", html.number(least), class_=verdict), size
