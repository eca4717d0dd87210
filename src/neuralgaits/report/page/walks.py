"""The part of the page that shows the walk: animation, controls, and results of simulations."""

import json

from neuralgaits._control_laws import CONTROL_LAWS
from neuralgaits._printable import counted
from neuralgaits.records.report_walk import ShownWalk
from neuralgaits.records.simulated import SimulationSummary
from neuralgaits.report.page import markup as html
from neuralgaits.report.page import phrases
from neuralgaits.report.page.adapted_table import adapted
from neuralgaits.report.page.markup import Html, Section
from neuralgaits.report.page.monitor_table import monitored
from neuralgaits.report.page.saved import Contents, RunContents
from neuralgaits.runs import plain
from neuralgaits.runs.shell_words import command


def animation(contents: Contents) -> Html:
    """Return the walk as a 3-D picture that turns, beside the moving point in the plane of z."""
    walk = contents.walk
    if walk is None:
        return html.section("walk", "The walk", html.missing(contents.no_walk or ""))
    picture = html.tag(
        "section",
        _pictures(),
        html.paragraph(
            "Chart: the green area is the region of the gait, the blue line is this walk, a dotted "
            "line is a touchdown, and the red dot is the robot now.",
            class_="quiet",
        ),
        _controls(walk),
        html.paragraph(_walk_sentence(walk)),
        html.paragraph(differs) if (differs := _beside(walk)) else "",
        html.folded("What the pictures show, and how to turn them", *_explain_pictures(walk)),
        html.tag("noscript", html.paragraph("The animation needs JavaScript; the rest does not.")),
        data(walk),
        id="walk",
        aria_label="The walk",
    )
    return Section.of("walk", "The walk", picture)


def _pictures() -> Html:
    """Return the canvases of the robot and of the moving point."""
    return html.tag(
        "div",
        html.tag(
            "div",
            html.tag(
                "canvas",
                id="robot",
                tabindex=0,
                role="img",
                aria_label="The robot walking. Arrow keys turn the view, plus and minus zoom.",
            ),
            html.tag("p", id="no-picture", hidden=True, role="status"),
        ),
        html.tag(
            "canvas",
            id="portrait",
            role="img",
            aria_label="Moving point in the plane of z1 and z2, inside the region of the gait.",
        ),
        class_="player wide",
    )


def _explain_pictures(walk: ShownWalk) -> list[Html]:
    """Explain both pictures and the ways to turn the robot."""
    force = (
        " The arrow is the force of the ground on the standing foot, the mean over "
        f"{html.number(walk.frame_s)} s."
        if walk.force_n
        else ""
    )
    return [
        html.paragraph(
            "Drag the robot to turn it. Zoom with the wheel or by pinching. The keyboard's arrows, "
            f"+ and − do the same.{force}"
        ),
        html.paragraph(
            "The chart shows the same moment as a point of the zero dynamics, the two numbers that "
            "no motor acts on. The green area is the gait's region. Along a step the point moves "
            "to the right; at touchdown it jumps back to the left, and the next step begins."
        ),
    ]


def data(walk: ShownWalk) -> Html:
    """Return the recording as a block of JSON that no parser takes for markup."""
    written = json.dumps(plain(walk), separators=(",", ":"), allow_nan=False)
    safe = written.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")
    return html.tag("script", Html(safe), type="application/json", id="recording")


def _walk_sentence(walk: ShownWalk) -> str:
    """Describe the walk, and say that it is a simulation, not a playback of the plan."""
    law = CONTROL_LAWS.get(walk.controller)
    control = f"controller {walk.controller}" if law is None else law.words
    sentence = (
        f"Recorded from a MuJoCo simulation of the whole robot under {control}, with contact, "
        f"impacts and torque limits: not a playback of the plan. It {walk.origin}"
    )
    if walk.fell:
        sentence += f", and falls after {counted(walk.steps_walked, 'step')}: {walk.fall_reason}."
    else:
        sentence += f", and stays up for its {counted(walk.steps_walked, 'step')}."
    return sentence


def _beside(walk: ShownWalk) -> str:
    """Describe the differences between the plant and the model."""
    parts = []
    if walk.plant != walk.robot:
        parts.append(f"the robot that walks is {walk.plant}, the model is {walk.robot}")
    if changed := phrases.changes(walk.disturb):
        parts.append(f"changed in the simulation: {', '.join(changed)}")
    if walk.push_n_s:
        parts.append(f"a push of {html.number(walk.push_n_s)} N s")
    sentence = "; ".join(parts)
    return f"{sentence[0].upper()}{sentence[1:]}." if sentence else ""


