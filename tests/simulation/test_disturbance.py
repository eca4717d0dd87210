import pytest

from neuralgaits.errors import InputError
from neuralgaits.simulation.setup.disturbance import PlantChanges, existing, parse
from neuralgaits.simulation.setup.disturbance_set import DISTURBANCE_SET


def test_names_and_values_are_read():
    expected = PlantChanges(friction=0.4, delay_ms=4.0, slope_deg=-2.0)
    assert parse("friction=0.4, delay_ms=4,slope_deg=-2") == expected
    assert parse({"friction": 0.4, "delay_ms": 4, "slope_deg": -2}) == expected
    assert parse(expected) is expected


@pytest.mark.parametrize("nothing", [None, "", {}])
def test_nothing_disturbs_nothing(nothing):
    assert parse(nothing) == PlantChanges()


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("gravity=3", "unknown disturbance 'gravity': expected one of friction"),
        ("friction", "expected NAME=VALUE"),
        ("friction=ice", "friction: expected a number, found 'ice'"),
        ("friction=", "expected a number"),
        ("friction=nan", "friction: expected 0 to 10"),
        ("mass_scale=0", "mass_scale: expected 0.01 to 100"),
        ("delay_ms=1.5", "whole milliseconds, found 1.5"),
        ("friction=0.4,friction=0.5", "given twice"),
        (",", "found ',' with nothing before or after a comma"),
        (" , ", "with nothing before or after a comma"),
        ("friction=0.4,", "with nothing before or after a comma"),
        ("friction=0.4,,delay_ms=4", "with nothing before or after a comma"),
        ({1: 2}, "unknown disturbance 1: expected one of friction"),
        ({None: 2}, "unknown disturbance None: expected one of friction"),
        (0, "disturb: expected NAME=VALUE,... or a mapping, found 0"),
    ],
)
def test_what_cannot_be_meant_is_refused_in_one_line(text, says):
    with pytest.raises(InputError) as refusal:
        parse(text)
    assert says in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_the_list_of_what_exists_has_units():
    assert "delay_ms: delay of the torques [ms]" in existing()


def test_the_set_has_every_kind_of_disturbance_and_each_changes_one_thing():
    usual = vars(PlantChanges())
    changed = [
        {name: value for name, value in vars(entry).items() if value != usual[name]}
        for entry in DISTURBANCE_SET.values()
    ]
    noisy = [one for one in changed if len(one) > 1]
    assert noisy == [{"encoder_noise": 0.002, "rate_noise": 0.1}]
    # What a controller is told has a set of its own in `sensing`.
    told = {"pitch_noise", "pitch_offset", "estimator"}
    # And drives are no error of a model.
    told |= {"drive_stiffness", "drive_damping", "drive_rate"}
    assert {name for one in changed for name in one} == set(usual) - told
    assert min(one.get("mass_scale", 1.0) for one in changed) == 0.85
    assert min(one.get("torso_shift_m", 0.0) for one in changed) == -0.03
    assert {one["delay_ms"] for one in changed if "delay_ms" in one} == {1, 2, 4}
    assert {one["slope_deg"] for one in changed if "slope_deg" in one} == {-3.0, 3.0}
