"""The certify workflow: a proof of a trained gait, refutations, budgets, what cannot be traced."""

import json
import shutil
import time
from pathlib import Path

import numpy as np
import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.certificate.run_certificate import run_proof
from neuralgaits.certificate.search.root_turns import SearchInterrupted
from neuralgaits.errors import InputError, RunError, SpecError
from neuralgaits.runs import read_arrays
from neuralgaits.workflows.certify import certify

FIELDS = {"verdict", "level", "conditions", "wall_s", "proof"}
ENTRY = {"verdict", "proved_fraction", "boxes", "margin", "counterexample"}


@pytest.fixture(scope="module")
def gait(trained, tmp_path_factory):
    """The default gait in a folder of this file's own: other tests read the shared one."""
    return open_run(shutil.copytree(trained.path, tmp_path_factory.mktemp("gait") / "run"))


@pytest.fixture(scope="module")
def certificate(gait):
    """The default gait's proof."""
    return certify(gait, level=1)


@pytest.fixture(scope="module")
def poor(small_run, tmp_path_factory):
    """A run of two gradient steps: some conditions cannot hold."""
    return open_run(shutil.copytree(small_run.path, tmp_path_factory.mktemp("poor") / "run"))


def test_the_default_gait_is_proved(gait, certificate):
    summary = certificate.summary
    assert summary["verdict"] == certificate.verdict == "proved"
    assert set(summary) >= FIELDS
    assert summary["level"] == 1
    assert sorted(summary["conditions"]) == sorted(c.name for c in gait.spec.conditions)
    for name, entry in summary["conditions"].items():
        assert set(entry) >= ENTRY
        assert (entry["verdict"], entry["proved_fraction"]) == ("proved", 1.0), name
        assert entry["margin"] > 0.0
        assert entry["boxes"] >= 1
    folder = gait.path / "certificate"
    assert json.loads((folder / "summary.json").read_text()) == summary
    assert Path(summary["proof"]) == folder / "proof.json"
    assert (folder / "map.png").read_bytes()[:4] == b"\x89PNG"


def test_margins_are_those_of_samples_or_less(gait, certificate):
    draw, zd = np.random.default_rng(0), gait.zero_dynamics
    for region, boxes in gait.spec.regions.items():
        for box in boxes:
            point = zd.point(gait.gait.z(draw.uniform(box.low, box.high)))
            for condition in gait.spec.conditions:
                if condition.region == region:
                    values = np.asarray(condition.margins(point, gait.gait))
                    margin = certificate.conditions[condition.name].margin
                    assert np.all(values / condition.scale >= margin), condition.name


def test_the_proof_file_is_about_the_run(gait, certificate):
    claims = read_claims(gait.path / "certificate" / "proof.json")
    assert claims.program.hash == claims.program_hash
    stated = [name for statement in claims.statements for name in statement.conditions]
    assert sorted(set(stated)) == sorted(c.name for c in gait.spec.conditions)
    for statement in claims.statements:
        low, high = statement.leaves()
        axes = [k for k in (0, 1) if statement.high[k] > statement.low[k]]
        whole = np.prod([statement.high[k] - statement.low[k] for k in axes])
        assert np.sum(np.prod((high - low)[:, axes], axis=1)) == pytest.approx(whole)
        box = (statement.low, statement.high)
        assert box in [tuple(b) for b in gait.spec.regions[statement.region]]
    assert (gait.path / "certificate" / "proof.json").stat().st_size < 200_000


def test_the_same_run_gives_the_same_proof(gait, certificate):
    path = gait.path / "certificate" / "proof.json"
    before = path.read_bytes()
    assert certify(gait, level=1, resume=True).verdict == "proved"
    assert path.read_bytes() == before


