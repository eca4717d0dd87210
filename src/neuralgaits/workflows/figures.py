"""All figures of a run, drawn from the files in its folder."""

from pathlib import Path

from neuralgaits._argument_types import type_checked
from neuralgaits.analysis.run import Run, open_run
from neuralgaits.certificate.run_certificate.verified_summary import CertificateReading
from neuralgaits.errors import InputError
from neuralgaits.records.training_config import TrainingConfig
from neuralgaits.report.certificate import certificate_of
from neuralgaits.report.drawing.figure import paths_of
from neuralgaits.report.drawing.figure_files import FigureFiles, MissingFigure
from neuralgaits.report.drawing.parallel_figures import FigureFile, second_pen, write_all
from neuralgaits.report.run_figures import Absent, Maker, RunFigures, makers_of
from neuralgaits.runs.atomic import refuse_unwritable

FOLDER = "figures"


@type_checked
def figures(
    run: Run | str | Path, out: str | Path | None = None
) -> list[FigureFiles | MissingFigure]:
    """Draw every figure of a run.

    Args:
        run: a run, its folder, or `latest`.
        out: folder for the files; `figures` in the run's folder if None.

    Returns: one entry for each figure, always in the same order; `MissingFigure` names the
        command that makes the figure.
    Raises: RunError with one line if the run is missing or damaged, InputError if `out` is a file.
    """
    return draw(open_run(run), out)


def writable_figures(config: TrainingConfig, folder: Path) -> list[Maker]:
    """Return the makers of the figures that such a run can have.

    Raises: InputError if the folder cannot take one of them.
    """
    if folder.exists() and not folder.is_dir():
        raise InputError(
            f"expected a folder for the figures, found a file at {folder}: move it away"
        )
    makers = makers_of(config)
    refuse_unwritable(*(path for name, *_ in makers for path in paths_of(folder, name)), own=True)
    return makers


def draw(
    run: Run, out: str | Path | None = None, certificate: CertificateReading | None = None
) -> list[FigureFiles | MissingFigure]:
    """Draw the figures of an open run, whose certificate may already have been read."""
    folder = run.path / FOLDER if out is None else Path(out)
    makers = writable_figures(run.config, folder)
    of_run = RunFigures(run, certificate_of(run, certificate))
    tables: list[tuple[str, str] | MissingFigure] = []
    sheets = []
    with second_pen() as pen:
        for name, title, make in makers:
            try:
                caption, figure = make(of_run)
            except Absent as absent:
                tables.append(MissingFigure(name, title, absent.reason, absent.command))
                continue
            tables.append((title, caption))
            sheets.append(FigureFile(figure, folder, name))
        files = zip(sheets, write_all(sheets, pen), strict=True)
    figures: list[FigureFiles | MissingFigure] = []
    for entry in tables:
        if isinstance(entry, MissingFigure):
            figures.append(entry)
        else:
            sheet, paths = next(files)
            figures.append(FigureFiles(sheet.name, *entry, *paths))
    return figures
