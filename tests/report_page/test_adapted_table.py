"""What a page says of a commanded speed that was adapted."""

from types import SimpleNamespace
from typing import Any

from neuralgaits.records.adapted_speeds import (
    AdaptedSpeeds,
    BelievedLean,
    BelievedSlope,
    LearnedLean,
)
from neuralgaits.report.page.adapted_table import adapted


def page(
    speeds: AdaptedSpeeds | None,
    adapt: str = "speed",
    belief: BelievedLean | None = None,
    slope: BelievedSlope | None = None,
) -> str:
    lean = LearnedLean(-0.0123, 2e-4, 29)
    done: Any = SimpleNamespace(
        adapt=adapt,
        adapted=speeds,
        learned_lean=lean,
        believed_lean=belief,
        believed_slope=slope,
    )
    return str(adapted(done))


def speeds_of(steps: int) -> AdaptedSpeeds:
    walked = tuple(0.8 - 0.0049 * k for k in range(steps))
    return AdaptedSpeeds((0.7,) * steps, (0.65,) * steps, walked, (None, *walked[1:]), 3)


def test_each_step_has_a_row():
    said = page(speeds_of(3))
    for cell in ("Speeds of the first walk in m/s<", "0.700", "0.650", "0.795", "unknown"):
        assert cell in said, cell
    assert said.count("<tr>") == 4 and "too short" in said


def test_a_long_walk_is_shortened_and_says_where_it_settled():
    said = page(speeds_of(30))
    assert "the first 20 of 30" in said and said.count("<tr>") == 21
    assert "walked 0.704 m/s for 0.700 m/s" in said
    assert "12.3 mm behind the file" in said


def test_without_adaptation_there_is_nothing():
    assert page(None) == page(speeds_of(0)) == ""


def test_a_belief_is_said_with_speeds_and_without():
    belief = BelievedLean((0.0, -0.0048, -0.0096))
    said = page(speeds_of(3), "lean", belief)
    assert "believed 9.6 mm behind the file" in said
    assert "The commanded speed was not adapted" in said and "was adapted at each" not in said
    alone = page(None, "lean", belief)
    assert "9.6 mm behind" in alone and "<table" not in alone
    assert "too few steps" in page(None, "lean", BelievedLean(()))


def test_a_belief_at_the_end_of_its_range_is_said_to_be_there():
    ended = page(None, "lean", BelievedLean((0.01,), at_end=True))
    assert "after 1 steps, the end of the gait" in ended
    slope = page(None, "slope", slope=BelievedSlope((0.035,), at_end=True))
    assert "uphill after 1 steps, the end of the gait" in slope
    assert "the end of the gait" not in page(None, "lean", BelievedLean((0.01,)))


def test_what_is_proved_of_beliefs_is_said_with_the_robots_that_it_is_about():
    proved = page(None, "lean", BelievedLean((0.01,), 3, 0.0025))
    assert "to level 3, is about every sequence of beliefs, of robots within 2.5 mm" in proved
    assert "no proof of this run" in page(None, "lean", BelievedLean((0.01,)))


def test_a_believed_slope_is_said_in_degrees():
    said = page(speeds_of(3), "speed,slope", slope=BelievedSlope((0.0, -0.0175), 2))
    assert "believed 1.00 degrees downhill after 2 steps" in said
    assert "to level 2, is about every sequence of slopes, on ground that is as believed" in said
    alone = page(None, "slope", slope=BelievedSlope((0.035,)))
    assert "2.01 degrees uphill" in alone and "no proof of this run" in alone
