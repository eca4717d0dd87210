"""Figures on a telephone: as wide as that, panels below one another, nothing cut or hidden."""

import itertools
import re

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from neuralgaits.report.certificate import certificate_of
from neuralgaits.report.drawing.narrow import make_narrow
from neuralgaits.report.drawing.style import NARROW_IN, SMALL_PT, new_figure, settings
from neuralgaits.report.run_figures import Absent, RunFigures, makers_of


def laid_out(figure: Figure) -> Figure:
    """Find the layout, as files have it."""
    FigureCanvasAgg(figure)
    figure.draw_without_rendering()
    return figure


def beyond_in(figure: Figure) -> float:
    """By how much what is drawn reaches beyond the edges of a figure [in]."""
    box = figure.get_tightbbox(FigureCanvasAgg(figure).get_renderer())
    width, height = figure.get_size_inches()
    return max(-box.x0, -box.y0, box.x1 - width, box.y1 - height)


def check_panels(figure: Figure) -> None:
    """Panels stand below one another in the order of their letters, and none touches another."""
    panels = [axes for axes in figure.axes if axes.get_subplotspec() is not None]
    boxes = [axes.get_tightbbox(FigureCanvasAgg(figure).get_renderer()) for axes in panels]
    for above, below in itertools.pairwise(boxes):
        assert above is not None and below is not None
        assert above.y0 >= below.y1 - 1.0
    titles = [axes.get_title(loc="left") for axes in panels]
    letters = [title[0] for title in titles if re.match(r"[a-z]\)", title)]
    assert letters == sorted(letters)


def test_every_figure_of_a_run_fits_in_both_forms(run, data):
    of_run, seen = RunFigures(run, certificate_of(run, None)), 0
    for name, _, make in makers_of(run.config):
        try:
            caption, figure = make(of_run)
        except Absent:
            continue
        # Letters name the panels: of two panels none is the left one on a telephone.
        assert not re.search(r"\b(left|right)\b *[:)]|\((left|right)\b", caption, re.I), name
        seen += 1
        with settings():
            assert beyond_in(laid_out(figure)) < 0.02, name
            make_narrow(figure)
            assert beyond_in(laid_out(figure)) < 0.02, name
        assert figure.get_size_inches()[0] == NARROW_IN
        check_panels(figure)
    assert seen >= 8


@pytest.fixture
def side_by_side() -> Figure:
    """Two panels with one y axis, long words and a legend each."""
    with settings():
        figure = new_figure(3.0)
        for letter, axes in zip("ab", figure.subplots(1, 2, sharey=True), strict=True):
            axes.plot([0.0, 1.0], [0.0, 1.0], label="a line with a long name of its own")
            axes.plot([0.0, 1.0], [1.0, 0.0], label="another")
            axes.set(xlabel="so many words that they are longer than a telephone", ylabel="up [m]")
            axes.set_title(f"{letter})  panel", loc="left")
            axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.3), ncols=2)
            axes.label_outer()
        figure.legend(
            handles=[Patch(label=f"entry {n}") for n in range(3)],
            loc="outside lower center",
            ncols=3,
        )
        figure.suptitle("a title that is longer than the width of a telephone, by some words more")
    return figure


def test_panels_that_shared_numbers_have_their_own(side_by_side):
    with settings():
        make_narrow(side_by_side)
        laid_out(side_by_side)
    check_panels(side_by_side)
    assert beyond_in(side_by_side) < 0.02
    for axes in side_by_side.axes:
        assert axes.get_ylabel() == "up [m]"
        assert any(label.get_text() for label in axes.get_yticklabels())


def test_words_stay_as_large(side_by_side):
    with settings():
        before = [
            text.get_text() for axes in side_by_side.axes for text in axes.get_legend().get_texts()
        ]
        make_narrow(side_by_side)
    after = [text for axes in side_by_side.axes for text in axes.get_legend().get_texts()]
    assert [text.get_text() for text in after] == before
    sizes = {text.get_fontsize() for text in after}
    sizes |= {axes.xaxis.label.get_fontsize() for axes in side_by_side.axes}
    assert min(sizes) >= SMALL_PT


@pytest.mark.parametrize("rows", [3, 27])
def test_names_of_rows_do_not_touch(rows):
    with settings():
        figure = new_figure(3.0)
        axes = figure.subplots()
        axes.barh(np.arange(rows), np.ones(rows))
        axes.set_yticks(range(rows), [f"condition-{row}" for row in range(rows)])
        make_narrow(figure)
        laid_out(figure)
    renderer = FigureCanvasAgg(figure).get_renderer()
    boxes = [label.get_window_extent(renderer) for label in axes.get_yticklabels()]
    assert all(one.y1 <= other.y0 for one, other in itertools.pairwise(boxes))
