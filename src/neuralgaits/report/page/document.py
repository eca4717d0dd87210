"""The whole page: parts in the order a newcomer needs them, in one file that fetches nothing."""

import base64
import hashlib
from importlib import resources
from pathlib import Path

from neuralgaits.report.drawing.drawn import Drawn
from neuralgaits.report.page.answer import answer, title
from neuralgaits.report.page.closing import failures, figures, glossary, missing, reproduction
from neuralgaits.report.page.family import family
from neuralgaits.report.page.learning import learning
from neuralgaits.report.page.markup import Html, join, tag
from neuralgaits.report.page.proof import certificate
from neuralgaits.report.page.saved import Contents
from neuralgaits.report.page.training import training
from neuralgaits.report.page.walking import animation, simulations

MOST_BYTES = 5_000_000
"""Of the whole file."""
_SVG_BYTES = 300_000
"""A drawing larger than this is shown as its PNG file, if that is smaller."""
_CONTENTS = (
    ("answer", "The answer"),
    ("walk", "The walk"),
    ("training", "What was trained"),
    ("told", "What it is told"),
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
    """The page as HTML.

    Its policy lets the browser run this page's own script and show its own images, and connect
    to nothing, whatever the run's texts hold.
    """
    style = _asset("page.css")
    script = _asset("hints.js") + _asset("scene.js") + _asset("player.js")
    pictures = {
        figure.name: _picture(figure) for figure in contents.figures if isinstance(figure, Drawn)
    }
    parts = [animation(contents), training(contents)]
    if contents.saved.summary is not None:
        parts += [
            *family(contents, pictures),
            figures(contents, pictures),
            certificate(contents),
            simulations(contents.saved),
            learning(contents.saved),
        ]
    parts += [
        failures(contents),
        missing(contents),
        reproduction(contents),
        glossary(),
    ]
    policy = (
        "default-src 'none'; img-src data:; base-uri 'none'; form-action 'none'; "
        f"style-src '{_digest(style)}'; script-src '{_digest(script)}'"
    )
    name = f"A walking gait for {contents.saved.robot}"
    head = tag(
        "head",
        Html('<meta charset="utf-8">'),
        Html(f'<meta http-equiv="Content-Security-Policy" content="{policy}">'),
        Html('<meta name="viewport" content="width=device-width, initial-scale=1">'),
        # Without it browsers ask for an icon.
        Html('<link rel="icon" href="data:,">'),
        tag("title", name),
        tag("style", Html(style)),
    )
    body = tag(
        "body",
        tag("header", title(contents.saved), answer(contents), _list_of_contents(parts)),
        tag("main", *parts),
        tag("footer", "Made by neuralgaits from the files of the run; nothing was fetched."),
        tag("script", Html(script)),
    )
    return f"<!doctype html>\n{tag('html', head, body, lang='en')}\n"


def _list_of_contents(parts: list[Html]) -> Html:
    present = "".join(parts)
    links = [
        tag("li", tag("a", words, href=f"#{name}"))
        for name, words in _CONTENTS
        if name == "answer" or f'<h2 id="{name}">' in present
    ]
    return tag("nav", tag("ul", *links), aria_label="Contents")


def _picture(figure: Drawn) -> Html:
    """The figure inside the page. As an image, a drawing can neither run nor fetch anything."""
    kind, file = "svg+xml", figure.path_svg
    if file.stat().st_size > _SVG_BYTES and figure.path_png.stat().st_size < file.stat().st_size:
        kind, file = "png", figure.path_png
    content = base64.b64encode(Path(file).read_bytes()).decode()
    source = f"data:image/{kind};base64,{content}"
    return join([Html(f'<img src="{source}" alt="'), figure.title, Html('">')])


def _asset(name: str) -> str:
    return resources.files("neuralgaits.report.page").joinpath("assets", name).read_text("utf-8")


def _digest(text: str) -> str:
    """As a content security policy names an inline style or script."""
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
