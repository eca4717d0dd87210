"""The top of the page: the result in four lines, then how it walks, why, and what is proved."""

from neuralgaits._printable import counted
from neuralgaits.records import certificate_sentences
from neuralgaits.records.level_words import HIGHEST
from neuralgaits.records.report_walk import ShownWalk
from neuralgaits.records.simulated import SimulationSummary
from neuralgaits.report.page import phrases
from neuralgaits.report.page.markup import Html, Section, join, number, paragraph, tag
from neuralgaits.report.page.saved import Contents, RunContents
from neuralgaits.runs.names import RESIDUAL


def answer(contents: Contents) -> Section:
    """Return three short paragraphs that use the run's own numbers."""
    saved = contents.saved
    parts = [
        _part("What it does.", _what_is_shown(contents)),
        _part(_heading(contents), _why_it_walks(saved)),
        _part("How sure we are.", _how_sure(saved)),
    ]
    if saved.proved_level:
        parts.append(_part("What is not covered.", _left_open(saved)))
    return Section.of("answer", "The answer", tag("div", *parts, class_="answer", id="answer"))


def glance(contents: Contents) -> Html:
    """Return what is proved, simulated, sampled and not shown, a line each; empty without a gait.

    The paragraphs of `answer` say the same with its conditions.
    """
    saved = contents.saved
    if saved.summary is None or saved.nan is not None:
        return Html("")
    entries = (
        ("Proved", _proved_in_short(saved)),
        ("Simulated", _simulated_in_short(saved, contents.walk)),
        ("Sampled", _sampled_in_short(saved)),
        ("Not shown", "how the real robot walks"),
    )
    lines = [tag("li", tag("b", head), " ", words) for head, words in entries]
    return tag("ul", *lines, class_="glance", aria_label="The result in short")


def _proved_in_short(saved: RunContents) -> str:
    if saved.of_some is not None:
        return "of some commands only: see the certificate"
    if saved.certificate is None:
        return "nothing"
    if not saved.proved_level:
        return f"no level: {saved.certificate.verdict} at level {saved.certificate.level}"
    robots = ", for a box of robots" if saved.certificate.robots else ""
    level = f"level {saved.proved_level} of {HIGHEST}{robots}"
    return f"{level}, about the model, according to the proof file"


def _simulated_in_short(saved: RunContents, walk: ShownWalk | None) -> str:
    simulation, walks = saved.simulation, saved.walks
    if simulation is not None:
        changed = bool(_place_of_walk(simulation)) or simulation.plant_given
        where = f", in {simulation.stepped_by}" + (", robot or floor changed" if changed else "")
        count = len(simulation.fell)
        stayed = f"{simulation.stayed} of {counted(count, 'walk')} stayed up"
        return f"{stayed}{phrases.steps_each(simulation)}{where}"
    if walks is not None and walks.steps_walked and walks.share_that_walks is not None:
        count = len(walks.steps_walked)
        stayed = round(walks.share_that_walks * count)
        return f"{stayed} of {counted(count, 'walk')} stayed up, on the robot of its episodes"
    if walk is None:
        return "nothing yet"
    ending = "fell after" if walk.fell else "stayed up for"
    return f"one walk in MuJoCo, which {ending} {counted(walk.steps_walked, 'step')}"


def _sampled_in_short(saved: RunContents) -> str:
    if saved.summary is None or not saved.measured:
        return "no measurement of these weights is recorded"
    count, broken = len(saved.measured), len(saved.summary.broken)
    return f"{count - broken} of {count} conditions held at every random state"


def _heading(contents: Contents) -> str:
    """Return the second paragraph's heading, which depends on falls and refuted conditions."""
    saved = contents.saved
    walk = contents.walk
    simulation = contents.saved.simulation
    fell = (walk is not None and walk.fell) or (simulation is not None and any(simulation.fell))
    broken = any(entry.verdict == "refuted" for entry in saved.conditions.values())
    meant = fell or saved.summary is None or broken
    return "How it is meant to stay up." if meant else "Why it stays up."


def _part(head: str, body: str) -> Html:
    return paragraph(tag("b", head), " ", body)


