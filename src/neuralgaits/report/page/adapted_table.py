"""Part of the page about a commanded speed that was adapted: the steps of the first walk."""

from neuralgaits.records.simulated import SimulationSummary
from neuralgaits.report.page import markup as html
from neuralgaits.report.page.markup import Html


def adapted(simulation: SimulationSummary) -> Html:
    """Return the speeds of a walk's steps; the belief alone where no speed is commanded."""
    speeds = simulation.adapted
    if speeds is None and (simulation.believed_lean or simulation.believed_slope) is not None:
        return html.paragraph(_learned_lean(simulation).strip())
    if speeds is None or not speeds.told:
        return Html("")
    columns = zip(speeds.told, speeds.commanded, speeds.walked, speeds.measured, strict=True)
    most_steps = 20  # Steps that the table shows: an adapted speed has settled by then.
    rows = [
        (str(number), *("unknown" if one is None else f"{one:.3f}" for one in row))
        for number, row in enumerate(columns, start=2)
    ][:most_steps]
    count = len(speeds.told)
    rest = f", the first {most_steps} of {count}" if count > most_steps else ""
    head = ("step", "told", "commanded", "walked", "measured by the robot")
    return html.tag(
        "div",
        html.table(f"Speeds of the first walk in m/s{rest}", head, rows, numbers="nnnnn"),
        html.paragraph(
            f"{_how_adapted(simulation)}{_settled_speed(simulation)}{_learned_lean(simulation)}"
        ),
    )


def _how_adapted(simulation: SimulationSummary) -> str:
    """Say how the speed was adapted, if it was."""
    if "speed" not in (simulation.adapt or "").split(","):
        return "The commanded speed was not adapted. "
    return (
        "The command was adapted at each touchdown, within the range of the gait's commands, "
        "to the speed that the robot measures by its joint angles and pitch. "
    )


def _learned_lean(simulation: SimulationSummary) -> str:
    """Say what the joint angles show of the torso, and what the robot believed of it."""
    lean, belief = simulation.learned_lean, simulation.believed_lean
    sentence = "" if lean is None else f" Learned from joint angles and pitch: {lean.in_words}."
    sentence += "" if belief is None else f" The lean that it was told: {belief.in_words}."
    slope = simulation.believed_slope
    return sentence + ("" if slope is None else f" The slope that it was told: {slope.in_words}.")


def _settled_speed(simulation: SimulationSummary) -> str:
    """Say how near the walked speed came to the told one."""
    means = None if simulation.adapted is None else simulation.adapted.settled
    if means is None:
        return "The walk is too short for it to settle."
    return f"In the mean of the later steps it walked {means[1]:.3f} m/s for {means[0]:.3f} m/s."
