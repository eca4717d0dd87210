"""The figure of a family of gaits: its numbers are those of the orbits, and its words fit them."""

import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_hex

from neuralgaits.analysis import family_data as finding
from neuralgaits.analysis.command_sweeps import CommandSweep, Family
from neuralgaits.analysis.poincare_map import poincare
from neuralgaits.analysis.run import open_run
from neuralgaits.errors import InputError
from neuralgaits.report import run_figures
from neuralgaits.report.certificate import certificate_of
from neuralgaits.report.drawing import command_words
from neuralgaits.report.drawing.figure_files import FigureFiles
from neuralgaits.report.drawing.style import series
from neuralgaits.report.figures import family as drawing
from neuralgaits.workflows import demo
from neuralgaits.workflows import figures as writing

UNIT = re.compile(r"\[.+\]")
SPEEDS = (0.55, 0.725, 0.9)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """The gait that ships with the package and is told its speed, 0.55 to 0.90 m/s."""
    place = tmp_path_factory.mktemp("family") / "run"
    return open_run(Path(shutil.copytree(demo.TOLD, place)))


@pytest.fixture(scope="module")
def family(run):
    """At three commands: all that panels b and c show."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(finding, "VALUES", 3)
        return finding.family_data(run)


@pytest.fixture(scope="module")
def orbit(run):
    """At the highest speed, found otherwise: on a finer mesh that knows no tube, from elsewhere."""
    steady = run.at(speed=SPEEDS[-1])
    found = poincare(steady.zero_dynamics, steady.gait.z(np.array([0.3, 0.6])))
    assert found.result == "found"
    return found


def without(family, *lost):
    """The family, with no orbit at some of its commands."""
    (sweep,) = family.sweeps
    speed, members = sweep.speed.copy(), list(family.members)
    for at in lost:
        speed[at] = np.nan
        members[at] = members[at]._replace(orbit=np.zeros((0, 2)), touchdown=np.zeros((0, 7, 2)))
    return Family((sweep._replace(speed=speed),), tuple(members), family.torso)


def lines(axes):
    return [np.column_stack([np.asarray(x) for x in line.get_data()]) for line in axes.lines]


def drawn(wanted, axes):
    """Whether some line of a panel is this one."""
    return any(
        line.shape == np.shape(wanted) and np.allclose(line, wanted, atol=1e-7)
        for line in lines(axes)
    )


def test_speeds_and_footholds_are_those_of_the_orbits(run, family, orbit):
    (sweep,) = family.sweeps
    assert sweep.values == pytest.approx(SPEEDS)
    assert sweep.speed[-1] == pytest.approx(orbit.step_length_m / orbit.period_s, rel=1e-7)
    last = family.members[-1]
    assert last.touchdown[0, 0] == pytest.approx((0.0, 0.0), abs=1e-12)
    assert last.touchdown[0, -1] == pytest.approx((orbit.step_length_m, 0.0), abs=1e-7)
    assert last.orbit[-1] == pytest.approx(orbit.guard_state, rel=1e-6)
    for member in family.members:
        moving = run.at(speed=member.value).zero_dynamics
        assert moving.point(member.orbit[-1]).z_after == pytest.approx(member.orbit[0], rel=1e-7)
        low, high = (np.interp(member.orbit[:, 0], member.fence_z1, f) for f in member.fence_z2)
        assert np.all((member.orbit[:, 1] > low) & (member.orbit[:, 1] < high))


def test_what_is_drawn_is_what_was_found(family, orbit):
    speeds, plane, postures = drawing.draw(family).axes
    (sweep,) = family.sweeps
    assert drawn([(0.55, 0.55), (0.9, 0.9)], speeds), "what is told"
    assert drawn(np.column_stack([sweep.values, sweep.speed]), speeds)
    assert drawn([(0.9, orbit.speed_m_s)], speeds)
    for number, member in enumerate(family.members):
        at = [
            line.shape == member.orbit.shape and np.allclose(line, member.orbit)
            for line in lines(plane)
        ].index(True)
        line = plane.lines[at]
        assert to_hex(line.get_color()) == series(number)["color"]
        assert all(drawn(np.column_stack([member.fence_z1, f]), plane) for f in member.fence_z2)
        assert drawn(member.touchdown[0, -1:], postures)
    for axes in (speeds, plane, postures):
        assert UNIT.search(axes.get_xlabel()) and UNIT.search(axes.get_ylabel())


def test_the_caption_says_which_commands_and_claims_nothing(family):
    said = drawing.caption(family)
    assert "0.55 m/s, 0.725 m/s and 0.9 m/s" in said and "exactly what was told" in said
    assert "nothing here is simulated or proved" in said
    assert "middle of its range" not in said and "No periodic orbit" not in said
    two = Family(
        (*family.sweeps, CommandSweep("slope", SWEPT, FASTER)), family.members, family.torso
    )
    assert "Every other command stays in the middle of its range." in drawing.caption(two)


SWEPT, FASTER = np.radians([-5.0, 0.0, 5.0]), np.array([0.9, 0.8, 0.7])


def test_slopes_are_drawn_in_degrees_and_their_grounds_slope(family):
    members = [
        member._replace(value=slope, touchdown=member.touchdown.copy())
        for member, slope in zip(family.members, SWEPT, strict=True)
    ]
    for member, slope in zip(members, SWEPT, strict=True):
        member.touchdown[0, -1, 1] = np.tan(slope) * member.touchdown[0, -1, 0]
    found = Family((CommandSweep("slope", SWEPT, FASTER),), tuple(members), family.torso)
    speeds, _, postures = drawing.draw(found).axes
    assert drawn(np.column_stack([(-5.0, 0.0, 5.0), FASTER]), speeds)
    assert [text.get_text() for text in speeds.get_xticklabels()] == ["−5", "0", "5"]
    assert "[°]" in speeds.get_xlabel() and "−5°, 0° and 5°" in drawing.caption(found)
    grounds = {
        round(float(np.degrees(np.arctan2(*(line[1] - line[0])[::-1]))), 6)
        for line in lines(postures)
        if len(line) == 2 and np.isclose(line[0, 0], postures.get_xlim()[0])
    }
    assert grounds == {-5.0, 0.0, 5.0}


def test_a_foothold_above_the_stance_foot_lies_on_a_ledge_of_its_own(family):
    members = [
        member._replace(value=height, touchdown=member.touchdown.copy())
        for member, height in zip(family.members, (-0.05, 0.0, 0.05), strict=True)
    ]
    for member in members:
        member.touchdown[0, -1, 1] = member.value
    sweep = CommandSweep("step_height", np.array([-0.05, 0.0, 0.05]), FASTER)
    *_, postures = drawing.draw(Family((sweep,), tuple(members), family.torso)).axes
    flat = {line[0, 1] for line in lines(postures) if len(line) == 2 and line[0, 1] == line[1, 1]}
    assert {-0.05, 0.0, 0.05} <= flat


def test_where_there_is_no_orbit_the_rest_is_drawn_and_it_is_said(family):
    part = without(family, 0)
    assert part.periodic
    assert drawing.caption(part).endswith("No periodic orbit was found at mean speed 0.55 m/s.")
    speeds, plane, postures = drawing.draw(part).axes
    assert speeds.get_xlim()[0] < 0.55, "the whole range"
    assert drawn(family.members[2].orbit, plane) and not drawn(family.members[0].orbit, plane)
    assert drawn(family.members[2].touchdown[0, -1:], postures)
    none = without(family, 0, 1, 2)
    assert not none.periodic
    texts = [text.get_text() for axes in drawing.draw(none).axes for text in axes.texts]
    assert texts == ["no periodic orbit"] * 2


def test_a_family_without_any_orbit_has_a_line_instead_of_a_figure(run, family, monkeypatch):
    monkeypatch.setattr(run_figures, "family_data", lambda run: without(family, 0, 1, 2))
    with pytest.raises(run_figures.Absent) as absent:
        run_figures.RunFigures(run, certificate_of(run)).family()
    assert "no periodic orbit" in absent.value.reason
    assert absent.value.command.startswith("neuralgaits train amber3m")


def test_the_figure_is_one_of_gaits_with_commands_only(run, family, tmp_path, monkeypatch):
    monkeypatch.setattr(run_figures, "family_data", lambda run: family)
    monkeypatch.setattr(run_figures, "MAKERS", run_figures.MAKERS[:1])
    (found,) = writing.figures(run, out=tmp_path / "told")
    assert isinstance(found, FigureFiles) and found.name == command_words.FAMILY
    assert found.path_png.stat().st_size < 300_000 and found.path_svg.is_file()
    plain = open_run(Path(shutil.copytree(demo.FOLDER, tmp_path / "plain")))
    assert writing.figures(plain, out=tmp_path / "none") == []
    with pytest.raises(InputError, match="found one that takes none"):
        finding.family_data(plain)


def test_an_orbit_outside_of_the_fences_is_not_one_of_the_gait(run, monkeypatch):
    """A tube of which the orbit's level is cut off."""
    chart = finding.PlaneChart

    class Narrow(chart):
        def fences(self, phase):
            low, high = super().fences(phase)
            return np.stack([0.8 * high + 0.2 * low, high])

    monkeypatch.setattr(finding, "PlaneChart", Narrow)
    found = finding._orbit_at(run, {"speed": 0.725}, 0.5)
    assert np.isnan(found.orbit.speed_m_s) and "between the fences" in found.orbit.result
    assert len(finding._member(0.725, found).touchdown) == 0


@pytest.mark.parametrize("name", ["speed", "slope", "step_height", "own"])
def test_values_about_which_something_is_proved_are_never_rounded_outward(name):
    random = np.random.default_rng(0)
    for _ in range(200):
        low, high = np.sort(random.uniform(-0.3, 0.3, 2))
        first, last = (number(text) for text in command_words.within(name, float(low), float(high)))
        assert command_words.value(name, low) <= first and last <= command_words.value(name, high)
        assert 0.0 < number(command_words.change_within(name, float(high - low)))
        assert number(command_words.change_within(name, high - low)) <= command_words.value(
            name, high - low
        )


def number(text):
    found = re.match(r"[−\d.e]+", text)
    assert found
    return float(found[0].replace("−", "-"))


def test_values_have_their_units():
    assert command_words.written("slope", np.radians(-5.0)) == "−5°"
    assert command_words.written("speed", 0.55) == "0.55 m/s"
    assert command_words.written("step_height", 1e-17) == "0 m"
    assert command_words.written("own", 2.0) == "2"
