"""Style of the live page on top of viser's: inks, a phone's window, light or dark.

Another version of viser that names its parts otherwise is shown as it is.
"""

import html
import json
from typing import NamedTuple

PHONE_PX = 576
"""Largest width of a window whose controls are a sheet below the scene; viser's own."""
SCENE_SHARE = 0.5
"""Share of a phone's window that the scene has to itself."""
STATUS_PX = 150
"""Height of the lines about the walk, so that nothing below moves as they come and go."""
PHONE_STATUS_PX = 104
"""Their height on a phone, where they would hide the controls; the rest is scrolled."""


class Ink(NamedTuple):
    """A colour of text, on a light page and on a dark one."""

    light: str
    dark: str

    @property
    def css(self) -> str:
        """Return its declaration; browsers without `light-dark` use the first one."""
        return f"color:{self.light};color:light-dark({self.light},{self.dark})"


GOOD, BAD = Ink("#2e7d53", "#6fd09a"), Ink("#c0392b", "#ff8f83")
TIGHT, QUIET, SAID = Ink("#9c5d00", "#f0b35b"), Ink("#5b6770", "#a3b0bb"), Ink("#7a3e9d", "#cf9df0")


def head() -> str:
    """Return HTML with the style of the page: widths on a phone, the status, small letters."""
    # By itself the sheet covers two thirds of the width and three fifths of the height.
    sheet = '.mantine-Paper-root[style*="bottom: 0px"]'
    # Folders of controls cut what is beyond them, which holds a sticky line in its place.
    around = '.mantine-ScrollArea-content div[style*="overflow: hidden"]:has(.walk-status)'
    return (
        "<style>code { overflow-wrap: anywhere; } p + p { margin-top: 0.5em !important; } "
        f".walk-status {{ height: {STATUS_PX}px; overflow-y: auto; "
        "background: var(--mantine-color-body); border-bottom: 1px solid rgba(128,140,150,.35); } "
        "div:has(> .walk-status) { position: sticky; top: 0; z-index: 5; } "
        f"{around} {{ overflow: clip !important; }} "
        # By themselves these are paler than text may be, and ends of sliders 8 pixels high.
        f":root {{ --mantine-color-dimmed: light-dark({QUIET.light},{QUIET.dark}) !important; }} "
        ".mantine-Slider-markLabel { font-size: 11px !important; } "
        f"@media (max-width: {PHONE_PX}px) {{"
        f".walk-status {{ height: {PHONE_STATUS_PX}px; }} "
        f"{sheet} {{ width: 100% !important; max-height: {100.0 * SCENE_SHARE:.0f}% !important; }} "
        f'{sheet} div[style="width: 20em;"] {{ width: 100% !important; }}'
        "}</style>"
    )


def follow_scheme() -> str:
    """Return HTML that reloads the page with viser's `?darkMode` if the browser prefers dark.

    The server does not learn a browser's preference, and viser has no setting that follows it.
    """
    return _run(
        # A bare URL is the document's here.
        "const here=new window.URL(window.location.href),asked=here.searchParams;"
        "const dark=window.matchMedia('(prefers-color-scheme: dark)').matches;"
        "if(dark&&!asked.has('darkMode')){asked.set('darkMode','');"
        "window.location.replace(here)}"
    )


def page_title(title: str) -> str:
    """Return HTML that names the browser's tab, which viser always calls `Viser`."""
    return _run(f"window.document.title={json.dumps(title)}")


def _run(script: str) -> str:
    """Return HTML with which a browser runs a script.

    The image is invalid on purpose, so that the code in `onerror` runs; nothing is fetched.
    """
    return f'<img src="data:," alt="" hidden onerror="{html.escape(script)}">'


def line(text: str, ink: Ink, *, strong: bool = False) -> str:
    """Return HTML of a line in a colour."""
    weight = 700 if strong else 500
    return (
        f'<div style="padding:3px 10px;font-size:13px;line-height:1.35;font-weight:{weight};'
        f'{ink.css}">{html.escape(text)}</div>'
    )


def status_block(lines: str) -> str:
    """Return the lines about the walk in a block of one height, which stays in view."""
    return f'<div class="walk-status">{lines}</div>'


def reset_button() -> str:
    """Return a button that presses the panel's own Reset, which may be out of view."""
    press = (
        "for(const one of document.querySelectorAll('button'))"
        "if(one!==this&amp;&amp;one.textContent.trim()==='Reset'){one.click();break}"
    )
    return (
        '<div style="padding:2px 10px 4px"><button type="button" style="font:inherit;'
        "font-size:13px;font-weight:600;padding:2px 14px;border:1px solid currentColor;"
        f'border-radius:4px;background:none;cursor:pointer;{BAD.css}" onclick="{press}">'
        "Reset</button></div>"
    )


def note(text: str) -> str:
    """Return HTML of a small line."""
    return f'<div style="padding:2px 10px 6px;font-size:12px">{html.escape(text)}</div>'
