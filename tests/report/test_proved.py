"""What figures say is proved: read from a certificate, as far as its proof files bear it out."""

import json
import math
import shutil

import pytest
from numpy.polynomial.chebyshev import chebval

from neuralgaits.analysis.run import open_run
from neuralgaits.certificate.levels.full_order.theorem import BarrierConstants, FullOrderConstants
from neuralgaits.certificate.levels.orbit.theorem import OrbitConstants
from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.certificate.run_certificate.verified_summary import (
    UNCHECKED,
    hashes,
    read_certificate,
)
from neuralgaits.records.certified import Conclusion
from neuralgaits.report import certificate as proved
from neuralgaits.report.certificate import certificate_of
from neuralgaits.runs import RunFolder
from neuralgaits.viewer.sureness import how_sure
from neuralgaits.workflows import demo

LOW, HIGH = 72.0, 84.5
"""Fences of a thin tube, zeta = z2^2 / 2: z2 from 12 to 13 kg m^2/s."""
BARRIER = BarrierConstants("torso-lower", 1.0, 0.1, 1.0, 4.0, 0.1, 0.1, 16.0)
FULL = FullOrderConstants(
    30.0, 0.01, 3.0, 1e-3, 0.0, 0.0, 0.0, 0.1, (1.0, 2.0), 5.0, 0.0, 0.0, 2.0, 0.0, 0.0, (BARRIER,)
)
PROVED = Conclusion(3, "proved", None, (), {"multiplier_at_least": 0.6, "multiplier_at_most": 0.7})


@pytest.fixture
def certified(tmp_path):
    """The run that ships with the package, proved to level 3."""
    return open_run(shutil.copytree(demo.FOLDER, tmp_path / "run"))


def change(run, name, how):
    file = run.path / "certificate" / name
    file.write_text(json.dumps(how(json.loads(file.read_text()))))


def test_bounds_and_enclosure_are_those_of_the_proof(certified):
    found = certificate_of(certified)
    assert found.reason is None and found.level == 3
    claims = read_claims(certified.path / "certificate" / "proof.json")
    theorem = claims.theorems.orbit
    assert found.orbit is not None and theorem is not None
    start, guard = (float(end) for end in certified.gait.span)
    middle = -2.0 * start / (guard - start) - 1.0
    for seen, side in zip(found.orbit.z2, (theorem.lower, theorem.upper), strict=True):
        assert 0.5 * seen**2 == pytest.approx(chebval(middle, side), rel=1e-12)
    (knee,) = [
        s.bounds["knee"] for s in claims.statements if s.region == "tube" and "knee" in s.bounds
    ]
    assert found.margins["knee"] == knee
    assert len(found.margins) == 27
    assert 0.6 < found.orbit.multiplier[0] < found.orbit.multiplier[1] < 0.8
    assert found.map_fits


def test_the_thin_tube_is_read_at_the_hip_above_the_foot(certified):
    """Series that are not constant: a fence linear in z1, through zeta = 72 at z1 = 0."""
    start, guard = (float(end) for end in certified.gait.span)
    middle, half = 0.5 * (start + guard), 0.5 * (guard - start)
    lower = (72.0 + 10.0 * middle, 10.0 * half)
    shape = OrbitConstants("contraction", 0.9, 1.1, lower, (HIGH,), (0.1,), (0.1,), (0.2,))
    found = proved.tube_around_orbit(certified, PROVED, shape)
    assert found is not None
    assert found.z2 == pytest.approx((12.0, 13.0), rel=1e-12)
    assert found.multiplier == (0.6, 0.7) and found.contraction is None


def test_walks_that_come_together_around_no_one_orbit_have_no_thin_tube(certified):
    """Level 3 of a gait that takes commands: the proof has no fences of a thin tube."""
    shape = OrbitConstants("any two walks", expansion=(0.1,))
    together = Conclusion(3, "proved", None, ("converge",), {"contraction_at_most": 0.95})
    assert proved.tube_around_orbit(certified, together, shape) is None


