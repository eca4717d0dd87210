"""Draw the flow chart of docs/your_robot.md: questions on the left, what to do on the right.

    python3 docs/images/make_suitable.py

Its colours can be read on a light and on a dark page; it needs nothing but Python.
"""

from html import escape
from pathlib import Path

STEPS = (
    ("Do all joints turn in one plane?", "Use --planarise: it welds the others"),
    ("Two equal legs of one to three links each?", "Not supported"),
    ("All else welded to these links, arms too?", "Use --planarise: it welds arms and waist"),
    ("Does each leg end in a sphere, no ankle?", "Use --planarise, --feet flat for ankles"),
    ("Are links and joints free of springs?", "Use --planarise: it removes springs"),
    ("A motor with a limit on each leg joint?", "Add them; the root has no motor"),
    ("A range on each leg joint?", "Add it, in the file's unit of angles"),
)
WIDTH, PITCH, HEIGHT, MIDDLE = 720, 66, 44, 172
LEFT, RIGHT, SPLIT = 10, 710, 400
BLUE, ORANGE, GREEN, GREY = "#1f6fb5", "#b25a00", "#2e7d32", "#808080"


def box(x: int, y: int, width: int, colour: str, text: str) -> str:
    """A box with one line of white text in it."""
    return (
        f'<rect x="{x}" y="{y}" width="{width}" height="{HEIGHT}" rx="6" fill="{colour}"/>'
        f'<text x="{x + width / 2:g}" y="{y + HEIGHT / 2 + 5:g}" text-anchor="middle" '
        f'fill="#ffffff">{escape(text)}</text>'
    )


def arrow(x0: int, y0: int, x1: int, y1: int, word: str, at: tuple[int, int]) -> str:
    """An arrow with a word beside it."""
    return (
        f'<path d="M{x0} {y0} L{x1} {y1}" stroke="{GREY}" stroke-width="2" '
        f'marker-end="url(#head)"/><text x="{at[0]}" y="{at[1]}" fill="{GREY}">{word}</text>'
    )


def chart() -> str:
    """The whole picture as SVG."""
    parts = []
    for place, (question, remedy) in enumerate(STEPS):
        y = 10 + place * PITCH
        middle = y + HEIGHT // 2
        parts += [
            box(LEFT, y, 330, BLUE, question),
            arrow(LEFT + 330, middle, SPLIT - 8, middle, "no", (354, middle - 7)),
            box(SPLIT, y, RIGHT - SPLIT, ORANGE, remedy),
            arrow(MIDDLE, y + HEIGHT, MIDDLE, y + PITCH - 8, "yes", (MIDDLE + 10, y + HEIGHT + 16)),
        ]
    bottom = 10 + len(STEPS) * PITCH
    parts.append(box(LEFT, bottom, 330, GREEN, "Suitable: inspect FILE, then train FILE"))
    lines = "\n".join(parts)
    head = (
        f'<marker id="head" viewBox="0 0 8 8" refX="2" refY="4" markerWidth="5" markerHeight="5" '
        f'orient="auto"><path d="M0 0 L8 4 L0 8 z" fill="{GREY}"/></marker>'
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {bottom + HEIGHT + 10}" '
        f'width="{WIDTH}" font-family="sans-serif" font-size="14" role="img">'
        f"<title>Is my robot suitable?</title><defs>{head}</defs>\n{lines}\n</svg>\n"
    )


if __name__ == "__main__":
    Path(__file__).with_name("suitable.svg").write_text(chart(), encoding="utf-8")
