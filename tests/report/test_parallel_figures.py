"""Figures are the same whoever writes them, and a process that cannot write them loses none."""

import sys
from collections.abc import Iterator, Sequence
from contextlib import nullcontext
from pathlib import Path

import matplotlib as mpl
import pytest

from neuralgaits.report.drawing.parallel_figures import FigureFile, second_pen, write_all
from neuralgaits.report.drawing.style import new_figure, settings


def _sheets(folder: Path) -> list[FigureFile]:
    sheets = []
    for number in range(3):
        with settings():
            figure = new_figure(2.0)
            axes = figure.subplots()
            axes.plot([0.0, 1.0], [0.0, number], label=f"line {number}")
            axes.legend()
        sheets.append(FigureFile(figure, folder, f"figure-{number}"))
    return sheets


def _files(paths: Sequence[Sequence[Path]]) -> Iterator[tuple[str, bytes]]:
    for pair in paths:
        for path in pair:
            yield path.name, path.read_bytes()


def test_two_processes_write_what_one_does(tmp_path: Path) -> None:
    (tmp_path / "one").mkdir()
    (tmp_path / "two").mkdir()
    alone = list(_files(write_all(_sheets(tmp_path / "one"), None)))
    with second_pen() as pen:
        both = list(_files(write_all(_sheets(tmp_path / "two"), pen)))
        assert pen is not None and pen.returncode == 0
    assert [name for name, _ in both] == [
        f"figure-{n}{e}" for n in range(3) for e in (".png", ".svg", "-narrow.svg")
    ]
    assert both == alone


def test_settings_of_the_user_change_nothing(tmp_path: Path) -> None:
    """As a `matplotlibrc` has them, in the folder or the user's."""
    (tmp_path / "plain").mkdir()
    (tmp_path / "other").mkdir()
    plain = list(_files(write_all(_sheets(tmp_path / "plain"), None)))
    with mpl.rc_context({"text.usetex": True, "font.family": "NoSuchFont", "axes.grid": True}):
        assert list(_files(write_all(_sheets(tmp_path / "other"), None))) == plain


@pytest.mark.parametrize("executable", ["/bin/false", "/no/such/python", None])
def test_without_the_other_process_all_are_written_here(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, executable: str | None
) -> None:
    (tmp_path / "one").mkdir()
    (tmp_path / "two").mkdir()
    alone = list(_files(write_all(_sheets(tmp_path / "one"), None)))
    monkeypatch.setattr(sys, "executable", executable)
    with second_pen() as pen:
        assert list(_files(write_all(_sheets(tmp_path / "two"), pen))) == alone


def test_what_can_be_written_nowhere_is_said(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("not a folder")
    for context in (second_pen(), nullcontext()):
        with context as pen, pytest.raises(OSError):
            write_all(_sheets(tmp_path / "file"), pen)