def test_the_set_of_level_4_keeps_its_constants():
    full = proved.full_order_set(
        Conclusion(4, "proved", None, (), {"r_bar": 0.005, "gamma": 45.0}), FULL
    )
    assert full is not None
    # t = l_P^2 / (4 sigma): what the barrier loses to what it reads on the robot.
    assert full.tightening["torso-lower"] == 16.0 / 64.0
    assert full.room("torso-lower", 0.25 + 16.0 * 0.01**2) == pytest.approx(0.01)
    assert full.room("torso-lower", 0.2) == 0.0
    assert full.tube(0.5) == pytest.approx(0.01 * math.exp(-0.75))


@pytest.mark.parametrize(
    ("file", "what"),
    [("policy.safetensors",) * 2, ("robot.xml",) * 2, ("spec.py",) * 2],
)
def test_a_proof_about_other_files_proves_nothing(certified, file, what):
    path = certified.path / file
    path.write_bytes(path.read_bytes() + b" ")
    found = certificate_of(certified)
    assert f"another {what} " in str(found.reason)
    assert (found.level, found.orbit, found.full, dict(found.margins)) == (0, None, None, {})


@pytest.mark.parametrize(
    ("other", "what"),
    [
        ({"weights_sha256": "0" * 64}, "policy.safetensors"),
        ({"robot": {"name": "amber3m", "sha256": "0" * 64}}, "robot.xml"),
        ({"spec": {"name": "paper", "sha256": "0" * 64}}, "spec"),
        ({"theorems": [], "program_hash": "0"}, "damaged"),
        ({"statements": []}, "no statements"),
        ({"model": None}, None),
    ],
)
def test_a_proof_that_is_not_the_runs_own_proves_nothing(certified, other, what):
    change(certified, "proof.json", lambda proof: proof | other)
    change(certified, "summary.json", lambda summary: summary | {"sha256": hashes(certified.path)})
    found = certificate_of(certified)
    assert (found.level == 3) is (what is None)
    if what is not None:
        assert what in str(found.reason) and found.orbit is None


def test_a_proof_of_the_rigid_model_is_not_about_learned_dynamics(certified):
    (certified.path / "residual.safetensors").write_bytes(b"learned")
    found = certificate_of(certified)
    assert "another residual.safetensors" in str(found.reason)
    change(certified, "summary.json", lambda summary: summary | {"sha256": hashes(certified.path)})
    found = certificate_of(certified)
    assert found.level == 0
    assert "dynamics carry a residual" in str(found.reason)


def without_a_cone(described):
    row = next(row for row in described["conditions"] if row["name"] == "friction-forward")
    row["quantity"]["coefficient"] = 0.01


def slower(described):
    described["commands"][0]["low"] = 0.3


@pytest.mark.parametrize(
    ("folder", "how", "what"),
    [
        (demo.FOLDER, without_a_cone, "found other conditions"),
        (demo.TOLD, without_a_cone, "found other conditions"),
        (demo.TOLD, slower, "other commands"),
    ],
)
def test_a_config_that_says_otherwise_than_the_proof_proves_nothing(tmp_path, folder, how, what):
    run = shutil.copytree(folder, tmp_path / "run")
    asked = json.loads((run / "config.json").read_text())
    how(asked["described"])
    (run / "config.json").write_text(json.dumps(asked))
    found = read_certificate(RunFolder.open(run))
    assert found.summary is None and what in str(found.reason)


def without_strips(proof):
    """A cone that holds on its region alone."""
    name = "friction-forward"
    proof["theorems"][0]["parameters"]["carried"].remove(name)
    for statement in proof["statements"]:
        low, high = (float.fromhex(statement["root"][end][0]) for end in ("low", "high"))
        if name in statement["conditions"] and (low < 0.0 or high > 1.0):
            statement["conditions"].remove(name)
            for field in ("scales", "bounds"):
                del statement[field][name]
    proof["statements"] = [one for one in proof["statements"] if one["conditions"]]


