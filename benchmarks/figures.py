"""Figures of a run: seconds and bytes, with nothing computed before and with the data there."""

import shutil
import tempfile
import time
from pathlib import Path

from common import show, trained

from neuralgaits.analysis.gait_data import gait_data
from neuralgaits.analysis.run import open_run
from neuralgaits.report.drawing.figure_files import FigureFiles
from neuralgaits.workflows.certify import certify
from neuralgaits.workflows.figures import figures
from neuralgaits.workflows.simulate import simulate


def main() -> None:
    """Every figure that a certified run with a log has."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "run"
        shutil.copytree(trained("amber3m", 0).path, folder)
        shutil.rmtree(folder / "figures", ignore_errors=True)
        certify(folder, level=4)
        simulate(folder, steps=20, log=folder / "simulation" / "walk.csv")
        start_time = time.process_time()
        run = open_run(folder)
        show("open the run: CPU [s]", time.process_time() - start_time)
        start_time = time.process_time()
        gait_data(run)
        show("data of the gait: CPU [s]", time.process_time() - start_time, "≤ 5")
        start_time = time.process_time()
        drawn = [figure for figure in figures(run) if isinstance(figure, FigureFiles)]
        show(f"{len(drawn)} figures, each PNG and SVG: CPU [s]", time.process_time() - start_time)
        show("data and figures, asked", "", "≤ 10")
        for kind, sizes in (
            ("PNG", [figure.path_png.stat().st_size for figure in drawn]),
            ("SVG", [figure.path_svg.stat().st_size for figure in drawn]),
        ):
            show(f"{kind} files together [MB]", sum(sizes) / 1e6, "both ≤ 3.5")


if __name__ == "__main__":
    main()
