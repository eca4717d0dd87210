"""A whole page around its parts: one file that may run its own script and connect to nothing."""

import base64
import hashlib
from importlib import resources

from neuralgaits.report.page.markup import Html, join, tag


def whole(name: str, header: Html, main: Html, made_from: str, scripts: tuple[str, ...]) -> str:
    """The page as HTML.

    Its policy lets the browser run this page's own scripts and show its own images, and connect
    to nothing, whatever texts it holds.

    Args:
        name: of the page, in the browser.
        header: above the parts.
        main: the parts.
        made_from: whose files it was made from.
        scripts: names of the assets that it runs.
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


def inline_image(kind: str, content: bytes, alt: str) -> Html:
    """A picture inside the page. As an image, a drawing can neither run nor fetch anything.

    Args:
        kind: after `image/`.
        content: of its file.
        alt: what is said in its place.
    """
    source = f"data:image/{kind};base64,{base64.b64encode(content).decode()}"
    return join([Html(f'<img src="{source}" alt="'), alt, Html('">')])


def _asset(name: str) -> str:
    """Text of a file that pages share."""
    return resources.files("neuralgaits.report.page").joinpath("assets", name).read_text("utf-8")


def _digest(text: str) -> str:
    """As a content security policy names an inline style or script."""
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
