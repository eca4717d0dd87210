"""Report of a run in one file: read it, show a walk, draw the figures, write the page."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from neuralgaits._argument_types import type_checked
from neuralgaits._printable import printable
from neuralgaits.analysis import gait_data
from neuralgaits.analysis.run import Run, open_run
from neuralgaits.certificate.proof_file.check import ASSUMPTIONS
from neuralgaits.certificate.run_certificate.retrace import refuse_endless
from neuralgaits.certificate.run_certificate.verified_summary import (
    CertificateReading,
    read_certificate,
)
from neuralgaits.errors import InputError, RunError
from neuralgaits.records import report_walk
from neuralgaits.records.report_walk import ShownWalk
from neuralgaits.records.reported import Lack, ReportRecord
from neuralgaits.report.certificate import part_of
from neuralgaits.report.drawing.figure_files import FigureFiles, MissingFigure
from neuralgaits.report.page.closing import missing_parts
from neuralgaits.report.page.document import MOST_BYTES, document
from neuralgaits.report.page.saved import Contents, RunContents, read
from neuralgaits.report.shown_walk import shown_walk
from neuralgaits.robots.mjcf.loader import robot_from_text
from neuralgaits.runs import RunFolder, resolve, write_text
from neuralgaits.runs.atomic import refuse_unwritable
from neuralgaits.runs.names import ROBOT
from neuralgaits.runs.outputs import refuse_outputs
from neuralgaits.systems.family_tasks import task_with
from neuralgaits.systems.system_family import ProgressCallbacks
from neuralgaits.workflows.figures import FOLDER, draw, writable_figures
from neuralgaits.workflows.inspect import inspect


@dataclass(frozen=True)
class Report:
    """Written report of a run.

    Attributes:
        path: path of the page.
        figures: figures, drawn and missing.
        summary: what `report --json` prints.
    """

    path: Path
    figures: list[FigureFiles | MissingFigure]
    summary: ReportRecord


@type_checked
def write_report(
    run: Run | str | Path,
    *,
    out: str | Path | None = None,
    begun: Callable[[], None] | None = None,
) -> Report:
    """Write the report of a run, finished or not.

    Args:
        run: a run, its folder, or `latest`.
        out: the file; `report.html` in the run if None.
        begun: called when the run is read and the work begins.

    Returns: `Report`; of a family beside walkers, the record that `--json` prints.
    Raises: RunError if the run does not exist or is damaged, TimeLimitError if its own spec does
        not come to an end; InputError if the file cannot be written.
    """
    arguments = {"run": run} if out is None else {"run": run, "out": Path(out)}
    if (task := task_with("report", arguments)) is not None:
        return task(ProgressCallbacks(begun=begun)).returned
    folder = run.folder if isinstance(run, Run) else resolve(run, finished=False)
    path = folder.path / "report.html" if out is None else Path(out)
    refuse_outputs([path], run=folder.path)
    if path.suffix.lower() not in ("", ".html", ".htm"):
        raise InputError(f"expected --out as a file *.html, found {path}: the report is a page")
    refuse_unwritable(
        *(folder.path / file for file in (gait_data.FILE, report_walk.FILE)), own=True
    )
    certificate = read_certificate(folder)
    if folder.finished and certificate.proof is None and not isinstance(run, Run):
        # No other process has traced its spec: before this one imports it, one does.
        refuse_endless(folder)
    saved = saved_of(folder, certificate)
    robot = robot_from_text(folder.copy(ROBOT), saved.config.robot)
    if folder.finished:
        writable_figures(saved.config, folder.path / FOLDER)
    if begun is not None:
        begun()
    with ThreadPoolExecutor(1) as beside:
        # Most of a walk is compiled without Python, while the figures are drawn.
        walking = beside.submit(_walk, run, folder)
        figures = draw(open_run(folder.path), None, certificate) if folder.finished else []
        walk, no_walk = walking.result()
    contents = Contents(
        saved=saved,
        robot=inspect(robot),
        walk=walk,
        no_walk=no_walk,
        figures=figures,
        assumptions=ASSUMPTIONS,
    )
    summary = ReportRecord(
        run=str(folder.path),
        report=str(path),
        bytes=_write_page(path, contents),
        figures=tuple(figure.name for figure in figures if isinstance(figure, FigureFiles)),
        missing=tuple(Lack(what, command) for what, command in missing_parts(contents)),
        damaged=saved.damaged,
    )
    return Report(path, figures, summary)


def _write_page(path: Path, contents: Contents) -> int:
    """Write the page. Returns: its bytes. Raises: InputError for a page of too many."""
    page = printable(document(contents))
    if (size := len(page.encode())) > MOST_BYTES:
        raise InputError(
            f"expected a page of at most {MOST_BYTES} bytes, found {size}: a figure is too large"
        )
    write_text(path, page)
    return size


def saved_of(folder: RunFolder, certificate: CertificateReading | None = None) -> RunContents:
    """Read a run's files; its certificate, too, if `certificate` is None."""
    certificate = certificate or read_certificate(folder)
    disturbance: tuple[float, ...] = ()
    if certificate.proof is not None and 2 in certificate.proof.theorems.claimed:
        walking = certificate.proof.theorems.walking
        assert walking is not None  # It is claimed.
        disturbance = walking.disturbance if any(walking.disturbance) else ()
    return read(folder, certificate.summary, certificate.reason, disturbance, part_of(certificate))


def _walk(run: Run | str | Path, folder: RunFolder) -> tuple[ShownWalk | None, str | None]:
    """Return the walk to show, or the reason why there is none."""
    if not folder.finished:
        return None, "There is no gait to show before the training has ended."
    try:
        return shown_walk(run if isinstance(run, Run) else open_run(folder.path)), None
    except InputError as error:
        if isinstance(error, RunError):
            raise
        return None, f"The gait could not be walked: {error}"