@pytest.mark.parametrize(
    ("least", "change_of_proof", "what"),
    [
        (0.44, None, "less friction than its conditions ask for"),
        (
            0.5,
            without_strips,
            "carried of level 2 are not all those",
        ),
        (0.5, None, None),
    ],
)
def test_friction_is_stated_where_the_proof_carries_its_cones(
    certified, least, change_of_proof, what
):
    if change_of_proof is not None:
        change(certified, "proof.json", lambda proof: change_of_proof(proof) or proof)
    told = {"parameters": {"friction": least}}
    change(
        certified,
        "summary.json",
        lambda summary: summary | told | {"sha256": hashes(certified.path)},
    )
    found = read_certificate(certified.folder)
    if what is None:
        assert found.reason is None
    else:
        assert found.summary is None and what in str(found.reason)


def test_no_floor_is_stated_where_the_level_that_speaks_of_it_is_not_claimed(certified):
    def unclaimed(proof):
        for theorem in proof["theorems"]:
            theorem["claimed"] = False
        proof["theorems"][0]["parameters"]["floor"] = (10.0).hex()
        return proof

    change(certified, "proof.json", unclaimed)
    told = {"parameters": {"floor": 10.0}, "level": 1, "levels": []}
    change(
        certified,
        "summary.json",
        lambda summary: summary | told | {"sha256": hashes(certified.path)},
    )
    found = read_certificate(certified.folder).summary
    assert found is not None and not found.parameters


def test_a_map_of_another_proof_is_not_shown(certified):
    file = certified.path / "certificate" / "map.safetensors"
    file.write_bytes(file.read_bytes() + b" ")
    found = certificate_of(certified)
    assert (found.level, found.map_fits) == (3, False)
    assert not how_sure(certified).map_fits


def test_margins_of_what_is_not_proved_are_none(certified):
    def opened(summary):
        summary["conditions"]["knee"] |= {
            "verdict": "undecided",
            "margin": 99.0,
            "undecided_boxes": 1,
        }
        return summary

    change(certified, "summary.json", opened)
    found = read_certificate(certified.folder)
    assert found.summary is not None
    assert found.summary["conditions"]["knee"]["margin"] is None
    assert found.summary["verdict"] == "undecided"


def test_level_3_stands_on_level_2(certified):
    def opened(summary):
        summary["levels"][0] |= {"verdict": "undecided", "reason": "no"}
        return summary

    change(certified, "summary.json", opened)
    assert "calls level 3 proved, and level 2 not" in str(certificate_of(certified).reason)


def test_a_file_that_was_exchanged_proves_nothing(certified):
    change(certified, "proof.json", lambda proof: proof | {"model": None})
    found = certificate_of(certified)
    assert "certificate/proof.json is damaged, or not the file" in str(found.reason)
    assert found.level == 0


def test_a_level_that_is_open_is_not_claimed_nor_those_above(certified):
    def opened(summary):
        summary["levels"][1] |= {"verdict": "undecided"}
        further = {"verdict": "undecided", "reason": "time was up", "words": [], "figures": {}}
        summary["levels"].append({"level": 4} | further)
        summary["level"] = 4
        return summary

    change(certified, "summary.json", opened)
    found = certificate_of(certified)
    assert (found.level, found.orbit, found.full) == (2, None, None)
    assert found.no_full == f"{UNCHECKED} “time was up”"


@pytest.mark.parametrize("content", ["{}", '{"conditions": []}', "not json", "[1]", "[" * 99_999])
def test_a_damaged_certificate_is_none(certified, content):
    (certified.path / "certificate" / "summary.json").write_text(content)
    found = certificate_of(certified)
    assert found.reason is not None
    assert found.level == 0
