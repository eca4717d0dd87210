"""A log or a residual that lies in a run folder is of the gait that its record names."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from safetensors.numpy import load_file, save_file

from neuralgaits.analysis.learned import LearnedResiduals
from neuralgaits.analysis.recorded_gait import (
    refuse_logs_of_another,
    refuse_residual_of_another,
)
from neuralgaits.analysis.run import open_run
from neuralgaits.analysis.walk_log import GAIT_FILES
from neuralgaits.errors import InputError
from neuralgaits.gait.flow_residual import Residual
from neuralgaits.runs.hashes import file_hashes
from neuralgaits.workflows.fit import fit
from neuralgaits.workflows.refine import refine
from support.shipped_run import SHIPPED

RESIDUAL = "residual/residual.safetensors"


def other_weights(run):
    weights = load_file(run / "policy.safetensors")
    weights = {name: np.array(1.01 * array, order="C") for name, array in weights.items()}
    save_file(weights, run / "policy.safetensors")


def written(file, content):
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(content if isinstance(content, str) else json.dumps(content))
    return file


@pytest.fixture
def one(tmp_path):
    return Path(shutil.copytree(SHIPPED, tmp_path / "one"))


@pytest.fixture
def other(tmp_path):
    """A run of the same robot with other weights."""
    run = Path(shutil.copytree(SHIPPED, tmp_path / "other"))
    other_weights(run)
    return run


@pytest.fixture
def log(one):
    """The log of a walk of the first run, whose record names it by a path from before a move."""
    record = {"logs": ["gone/walk.csv"], "sha256": file_hashes(one, GAIT_FILES)}
    written(one / "simulation/summary.json", record)
    return written(one / "simulation/walk.csv", "no walk")


@pytest.fixture
def residual(one):
    """What the first run has learned."""
    file = one / RESIDUAL
    LearnedResiduals(Residual.like((4,)), None, np.zeros(2)).write(file)
    (digest,) = file_hashes(one, (RESIDUAL,)).values()
    record = {"residual_sha256": digest, "sha256": file_hashes(one, GAIT_FILES)}
    written(one / "residual/summary.json", record)
    return file


def test_a_log_that_another_gait_walked_is_refused(one, other, log):
    before = sorted(other.rglob("*"))
    said = (
        f"gait of {other}, found {log}, walked with another policy.safetensors: give logs of this "
        f"run, or learn for that one with `neuralgaits fit {one} {log}`"
    )
    with pytest.raises(InputError) as refused:
        fit(other, [log])
    assert str(refused.value) == f"expected logs of the {said}"
    assert sorted(other.rglob("*")) == before
    # What is wrong with the run's own log is that it holds no walk.
    with pytest.raises(InputError, match=r"walk\.csv") as read:
        fit(one, [log])
    assert "walked with another" not in str(read.value)


def test_a_log_from_before_the_weights_changed_is_walked_again(one, log):
    other_weights(one)
    with pytest.raises(InputError, match=f": walk again with `neuralgaits simulate {one} --log "):
        fit(one, [log])


def test_a_log_of_another_rounds_walks_is_refused(one, other):
    log = written(one / "walks/logs/walk-0.csv", "no walk")
    refuse_logs_of_another(open_run(one), [log])
    with pytest.raises(InputError, match=r"walked with another policy\.safetensors"):
        refuse_logs_of_another(open_run(other), [log])


def test_a_log_that_no_record_names_is_taken(one, other, log, tmp_path):
    """As a robot's own."""
    run, summary = open_run(other), one / "simulation/summary.json"
    refuse_logs_of_another(run, [shutil.copy(log, tmp_path / "mine.csv"), tmp_path / "none.csv"])
    refuse_logs_of_another(run, [written(one / "simulation/another.csv", "")])
    for record in ({"logs": ["walk.csv"]}, {"logs": None}, "{", {"logs": [], "sha256": []}):
        written(summary, record)
        refuse_logs_of_another(run, [log])


def test_a_residual_of_another_gait_is_refused_and_no_run_is_made(one, other, residual, tmp_path):
    refuse_residual_of_another(open_run(one), residual)
    with pytest.raises(
        InputError, match=r"another policy\.safetensors: learn one of this gait, as"
    ):
        refine(other, residual=residual, out=tmp_path / "new")
    assert not (tmp_path / "new").exists()


def test_the_runs_own_residual_is_of_the_weights_that_it_has(one, residual, tmp_path):
    other_weights(one)
    with pytest.raises(InputError, match="learned with another policy"):
        refine(one, out=tmp_path / "new")
    # A summary of an earlier version names no gait: its run is looked at.
    (digest,) = file_hashes(one, (RESIDUAL,)).values()
    written(one / "residual/summary.json", {"residual_sha256": digest})
    refuse_residual_of_another(open_run(one), residual)


def test_the_copy_in_a_refined_run_is_of_the_weights_that_were_refined(one, other, residual):
    """So the command that a page repeats goes through."""
    copy = other / "residual.safetensors"
    shutil.copy(residual, copy)
    shutil.copy(one / "policy.safetensors", other / "start.safetensors")
    refuse_residual_of_another(open_run(one), copy)
    with pytest.raises(InputError, match="learned with another policy"):
        refuse_residual_of_another(open_run(other), copy)


@pytest.mark.parametrize("record", ["{", {"residual_sha256": "0" * 64, "sha256": {}}])
def test_a_residual_that_no_record_names_is_taken(one, other, residual, tmp_path, record):
    run = open_run(other)
    refuse_residual_of_another(run, shutil.copy(residual, tmp_path / "residual.safetensors"))
    written(one / "residual/summary.json", record)
    refuse_residual_of_another(run, residual)
