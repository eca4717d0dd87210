"""Draw the pictures of docs/pictures.md from a run that is proved and one that has learned.

    .venv/bin/python docs/images/make_pictures.py RUN ROUND

RUN is a run with a certificate of level 4, ROUND a round of `episodes` that was refined.
"""

import argparse
from io import BytesIO
from pathlib import Path

import jax
import pictures
from PIL import Image

from neuralgaits.analysis.gait_data import gait_data
from neuralgaits.analysis.run import open_run
from neuralgaits.report.drawing.figure import png
from neuralgaits.report.drawing.figure_files import FigureFiles
from neuralgaits.workflows.figures import figures

FOLDER = Path(__file__).parent
OWN = {
    "1-robot": pictures.coordinates,
    "2-plane": pictures.plane,
    "3-policy": pictures.constraints,
    "6-reset": pictures.reset,
}
OF_RUN = {
    "4-conditions": "barrier-sketches",
    "5-tube": "phase-portrait",
    "7-training": "loss",
    "8-proof": "certificate-map",
    "9-full-order": "full-order-set",
}
OF_ROUND = {"10-learning": "rounds"}
LIMIT = 130_000
"""Largest picture [bytes]."""
COLOURS = (128, 112, 96, 64, 32)


def main() -> None:
    """Draw all ten."""
    parser = argparse.ArgumentParser()
    parser.add_argument("run", help="run folder, proved to level 4")
    parser.add_argument("round", help="folder of a refined round of episodes")
    parser.add_argument("--scratch", type=Path, required=True, help="folder for all figures")
    options = parser.parse_args()
    jax.config.update("jax_enable_x64", True)
    data = gait_data(open_run(options.run))
    for name, draw in OWN.items():
        save(name, png(draw(data)))
    for run, wanted in ((options.run, OF_RUN), (options.round, OF_ROUND)):
        found = {drawn.name: drawn for drawn in figures(run, out=options.scratch)}
        for name, figure in wanted.items():
            drawn = found[figure]
            if not isinstance(drawn, FigureFiles):
                raise SystemExit(f"{run}: {drawn.reason}; first run {drawn.command}")
            save(name, drawn.path_png.read_bytes())


def save(name: str, picture: bytes) -> None:
    """Write a PNG with all of its colours, or as many as the limit allows."""
    whole = Image.open(BytesIO(picture)).convert("RGB")
    small = BytesIO()
    whole.save(small, "PNG", optimize=True)
    colours = 2**24
    for colours in COLOURS if small.tell() > LIMIT else ():
        small = BytesIO()
        # By coverage: the few dots of a legend keep their colours.
        few = whole.quantize(colours, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
        few.save(small, "PNG", optimize=True)
        if small.tell() <= LIMIT:
            break
    path = FOLDER / f"{name}.png"
    path.write_bytes(small.getvalue())
    print(f"{path.name}: {small.tell() / 1000:.0f} kB, {colours} colours")


if __name__ == "__main__":
    main()
