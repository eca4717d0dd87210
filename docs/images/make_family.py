"""Draw the picture of docs/commands.md: the figure `family` of the gait of `demo --speed`.

.venv/bin/python docs/images/make_family.py [RUN]
"""

import argparse
from io import BytesIO
from pathlib import Path

import jax
from PIL import Image

from neuralgaits.analysis.family_data import family_data
from neuralgaits.analysis.run import open_run
from neuralgaits.report.drawing.command_words import FIGURE
from neuralgaits.report.drawing.figure import png
from neuralgaits.report.figures import family
from neuralgaits.workflows import demo

COLOURS = 256
PATH = Path(__file__).with_name(f"{FIGURE}.png")


def main() -> None:
    """Find the orbits and draw."""
    parser = argparse.ArgumentParser()
    parser.add_argument(
        "run", nargs="?", default=str(demo.TOLD), help="run of a gait with commands"
    )
    options = parser.parse_args()
    jax.config.update("jax_enable_x64", True)
    whole = png(family.draw(family_data(open_run(options.run))))
    # By octree: the tints of tubes keep their hues, which few colours by coverage would swap.
    picture = Image.open(BytesIO(whole)).convert("RGB")
    few = picture.quantize(COLOURS, Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
    few.save(PATH, optimize=True)
    print(f"{PATH.name}: {PATH.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main()