def test_a_gait_that_breaks_conditions_is_refuted_at_a_state(poor):
    told = []
    done = certify(poor, level=1, progress=lambda share, boxes: told.append((share, boxes)))
    assert done.verdict == "refuted"
    assert told
    assert all(0.0 <= share <= 1.0 for share, _ in told)
    broken = {n: v for n, v in done.conditions.items() if v.verdict == "refuted"}
    assert broken
    conditions = {c.name: c for c in poor.spec.conditions}
    zd = poor.zero_dynamics
    for name, verdict in broken.items():
        point, condition = verdict.counterexample, conditions[name]
        assert point is not None
        z = poor.gait.z(np.array(point.u))
        np.testing.assert_allclose(z, point.z)
        value = np.min(np.asarray(condition.margins(zd.point(z), poor.gait)))
        assert value / condition.scale == pytest.approx(point.margin)
        assert value < 0.0
        assert verdict.proved_fraction < 1.0
    proof = done.summary["proof"]
    stated = set()
    if proof is not None:
        stated = {name for s in read_claims(Path(proof)).statements for name in s.conditions}
    assert not stated & set(broken)
    arrays, _ = read_arrays(poor.path / "certificate" / "map.safetensors")
    assert len(arrays["counterexamples"]) >= len(broken)


def test_no_time_is_undecided_and_can_be_resumed(gait, certificate, tmp_path):
    run = open_run(shutil.copytree(gait.path, tmp_path / "run"))
    shutil.rmtree(run.path / "certificate")
    start_time = time.monotonic()
    short = certify(run, level=1, budget=1e-9)
    assert time.monotonic() - start_time < 0.8 * certificate.summary["wall_s"] + 1.0
    assert short.verdict == "undecided"
    assert "budget" in short.summary["reason"]
    assert short.summary["proof"] is None
    assert sum(v.proved_fraction for v in short.conditions.values()) == 0.0
    entry = short.summary["conditions"]["torque-lower"]
    assert entry["verdict"] == "undecided"
    assert entry["undecided_boxes"] > 0
    assert entry["margin"] is None
    done = certify(run, level=1, resume=True)
    assert done.verdict == "proved"
    whole = certificate.summary["conditions"]["torque-lower"]
    assert done.summary["conditions"]["torque-lower"]["boxes"] == whole["boxes"]


def test_a_shorter_search_leaves_the_boxes_of_a_longer_one(gait, certificate, tmp_path):
    run = open_run(shutil.copytree(gait.path, tmp_path / "run"))
    before = {path: path.read_bytes() for path in run.path.glob("certificate/boxes-*")}
    assert before
    certify(run, level=1, budget=1e-9)
    assert {path: path.read_bytes() for path in before} == before
    damaged = min(before)
    damaged.write_bytes(before[damaged][:100])
    certify(run, level=1, budget=1e-9)
    assert len(damaged.read_bytes()) > 100


@pytest.mark.parametrize("damage", [None, "{", '{"wall_s": null}'])
def test_no_proof_is_lost(gait, certificate, tmp_path, damage):
    """A summary that nobody can read is no reason to delete the proof beside it."""
    run = open_run(shutil.copytree(gait.path, tmp_path / "run"))
    summary = run.path / "certificate" / "summary.json"
    if damage is None:
        summary.unlink()
    else:
        summary.write_text(damage)
    files = {path: path.read_bytes() for path in _certificate_files(run)}
    short = certify(run, level=2, budget=1e-9)
    assert "what it states is unknown" in (short.summary["reason"] or "")
    assert {path: path.read_bytes() for path in _certificate_files(run)} == files
    done = certify(run, level=1)
    assert done.verdict == "proved"
    [aside] = (run.path / "certificate").glob("proof-*.json")
    assert aside.read_bytes() == files[run.path / "certificate" / "proof.json"]
    assert str(aside) in (done.summary["reason"] or "")
    # The same again says as much, and leaves nothing more behind.
    assert certify(run, level=1).summary.reason is None
    assert len(list((run.path / "certificate").glob("proof-*.json"))) == 1


