"""Results about cart-poles for a person."""

from neuralgaits._digits import at_least
from neuralgaits.records.certified import CertificateRecord
from neuralgaits.records.installed import BuiltIn
from neuralgaits.runs.shell_words import command, named
from neuralgaits.systems.cartpole.cartpole_export import CartPoleExport
from neuralgaits.systems.cartpole.cartpole_inspect import CartPoleFacts
from neuralgaits.systems.cartpole.cartpole_report import CartPoleReport
from neuralgaits.systems.cartpole.cartpole_run import CartPoleTrained
from neuralgaits.systems.cartpole.cartpole_simulate import CartPoleEpisodes
from neuralgaits.systems.system_family import Screen

_STATE = ("x", "theta", "x'", "theta'")
_UNITS = ("m", "rad", "m/s", "rad/s")


def of_robot(found: CartPoleFacts) -> Screen:
    """Return a cart-pole's numbers."""
    low, high = found.rail_m
    pole = (
        f"{found.pole_mass_kg:.4g} kg, centre of mass {found.com_distance_m:.4g} m from its hinge, "
        f"inertia about it {found.inertia_kg_m2:.4g} kg m^2"
    )
    return Screen(
        facts=[
            ("robot", f"{found.robot}, a cart-pole"),
            ("cart", f"{found.cart_mass_kg:.4g} kg, rail from {low:g} to {high:g} m"),
            ("pole", pole),
            (
                "motor",
                f"{found.motor or 'no name'}, up to {found.force_limit_n:.4g} N on the cart",
            ),
            ("joints", f"{found.slide} (slide), {found.hinge or 'no name'} (hinge)"),
        ]
    )


def of_written(found: BuiltIn) -> Screen:
    """Return where a built-in cart-pole was written, and the next command."""
    facts = [("robot", one.name) for one in found.robots]
    next_line = command("inspect", str(found.written))
    return Screen(facts=[*facts, ("written", found.written), ("next", next_line)])


def of_training(found: CartPoleTrained) -> Screen:
    """Return whether a training's conditions hold at fresh random states, and the set's size."""
    what = "hold" if found.holds else "do not all hold"
    sizes = ", ".join(
        f"{name} +-{width:.3g} {unit}"
        for name, width, unit in zip(_STATE, found.widths, _UNITS, strict=True)
    )
    rows = [(name, f"{least:.4g}") for name, least in found.margins.items()]
    return Screen(
        "trained" if found.holds else "not trained",
        f": {len(found.margins)} conditions {what} at {found.samples} random states",
        None if found.holds else (("condition", "smallest margin"), rows),
        [
            ("set", sizes),
            ("time", f"{found.wall_s:.0f} s"),
            ("run", found.run),
            *([("proof", found.proof)] if found.proof else []),
            ("next", command("simulate" if found.proof else "certify", named(found.run))),
        ],
    )


def of_proof(found: CertificateRecord) -> Screen:
    """Return what is proved of a cart-pole, and where the proof is."""
    reason = f": {found.reason}" if found.reason else ""
    level, least = found.proved_level, found.least_margin
    margins = "" if least is None else f", margins of {at_least(least, 2)} or more"
    to = f" to level {level}, {len(found.conditions)} conditions{margins}" if level else ""
    facts = [
        (f"level {one.level}", one.words[0] if one.proved else one.reason) for one in found.levels
    ]
    for name, one in found.conditions.items():
        if (point := one.counterexample) is not None:
            x, theta = point.z
            where = f"x = {x:.4g} m, theta = {theta:.4g} rad"
            facts.append(("broken", f"{name}: margin {point.margin:.3g} at {where}"))
    facts += [
        ("about", "the rigid model's full state, in continuous time"),
        ("boxes", f"{found.boxes} in {found.wall_s:.0f} s; -v prints more"),
        ("proof", found.proof),
        ("next", command("simulate", named(found.run))),
    ]
    return Screen(found.verdict, f"{to}{reason}", None, facts)


def of_episodes(found: CartPoleEpisodes) -> Screen:
    """Return how many episodes stayed in the set, and how close they came to its limits."""
    good = found.stayed == found.episodes
    rest = "not all" if found.settled_s is None else f"within {found.settled_s:.3g} s"
    return Screen(
        "balances" if good else "leaves the set",
        f": {found.stayed} of {found.episodes} episodes of {found.seconds:g} s stayed in it",
        None,
        [
            ("at rest", rest),
            ("force", f"up to {found.largest_force:.4g} of {found.force_limit:g} N"),
            ("cart", f"up to {found.largest_x:.4g} of {found.rail:g} m from the middle"),
            ("radius", f"up to {found.largest_radius:.6g}; 1 is the set's face"),
            ("next", command("report", named(found.run))),
        ],
    )


def of_export(found: CartPoleExport) -> Screen:
    """Return where the C files are, and how far they agree with Python."""
    answer, told = "written", ": no C compiler here, so it was not compared"
    if found.max_abs_error is not None:
        answer = "written and compared"
        told = f": largest difference {found.max_abs_error:.4g} N at {found.states} states"
    return Screen(answer, told, None, [("files", ", ".join(found.files))])


def of_report(found: CartPoleReport) -> Screen:
    """Return the page to open."""
    facts = [("open", found.report)]
    if found.damaged is not None:
        facts.append(("damaged", found.damaged))
    return Screen("written", f": {found.bytes / 1e6:.1f} MB", None, facts)
