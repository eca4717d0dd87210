"""Level 4: the whole robot walks for ever, joints that are off their targets included."""

from neuralgaits.certificate.chart import Chart
from neuralgaits.certificate.level import Level, Parameters
from neuralgaits.certificate.levels.full_order.conclude import conclude_full_order
from neuralgaits.certificate.levels.full_order.theorem import (
    FullOrderConstants,
    labelled_premises,
    refusal,
    series,
)


def of_one_gait(known: Parameters, chart: Chart) -> str | None:
    """Explain why the theorems of full order do not cover a chart, or return None."""
    return refusal(chart, known[2].floor if 2 in known else 0.0)


LEVEL = Level(
    4,
    "full",
    FullOrderConstants,
    series,
    lambda known, boxes: labelled_premises(known[4]),
    lambda known, boxes, bounds: conclude_full_order(known[4], bounds),
    full_order=True,
    refusal=of_one_gait,
)