def _controls(walk: ShownWalk) -> Html:
    speeds = [
        html.tag("option", f"{speed:g}×", value=speed, selected=speed == 1.0)
        for speed in (0.1, 0.25, 0.5, 1.0, 2.0)
    ]
    forces = Html("")
    if walk.force_n:
        box = Html('<input type="checkbox" id="forces" checked>')
        forces = html.tag("label", box, "ground force")
    slider = Html(
        '<input type="range" id="time" min="0" max="1" step="0.01" value="0" '
        'aria-label="Time of the walk in seconds">'
    )
    return html.tag(
        "div",
        html.tag("button", "Play", id="play", type="button"),
        slider,
        html.tag("label", "speed", html.tag("select", *speeds, id="speed")),
        forces,
        html.tag("button", "Reset view", id="reset", type="button"),
        html.tag("span", id="reading", class_="quiet"),
        class_="controls",
    )


def simulations(saved: RunContents) -> Html:
    """Return the results of `simulate`, or the command to run if there are none."""
    simulation = saved.simulation
    if simulation is None:
        return html.section(
            "simulations",
            "Simulations",
            html.missing(
                "No simulation of this run is saved, apart from the walk above.",
                line=command("simulate", saved.name),
            ),
        )
    rows = [
        (words, f"{html.number(value)} {unit}".rstrip()) for words, value, unit in simulation.shown
    ]
    notes = (
        []
        if simulation.drawn_from is None
        else [f"robots drawn from the box {simulation.drawn_from}"]
    )
    changed = ", ".join([*notes, *phrases.changes(simulation.changed)]) or "nothing"
    push = f", push {html.number(simulation.push)} N s" if simulation.push else ""
    ground = "" if simulation.terrain is None else f", terrain {simulation.terrain}"
    off = simulation.foothold_error_m
    if off is not None and off.mean is not None and off.worst is not None:
        distance = f"{html.number(off.mean)} m in the mean, {html.number(off.worst)} m at worst"
        rows.append(("feet from the middle of their stones", distance))
    return html.section(
        "simulations",
        "Simulations",
        html.paragraph(
            f"The whole robot in {simulation.stepped_by}, controller {simulation.law_in_words}: "
            f"{simulation.stayed} of "
            f"{len(simulation.fell)} walks stayed up to their last step"
            f"{phrases.steps_each(simulation)}. Started from "
            f"{simulation.start}, "
            f"plant {simulation.plant}, changed: {changed}{push}{ground}, seed {simulation.seed}. "
            "Simulations are samples: they show what happened, not what must happen."
        ),
        _walks(simulation),
        html.facts("Means and extremes over these walks", rows),
        _orbit(simulation),
        *map(html.paragraph, _remarks(simulation)),
        adapted(simulation),
        monitored(saved, simulation),
    )


def _orbit(simulation: SimulationSummary) -> Html:
    """Return the numbers of the model's orbit, which are of no walk; nothing without an orbit."""
    orbit = simulation.poincare
    if orbit is None or orbit.multiplier is None:
        return Html("")
    rows = [
        ("multiplier", html.number(orbit.multiplier)),
        ("length of a step", f"{html.number(orbit.step_length_m)} m"),
    ]
    about = "For comparison, the model's periodic orbit: computed in float64, not proved"
    return html.facts(about, rows)


def _remarks(simulation: SimulationSummary) -> list[str]:
    """Describe what a reader of the means and extremes may overlook."""
    remarks = []
    orbit = None if simulation.poincare is None else simulation.poincare.speed_m_s
    # Share of the orbit's speed by which walks may differ from it without a word.
    noticeable = 0.05
    if orbit and simulation.speed_m_s and abs(simulation.speed_m_s / orbit - 1.0) > noticeable:
        remarks.append(
            f"The walks had {html.number(simulation.speed_m_s)} m/s, and the model's orbit has "
            f"{html.number(orbit)} m/s: a proof is about the model, whose contact is rigid and "
            "whose joints follow the gait exactly."
        )
    if simulation.min_normal_force_n is not None and simulation.min_normal_force_n <= 0.0:
        remarks.append(
            "At some moment between touchdowns the standing foot pressed on nothing: in the "
            "simulation it left the floor."
        )
    return remarks


def _walks(simulation: SimulationSummary) -> Html:
    """Return a table of the walks that fell; nothing if none did."""
    fallen = [
        (n, steps, reason)
        for n, (steps, fell, reason) in enumerate(
            zip(simulation.steps_walked, simulation.fell, simulation.fall_reasons, strict=True)
        )
        if fell
    ]
    if not fallen:
        return Html("")
    listed = fallen[:20]
    rest = f" The first {len(listed)} of {len(fallen)}." if len(fallen) > len(listed) else ""
    return html.table(f"Walks that fell.{rest}", ("walk", "steps", "reason"), listed, numbers="nn ")