def _what_is_shown(contents: Contents) -> str:
    saved, robot = contents.saved, contents.robot
    feet = "feet like points: nothing holds it upright but the next step"
    if robot.flat_feet is not None:
        feet = "flat feet, which hold it as long as its weight is over a sole"
    who = (
        f"{saved.robot} is a two-legged robot of {number(robot.mass_kg)} kg with legs of "
        f"{number(robot.hip_height_m)} m, {len(robot.actuators)} motors and {feet}."
    )
    if saved.nan is not None:
        return f"{who} {saved.nan} There is no gait to judge."
    if saved.summary is None:
        return f"{who} The training of its gait has not ended, so there is no gait to judge yet."
    return f"{who} {_walk_sentence(saved, contents.walk)}"


def _walk_sentence(saved: RunContents, walk: ShownWalk | None) -> str:
    """Describe what simulations showed, preferring the more detailed record."""
    simulation, walks = saved.simulation, saved.walks
    if simulation is not None:
        walker = f"{_what_walked(simulation)}{_place_of_walk(simulation)}"
        return f"In a {simulation.stepped_by} simulation of {walker} {_counts(simulation)}."
    if walks is not None and walks.steps_walked and walks.share_that_walks is not None:
        count = len(walks.steps_walked)
        stayed = round(walks.share_that_walks * count)
        return (
            f"In MuJoCo, on the robot of its episodes, {stayed} of {count} walks stayed up to "
            f"their last step."
        )
    if walk is None:
        return "It has not been simulated yet."
    if walk.fell:
        ending = f"fell after {counted(walk.steps_walked, 'step')}"
    else:
        ending = f"took {_all_steps(walk.steps_walked)}"
    return (
        "In the one walk recorded for this page, a MuJoCo simulation of the whole robot, it "
        f"{ending}."
    )


def _what_walked(simulation: SimulationSummary) -> str:
    return f"another robot, {simulation.plant}," if simulation.plant_given else "the whole robot"


def _place_of_walk(simulation: SimulationSummary) -> str:
    changed = phrases.changes(simulation.changed)
    if simulation.drawn_from is not None:
        changed.insert(0, f"each walk of another robot, drawn from the box {simulation.drawn_from}")
    if simulation.push:
        changed.append(f"a push of {number(simulation.push)} N s")
    return f" ({'; '.join(changed)})" if changed else ""


def _all_steps(steps: int) -> str:
    return "its one step" if steps == 1 else f"all {steps} steps"


def _counts(simulation: SimulationSummary) -> str:
    steps, count = simulation.steps_walked, len(simulation.fell)
    if count == 1:
        of_steps = (
            f" of {simulation.steps}" if simulation.fell[0] and simulation.steps is not None else ""
        )
        fallen = f"{steps[0]}{of_steps} steps" if of_steps else counted(steps[0], "step")
        sentence = (
            f"it fell after {fallen}" if simulation.fell[0] else f"it walked {_all_steps(steps[0])}"
        )
    else:
        sentence = (
            f"{simulation.stayed} of {count} walks stayed up to their last step"
            f"{phrases.steps_each(simulation)}"
        )
        reasons = sorted({reason for reason in simulation.fall_reasons if reason})
        sentence += f" (falls: {', '.join(reasons)})" if reasons else ""
    if simulation.speed_m_s is not None:
        sentence += f", at {number(simulation.speed_m_s, 2)}\u00a0m/s"
        time = simulation.step_time_s
        sentence += "" if time is None else f" with a step every {number(time, 2)}\u00a0s"
    return sentence


