"""The chart of the live page: a run's phase portrait in the panel, with the robot's state on it.

A click on it writes the state into the field below it and submits that, as a visitor could by hand.
"""

import re
from collections.abc import Callable

import numpy as np
import viser

from neuralgaits._types import Float
from neuralgaits.analysis.box_map import BoxAnswer
from neuralgaits.viewer import portrait_drawing as drawing
from neuralgaits.viewer.page_style import note
from neuralgaits.viewer.portrait import Portrait
from neuralgaits.viewer.push_arrow import RED

WALK = "#2f7fd0"
"""Colour of the walk; as on the report, it is blue, and the orbit is orange."""
_BALL = "#{:02x}{:02x}{:02x}".format(*RED)
_PLANE = np.array([drawing.LEFT_PX, drawing.HEIGHT_PX - drawing.BOTTOM_PX])
"""Lower left corner of the plane in the drawing [px]."""
_SIZE = np.array(
    [
        drawing.WIDTH_PX - drawing.LEFT_PX - drawing.RIGHT_PX,
        drawing.HEIGHT_PX - drawing.TOP_PX - drawing.BOTTOM_PX,
    ]
)
"""Size of the plane in the drawing [px]."""
_FRAMES = 2
"""Pictures of the page for each one of the chart, which changes twenty times a second."""
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
Clicked = Callable[[viser.ClientHandle | None, Float[np.ndarray, "2"]], None]
"""Receives the visitor who clicked, and the state; `LiveView._clicked` of a walker's page."""


class PhaseChart:
    """The chart, empty until the portrait of the gait is computed."""

    def __init__(self, gui: viser.GuiApi):
        """Reserve its place in the panel."""
        self._portrait: Portrait | None = None
        self._count = 0
        # The form is what the click submits.
        self._form = gui.add_form(None, visible=False)
        with self._form:
            self._plane = gui.add_html("")
            self._moving = gui.add_html("")
            self._legend = gui.add_html("")
            self._field = gui.add_text(
                "put to z1, z2", "", hint="click the chart, or type two numbers and press Enter"
            )

    def fill(self, portrait: Portrait, clicked: Clicked) -> None:
        """Show the portrait; `clicked` gets every state that a visitor asks for."""
        self._plane.content = note(
            f"{portrait.title}. Click to put the robot there, or type z1, z2 below, then Enter."
        ) + drawing.svg(portrait).replace("</svg>", f"{_click_area(portrait)}</svg>")
        self._legend.content = _legend(portrait)
        self._form.visible = True

        @self._form.on_submit
        def _(event: viser.GuiEvent) -> None:
            z = typed_state(self._field.value)
            if z is not None:
                clicked(event.client, z)
            elif event.client is not None:
                event.client.add_notification(
                    "Not there", "Type two numbers: z1 [m], z2 [kg m²/s].", color="orange"
                )

        self._portrait = portrait

    def show(self, z: Float[np.ndarray, "2"], trail: Float[np.ndarray, "K 2"]) -> None:
        """Move the ball to a state, and draw the states before it."""
        if self._portrait is not None:
            if self._count % _FRAMES == 0:
                self._moving.content = moving_layer(self._portrait, z, trail)
            self._count += 1


def typed_state(text: str) -> Float[np.ndarray, "2"] | None:
    """Return the state that a text states; None if it is no two numbers."""
    parts = re.fullmatch(rf"\s*({_NUMBER})[\s,;]+({_NUMBER})\s*", text)
    return None if parts is None else np.array([float(part) for part in parts.groups()])


def moving_layer(
    portrait: Portrait, z: Float[np.ndarray, "2"], trail: Float[np.ndarray, "K 2"]
) -> str:
    """Return what moves, as HTML that lies over the drawing before it.

    A state off the plane has no ball and no line, but a word at the plane's edge.
    """
    lines = _path(portrait, trail)
    path = (
        f'<path d="{lines}" fill="none" stroke="{WALK}" stroke-width="2" stroke-linejoin="round"/>'
    )
    return (
        # A layer of its own: the browser does not draw the portrait again.
        '<div style="height:0;position:relative">'
        f'<svg viewBox="0 0 {drawing.WIDTH_PX:g} {drawing.HEIGHT_PX:g}" style="position:absolute;'
        "left:0;bottom:0;width:100%;pointer-events:none;"
        f'will-change:transform;{drawing.INK.css}">{path}{_ball(portrait, z)}</svg></div>'
    )


def _ball(portrait: Portrait, z: Float[np.ndarray, "2"]) -> str:
    if not np.all(np.isfinite(z)):
        return ""
    x, y = _pixels(portrait, portrait.clip(z))
    words = portrait.beyond(z)
    if words is None:
        return (
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="5.5" fill="{_BALL}" stroke="#fff" '
            'stroke-width="1.5"/>'
        )
    low, high = _PLANE[0] + 55.0, _PLANE[0] + _SIZE[0] - 55.0
    x, y = min(max(x, low), high), min(max(y, drawing.TOP_PX + 14.0), _PLANE[1] - 6.0)
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="middle" font-size="12" font-weight="700" '
        f'fill="currentColor">{words}</text>'
    )


