"""The verb fit on logs of a known truth: residuals of flow and reset, errors, refusals."""

import json
import shutil
from dataclasses import replace

import jax
import numpy as np
import pytest

from neuralgaits import logs
from neuralgaits.analysis.learned import LearnedResiduals
from neuralgaits.errors import InputError, RunError
from neuralgaits.residual.fitter import FitConfig
from neuralgaits.runs.hashes import file_hashes
from neuralgaits.runs.names import FIT_SUMMARY, LEARNED_RESIDUAL
from neuralgaits.workflows.fit import fit
from support import planted_walk

pytestmark = pytest.mark.slow

FIELDS = {"residual", "train_error", "heldout_error", "nominal_heldout_error", "windows", "wall_s"}


def test_the_summary_is_what_the_interface_asks(brief_run, fitted):
    assert set(fitted.summary) >= FIELDS
    assert fitted.residual == brief_run.path / LEARNED_RESIDUAL
    assert json.loads((brief_run.path / FIT_SUMMARY).read_text()) == fitted.summary
    assert fitted.summary["strides"] == {"train": 12, "validation": 2, "heldout": 2}


def test_the_planted_flow_is_found(fitted, planted_logs):
    visited = np.concatenate([log.z for log in planted_logs])[::20]
    true, found = jax.jit(jax.vmap(lambda z: (planted_walk.flow(z), fitted.learned.flow(z))))(
        visited
    )
    error, size = (np.sqrt(np.mean(part**2, axis=0)) for part in (found - true, true))
    assert np.all(error <= 0.05 * size)


def test_errors_on_held_out_strides(fitted):
    summary = fitted.summary
    assert summary["heldout_error"] < 0.03 * summary["nominal_heldout_error"]
    # The truth is a function of z, so a table leaves what its steps leave, and no more.
    assert summary["heldout_error"] < summary["binned_floor"]
    assert summary["binned_floor"] < 0.2 * summary["nominal_heldout_error"]


def test_the_nominal_error_is_what_the_model_misses_over_windows(fitted, brief_run, planted_logs):
    """Integrated again by Euler's method in steps of 0.1 ms."""
    zd = brief_run.zero_dynamics
    strides = logs.cut(planted_logs, zd.robot).strides
    heldout = logs.windows(logs.split(strides, seed=0).heldout, samples=11, step=0.01)
    start, guard = (float(end) for end in brief_run.gait.span)
    momenta = np.concatenate([stride.z[:, 1] for stride in strides])
    scale = np.array([guard - start, np.median(momenta)])

    def later(z, _):
        def step(z, _):
            return z + 1e-4 * zd.zdot(z), None

        z, _ = jax.lax.scan(step, z, None, length=100)
        return z, z

    ends = jax.jit(jax.vmap(lambda z: jax.lax.scan(later, z, None, length=10)[1]))
    errors = (heldout.z[:, 1:] - np.asarray(ends(heldout.z[:, 0]))) / scale
    expected = np.sqrt(np.mean(np.sum(errors**2, axis=-1)))
    assert fitted.summary["nominal_heldout_error"] == pytest.approx(expected, rel=0.02)


def test_the_residual_stays_below_its_bound(fitted):
    far = np.random.default_rng(0).normal(size=(500, 2)) * [5.0, 500.0]
    found = np.abs(jax.jit(jax.vmap(fitted.learned.flow))(far))
    assert np.all(found <= fitted.summary["bound"])
    assert np.all(np.array(fitted.summary["bound"]) < 5.0 * np.array([0.02, 4.0]))


def test_touchdowns_before_and_after_the_reset_residual(fitted, brief_run):
    found = fitted.summary["touchdowns"]
    assert found["count"] >= 1
    lost = planted_walk.MOMENTUM_LOST * 15.0
    assert found["before"]["z2_kg_m2_s"] == pytest.approx(lost, rel=0.4)
    assert found["after"]["z2_kg_m2_s"] < 0.05 * found["before"]["z2_kg_m2_s"]
    assert found["after"]["rate_rad_s"] < 0.2 * found["before"]["rate_rad_s"]
    correction = fitted.learned.reset(np.array([0.17, 17.0]))
    assert float(correction.momentum) == pytest.approx(-planted_walk.MOMENTUM_LOST, rel=0.02)


