"""Level 5: the same under torques that are not exact, or held between ticks."""

from neuralgaits.certificate.level import Level
from neuralgaits.certificate.levels.disturbed.conclude import conclude_disturbed
from neuralgaits.certificate.levels.disturbed.theorem import (
    DisturbedConstants,
    labelled_premises,
    series,
)
from neuralgaits.certificate.levels.full_order.level import of_one_gait

LEVEL = Level(
    5,
    "disturbed",
    DisturbedConstants,
    series,
    lambda known, boxes: labelled_premises(known[4], known[5]),
    lambda known, boxes, bounds: conclude_disturbed(known[4], known[5], bounds),
    rests_on=(4,),
    full_order=True,
    refusal=of_one_gait,
)
