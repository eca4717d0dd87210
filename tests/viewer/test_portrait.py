"""The portrait's picture: a pixel is a state, and looks like what is known of it."""

import json
import re
import shutil
from dataclasses import replace

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from neuralgaits.analysis.box_map import BoxAnswer, BoxMap
from neuralgaits.analysis.point_evaluator import PlaneChart, PointEvaluator, quantities
from neuralgaits.analysis.run import open_run
from neuralgaits.certificate.run_certificate.verified_summary import (
    ProvedPart,
    hashes,
    read_certificate,
)
from neuralgaits.viewer import markdown, phase_chart, portrait_of_run, sureness
from neuralgaits.viewer import portrait_drawing as drawing
from neuralgaits.viewer.portrait import Portrait
from neuralgaits.viewer.portrait_of_run import portrait
from neuralgaits.viewer.sureness import how_sure, verdict_of
from support.contrast import channels, contrast


@pytest.fixture(scope="module")
def look(shipped):
    """Compiled once for all pictures."""
    return PointEvaluator(quantities(shipped.zero_dynamics, shipped.gait, shipped.spec))


@pytest.fixture(scope="module")
def plane(shipped, look):
    return portrait(shipped, look, certified=True)


LIGHT, DARK = 255.0, 20.0
"""Grounds of viser's pages."""


def on_ground(drawn, ground):
    """What is seen of a picture whose ground is transparent."""
    share = drawn[..., 3:] / 255.0
    return share * drawn[..., :3] + (1.0 - share) * ground


def pixels(portrait):
    """Picture of the drawing in the inks of a light page: red, green, blue and opacity."""
    figure = drawing.figure(portrait)
    figure.set_dpi(288)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.array(canvas.buffer_rgba()).astype(float)


@pytest.fixture(scope="module")
def drawn(plane):
    return pixels(plane)


@pytest.fixture(scope="module", params=[LIGHT, DARK], ids=["light", "dark"])
def picture(request, drawn):
    return on_ground(drawn, request.param)


def pixel(picture, portrait, z):
    """Row and column of a state."""
    x, y = phase_chart._pixels(portrait, z)
    height, width, _ = picture.shape
    return round(y / drawing.HEIGHT_PX * height), round(x / drawing.WIDTH_PX * width)


def colour_at(picture, portrait, z):
    """Median colour around a state: a line of the flow does not matter."""
    row, column = pixel(picture, portrait, np.asarray(z))
    return np.median(picture[row - 4 : row + 5, column - 4 : column + 5].reshape(-1, 3), axis=0)


def test_settings_of_the_user_change_nothing(plane):
    svg = drawing.svg(plane)
    with mpl.rc_context({"text.usetex": True, "axes.grid": True}):
        assert drawing.svg(plane) == svg


def test_places_are_shares_of_the_plane(plane):
    middle = 0.5 * (plane.low + plane.high)
    np.testing.assert_allclose(
        plane.place(np.array([plane.low, middle, plane.high])).T[0], [0, 0.5, 1]
    )
    np.testing.assert_array_equal(plane.clip(np.array([9.0, -9.0])), [plane.high[0], plane.low[1]])


def test_a_state_off_the_plane_is_on_none_of_its_places(plane):
    middle = 0.5 * (plane.low + plane.high)
    assert plane.in_view(middle) and plane.beyond(middle) is None
    below = np.array([middle[0], plane.low[1] - 0.1])
    trail = np.array([middle, below, [np.nan, np.nan]])
    np.testing.assert_array_equal(plane.in_view(trail), [True, False, False])
    assert plane.beyond(below) == "▼ below the chart"
    assert plane.beyond(plane.high + np.array([1e-3, 0.0])) == "► right of the chart"


