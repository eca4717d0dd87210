"""Plain words for what a run is about: conditions, verdicts, levels, disturbances, terms."""

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from neuralgaits._printable import counted
from neuralgaits.barriers.quantity_words import QUANTITIES, QuantityWords
from neuralgaits.records.simulated import SimulationSummary, disturbances
from neuralgaits.report.page.markup import Html, join, number, tag

_CHANGES = {
    "friction": "friction of the feet {}",
    "torque_limit": "torques limited to {} N m",
    "delay_ms": "torques late by {} ms",
    "floor_height": "floor uneven by {} m",
    "slope_deg": "floor rising by {}°",
    "mass_scale": "all masses times {}",
    "torso_shift_m": "centre of mass of the torso shifted forward by {} m",
    "joint_friction": "friction of {} N m in the joints",
    "encoder_noise": "noise of {} rad on the joint angles",
    "rate_noise": "noise of {} rad/s on the joint rates",
    "encoder_step": "joint angles known in steps of {} rad",
    "pitch_noise": "noise of {} rad on the torso's angle",
    "pitch_offset": "torso's angle read {} rad too large",
    "estimator": "speeds estimated, not measured",
    "drive_stiffness": "drives holding joints with {} N m/rad",
    "drive_damping": "drives damping joints with {} N m s/rad",
    "drive_rate": "loops of the drives at {} Hz",
}
"""Differences between simulation and model, in words."""
GLOSSARY = (
    (
        "Zero dynamics",
        "what is left of the robot's motion when every joint follows its reference exactly: how "
        "the body falls forward over the foot on the ground. No motor acts on it directly. It is "
        "two numbers: z1, how far the hip is ahead of the foot, and z2, the angular momentum over "
        "it.",
    ),
    (
        "Policy",
        "the function that says, for these two numbers, where every joint should be. There "
        "is no clock in it: if the robot is held up, the gait waits.",
    ),
    ("Stance and swing", "the leg that stands on the ground, and the one that moves forward."),
    (
        "Guard, impact, reset",
        "the moment the swinging foot meets the ground; the sudden change of speeds there; the map "
        "from just before to just after it, the legs having swapped roles.",
    ),
    (
        "Region, tube",
        "the set of states that the gait is meant for: from the start of a step (phase 0) to "
        "touchdown (phase 1), between a slow and a fast edge, its fences.",
    ),
    (
        "Condition",
        "an inequality that must hold at every state of its region: “the ground pushes and never "
        "pulls”. Its margin says by how much it holds, in units of its scale, a typical size.",
    ),
    (
        "Barrier condition",
        "not only must a quantity stay positive: the nearer it comes to zero, the slower it may "
        "fall. So it cannot cross zero.",
    ),
    (
        "Walking set",
        "a set of states that no step leaves: from every state in it a step ends in it again.",
    ),
    (
        "Periodic orbit, multiplier",
        "the one motion that repeats itself at every step; the factor by which a small deviation "
        "from it shrinks in a step (0.7: a third is gone after each step).",
    ),
    (
        "Proved, measured",
        "proved: shown by interval arithmetic for every state of a region, rounding included. "
        "Measured: seen in samples or simulations. That is evidence, however much there is of it.",
    ),
)
"""Ten entries for a reader who has never met these terms."""


def verdict(word: str) -> Html:
    """Return a verdict in its colour; the word also carries the meaning."""
    return tag("span", word, class_={"proved": "good", "refuted": "bad"}.get(word, "open"))


def region(name: str) -> str:
    """Return in words where a condition must hold."""
    words = {
        "tube": "the whole step",
        "lift-off": "start of the step",
        "swing": "middle of the step",
        "landing": "end of the step",
        "guard": "at touchdown",
        "fence-lower": "slow edge of the region",
        "fence-upper": "fast edge of the region",
    }
    return words.get(name, name)


def named(name: str, words: str) -> Html:
    """Return a condition in words, with its name below."""
    code = tag("code", name, class_="quiet")
    return join([tag("span", words), Html("<br>"), code]) if words else code


def any_condition(described: Mapping[str, Any]) -> str:
    """Return a condition as a sentence, even one from another version."""
    try:
        return condition(described)
    except (AttributeError, KeyError, TypeError):
        return "described in a way that this version does not know"


def condition(described: Mapping[str, Any]) -> str:
    """Return a condition as a sentence, from its description in the run's config."""
    kind, sides = described.get("kind"), {"lower": "slow", "upper": "fast"}
    side = sides.get(described.get("side", ""), "")
    if kind == "Fence":
        return f"trajectories do not leave over the {side} edge"
    if kind == "Inlet":
        return f"after touchdown the next step begins inside the {side} edge"
    if kind == "TubeWidth":
        return f"width of the region in z2 ≥ {number(described['least'])} of its mean z2"
    if kind == "FencesApart":
        return "the edges of the region stay apart, both above zero"
    if kind == "Equality":
        inner = described["quantity"]
        bounded = inner.get("function") in ("at_least", "at_most")
        what, unit = _words_and_unit(inner["of"] if bounded else inner)
        middle = f" of {_numbers(inner['bound'])}" if bounded else ""
        return f"{what} within ±{number(described['tolerance'])}{middle} {unit}".rstrip()
    inner = described.get("quantity")
    if kind is None or not isinstance(inner, Mapping):
        return f"written by the user: {described.get('user', 'unknown')}"
    words = quantity(inner)
    if kind == "Barrier":
        alpha = described["alpha"]
        gains = alpha if isinstance(alpha, list) else [alpha]
        pace = " or ".join(number(gain) for gain in gains)
        return f"{words}; approached at {pace} per second times the distance left, or slower"
    if kind == "DiscreteBarrier":
        return f"{words}; touchdown takes no more than {number(described['gamma'])} of it"
    return words


