"""Draw the figures of docs/space.md from a run of `walker3d`.

    .venv/bin/python docs/images/make_space.py RUN

The run needs no proof.
"""

import sys
from pathlib import Path

from neuralgaits._environment import prepare

NAMES = "space-step", "space-footprints", "space-tube", "space-sections"


def main(run: str) -> None:
    """Draw a step, footprints and the tube."""
    prepare()
    from neuralgaits.systems.family_run import open_family_run
    from neuralgaits.systems.walker3d.spatial_system import SYSTEM

    figures = SYSTEM.page_figures(open_family_run(SYSTEM, run))
    for (figure, _), name in zip(figures, NAMES, strict=True):
        figure.savefig(Path(__file__).with_name(f"{name}.png"), dpi=90)


if __name__ == "__main__":
    main(sys.argv[1])