def test_the_orbit_has_the_colour_of_the_report(drawn, plane):
    z = plane.orbit[len(plane.orbit) // 2]
    red, green, blue = colour_at(drawn[..., :3], plane, z)
    assert red > green > blue


def test_a_proved_state_is_green_and_a_state_outside_is_not(shipped, plane, picture):
    chart = PlaneChart(shipped.gait, shipped.spec)
    inside = chart.z(np.array([0.3, 0.7]), np.array([0.25, 0.75]))
    outside = np.array([[-0.1, 6.0], [0.0, 20.0]])
    assert np.all(np.abs(chart.chart(outside)[1] - 0.5) > 0.5)
    for z in inside:
        red, green, blue = colour_at(picture, plane, z)
        assert green > red + 5
        assert green > blue + 5
    for z in outside:
        colour = colour_at(picture, plane, z)
        assert np.ptp(colour) < 12


def test_fences_are_where_their_states_are(plane, drawn):
    ink = np.array(channels(drawing.INK.light))
    for fence in plane.fence_z2:
        row, column = pixel(drawn, plane, np.array([plane.fence_z1[30], fence[30]]))
        assert np.abs(drawn[row - 3 : row + 4, column, :3] - ink).max(axis=-1).min() < 6


def test_words_and_lines_stand_out_from_a_light_ground_and_from_a_dark_one(drawn):
    # Its corners are the page's own.
    assert drawn[0, 0, 3] == drawn[-1, -1, 3] == 0.0
    for ground, ink in ((LIGHT, drawing.INK.light), (DARK, drawing.INK.dark)):
        # Contrast of text, of large text and of lines. Source: WCAG 2.2, 1.4.3 and 1.4.11.
        assert contrast(channels(ink), [ground] * 3) >= 4.5
        for line in (drawing.GUARD, drawing.FLOW, drawing.ORBIT, phase_chart.WALK):
            assert contrast(channels(line), [ground] * 3) >= 3.0


def test_the_orbit_lies_inside_and_closes(shipped, plane):
    chart = PlaneChart(shipped.gait, shipped.spec)
    phase, level = chart.chart(plane.orbit)
    assert np.all((level > 0.0) & (level < 1.0))
    assert phase[0] == pytest.approx(0.0, abs=1e-6)
    assert phase[-1] == pytest.approx(1.0, abs=1e-6)
    after = np.asarray(shipped.zero_dynamics.reset(plane.orbit[-1]))
    np.testing.assert_allclose(after, plane.orbit[0], rtol=1e-6)


@pytest.fixture
def known_orbit(plane, monkeypatch):
    """For pictures of the same gait: its orbit, looked for once, is in `plane`."""

    class Known:
        orbit = None

    class Path:
        z = plane.orbit[:, None]

    monkeypatch.setattr(portrait_of_run, "sampled_map", lambda *_: Known)
    monkeypatch.setattr(portrait_of_run, "cycle", lambda *_: Path)


def test_without_a_certificate_margins_are_sampled_and_called_so(shipped, look, known_orbit):
    plane = portrait(shipped, look, certified=False)
    assert "not a proof" in plane.title
    assert set(np.unique(plane.boxes.answer)) == {BoxAnswer.PROVED}
    assert np.all(plane.boxes.margin > 0.0)


def test_a_map_that_is_open_somewhere_is_not_called_proved(
    shipped, look, plane, known_orbit, monkeypatch
):
    assert "proved margins" in plane.title
    boxes = plane.boxes
    third = np.arange(len(boxes.answer)) == 3
    boxes = boxes._replace(answer=np.where(third, BoxAnswer.UNDECIDED, boxes.answer))
    monkeypatch.setattr(BoxMap, "read", lambda _: boxes)
    assert "only green is proved" in portrait(shipped, look, certified=True).title


def test_a_broken_region_is_red():
    corners = np.array([[[0.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]])
    line = np.array([0.0, 1.0])
    bad = Portrait(
        z1=np.linspace(-0.2, 1.2, 5),
        z2=np.linspace(0.8, 2.2, 4),
        dz=np.ones((4, 5, 2)),
        fence_z1=line,
        fence_z2=np.array([[1.0, 1.0], [2.0, 2.0]]),
        orbit=np.zeros((0, 2)),
        boxes=BoxMap(corners, np.array([BoxAnswer.REFUTED]), np.array([-0.5])),
        title="broken",
    )
    red, green, _ = colour_at(on_ground(pixels(bad), LIGHT), bad, [0.45, 1.55])
    assert red > green + 60


def test_the_words_claim_what_the_certificate_says(shipped):
    sure = how_sure(shipped)
    assert sure.certified
    assert sure.words.startswith("Proved, to level 3 of 5: ")
    assert sure.verdict.startswith("The proof file states level 3 of 5. You watch a simulation")
    assert "may fall" in sure.words
    # Exact bounds stand in the theorem's own words, which are folded away.
    assert re.search(r"\de-\d", sure.words) is None
    assert sure.theorem.startswith("- Level 2: T is every state") and "Level 3" in sure.theorem


def test_words_of_a_run_without_a_proof_claim_nothing(shipped, tmp_path):
    folder = tmp_path / "run"
    shutil.copytree(shipped.path, folder)
    summary = folder / "certificate" / "summary.json"
    answer = json.loads(summary.read_text())
    (folder / "certificate" / "proof.json").unlink()
    lost = how_sure(open_run(folder))
    assert not lost.certified and "no certificate of this gait" in lost.words
    assert lost.verdict.startswith("There is no certificate of this gait. ")
    # Nothing was proved that a file could hold: undecided, and no other gait's.
    open_conditions = {
        name: entry | {"verdict": "undecided", "margin": None}
        for name, entry in answer["conditions"].items()
    }
    answer |= {"verdict": "proved", "proof": None, "levels": [], "conditions": open_conditions}
    summary.write_text(json.dumps(answer | {"sha256": hashes(folder)}))
    undecided = how_sure(open_run(folder))
    assert undecided.certified and "Not proved: undecided at level 3" in undecided.words
    assert "at every state" not in undecided.words
    assert undecided.verdict.startswith("Not proved: undecided at level 3. ")
    assert r"27 of 27 conditions undecided \(torso-lower, " in undecided.words
    # A summary alone proves nothing, whatever it says.
    forged = json.loads((shipped.path / "certificate" / "summary.json").read_text())
    summary.write_text(json.dumps(forged | {"sha256": hashes(folder)}))
    alone = how_sure(open_run(folder))
    assert not alone.certified and "no such statement" in alone.words
    summary.write_text("{}")
    assert "damaged" in how_sure(open_run(folder)).words


def test_words_of_a_run_are_no_markup(shipped, tmp_path):
    folder = tmp_path / "run"
    shutil.copytree(shipped.path, folder)
    summary = folder / "certificate" / "summary.json"
    answer = json.loads(summary.read_text())
    answer["conditions"]["<iframe srcdoc='x'>\n\n# *big* [a](b)"] = answer["conditions"]["knee"]
    summary.write_text(json.dumps(answer))
    words = how_sure(open_run(folder)).words
    assert "iframe" not in words or re.search(r"(?<!\\)[<*\[]", words.replace("**", "")) is None
    assert "\n#" not in words
    assert markdown.code("a`<b>\n\n# c") == "`a'<b> # c`"


def test_the_verdict_of_a_proof_about_some_commands_names_no_level(shipped):
    found = read_certificate(shipped.folder)
    part = ProvedPart(sequences=("speed 0.5 to 0.6 m/s",), conditions=("knee",), levels=())
    assert found.summary is not None
    assert (
        verdict_of(found.summary, part) == "The proof file is about some commands only: see below."
    )


def test_a_proof_about_some_commands_is_said_with_its_premise_about_the_joints(
    shipped, monkeypatch
):
    found = read_certificate(shipped.folder)
    assert found.summary is not None
    above = tuple(one for one in found.summary.levels if one.level == 2)
    part = ProvedPart(sequences=("speed 0.5 to 0.6 m/s",), conditions=("knee",), levels=above)
    reading = found._replace(part=part)
    monkeypatch.setattr(sureness, "read_certificate", lambda *_: reading)
    words = how_sure(shipped).words
    assert "There, with joints exactly on target, 1 of " in words and "walk for ever" in words


def test_the_verdict_of_beliefs_names_the_robots(shipped):
    found = read_certificate(shipped.folder).summary
    assert found is not None
    about = replace(found, parameters={"lean": 3e-3})
    words = "for every robot whose lean is within 3 mm of its belief."
    assert verdict_of(about, None).endswith(words)
    assert "robot" not in verdict_of(found, None)