def gist(conditions: Sequence[Mapping[str, Any]]) -> list[str]:
    """Summarise the requirements of a list of conditions, each once, in the order of the list."""
    counts = {}
    for described in conditions:
        inner = _object(described.get("quantity"))
        words_of_quantity = _quantity_words(_object(inner.get("of")) or inner)
        if described.get("kind") == "Inlet":
            counts["a next step that begins in range"] = None
        elif words_of_quantity is not None and words_of_quantity.gist is not None:
            counts[words_of_quantity.gist] = None
    return list(counts)


def _object(value: Any) -> Mapping[str, Any]:
    return value if isinstance(value, Mapping) else {}


def quantity(described: Mapping[str, Any]) -> str:
    """Return an inequality on a quantity in words."""
    name = described.get("function")
    if name == "after_reset":
        return f"after touchdown: {quantity(described['of'])}"
    if name in ("at_least", "at_most"):
        if (lean := _lean(described)) is not None:
            return lean
        what, unit = _words_and_unit(described["of"])
        sign = "≥" if name == "at_least" else "≤"
        return f"{what} {sign} {_numbers(described['bound'])} {unit}".rstrip()
    words_of_quantity = _quantity_words(described)
    if words_of_quantity is not None and words_of_quantity.says is not None:
        return words_of_quantity.says(described, number)
    what, unit = _words_and_unit(described)
    return f"{what} ≥ 0 {unit}".rstrip()


def _lean(described: Mapping[str, Any]) -> str | None:
    """Return a bound of the torso's angle as the largest lean to one side; None for any other."""
    bound = described["bound"]
    if described["of"].get("function") != "torso_angle" or isinstance(bound, list):
        return None
    # The angle is positive backwards.
    if described["function"] == "at_most" and bound >= 0.0:
        return f"lean of the torso backwards ≤ {number(bound)} rad"
    if described["function"] == "at_least" and bound <= 0.0:
        return f"lean of the torso forwards ≤ {number(-bound)} rad"
    return None


def told_apart(conditions: Mapping[str, Mapping[str, Any]]) -> dict[str, str]:
    """Return sentences of conditions by name, the region in front where two would be the same."""
    sentences = {name: any_condition(described) for name, described in conditions.items()}
    counts = Counter(sentences.values())
    for name, words in sentences.items():
        if counts[words] > 1:
            sentences[name] = f"{region(str(conditions[name].get('region', '')))}: {words}"
    return sentences


def _quantity_words(described: Mapping[str, Any]) -> QuantityWords | None:
    """Return the words about a quantity of this package; None for any other."""
    name = described.get("function")
    return QUANTITIES.get(name) if isinstance(name, str) else None


def _short_text(words: Any) -> str:
    """Return a user's words if they are short enough to be some; the empty text otherwise."""
    return words if isinstance(words, str) and len(words) <= 80 else ""


def _numbers(bound: Any) -> str:
    """Format a bound, or one bound for each joint."""
    return ", ".join(number(value) for value in (bound if isinstance(bound, list) else [bound]))


def _words_and_unit(described: Mapping[str, Any]) -> tuple[str, str]:
    """Return a quantity's words and unit; its name if it has no words."""
    name = described.get("function")
    if name == "after_reset":
        what, unit = _words_and_unit(described["of"])
        return f"{what}, after touchdown", unit
    if (words_of_quantity := _quantity_words(described)) is not None and words_of_quantity.what:
        return words_of_quantity.what, words_of_quantity.unit
    if name is None:
        own = f"{described.get('user', 'a quantity')}, written by the user"
        what, unit = (_short_text(described.get(key)) for key in ("what", "unit"))
        return (f"{what} ({own})" if what else own), unit
    return str(name).replace("_", " "), ""


def scale(described: Mapping[str, Any], size: float) -> str:
    """Return the size of one scale of a condition, with its unit if that is known."""
    without_quantity = {
        "Fence": "the region's width in a step",
        "Inlet": "the region's width",
        "TubeWidth": "the region's middle",
    }
    if whole := without_quantity.get(described.get("kind", "")):
        return whole if size == 1.0 else f"{number(size)} × {whole}"
    return f"{number(size)} {_unit(described)}".rstrip()


def _unit(described: Mapping[str, Any]) -> str:
    kind, inner = described.get("kind"), _object(described.get("quantity"))
    while inner.get("function") in ("after_reset", "at_least", "at_most"):
        inner = _object(inner.get("of"))
    words_of_quantity = _quantity_words(inner)
    unit = _short_text(inner.get("unit")) if words_of_quantity is None else words_of_quantity.unit
    if kind == "Barrier" and unit:
        # What a rate is compared with.
        alpha = described.get("alpha")
        order = len(alpha) if isinstance(alpha, list) else 1
        return f"{unit} per second" + ("" if order == 1 else " squared")
    return unit


def steps_each(simulation: SimulationSummary) -> str:
    """Return how many steps the walks took that stayed up, after a comma; empty if none did."""
    pairs = zip(simulation.steps_walked, simulation.fell, strict=True)
    steps = sorted({count for count, fell in pairs if not fell})
    if not steps:
        return ""
    each = (
        f", {counted(steps[0], 'step')}"
        if len(steps) == 1
        else f", {steps[0]} to {steps[-1]} steps"
    )
    return f"{each} each" if simulation.stayed > 1 else each


def changes(values: Mapping[str, Any] | None) -> list[str]:
    """Return the disturbances that differ from their defaults in words, one entry each."""
    return [
        _CHANGES.get(name, f"{name} {{}}").format(number(value))
        for name, value in disturbances(values).items()
    ]
