"""The whole page: its parts in the order that a newcomer needs, in one self-contained file."""

from neuralgaits.report.drawing.figure_files import FigureFiles
from neuralgaits.report.page.answer import answer, glance, headline, title
from neuralgaits.report.page.closing import failures, figures, glossary, missing, reproduction
from neuralgaits.report.page.command_family import family
from neuralgaits.report.page.html_shell import inline_image, whole
from neuralgaits.report.page.learning import learning
from neuralgaits.report.page.markup import Html, Section, tag
from neuralgaits.report.page.proof import certificate
from neuralgaits.report.page.saved import Contents
from neuralgaits.report.page.training import training
from neuralgaits.report.page.walks import animation, simulations

MOST_BYTES = 5_000_000
"""Largest size of the whole file [bytes]."""


def document(contents: Contents) -> str:
    """Return the page of a run as HTML."""
    pictures = {
        figure.name: _picture(figure)
        for figure in contents.figures
        if isinstance(figure, FigureFiles)
    }
    walk, parts = animation(contents), [training(contents)]
    if contents.saved.summary is not None:
        parts += [
            *family(contents, pictures),
            figures(contents, pictures),
            certificate(contents),
            simulations(contents.saved),
            learning(contents.saved),
        ]
    parts += [failures(contents), missing(contents), reproduction(contents), glossary()]
    # A robot that moves comes first; without one the answer does.
    first = [walk, answer(contents)] if contents.walk else [answer(contents), walk]
    links = [
        tag("li", tag("a", part.title, href=f"#{part.name}"))
        for part in (*first, *parts)
        if isinstance(part, Section)
    ]
    contained = tag("nav", tag("ul", *links), aria_label="Contents")
    header = tag("header", title(contents.saved), glance(contents))
    name = headline(contents.saved)
    main = tag("main", *first, contained, *parts)
    return whole(name, header, main, "the files of the run", ("hints.js", "scene.js", "player.js"))


def _picture(figure: FigureFiles) -> Html:
    kind, content = "svg+xml", figure.path_svg.read_bytes()
    # Of a drawing so large, the smaller of its files.
    if len(content) > 400_000 and figure.path_png.stat().st_size < len(content):
        kind, content = "png", figure.path_png.read_bytes()
    return inline_image(kind, content, figure.title, figure.path_narrow.read_bytes())