def _path(portrait: Portrait, trail: Float[np.ndarray, "K 2"]) -> str:
    """Return the lines between states that are both on the plane, as an SVG path."""
    seen = np.isfinite(trail).all(axis=1) & portrait.in_view(trail)
    parts, drawing_on = [], False
    for (x, y), there in zip(_pixels(portrait, trail), seen, strict=True):
        if there:
            parts.append(f"{'L' if drawing_on else 'M'}{x:.1f} {y:.1f}")
        drawing_on = bool(there)
    return "".join(parts)


def _pixels(portrait: Portrait, z: Float[np.ndarray, "... 2"]) -> Float[np.ndarray, "... 2"]:
    """Return places of states in the drawing, from its upper left corner [px]."""
    return _PLANE + portrait.place(z) * _SIZE * [1.0, -1.0]


def _click_area(portrait: Portrait) -> str:
    """Return a transparent area over the plane that submits the state under a click."""
    (z1, low), (right, z2) = portrait.low, portrait.high
    # The page takes note of a value only if it is set as a keyboard would. It sends one message in
    # 50 ms, and the last of them only: the submission waits until the value is sent.
    click = (
        "const area=this.getBoundingClientRect(),form=this.closest('form'),"
        "field=form.querySelector('input'),"
        f"z1={z1:.9g}+{right - z1:.9g}*(event.clientX-area.left)/area.width,"
        f"z2={z2:.9g}-{z2 - low:.9g}*(event.clientY-area.top)/area.height;"
        "Object.getOwnPropertyDescriptor(window.HTMLInputElement.prototype,'value')"
        ".set.call(field,z1.toFixed(4)+', '+z2.toFixed(3));"
        "field.dispatchEvent(new window.Event('input',{bubbles:true}));"
        "window.setTimeout(()=>form.requestSubmit(),150)"
    )
    x, y = _PLANE - [0.0, _SIZE[1]]
    return (
        f'<rect x="{x:g}" y="{y:g}" width="{_SIZE[0]:g}" height="{_SIZE[1]:g}" '
        f'fill="transparent" style="cursor:crosshair" onclick="{click}"/>'
    )


def _legend(portrait: Portrait) -> str:
    """Return what lines, fills and the ball are, as HTML."""
    ink = "currentColor"
    entries = [
        _entry(f'<circle cx="12" cy="6" r="5" fill="{_BALL}"/>', "ball: the robot now"),
        _entry(_line(WALK, 2.0), "this walk"),
    ]
    if len(portrait.orbit):
        entries.append(_entry(_line(drawing.ORBIT, 3.6), "periodic orbit; dotted: its reset"))
    entries.append(_entry(_line(ink, 1.4), "edge of the region"))
    arrow = f'<path d="M9 3l6 3-6 3z" fill="{drawing.FLOW}"/>'
    entries.append(_entry(_line(drawing.FLOW, 0.8) + arrow, "flow"))
    answers = portrait.boxes.answer
    for answer, colour, words in (
        (BoxAnswer.UNDECIDED, drawing.UNDECIDED, "undecided"),
        (BoxAnswer.REFUTED, drawing.REFUTED, "violated: margin below 0"),
    ):
        if np.any(answers == answer):
            swatch = f'<rect x="1" y="1" width="22" height="10" fill="{colour}"/>'
            entries.append(_entry(swatch, words))
    bar = _colour_bar(portrait) if np.any(answers == BoxAnswer.PROVED) else ""
    lines = "".join(entries)
    return (
        f'<div style="font-size:12px;line-height:1.35;padding:2px 10px 8px;{drawing.INK.css}">'
        f'{bar}<div style="display:flex;flex-wrap:wrap;gap:2px 12px">{lines}</div></div>'
    )


def _colour_bar(portrait: Portrait) -> str:
    ramp = ",".join(drawing.GREENS)
    return (
        '<div style="margin-bottom:4px">least margin of all conditions, in scales'
        '<div style="display:flex;align-items:center;gap:6px"><span>0, none</span>'
        f'<span style="flex:1;height:10px;background:linear-gradient(to right,{ramp})"></span>'
        f"<span>{portrait.darkest_margin:.2f} or more</span></div></div>"
    )


def _entry(mark: str, words: str) -> str:
    return (
        '<span style="display:inline-flex;align-items:center;gap:5px">'
        f'<svg width="24" height="12" style="flex:none">{mark}</svg>{words}</span>'
    )


def _line(colour: str, width: float) -> str:
    return f'<path d="M1 6H23" stroke="{colour}" stroke-width="{width:g}"/>'
