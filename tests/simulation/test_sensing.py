import math

import pytest

from neuralgaits.errors import InputError
from neuralgaits.simulation.setup.disturbance import PlantChanges, parse
from neuralgaits.simulation.setup.sensing import name_of, sensed


def test_encoders_have_the_numbers_that_are_asked_for():
    usual = sensed(PlantChanges(), "encoders")
    assert usual == PlantChanges(
        encoder_step=math.tau / 2**14, pitch_noise=1e-3, delay_ms=2, estimator=1
    )
    asked = sensed(parse("friction=0.4"), "encoders, bits=12,pitch_offset=-0.01,delay_ms=0")
    assert asked == PlantChanges(
        encoder_step=math.tau / 2**12,
        pitch_noise=1e-3,
        pitch_offset=-0.01,
        estimator=1,
        friction=0.4,
    )
    assert sensed(parse("delay_ms=5"), "encoders").delay_ms == 5
    assert (name_of(asked), name_of(PlantChanges())) == ("encoders", "perfect")


def test_perfect_sensing_leaves_a_plant_as_it_is():
    plant = parse("delay_ms=5")
    assert sensed(plant, "perfect") == sensed(plant, None) == plant
    assert not sensed(parse("estimator=1"), "perfect").estimator


@pytest.mark.parametrize(
    ("disturb", "sensing", "says"),
    [
        ("", "radar", "expected perfect or encoders, found 'radar'"),
        ("", "", "expected perfect or encoders, found ''"),
        ("", "perfect,bits=14", "expected perfect alone"),
        ("", "encoders,bits", "expected NAME=VALUE after encoders, found 'bits'"),
        ("", "encoders,gyro=1", "unknown sensing 'gyro': expected one of bits"),
        ("", "encoders,bits=12,bits=13", "bits is given twice"),
        ("", "encoders,", "nothing before or after a comma"),
        ("", "encoders,,bits=12", "nothing before or after a comma"),
        ("", "encoders,bits=many", "bits: expected a number, found 'many'"),
        ("", "encoders,bits=0", "whole number from 1 to 32, found 0"),
        ("", "encoders,bits=13.5", "whole number from 1 to 32, found 13.5"),
        ("", "encoders,bits=nan", "whole number from 1 to 32, found nan"),
        ("", "encoders,pitch_noise=-1", "pitch_noise: expected 0 to 1"),
        ("", "encoders,delay_ms=0.5", "whole milliseconds, found 0.5"),
        ("encoder_step=0.001", "encoders,bits=14", "found disturbance encoder_step beside it"),
        ("rate_noise=0.1", "encoders", "found that they are estimated"),
        ("estimator=0.5", None, "expected 0 or 1, found 0.5"),
    ],
)
def test_what_cannot_be_meant_is_refused_in_one_line(disturb, sensing, says):
    with pytest.raises(InputError) as refusal:
        sensed(parse(disturb), sensing)
    assert says in str(refusal.value) and "\n" not in str(refusal.value)