def test_a_search_that_came_to_less_leaves_the_proof_that_is_there(gait, certificate, tmp_path):
    run = open_run(shutil.copytree(gait.path, tmp_path / "run"))
    files = {path: path.read_bytes() for path in _certificate_files(run)}
    assert any(path.name == "proof.json" for path in files)
    short = certify(run, level=2, budget=1e-9)
    assert (short.verdict, short.summary["proof"]) == ("undecided", None)
    assert "from before stays: it states level 1, and" in (short.summary["reason"] or "")
    assert {path: path.read_bytes() for path in _certificate_files(run)} == files
    # One that the run does not bear out is not deleted, either: somebody may mend the run.
    (run.path / "certificate" / "proof.json").write_bytes(b"{}")
    again = certify(run, level=2, budget=1e-9)
    unknown = "what it states is unknown, and check-proof tells whether it is a proof"
    assert unknown in (again.summary["reason"] or "")
    assert (run.path / "certificate" / "proof.json").read_bytes() == b"{}"


def _certificate_files(run):
    kept = ("summary.json", "proof.json", "map.safetensors")
    return [path for path in sorted((run.path / "certificate").iterdir()) if path.name in kept]


def test_an_interrupted_search_keeps_what_it_has(gait, certificate, tmp_path):
    bare = shutil.ignore_patterns("certificate")
    run = open_run(shutil.copytree(gait.path, tmp_path / "run", ignore=bare))
    shares = []

    def ctrl_c(share, boxes):
        del boxes
        shares.append(share)
        if len(shares) == 5:
            raise KeyboardInterrupt

    with pytest.raises(SearchInterrupted):
        certify(run, level=1, progress=ctrl_c)
    kept = json.loads((run.path / "certificate" / "summary.json").read_text())
    assert kept["verdict"] == "undecided"
    assert "interrupted" in kept["reason"]
    fractions = [entry["proved_fraction"] for entry in kept["conditions"].values()]
    assert 0.0 < np.mean(fractions) < 1.0
    proof = run.path / "certificate" / "proof.json"
    done = certify(run, level=1, resume=True)
    assert done.verdict == "proved"
    assert "reason" not in done.summary
    stated = {s.region: s for s in read_claims(proof).statements}
    whole = {s.region: s for s in read_claims(gait.path / "certificate" / "proof.json").statements}
    assert stated.keys() == whole.keys()
    for region, one in stated.items():
        for name, bound in one.bounds.items():
            assert bound > 0.5 * whole[region].bounds.get(name, 0.0)


def test_a_proof_of_what_cannot_be_traced_any_more_is_removed(gait, tmp_path, monkeypatch):
    run = open_run(shutil.copytree(gait.path, tmp_path / "run"))
    proof = run.path / "certificate" / "proof.json"
    proof.write_text("{}")

    def untraceable(*parts):
        raise SpecError("a kink in mine.py:7")

    monkeypatch.setattr(run_proof, "trace_certificate", untraceable)
    done = certify(run, level=1)
    assert (done.verdict, done.summary["proof"]) == ("undecided", None)
    assert "mine.py:7" in done.summary["reason"]
    assert not proof.exists()


def test_relu_is_undecided_and_says_why(relu_run, tmp_path):
    done = certify(shutil.copytree(relu_run.path, tmp_path / "run"))
    assert done.verdict == "undecided"
    assert done.summary["proof"] is None
    assert "max" in done.summary["reason"]
    assert all(v.verdict == "undecided" for v in done.conditions.values())


@pytest.mark.parametrize(
    ("options", "found"),
    [
        ({"level": 6}, "level 1"),
        ({"level": 0}, "level 1"),
        ({"disturbance": (-0.1, 0.0)}, "disturbance"),
        ({"disturbance": (0.1, 0.0), "level": 1}, "--level"),
        ({"budget": 0.0}, "budget"),
        ({"budget": float("nan")}, "budget"),
    ],
)
def test_bad_settings(gait, options, found):
    with pytest.raises(InputError, match=found):
        certify(gait, **options)


def test_resume_without_boxes(small_run, tmp_path):
    run = shutil.copytree(small_run.path, tmp_path / "run")
    with pytest.raises(RunError, match="boxes"):
        certify(run, level=1, resume=True)
