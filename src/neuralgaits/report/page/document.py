"""The whole page: its parts in the order that a newcomer needs, in one self-contained file."""

from pathlib import Path

from neuralgaits.report.drawing.drawn import Drawn
from neuralgaits.report.page.answer import answer, title
from neuralgaits.report.page.closing import failures, figures, glossary, missing, reproduction
from neuralgaits.report.page.command_family import family
from neuralgaits.report.page.html_shell import inline_image, whole
from neuralgaits.report.page.learning import learning
from neuralgaits.report.page.markup import Html, tag
from neuralgaits.report.page.proof import certificate
from neuralgaits.report.page.saved import Contents
from neuralgaits.report.page.training import heading, training
from neuralgaits.report.page.walking import animation, simulations

MOST_BYTES = 5_000_000
"""Largest size of the whole file [bytes]."""
_SVG_BYTES = 300_000
"""Size above which a drawing is shown as its PNG file, if that is smaller [bytes]."""
_SCRIPTS = ("hints.js", "scene.js", "player.js")
_CONTENTS = (
    ("walk", "The walk"),
    ("answer", "The answer"),
    ("training", "What was made"),
    ("told", "Its commands"),
    ("figures", "Figures"),
    ("certificate", "The certificate"),
    ("simulations", "Simulations"),
    ("learning", "Learning"),
    ("failures", "What failed"),
    ("missing", "What is missing"),
    ("reproduce", "Make it again"),
    ("words", "Ten words"),
)


def document(contents: Contents) -> str:
    """Return the page of a run as HTML."""
    pictures = {
        figure.name: _picture(figure) for figure in contents.figures if isinstance(figure, Drawn)
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
    contained = _list_of_contents(contents, [*first, *parts])
    header = tag("header", title(contents.saved))
    name = f"A walking gait for {contents.saved.robot}"
    main = tag("main", *first, contained, *parts)
    return whole(name, header, main, "the files of the run", _SCRIPTS)


def _list_of_contents(contents: Contents, parts: list[Html]) -> Html:
    present, own = "".join(parts), {"training": heading(contents.saved)}
    links = [
        tag("li", tag("a", own.get(name, words), href=f"#{name}"))
        for name, words in _CONTENTS
        if f' id="{name}"' in present
    ]
    return tag("nav", tag("ul", *links), aria_label="Contents")


def _picture(figure: Drawn) -> Html:
    kind, file = "svg+xml", figure.path_svg
    if file.stat().st_size > _SVG_BYTES and figure.path_png.stat().st_size < file.stat().st_size:
        kind, file = "png", figure.path_png
    return inline_image(kind, Path(file).read_bytes(), figure.title)