def _why_it_walks(saved: RunContents) -> str:
    numbers = "its commands and two numbers" if saved.config.commands else "two numbers alone"
    numbers_known = (
        f"{numbers}: how far the hip is ahead of the foot on the ground, and with how much "
        "momentum the body turns over that foot"
    )
    is_given = saved.config.given is not None
    if saved.config.parameters or is_given:
        numbers_known = "one number alone: how far the hip is ahead of the foot on the ground"
    what = "A polynomial" if is_given else "A small neural network"
    common = (
        f"{what} says where every joint should be, from {numbers_known}. No clock is involved: "
        "the legs wait for the body. "
    )
    level = saved.proved_level
    if saved.summary is None:
        return common + "It is trained towards conditions on a whole region of states."
    if level >= 2:
        region = "Around its orbit" if is_given else "It was trained so that"
        return common + (
            f"{region} a whole region of states leads back into itself: a step that begins inside "
            "ends with a touchdown inside, so the next step can be taken, and so on."
        )
    described = saved.config.conditions
    gist = ", ".join(phrases.gist([one.data for one in described]))
    listed = f" ({gist})" if gist else ""
    if saved.config.as_given is not None:
        return common + (
            f"It is one periodic motion, found elsewhere; {len(described)} conditions{listed} are "
            "looked at on a whole region of states around it."
        )
    return common + (
        f"It was trained towards {len(described)} conditions{listed} on a whole region of states, "
        "not along one motion only."
    )


def _how_sure(saved: RunContents) -> str:
    if saved.summary is None:
        return "Nothing is claimed: nothing has been measured or proved."
    certificate, level = saved.certificate, saved.proved_level
    if certificate is None:
        return (
            f"{_sampled(saved)} That is a record and no proof; nothing has been proved of this "
            "gait."
        )
    if level == 0:
        sentence = certificate_sentences.not_proved(certificate)
        return f"Not proved. {sentence} {_sampled(saved)} Samples are no proof."
    words = phrases.told_apart({one.name: one.data for one in saved.config.conditions})
    proved = certificate_sentences.proved(certificate, bool(saved.config.commands), words)
    return f"{proved}{_borne(saved)} {certificate_sentences.AS_STATED}"


def _borne(saved: RunContents) -> str:
    """Describe the disturbance that a proof of level 2 covers; empty without one."""
    if not saved.disturbance:
        return ""
    first, second = (number(bound) for bound in saved.disturbance)
    return (
        f" At level 2 the motion between touchdowns may be off the model, by up to {first} m/s in "
        f"dz1 and {second} N m in dz2; forces, torques and touchdowns are the model's."
    )


def _left_open(saved: RunContents) -> str:
    robots = None if saved.certificate is None else saved.certificate.robots
    rests = certificate_sentences.left_open(saved.proved_level, robots)
    model = ""
    if RESIDUAL in saved.folder.copies:
        model = " The model is the robot file's, corrected by what was learned from logs."
    samples = (
        " The simulation covers some of that, in the walks it made."
        if saved.simulation is not None
        else ""
    )
    claims = f"It claims nothing about {certificate_sentences.not_claimed(saved.proved_level)}."
    return f"{rests}{model} {claims}{samples}"


def _sampled(saved: RunContents) -> str:
    if saved.summary is None or not saved.measured:
        return "No measurement of these weights is recorded."
    count = len(saved.measured)
    recorded = "as was recorded when the gait was made"
    if not saved.summary.tied:
        recorded += ", of weights that the record does not name"
    if broken := saved.summary.broken:
        return (
            f"On random samples {len(broken)} of {count} conditions were broken somewhere, "
            f"{recorded}."
        )
    return f"All {count} conditions held at every random sample, {recorded}."


def headline(saved: RunContents) -> str:
    """Return what the page is about: it says walking of no gait that fell or breaks a condition."""
    simulation = saved.simulation
    fails = (
        bool(saved.failing)
        or saved.nan is not None
        or (simulation is not None and any(simulation.fell))
    )
    return f"{'A gait' if fails else 'A walking gait'} for {saved.robot}"


def title(saved: RunContents) -> Html:
    """Return the heading of the page, with its subject below."""
    about = [
        f"spec {saved.config.spec}",
        f"seed {saved.config.seed}",
        f"{'trained' if saved.config.as_given is None else 'made'} {saved.folder.created_utc[:10]}",
    ]
    return join(
        [
            tag("h1", headline(saved)),
            paragraph(", ".join(about), ". Run ", tag("code", saved.name), ".", class_="quiet"),
        ]
    )
