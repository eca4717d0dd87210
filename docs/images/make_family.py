"""Draw the pictures of docs/commands.md: figures about commands, of the gait of `demo --speed`.

.venv/bin/python docs/images/make_family.py [RUN]
"""

import argparse
from io import BytesIO
from pathlib import Path

import jax
from PIL import Image

from neuralgaits.analysis.run import open_run
from neuralgaits.report.certificate import certificate_of
from neuralgaits.report.drawing.command_words import FIGURES
from neuralgaits.report.drawing.figure import png
from neuralgaits.report.run_figures import MAKERS, RunFigures
from neuralgaits.workflows import demo

COLOURS = 256


def main() -> None:
    """Find the orbits and walks, and draw."""
    parser = argparse.ArgumentParser()
    parser.add_argument(
        "run", nargs="?", default=str(demo.TOLD), help="run of a gait with commands"
    )
    options = parser.parse_args()
    jax.config.update("jax_enable_x64", True)
    run = open_run(options.run)
    figures = RunFigures(run, certificate_of(run))
    for name, _, draw in MAKERS:
        if name in FIGURES:
            save(Path(__file__).with_name(f"{name}.png"), png(draw(figures)[1]))


def save(path: Path, whole: bytes) -> None:
    """Write a picture in few colours."""
    # By octree: the tints of tubes keep their hues, which few colours by coverage would swap.
    picture = Image.open(BytesIO(whole)).convert("RGB")
    few = picture.quantize(COLOURS, Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
    few.save(path, optimize=True)
    print(f"{path.name}: {path.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main()
