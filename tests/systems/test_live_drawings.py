"""Slices of the tube on the live page: a state is drawn within a band exactly where it is in it."""

import re

import equinox as eqx
import numpy as np
import pytest

from neuralgaits.systems.walker3d.live_drawings import SEEN, TubeSlices, draw_prints
from neuralgaits.systems.walker3d.live_moment import Footprint, SpatialMoment
from neuralgaits.systems.walker3d.live_panel import tube_line
from neuralgaits.systems.walker3d.spatial_gait import empty_gait

AXES = np.diag([0.02, 0.3, 0.2])
"""Half axes at every phase but for a factor from 1 to 2."""


def gait_with(axes):
    """A gait whose tube grows to twice its width over a step, from these half axes."""
    gait = empty_gait()
    rows = np.zeros_like(gait.tube.axes)
    rows[0], rows[1] = 1.5 * axes, 0.5 * axes
    return eqx.tree_at(lambda one: one.tube.axes, gait, rows)


GAIT = gait_with(AXES)


@pytest.fixture
def slices():
    return TubeSlices(GAIT)


def moment(phase, off, distance=0.5, trail=()):
    return SpatialMoment(
        time=1.0,
        walked=1.0,
        qpos=np.zeros(11),
        hips=np.array([3.0, 0.1, 0.7]),
        z=np.zeros(4),
        phase=phase,
        off=np.asarray(off),
        distance=distance,
        share=0.5,
        trail=np.array(trail).reshape(-1, 5),
        prints=(Footprint(2.6, -0.08, False), Footprint(2.9, 0.08, True)),
        path=np.array([[2.9, 0.0], [3.0, 0.1]]),
        steps=1,
        speed=0.6,
        force=np.zeros(3),
        gait=GAIT,
        told=0.0,
        requested=0.0,
        slope=0.0,
        ground=0.0,
        fall=None,
        upright=False,
    )


def band_and_dot(text, number):
    """The band's upper and lower edge at the dot's phase, and the dot, in pixels."""
    drawing = re.findall(r"<svg.*?</svg>", text)[number]
    corners = re.findall(r'<polygon points="([^"]*)"', drawing)[0].split()
    points = np.array([[float(x) for x in corner.split(",")] for corner in corners])
    upper, lower = np.split(points, 2)
    x, y = (float(re.findall(rf'<circle.*?c{axis}="([^"]*)"', drawing)[0]) for axis in "xy")
    return np.interp(x, *upper.T), np.interp(x, *lower[::-1].T), y


@pytest.mark.parametrize("share", [-1.02, -0.98, 0.0, 0.98, 1.02])
@pytest.mark.parametrize("phase", [0.0, 0.4, 1.0])
def test_a_state_is_within_the_band_exactly_if_it_is_within_the_half_width(slices, phase, share):
    widths = np.diag(AXES) * (1.0 + phase)
    text = slices.render(moment(phase, share * widths))
    for number in range(3):
        upper, lower, y = band_and_dot(text, number)
        assert bool(upper <= y <= lower) is (abs(share) <= 1.0)
        # Up is positive.
        assert share == 0.0 or bool(y < 0.5 * (upper + lower)) is (share > 0.0)


@pytest.mark.parametrize(("distance", "word"), [(0.99, "yes"), (1.01, "no")])
def test_the_line_says_inside_up_to_one_half_axis(distance, word):
    line = tube_line("proved tube", moment(0.0, np.zeros(3), distance)._replace(share=0.99999))
    assert f"Inside the proved tube now: {word}, {distance:.2f} half axes" in line
    # Rounded down: 100 % is said of all ticks only.
    assert "99.9 % of ticks" in line


def test_a_step_of_another_tube_has_its_own_bands(slices):
    """On the scale of the first one: a step that was told another speed has its own tube."""
    wide = moment(0.4, 0.9 * 1.4 * np.diag(AXES))
    narrow = wide._replace(gait=gait_with(0.5 * AXES))
    for number in range(3):
        upper, lower, y = band_and_dot(slices.render(wide), number)
        assert upper <= y <= lower
        other_upper, other_lower, other_y = band_and_dot(slices.render(narrow), number)
        assert other_y == y < other_upper
        assert other_lower - other_upper == pytest.approx(0.5 * (lower - upper), rel=0.02)


def test_what_is_far_off_stays_on_the_drawing_and_is_told(slices):
    text = slices.render(moment(0.0, [0.3, 0.0, 0.0], distance=15.0))
    upper, _, y = band_and_dot(text, 0)
    edge = band_and_dot(slices.render(moment(0.0, [2.0 * SEEN * 0.02, 0.0, 0.0])), 0)[2]
    assert y == edge < upper
    assert "+300.00 mm = +15.0 half widths" in text


def test_before_the_first_tick_there_is_a_band_and_no_state(slices):
    text = slices.render(moment(0.0, np.full(3, np.nan), distance=np.nan))
    assert text.count("<polygon") == 3
    assert "circle" not in text and "nan" not in text


def test_a_trail_has_a_gap_at_a_touchdown(slices):
    row = [0.1, 0.0, 0.0, 0.0, 0.5]
    rows = [row, row, [np.nan] * 5, row, row]
    text = slices.render(moment(0.2, np.zeros(3), trail=rows))
    assert text.count("<polyline") == 2 * 3


def test_footprints_are_where_the_feet_were_forward_to_the_right_and_left_above():
    text = draw_prints(moment(0.5, np.zeros(3)))
    dots = re.findall(r'<circle cx="([^"]*)" cy="([^"]*)"', text)
    (x0, y0), (x1, y1) = ((float(x), float(y)) for x, y in dots)
    assert x1 > x0 and y1 < y0
    # Equal scales: 0.30 m forward and 0.16 m aside.
    assert (x1 - x0) / (y0 - y1) == pytest.approx(0.30 / 0.16, rel=2e-2)
