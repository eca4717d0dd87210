"""Figures of a training, which are of the weights that it ended with and of no others."""

import json
import re
import shutil
from dataclasses import replace

import numpy as np
import pytest
from safetensors.numpy import load_file, save_file

from neuralgaits.analysis.run import open_run
from neuralgaits.records.training_config import GaitOrigin
from neuralgaits.report.page.answer import answer
from neuralgaits.report.page.closing import failures
from neuralgaits.report.page.document import document
from neuralgaits.report.page.training import training

ALL_HOLD = r"(?i)all 27 (conditions )?h(o|e)ld"
LEFT_OUT = "figures of another policy.safetensors than the run"


@pytest.fixture
def unproved(shipped):
    """The shipped run without its certificate."""
    shutil.rmtree(shipped / "certificate")
    return shipped


def other_weights(run):
    weights = load_file(run / "policy.safetensors")
    weights = {name: np.array(1.5 * array, order="C") for name, array in weights.items()}
    save_file(weights, run / "policy.safetensors")


def edit(run, change):
    summary = json.loads((run / "summary.json").read_text())
    change(summary)
    (run / "summary.json").write_text(json.dumps(summary))


def test_figures_of_these_weights_are_told_as_a_record(contents, unproved):
    page = contents(unproved)
    for said in (answer(page), training(page)):
        assert re.search(ALL_HOLD, said) and "recorded when the gait was made" in said.lower()
    assert not page.saved.damaged and "which weights it is of" not in training(page)
    recorded = "recorded in training: all 27 conditions hold on fresh samples>"
    assert repr(open_run(unproved)).endswith(recorded)


def test_figures_of_other_weights_are_told_nowhere(contents, unproved):
    """Neither a page nor a notebook has them, and every other part of the page is there."""
    other_weights(unproved)
    page, run = contents(unproved), open_run(unproved)
    assert not page.saved.measured and page.saved.summary.loss is None
    for said in (document(page), repr(run), run._repr_html_()):
        assert not re.search(ALL_HOLD, said) and LEFT_OUT in said
    assert "to a loss of" not in training(page) and "smallest margin" in training(page)
    assert "No measurement of these weights is recorded" in answer(page)
    assert f"neuralgaits certify {unproved}" in failures(page)
    assert not run.summary.conditions and "tightest" not in run._repr_html_()


@pytest.mark.parametrize("file", ["policy.safetensors", "robot.xml", "spec.py"])
def test_a_record_of_other_files_is_left_out(contents, unproved, file):
    edit(unproved, lambda summary: summary["sha256"].update({file: "0" * 64}))
    assert f"another {file} than the run" in failures(contents(unproved))
    edit(unproved, lambda summary: summary["sha256"].pop(file))
    assert f"another {file} than the run" in failures(contents(unproved))


def test_a_record_without_hashes_is_read_and_said_to_be_of_any_weights(contents, unproved):
    """As earlier versions wrote it. Nothing can be compared."""
    edit(unproved, lambda summary: summary.pop("sha256"))
    page = contents(unproved)
    assert len(page.saved.measured) == 27 and not page.saved.damaged
    assert "of weights that the record does not name" in answer(page)
    assert "does not say which weights it is of" in training(page)
    assert repr(open_run(unproved)).endswith("of weights that the record does not name>")


def test_a_summary_cannot_say_itself_why_figures_are_left_out(contents, unproved):
    edit(unproved, lambda summary: summary.update(left_out="all is proved"))
    assert "all is proved" not in document(contents(unproved))


def test_figures_of_a_gait_that_was_not_trained_are_recorded_when_it_was_made(unproved):
    run = open_run(unproved)
    run.__dict__["config"] = replace(run.config, given=GaitOrigin("optimise", 5, 0.6))  # Cached.
    assert "seed 0, recorded when it was made: all 27 conditions" in repr(run)
