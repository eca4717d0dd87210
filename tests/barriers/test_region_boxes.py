"""Regions of a spec: boxes of the chart whose faces close."""

from dataclasses import replace

import pytest

from neuralgaits.barriers import Box
from neuralgaits.errors import SpecError
from neuralgaits.gait.commands import Command


@pytest.mark.parametrize(
    ("low", "high", "message"),
    [
        ((0.9, 0.0), (0.1, 1.0), "from its low corner to its high one, found 0.9 to 0.1 on axis 0"),
        ((0.0, 0.6), (1.0, 0.4), "found 0.6 to 0.4 on axis 1: exchange them"),
        ((0.0, 0.0), (float("nan"), 1.0), "found 0 to nan on axis 0"),
        ((0.0, 0.0), (2.0, 1.0), "expected phases and levels from 0 to 1"),
        ((-0.1, 0.0), (1.0, 1.0), "expected phases and levels from 0 to 1"),
        ((0.0, 0.0), (1.0,), "as many in both, found 2 and 1"),
        ((0.0,), (1.0,), "found 1 and 1: name phase and level in both"),
        ((0.0,) * 3, (1.0,) * 3, "expected 2 numbers in each corner"),
    ],
)
def test_a_region_whose_faces_close_no_box_is_refused(spec, low, high, message):
    regions = {**spec.regions, "mine": (Box((0.0, 0.0), (1.0, 1.0)), Box(low, high))}
    with pytest.raises(SpecError, match=f"region 'mine' of spec 'walking': .*{message}") as refusal:
        replace(spec, regions=regions)
    assert "\n" not in str(refusal.value)


def test_a_region_may_name_the_axes_of_commands(spec):
    command = Command("speed", 0.6, 0.8, 0.1)
    box = Box((0.0, 0.0, 0.6, 0.6), (1.0, 1.0, 0.7, 0.8))
    wider = replace(spec, commands=(command,), regions={**spec.regions, "slow": (box,)})
    assert wider.regions["slow"] == (box,)
