"""Figures as a reader meets them: units, words, files, and what is missing and how to get it."""

import json
import re
import shlex
import shutil
import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib._pylab_helpers import Gcf
from matplotlib.text import Text

from neuralgaits import logs
from neuralgaits.analysis.box_map import BoxAnswer, BoxMap
from neuralgaits.analysis.data import MeasuredWalk, ResidualData
from neuralgaits.analysis.learned import LearnedResiduals
from neuralgaits.analysis.residual_data import residual_data
from neuralgaits.analysis.run import open_run
from neuralgaits.analysis.walk_log import measured_walk
from neuralgaits.cli import arguments
from neuralgaits.cli.argv_parser import read
from neuralgaits.errors import InputError, RunError
from neuralgaits.gait.flow_residual import Residual
from neuralgaits.logs.walk_table import Log
from neuralgaits.records.simulated import WALK_SUMMARY
from neuralgaits.report.certificate import certificate_of
from neuralgaits.report.drawing.figure import png, svg, write
from neuralgaits.report.drawing.figure_files import FigureFiles, MissingFigure
from neuralgaits.report.drawing.style import BLACK
from neuralgaits.report.figures import (
    barrier_sketches,
    certificate_map,
    full_order_set,
    gait_tiles,
    loss_curves,
    margins_orbit,
    margins_region,
    phase_portrait,
    residual_field,
    return_map,
    stride,
)
from neuralgaits.report.figures.full_order_set import FullOrderSet
from neuralgaits.report.figures.return_map import ProvedOrbit
from neuralgaits.report.run_figures import Absent, RunFigures, makers_of
from neuralgaits.runs.hashes import file_hashes
from neuralgaits.runs.names import FIT_SUMMARY, ROBOT, WEIGHTS
from neuralgaits.workflows.figures import figures

UNIT = re.compile(r"\[.+\]")
PNG = b"\x89PNG\r\n\x1a\n"
LARGEST_BYTES = 3_500_000
"""Of all files together: a report embeds them and stays below 5 MB."""
FULL = FullOrderSet(
    0.01,
    3.0,
    {"level-lower": 120.0, "level-upper": 60.0, "torso-lower": 70.0, "torso-upper": 70.0},
    {"level-lower": 0.0, "level-upper": 0.0, "torso-lower": 0.006, "torso-upper": 0.006},
    0.006,
    45.0,
)


def sketches(run):
    of_run = RunFigures(run, certificate_of(run))
    for name, _, make in makers_of(run.config):
        try:
            yield name, *make(of_run)
        except Absent:
            continue


PURE = ("steps taken", "gradient steps", "loss", "steps walked")
"""Labels of counts and of the loss, whose unit of 1 says nothing."""


def test_no_letter_is_lower_than_11_pixels_in_a_column_of_the_page(run, data):
    """A column is 656 pixels wide on a window of 1440; 15 of them are the frame of the figure."""
    figures_drawn = [figure for _, _, figure in sketches(run)]
    figures_drawn += [full_order_set.draw(data, FULL), a_map()]
    for figure in figures_drawn:
        pixels = 641.0 / (72.0 * figure.get_figwidth())
        words = [one for one in figure.findobj(Text) if one.get_visible() and one.get_text()]
        assert min(float(one.get_fontsize()) for one in words) * pixels >= 11.0


def test_limits_are_black_and_leans_have_a_direction(data):
    """A motor's limit has the colour of none of the first motors; the file's sign is another."""
    torques = stride.draw(data).axes[1]
    limits = [line for line in torques.lines if str(line.get_label()).startswith("limit")]
    assert limits and {line.get_color() for line in limits} == {BLACK}
    assert barrier_sketches.lean_in_words(-0.25) == "0.25 rad forward"
    assert barrier_sketches.lean_in_words(0.08) == "0.08 rad back"
    words = [text.get_text() for text in barrier_sketches.draw(data).axes[0].texts]
    assert sum(word.endswith(" rad forward") for word in words) == 1


def test_every_axis_and_colour_bar_has_a_unit(run, data):
    field = ResidualData(data, 0.01 * data["plane/dz"], data["orbit/z"], True)
    rows = [{"step": 1, "loss": 2.0, "validation_loss": 2.0, "effort": 0.0, "torso": 0.1}]
    for name, _, figure in [
        *sketches(run),
        ("full-order-set", "", full_order_set.draw(data, FULL)),
        ("certificate-map", "", a_map()),
        ("residual-field", "", residual_field.draw(field)),
        ("loss", "", loss_curves.draw(rows)),
    ]:
        for axes in figure.axes:
            if axes.get_label() == "<colorbar>":
                assert UNIT.search(axes.get_xlabel() + axes.get_ylabel()), name
                continue
            for axis, side in ((axes.xaxis, "labelbottom"), (axes.yaxis, "labelleft")):
                label = axis.get_label_text()
                named = label in PURE or (not label and needs_none(axis, side))
                assert UNIT.search(label) or named, (name, label)
                assert label.removesuffix(" [1]") not in PURE or label in PURE, (name, label)


