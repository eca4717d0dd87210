"""Make docs/assets/math.woff again: the glyphs of formulas, from a font with a MATH table.

Without such a font a browser sets indices and accents badly, and many machines have none. Run with
the path of DejaVuMathTeXGyre.ttf (Debian: fonts-dejavu-extra).
"""

import sys
from pathlib import Path

from fontTools import subset
from fontTools.ttLib import TTFont

ASSETS = Path(__file__).parents[1] / "assets"
RANGES = (
    (0x20, 0x7F),
    (0xA0, 0x100),
    (0x2B0, 0x300),  # accents
    (0x391, 0x3F7),  # Greek
    (0x2010, 0x2060),  # dashes, primes
    (0x2100, 0x2130),  # letter-like: R, h
    (0x2190, 0x21B0),
    (0x2200, 0x2300),  # operators
    (0x239B, 0x23AF),  # pieces of tall brackets
    (0x27E6, 0x27F0),
    (0x1D434, 0x1D468),  # italic letters
    (0x1D6E2, 0x1D71C),  # italic Greek
)
NAME = "Neural Gaits Math"


def main(source: str) -> None:
    """Write the subset under a name of its own, as the font's licence asks of changed fonts."""
    options = subset.Options(flavor="woff", layout_features=["*"], notdef_outline=True)
    font = subset.load_font(source, options)
    assert isinstance(font, TTFont)
    subsetter = subset.Subsetter(options)
    subsetter.populate(unicodes=[code for low, high in RANGES for code in range(low, high)])
    subsetter.subset(font)
    for kind in (1, 3, 4, 6):
        font["name"].setName(NAME if kind != 6 else NAME.replace(" ", ""), kind, 3, 1, 0x409)
    subset.save_font(font, str(ASSETS / "math.woff"), options)


if __name__ == "__main__":
    main(sys.argv[1])
