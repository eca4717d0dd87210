"""Lists of constants and premises of level 5 about robots whose links are not the file's.

The argument is in docs/level5_model.md. Needs no JAX.
"""

from collections.abc import Iterable

from neuralgaits.certificate.levels.full_order.theorem import FullOrderConstants
from neuralgaits.certificate.premises import Premise

MODEL_LENGTHS = {
    "model_box": 3,
    "model_moves": 5,
    "model_moves_slope": 5,
    "model_pushes": 5,
    "model_feeds": 5,
    "model_errors": 3,
    "model_curvature": 2,
    "model_impacts": 5,
    "model_impacts_slope": 5,
    "model_impulses": 2,
    "model_peaks": 2,
}
"""How many numbers each list has."""
OUTPUT, MOMENTUM, GROWTH, CONTACT = 1, 2, 3, 4
"""Places in lists of moves and pushes. Those of feeds and impacts have the first two, too."""
PACE, IMPULSE = 3, 4
"""Places in lists of feeds and impacts, and of impacts; the last of feeds is that of contact."""
MODEL_SERIES = ("model_axes", "model_metric", "model_slopes", *list(MODEL_LENGTHS)[1:])
"""Lists that margins read."""


def model_premises(
    full: FullOrderConstants, barriers: Iterable[str], kick_end: float
) -> list[Premise]:
    """Return the premises about other robots.

    Args:
        full: the set.
        barriers: names of its barriers.
        kick_end: phase not reached between an impact and the next tick; 0 with a tick at each.
    """
    first, last = full.ends
    tube, strip = ((first, 0.0), (last, 1.0)), ((full.guard_from, 0.0), (last, 1.0))
    start = (first, 0.0), (full.start_strip, 1.0)
    # Until the first tick after an impact barriers' slopes are read, too: up to that phase.
    kicked = (first, 0.0), (max(full.start_strip, kick_end), 1.0)
    bounded = (
        (tube, "moves moves-slope pushes feeds errors"),
        (kicked, "slopes"),
        (start, "curvature"),
        (strip, "impact impact-slope impulses"),
    )
    required = [
        Premise(f"disturbed/model-{name}", *box, sign="not negative")
        for box, names in bounded
        for name in names.split()
    ]
    required += [
        Premise("disturbed/model-contact", *tube),
        Premise("disturbed/model-impulse", *strip),
    ]
    required += [
        Premise(f"disturbed/model-decrease {name}", *tube, sign="not negative") for name in barriers
    ]
    if kick_end != 0.0:
        required.append(Premise("disturbed/model-kick-contact", (first, 0.0), (kick_end, 1.0)))
    return required