def test_the_summary_names_the_gait_that_was_learned_from(fitted, brief_run):
    known = file_hashes(brief_run.path, ("robot.xml", "policy.safetensors"))
    assert fitted.summary["sha256"] == known and None not in known.values()


def test_a_stored_residual_reads_back_exactly(fitted, brief_run):
    read = LearnedResiduals.read(fitted.residual, brief_run.robot.n - 1)
    for one, other in zip(jax.tree.leaves(read), jax.tree.leaves(fitted.learned), strict=True):
        np.testing.assert_array_equal(one, other)


def test_another_file_is_no_residual(brief_run):
    with pytest.raises(RunError, match=r"expected a residual.*give a file that `fit` wrote"):
        LearnedResiduals.read(brief_run.path / "policy.safetensors", brief_run.robot.n - 1)


def test_rows_left_out_are_counted(brief_run, planted_logs, tmp_path):
    log, glitch, gap = planted_logs[0], 700, slice(200, 230)
    q, keep = log.q.copy(), np.ones(len(log), dtype=bool)
    q[glitch, 2] += 0.3
    keep[gap] = False
    worse = [replace(log, q=q).only(keep), *planted_logs[1:]]
    files = [tmp_path / f"{number}.csv" for number in range(len(worse))]
    for file, each in zip(files, worse, strict=True):
        logs.write(file, each)
    # What fit writes would replace the residual that other tests read.
    run = shutil.copytree(brief_run.path, tmp_path / "run")
    found = fit(run, files, config=FitConfig(patience=0)).summary
    assert found["steps"] == 0
    assert found["left_out"]["missing"] == 30
    assert found["left_out"]["outliers"] == 1
    # 20 ms at the beginning of each of 16 stance phases.
    assert found["left_out"]["settling"] == 16 * 20
    rows = sum(len(each) for each in worse)
    assert found["walked_s"] == pytest.approx(1e-3 * (rows + 30), abs=0.01)


@pytest.mark.parametrize(
    ("files", "found"),
    [
        (slice(0, 0), "expected at least one CSV or MCAP file, found none"),
        (slice(0, 1), "expected at least 3 strides of 0.1 s or more"),
    ],
)
def test_too_little_data_is_refused_and_nothing_written(
    brief_run, planted_logs, tmp_path, files, found
):
    short = planted_logs[0].only(planted_logs[0].t < 0.6)
    logs.write(tmp_path / "short.csv", short)
    before = sorted(path.name for path in brief_run.path.rglob("*"))
    with pytest.raises(InputError, match=found):
        fit(brief_run, [tmp_path / "short.csv"][files])
    assert sorted(path.name for path in brief_run.path.rglob("*")) == before


def test_a_walk_that_is_none_of_the_gait_is_not_asked_to_be_longer(
    brief_run, planted_logs, tmp_path
):
    """As of a hip whose sign is wrong: joints are far from what the gait asks."""
    asked = planted_logs[0].qd + 0.6
    logs.write(tmp_path / "off.csv", replace(planted_logs[0], qd=asked))
    with pytest.raises(InputError, match=r"rows are left out, because .* a sign, a zero or a unit"):
        fit(brief_run, [tmp_path / "off.csv"])


@pytest.mark.parametrize(
    ("words", "found"),
    [
        ({"optimizer": "sgd"}, "one of adam, adamw, nero, found 'sgd'"),
        ({"seed": -1}, "expected a seed from 0"),
    ],
)
def test_bad_settings(brief_run, planted_files, words, found):
    with pytest.raises(InputError, match=found):
        fit(brief_run, planted_files, **words)
