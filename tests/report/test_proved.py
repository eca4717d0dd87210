"""What figures say is proved: read from a certificate, and only from one of these weights."""

import hashlib
import json
import math
import shutil

import pytest

from neuralgaits.certificate.full_order_theorem import BarrierConstants, FullOrder
from neuralgaits.certificate.theorem_tables import Theorems
from neuralgaits.certificate.theorems import Orbit, WalkingSet
from neuralgaits.workflows.proved import certificate_of
from neuralgaits.workflows.run import open_run

LOW, HIGH = 72.0, 84.5
"""Fences of a thin tube, zeta = z2^2 / 2: z2 from 12 to 13 kg m^2/s."""
WALKING = WalkingSet(0.0, 0.0, 0.1, 0.8, (0.0, 0.0), (), ())
ORBIT = Orbit("contraction", 0.9, 1.1, (LOW, 0.0, 0.0), (HIGH, 0.0), (0.1,), (0.1,), (0.2,))
BARRIER = BarrierConstants("torso-lower", 1.0, 0.1, 1.0, 4.0, 0.1, 0.1, 16.0)
FULL = FullOrder(
    30.0, 0.01, 3.0, 1e-3, 0.0, 0.0, 0.0, 0.1, (1.0, 2.0), 5.0, 0.0, 0.0, 2.0, 0.0, 0.0, (BARRIER,)
)


@pytest.fixture
def certified(run, tmp_path):
    folder = tmp_path / "run"
    shutil.copytree(run.path, folder)
    write(folder, "proof.json", Theorems(WALKING, ORBIT, claimed=(2, 3)))
    write(folder, "full-order.json", Theorems(full=FULL, claimed=(4,)))
    levels = [
        {"level": 2, "verdict": "proved", "figures": {}},
        {
            "level": 3,
            "verdict": "proved",
            "figures": {"multiplier_at_least": 0.6, "multiplier_at_most": 0.7},
        },
        {"level": 4, "verdict": "proved", "figures": {"r_bar": 0.005, "gamma": 45.0}},
    ]
    save(folder, levels)
    return open_run(folder)


def write(folder, name, theorems):
    (folder / "certificate").mkdir(exist_ok=True)
    files = ("policy.safetensors", "robot.xml", "spec.py")
    weights, robot, spec = (
        hashlib.sha256((folder / file).read_bytes()).hexdigest() for file in files
    )
    content = {
        "weights_sha256": weights,
        "robot": {"sha256": robot},
        "spec": {"sha256": spec},
        "theorems": theorems.tables(),
    }
    (folder / "certificate" / name).write_text(json.dumps(content))


def save(folder, levels):
    conditions = {
        "knee": {"verdict": "proved", "margin": 0.25},
        "torso-lower": {"verdict": "proved", "margin": None},
    }
    content = {"conditions": conditions, "level": 4, "levels": levels}
    (folder / "certificate" / "summary.json").write_text(json.dumps(content))


def test_the_enclosure_is_the_thin_tube_at_mid_step(certified):
    found = certificate_of(certified)
    assert found.reason is None and found.level == 4
    assert found.orbit is not None
    assert found.orbit.z2 == pytest.approx((12.0, 13.0))
    assert found.orbit.multiplier == (0.6, 0.7)
    assert found.orbit.contraction is None
    assert found.margins == {"knee": 0.25}


def test_the_thin_tube_is_read_at_the_hip_above_the_foot(certified):
    """Series that are not constant: a fence linear in z1, through zeta = 72 at z1 = 0."""
    start, guard = (float(end) for end in certified.gait.span)
    middle, half = 0.5 * (start + guard), 0.5 * (guard - start)
    lower = (72.0 + 10.0 * middle, 10.0 * half)
    shape = Orbit("contraction", 0.9, 1.1, lower, (HIGH,), (0.1,), (0.1,), (0.2,))
    write(certified.path, "proof.json", Theorems(WALKING, shape, claimed=(2, 3)))
    found = certificate_of(certified).orbit
    assert found is not None
    assert found.z2[0] == pytest.approx(12.0, rel=1e-12)


def test_the_set_of_level_4_keeps_its_constants(certified):
    full = certificate_of(certified).full
    assert full is not None
    # t = l_P^2 / (4 sigma): what the barrier loses to what it reads on the robot.
    assert full.tightening["torso-lower"] == 16.0 / 64.0
    assert full.room("torso-lower", 0.25 + 16.0 * 0.01**2) == pytest.approx(0.01)
    assert full.room("torso-lower", 0.2) == 0.0
    assert full.tube(0.5) == pytest.approx(0.01 * math.exp(-0.75))


@pytest.mark.parametrize("file", ["proof.json", "full-order.json"])
@pytest.mark.parametrize(
    ("other", "what"),
    [
        ({"weights_sha256": "0" * 64}, "policy.safetensors"),
        ({"robot": {"sha256": "0" * 64}}, "robot.xml"),
        ({"spec": {"sha256": "0" * 64}}, "spec.py"),
    ],
)
def test_a_proof_about_other_files_proves_nothing(certified, file, other, what):
    proof = certified.path / "certificate" / file
    content = json.loads(proof.read_text()) | other
    proof.write_text(json.dumps(content))
    found = certificate_of(certified)
    assert found.reason == f"certificate/{file} is about another {what} than the run's"
    assert (found.level, found.orbit, found.full, dict(found.margins)) == (0, None, None, {})


def test_a_level_that_is_open_is_not_claimed_nor_those_above(certified):
    summary = certified.path / "certificate" / "summary.json"
    levels = json.loads(summary.read_text())["levels"]
    levels[1]["verdict"] = "undecided"
    levels[2] |= {"verdict": "undecided", "reason": "time was up"}
    save(certified.path, levels)
    found = certificate_of(certified)
    assert (found.level, found.orbit, found.full) == (2, None, None)
    assert found.no_full == "time was up"


@pytest.mark.parametrize("content", ["{}", '{"conditions": []}', "not json", "[1]"])
def test_a_damaged_certificate_is_none(certified, content):
    (certified.path / "certificate" / "summary.json").write_text(content)
    found = certificate_of(certified)
    assert found.reason is not None
    assert found.level == 0
