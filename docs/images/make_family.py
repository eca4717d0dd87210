"""Draw the picture of docs/commands.md: the figure `family` of the gait of `demo --speed`.

.venv/bin/python docs/images/make_family.py [RUN]
"""

import argparse

import jax
from make_pictures import save

from neuralgaits.analysis.family_data import family_data
from neuralgaits.analysis.run import open_run
from neuralgaits.report.drawing.figure import png
from neuralgaits.report.figures import family
from neuralgaits.report.told import FIGURE
from neuralgaits.workflows import demo


def main() -> None:
    """Find the orbits and draw."""
    parser = argparse.ArgumentParser()
    parser.add_argument(
        "run", nargs="?", default=str(demo.TOLD), help="run of a gait with commands"
    )
    options = parser.parse_args()
    jax.config.update("jax_enable_x64", True)
    save(FIGURE, png(family.draw(family_data(open_run(options.run)))))


if __name__ == "__main__":
    main()
