"""Results about cart-poles for a person, on stdout."""

from typing import Any

from rich.text import Text

from neuralgaits._digits import at_least
from neuralgaits.cli.screen_tables import number, show_facts, show_sentence, show_table, verdict
from neuralgaits.records.certified import CertificateRecord
from neuralgaits.runs.shell_words import command, named

_STATE = ("x", "theta", "x'", "theta'")
_UNITS = ("m", "rad", "m/s", "rad/s")


def show_robot(result: Any) -> None:
    """Show a cart-pole's numbers, and the next command."""
    low, high = result.rail_m
    motor = result.motor or "no name"
    show_facts(
        [
            ("robot", f"{result.robot}, a cart-pole"),
            ("cart", f"{number(result.cart_mass_kg)} kg, rail from {low:g} to {high:g} m"),
            (
                "pole",
                f"{number(result.pole_mass_kg)} kg, centre of mass {number(result.com_distance_m)}"
                f" m from its hinge, inertia about it {number(result.inertia_kg_m2)} kg m^2",
            ),
            ("motor", f"{motor}, up to {number(result.force_limit_n)} N on the cart"),
            ("joints", f"{result.slide} (slide), {result.hinge or 'no name'} (hinge)"),
        ]
    )


def show_training(result: Any) -> None:
    """Show whether a training's conditions hold at fresh random states, and the set's size."""
    held = result.holds
    answer = Text("trained", "green") if held else Text("not trained", "red")
    count = len(result.margins)
    what = "hold" if held else "do not all hold"
    show_sentence(answer, f": {count} conditions {what} at {result.samples} random states")
    if not held:
        rows = [(name, number(least)) for name, least in result.margins.items()]
        show_table(("condition", "smallest margin"), rows)
    sizes = ", ".join(
        f"{name} +-{width:.3g} {unit}"
        for name, width, unit in zip(_STATE, result.widths, _UNITS, strict=True)
    )
    show_facts(
        [
            ("set", sizes),
            ("time", f"{result.wall_s:.0f} s"),
            ("run", result.run),
            ("next", command("certify", named(result.run))),
        ]
    )


def brief_proof(result: CertificateRecord) -> None:
    """Print what is proved of a cart-pole, and where the proof is."""
    reason = f": {result.reason}" if result.reason else ""
    level = result.proved_level
    least = result.least_margin
    margins = "" if least is None else f", margins of {at_least(least, 2)} or more"
    to = f" to level {level}, {len(result.conditions)} conditions{margins}" if level else ""
    show_sentence(verdict(result.verdict), f"{to}{reason}")
    facts: list[tuple[str, Any]] = [
        (f"level {one.level}", one.words[0] if one.proved else one.reason) for one in result.levels
    ]
    for name, one in result.conditions.items():
        if (point := one.counterexample) is not None:
            x, theta = point.z
            where = f"x = {x:.4g} m, theta = {theta:.4g} rad"
            facts.append(("broken", f"{name}: margin {point.margin:.3g} at {where}"))
    facts += [
        ("about", "the rigid model's full state, in continuous time"),
        ("boxes", f"{result.boxes} in {result.wall_s:.0f} s; -v prints more"),
        ("proof", result.proof),
        ("next", command("simulate", named(result.run))),
    ]
    show_facts(facts)


def show_episodes(result: Any) -> None:
    """Show how many episodes stayed in the set, and how close they came to its limits."""
    good = result.stayed == result.episodes
    answer = Text("balances", "green") if good else Text("leaves the set", "red")
    told = f": {result.stayed} of {result.episodes} episodes of {result.seconds:g} s stayed in it"
    show_sentence(answer, told)
    rest = "not all" if result.settled_s is None else f"within {result.settled_s:.3g} s"
    show_facts(
        [
            ("at rest", rest),
            ("force", f"up to {number(result.largest_force)} of {result.force_limit:g} N"),
            ("cart", f"up to {number(result.largest_x)} of {result.rail:g} m from the middle"),
            ("radius", f"up to {result.largest_radius:.6g}; 1 is the set's face"),
            ("next", command("report", named(result.run))),
        ]
    )


def show_export(result: Any) -> None:
    """Show where the C files are, and how far they agree with Python."""
    if result.checked:
        answer = Text("written and compared", "green")
        told = f": largest difference {number(result.max_abs_error)} N at {result.states} states"
    else:
        answer, told = Text("written", "yellow"), ": no C compiler here, so it was not compared"
    show_sentence(answer, told)
    show_facts([("files", ", ".join(result.files))])


def show_report(result: Any) -> None:
    """Show the page to open."""
    show_sentence(Text("written", "green"), f": {result.bytes / 1e6:.1f} MB")
    show_facts([("open", result.report)])