def needs_none(axis, side):
    """An axis without numbers, or with numbers that stand at its neighbour."""
    shown = axis.get_tick_params().get(side, True)
    names = any(character.isalpha() for t in axis.get_ticklabels() for character in t.get_text())
    return len(axis.get_ticklocs()) == 0 or not shown or names


def test_figures_have_words_and_files_that_open(run, drawn):
    assert list(drawn) == [name for name, _, _ in makers_of(run.config)]
    total = 0
    for figure in drawn.values():
        assert figure.title
        if isinstance(figure, MissingFigure):
            assert figure.reason and figure.command.startswith("neuralgaits ")
            continue
        sentences = figure.caption.count(".") + figure.caption.count(";")
        assert 1 <= sentences <= 8 and figure.caption.endswith("."), figure.caption
        assert figure.path_png.read_bytes().startswith(PNG)
        text = figure.path_svg.read_text()
        assert ElementTree.fromstring(text).tag.endswith("svg")
        assert (
            "http"
            not in re.sub(r"http://(www\.w3\.org|purl\.org|creativecommons)\S*", "", text)[400:]
        )
        total += figure.path_png.stat().st_size + figure.path_svg.stat().st_size
    assert total < LARGEST_BYTES
    there = {name for name, figure in drawn.items() if isinstance(figure, FigureFiles)}
    assert {"gait-tiles", "phase-portrait", "barrier-sketches", "stride", "return-map"} <= there
    assert {"margins-orbit", "margins-region", "loss"} <= there


def test_commands_of_missing_figures_are_commands(run, drawn):
    missing = {name: figure for name, figure in drawn.items() if isinstance(figure, MissingFigure)}
    wanted = {"walk-tiles", "certificate-map", "full-order-set", "residual-field", "rounds"}
    assert set(missing) == wanted
    for figure in missing.values():
        for command in figure.command.split(" && "):
            words = shlex.split(command)
            verb = read(words[1:])
            given = getattr(verb, "run", None) or getattr(verb, "resume", None)
            assert str(given) == str(run.path), "a folder with a space in its name"
    certify = read(shlex.split(missing["full-order-set"].command)[1:])
    assert isinstance(certify, arguments.CertifyOptions) and certify.level == 4


def test_a_log_brings_the_walk(run, data, tmp_path):
    """The log that `simulate --log` would write, here of the orbit itself, walked twice."""
    copy = copied(run, tmp_path)
    missing = entry(copy, "walk-tiles")
    assert isinstance(missing, MissingFigure)
    simulate = read(shlex.split(missing.command)[1:])
    assert isinstance(simulate, arguments.SimulateOptions) and simulate.log is not None
    target = Path(simulate.log)
    walk = orbit_log(copy, data)
    target.parent.mkdir()
    logs.write(target, walk)
    assert isinstance(entry(copy, "walk-tiles"), tuple)
    measured = measured_walk(copy)
    assert measured is not None
    # The last step that ended is the second; the foot of the measured robot lands.
    assert set(measured.step[measured.last_step]) == {1}
    last = measured.skeleton[measured.last_step][-1]
    assert last[-1, 1] == pytest.approx(0.0, abs=1e-3), "one sample before"
    assert last[-1, 0] == pytest.approx(data.numbers.step_length_m, rel=0.01)

    # The record of `simulate` says that another gait walked.
    record = {"logs": [str(target)], "sha256": dict.fromkeys((ROBOT, WEIGHTS), "0" * 64)}
    (copy.path / WALK_SUMMARY).write_text(json.dumps(record))
    assert measured_walk(copy) is None
    assert isinstance(entry(copy, "walk-tiles"), MissingFigure)
    record["sha256"] = file_hashes(copy.path, (ROBOT, WEIGHTS))
    (copy.path / WALK_SUMMARY).write_text(json.dumps(record))
    assert measured_walk(copy) is not None


