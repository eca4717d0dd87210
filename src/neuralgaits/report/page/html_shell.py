"""A whole page around its parts: one file that runs only its own scripts and needs no network."""

import base64
import hashlib
from importlib import resources

from neuralgaits.report.page.markup import Html, join, tag


def whole(name: str, header: Html, main: Html, made_from: str, scripts: tuple[str, ...]) -> str:
    """Return the page as HTML.

    Its content security policy lets the browser run the page's own scripts and show its own images,
    and forbids all connections, whatever texts it holds.

    Args:
        name: title of the page in the browser.
        header: header above the parts.
        main: the parts.
        made_from: source of the page, in words.
        scripts: names of the script assets that it runs.
    """
    style, script = _asset("page.css"), "".join(map(_asset, scripts))
    policy = (
        "default-src 'none'; img-src data:; base-uri 'none'; form-action 'none'; "
        f"style-src '{_digest(style)}'; script-src '{_digest(script)}'"
    )
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
    footer = tag("footer", f"Made by neuralgaits from {made_from}; nothing was fetched.")
    body = tag("body", header, main, footer, tag("script", Html(script)))
    return f"<!doctype html>\n{tag('html', head, body, lang='en')}\n"


def inline_image(kind: str, content: bytes, alt: str, narrow_svg: bytes) -> Html:
    """Embed a picture in the page. As an image, a drawing can neither run nor fetch anything.

    Args:
        kind: media type after `image/`.
        content: content of its file.
        alt: alternative text.
        narrow_svg: its narrow form, an SVG file, which a telephone shows.
    """
    # Not in print: paper is as wide as a desk.
    narrow = f'media="screen and (max-width: 600px)" srcset="{_data("svg+xml", narrow_svg)}"'
    start = Html(f'<picture><source {narrow}><img src="{_data(kind, content)}" alt="')
    return join([start, alt, Html('"></picture>')])


def _data(kind: str, content: bytes) -> str:
    return f"data:image/{kind};base64,{base64.b64encode(content).decode()}"


def _asset(name: str) -> str:
    """Return the text of an asset file that pages share."""
    return resources.files("neuralgaits.report.page").joinpath("assets", name).read_text("utf-8")


def _digest(text: str) -> str:
    """Return the hash by which a content security policy allows an inline style or script."""
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
