"""The notebooks: their cells run, and what stands in them is what cells like these show."""

import json
import runpy
import shutil
from functools import partial

import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.barriers import specs
from neuralgaits.records.certified import CertificateRecord
from neuralgaits.report import run_figures
from neuralgaits.workflows import certify as proving
from neuralgaits.workflows import train as training
from support import brief_spec, pages
from support.shipped_run import SHIPPED

FOLDER = pages.ROOT / "examples" / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
RUN = runpy.run_path(str(pages.ROOT / "tools" / "run_notebooks.py"))["run"]
MOST_BYTES = 200_000


def read(path) -> dict:
    return json.loads(path.read_text(encoding="utf-8"))


def code(notebook) -> list[dict]:
    return [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]


@pytest.fixture
def beside(tmp_path, monkeypatch):
    """A folder with the example robots beside it, to be in as a notebook is."""
    shutil.copytree(pages.ROOT / "examples" / "robots", tmp_path / "robots")
    shutil.copytree(FOLDER, tmp_path / "notebooks", ignore=shutil.ignore_patterns("runs"))
    monkeypatch.chdir(tmp_path / "notebooks")
    return tmp_path


def kinds(outputs) -> list[list[str]]:
    """What each output is, without what it says."""
    return [sorted(output.get("data", {"printed": None})) for output in outputs]


def compare(path):
    """Run a notebook; what it shows is of the kinds that stand in it."""
    saved = read(path)
    for before, now in zip(code(saved), code(RUN(saved, path.name)), strict=True):
        assert kinds(before["outputs"]) == kinds(now["outputs"]), "".join(before["source"])


@pytest.mark.slow
def test_the_first_gait(beside, monkeypatch):
    """On the shipped run, trained and proved as the notebook does it."""
    folder = shutil.copytree(SHIPPED, beside / "run")
    proved = CertificateRecord.read(folder / "certificate" / "summary.json")
    monkeypatch.setattr(training, "train", lambda robot, seed: open_run(folder))
    monkeypatch.setattr(proving, "certify", lambda run: proving.CertifyResult(proved))
    # The one that it shows.
    shown = [row for row in run_figures.MAKERS if row[0] == "phase-portrait"]
    monkeypatch.setattr(run_figures, "MAKERS", shown)
    compare(FOLDER / "first_gait.ipynb")


@pytest.mark.slow
def test_the_own_robot(beside, monkeypatch):
    """With few of the conditions, and three steps."""
    walking = specs.walking
    monkeypatch.setattr(specs, "walking", lambda robot: brief_spec.briefly(walking(robot)))
    monkeypatch.setattr(training, "train", partial(training.train, steps=3, hidden=(4,)))
    monkeypatch.setattr(proving, "certify", partial(proving.certify, budget=5.0))
    compare(FOLDER / "own_robot_and_condition.ipynb")


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.name)
def test_a_notebook_is_small_whole_and_of_no_machine(path):
    text = path.read_text(encoding="utf-8")
    assert path.stat().st_size < MOST_BYTES
    assert pages.ROOT.as_posix() not in text and "/tmp/" not in text and "/home/" not in text
    cells = code(read(path))
    assert [cell["execution_count"] for cell in cells] == list(range(1, len(cells) + 1))
    assert all(cell["outputs"] for cell in cells)
    links = [
        link
        for cell in read(path)["cells"]
        if cell["cell_type"] == "markdown"
        for link in pages.links_of("".join(cell["source"]))
    ]
    assert all((path.parent / link).exists() for link in links)