def test_a_residual_brings_its_field(run, data, tmp_path):
    copy = copied(run, tmp_path)
    assert isinstance(entry(copy, "residual-field"), MissingFigure)
    flow = Residual.like((4,))
    LearnedResiduals(flow, None, np.zeros(2)).write(copy.path / "residual" / "residual.safetensors")
    made = entry(copy, "residual-field")
    assert not isinstance(made, MissingFigure)
    # The record of `fit` says that another gait walked.
    record = {"logs": [], "sha256": {WEIGHTS: "0" * 64}}
    (copy.path / FIT_SUMMARY).write_text(json.dumps(record))
    assert isinstance(entry(copy, "residual-field"), MissingFigure)
    (copy.path / FIT_SUMMARY).unlink()
    caption, _ = made
    assert "has not been trained with it yet" in caption
    found = residual_data(copy)
    assert found is not None
    z = np.array([data["plane/z1"][10], data["plane/z2"][20]])
    np.testing.assert_allclose(found.epsilon[20, 10], flow(z), atol=1e-12)


def test_the_room_for_errors_is_the_definition_of_the_set(data):
    rng = np.random.default_rng(0)
    rooms = full_order_set.allowed(data, FULL)
    for _ in range(40):
        row, column = rng.integers(0, len(data["chart/level"])), rng.integers(0, 81)
        level, phase = data["chart/level"][row], data["chart/phase"][column]
        torso = data["chart/barriers"][:, row, column]
        size = rng.uniform(0.0, 0.2)
        h = {"level-lower": level, "level-upper": 1 - level, "torso-lower": torso[0]}
        h["torso-upper"] = torso[1]
        inside = all(h[n] - FULL.tightening[n] >= FULL.sigma[n] * size**2 for n in FULL.sigma)
        inside &= size <= 0.01 * np.exp(-3.0 * phase**2)
        room = min(*(room[row, column] for room in rooms.values()), FULL.tube(phase))
        assert inside == (size <= room)


def test_the_map_tells_proved_open_and_broken_apart_without_colour():
    figure = a_map()
    legend = figure.axes[0].get_legend()
    assert legend is not None
    hatches = {patch.get_hatch() for patch in legend.get_patches()}
    assert len(hatches) == 3


@pytest.mark.parametrize("name", ["corners", "answer", "margin", "counterexamples"])
def test_a_map_is_read_as_it_was_written_and_one_with_other_arrays_is_refused(tmp_path, name):
    boxes = BoxMap(np.ones((3, 4, 2)), np.arange(3), np.ones(3), np.ones((1, 2)), "three boxes")
    (tmp_path / "map").write_bytes(boxes.content())
    found = BoxMap.read(tmp_path / "map")
    assert found.title == boxes.title
    for one, other in zip(found[:-1], boxes[:-1], strict=True):
        np.testing.assert_array_equal(one, other)
    for other in (np.ones((3, 3)), np.array(1.0)):
        (tmp_path / "map").write_bytes(boxes._replace(**{name: other}).content())
        with pytest.raises(RunError, match="found other arrays: certify the run again"):
            BoxMap.read(tmp_path / "map")


def a_map():
    square = np.array([[0.0, 1.0], [0.1, 1.0], [0.1, 2.0], [0.0, 2.0]])
    corners = np.stack([square + np.array([0.1 * k, 0.0]) for k in range(3)])
    broken = np.array([[0.25, 1.5]])
    return certificate_map.draw(BoxMap(corners, np.arange(3), np.ones(3), broken, "three boxes"))


def test_the_proved_enclosure_is_drawn_around_the_fixed_point(data):
    z2 = data.numbers.z2
    figure = return_map.draw(data, ProvedOrbit((z2 - 4e-4, z2 + 4e-4), (0.5, 0.9), 0.9))
    inset = figure.axes[0].child_axes[0]
    low, high = inset.get_xlim()
    corners = inset.patches[0].get_extents().transformed(inset.transData.inverted())
    band = corners.x0, corners.x1
    dot = float(np.asarray(inset.lines[-1].get_xdata())[0])
    assert low < band[0] < dot < band[1] < high
    assert band[1] - band[0] == pytest.approx(0.8)


def test_captions_claim_no_more_than_is_proved(data):
    walk = MeasuredWalk("MuJoCo", *(np.zeros((1, 2)) for _ in range(7)))
    assert "not proved" in phase_portrait.caption(data, None, 1)
    for level in (2, 3):
        assert "follow the policy exactly" in phase_portrait.caption(data, None, level)
    assert "settles" not in phase_portrait.caption(data, None, 2)
    assert "any two of them come together: that is proved" in phase_portrait.caption(
        data, None, 3, with_commands=True
    )
    assert "orbit" not in phase_portrait.caption(data, None, 3, with_commands=True)
    unsafe = replace(data, arrays={**data.arrays, "chart/barriers": np.array([[[-0.1]]])})
    assert "safe part" in phase_portrait.caption(unsafe, None, 2)
    assert phase_portrait.caption(data, None, 3).endswith("proved.")
    assert "MuJoCo" in phase_portrait.caption(data, walk, 0)
    assert "proved" not in return_map.caption(data, None)
    margins = np.full((len(data.conditions), 2, 2), 2.0)
    margins[0] = 0.1
    two = replace(data, arrays={**data.arrays, "chart/margins": margins})
    tight, wide = two.conditions[:2]
    assert "proved" not in margins_orbit.caption(two, {})
    assert "proved for every state" in margins_orbit.caption(two, {tight: 0.01})
    # A bound beyond the end of the axis is not drawn.
    assert "proved" not in margins_orbit.caption(two, {wide: 1.5})


def test_the_proved_approach_is_one_in_zeta():
    """A map that contracts zeta = z2^2 / 2 by a factor, towards the orbit and past it."""
    orbit, starts, factor = 12.0, np.array([9.0, 14.0]), -0.8
    far = return_map.farthest(orbit, starts, abs(factor) ** np.arange(9))
    zeta = 0.5 * starts**2
    for bound in far:
        away = np.abs(np.sqrt(2.0 * zeta) - orbit)
        assert np.all(away <= bound + 1e-12)
        zeta = 0.5 * orbit**2 + factor * (zeta - 0.5 * orbit**2)
    # The walk that starts farther off is on the far side every other step.
    assert far[0] == pytest.approx(3.0)


def test_the_same_data_give_the_same_file_and_settings_come_back(data, tmp_path):
    before = dict(mpl.rcParams)
    files = [gait_tiles.draw(data["orbit/skeleton"], data["orbit/t"], data.torso) for _ in range(2)]
    assert svg(files[0]) == svg(files[1])
    assert png(files[0]) == png(files[1])
    write(files[0], tmp_path, "tiles")
    assert dict(mpl.rcParams) == before
    assert not Gcf.figs, "no figure is kept in pyplot's list"


def test_a_missing_run_is_one_line():
    with pytest.raises(RunError, match=r"expected a run folder at nowhere at all, found nothing"):
        figures("nowhere at all")


def test_a_file_in_the_place_of_the_folder_is_one_line(run, tmp_path):
    place = tmp_path / "taken"
    place.touch()
    with pytest.raises(InputError, match=r"expected a folder for the figures, found a file"):
        figures(run, out=place)


def copied(run, tmp_path):
    folder = tmp_path / "copy"
    shutil.copytree(run.path, folder)
    return open_run(folder)


def entry(run, name):
    """A figure's caption and drawing, or why it is missing."""
    makers = makers_of(run.config)
    title, make = next((title, make) for known, title, make in makers if known == name)
    try:
        return make(RunFigures(run, certificate_of(run)))
    except Absent as absent:
        return MissingFigure(name, title, absent.reason, absent.command)


def orbit_log(run, data) -> Log:
    """Three steps of the periodic orbit, sampled every 2 ms."""
    t, period = data["orbit/t"], data.numbers.period_s
    times = np.arange(0.0, 3.0 * period, 0.002)
    step, within = np.divmod(times, period)
    within[-1] = min(within[-1], t[-1])

    def sampled(values):
        return np.stack([np.interp(within, t, column) for column in values.T], axis=1)

    q, dq, z = (sampled(data[f"orbit/{name}"]) for name in ("q", "dq", "z"))
    theta = q @ np.asarray(run.robot.link_angles).T
    dtheta = dq @ np.asarray(run.robot.link_angles).T
    torso = run.robot.torso
    return Log(
        times,
        step.astype(int) % 2,
        q,
        dq,
        q[:, 1:],
        dq[:, 1:],
        sampled(data["orbit/torque"]),
        theta[:, torso],
        dtheta[:, torso],
        z,
        None,
        np.arange(len(times)) + 2,
        run.robot.joint_names,
        "orbit",
    )


def test_pale_is_little_margin_on_both_maps(data):
    boxes = BoxMap(
        np.array([[[0.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]] * 2),
        np.full(2, BoxAnswer.PROVED),
        np.array([0.1, 0.5]),
    )
    for figure in (margins_region.draw(data), certificate_map.draw(boxes)):
        drawn = (one for axes in figure.axes for one in axes.collections)
        mesh = next(one for one in drawn if one.get_array() is not None)
        low, high = (np.sum(mesh.cmap(share)[:3]) for share in (0.5, 1.0))
        assert low > high + 0.5
