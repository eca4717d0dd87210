"""The C++ checker derives the conditions of families by formulas of its own: the Program's."""

import copy
import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.programs import POINT, evaluate
from neuralgaits.systems.cartpole.cartpole_verbs import SYSTEM as CARTPOLE
from neuralgaits.systems.family_certificate import certify_family
from neuralgaits.systems.family_run import open_family_run
from neuralgaits.systems.hopper.hopper_verbs import SYSTEM as HOPPER
from support.checker_case import bounds

pytestmark = pytest.mark.slow
POINTS = 20


@pytest.fixture(scope="module")
def hopper(small_hopper, tmp_path_factory) -> Path:
    return _proof(HOPPER, small_hopper, tmp_path_factory.mktemp("hopper"))


@pytest.fixture(scope="module")
def cartpole(small_cartpole, tmp_path_factory) -> Path:
    return _proof(CARTPOLE, small_cartpole, tmp_path_factory.mktemp("cartpole"))


def _proof(system, run: Path, folder: Path) -> Path:
    copied = open_family_run(system, shutil.copytree(run, folder / "run"))
    return Path(str(certify_family(copied).proof))


@pytest.mark.parametrize("family", ["cartpole", "hopper"])
def test_formulas_are_those_of_the_program(proofcheck, request, family):
    """Both at random points: one forms them from masses and weights, the other was traced."""
    proof = request.getfixturevalue(family)
    claims = read_claims(proof)
    axes = len(claims.chart.state)
    points = np.random.default_rng(0).uniform(0.05, 1.0, (POINTS, axes))
    values = evaluate(claims.program, {"u": points}, POINT)
    found = bounds(proofcheck, proof, points, points)
    assert len(found) == POINTS
    for row, enclosed in enumerate(found):
        assert set(enclosed) == set(values)
        for name, ranges in enclosed.items():
            value = values[name].reshape(POINTS, -1)[row]
            slack = 1e-9 * (1.0 + np.abs(value))
            assert np.all(ranges[:, 0] - slack <= value), name
            assert np.all(value <= ranges[:, 1] + slack), name
            assert np.all(ranges[:, 1] - ranges[:, 0] < slack), name


def test_a_hopper_is_proved_to_level_3_from_its_masses(proofcheck, hopper):
    answer = proofcheck(hopper)
    assert answer.returncode == 0, answer.stdout
    assert "level 2 proved" in answer.stdout and "level 3 proved" in answer.stdout
    assert "13 claims of 13 conditions" in answer.stdout
    for words in ("hub and wheel 7.5 kg", "foot 0.4 kg", "by the factor 1 / (1 + 0.2) a hop"):
        assert words in answer.stdout
    answer = proofcheck("--program", hopper)
    assert answer.returncode == 0 and "level 3 consistent" in answer.stdout


REFUSED = {
    "leans of no stance": lambda t: t["model"]["policy"].update(
        ends={"shape": [4], "values": [(x).hex() for x in (0.3, -0.3, 0.6, 0.0)]}
    ),
    "a polynomial without powers": lambda t: t["model"]["tube"].update(
        width={"shape": [], "values": [(1.0).hex()]}
    ),
    "a scale of nothing": lambda t: t["model"]["policy"].update(
        scale={"shape": [], "values": ["0x0p+0"]}
    ),
    "weight that pushes up": lambda t: t["model"]["robot"].update(gravity=(-9.81).hex()),
    "a foot of no mass": lambda t: t["model"]["robot"].update(foot_mass="0x0p+0"),
    "a leg that is too short": lambda t: t["model"]["robot"].update(longest=(0.5).hex()),
    "a floor of ice": lambda t: t["model"]["robot"].update(friction=(0.01).hex()),
    "a motor of 50 N": lambda t: t["model"]["robot"].update(force_limit=(50.0).hex()),
    "another tube": lambda t: t["model"]["tube"].update(
        weight={"shape": [2], "values": [(1.0).hex()] * 2}
    ),
    "a faster approach": lambda t: t["model"].update(rate=(0.5).hex()),
    "a condition more": lambda t: t["model"]["conditions"].update(safe={}),
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_hopper_that_is_another_is_refused(asked, hopper, name):
    table = copy.deepcopy(json.loads(hopper.read_text()))
    REFUSED[name](table)
    assert asked(table).returncode in (1, 2)


def test_without_a_premise_no_level_follows(asked, hopper):
    """Level 3 rests on all conditions, level 2 on all but those of distances."""
    table = json.loads(hopper.read_text())
    for name, levels in (("closer", "2"), ("low fence", "")):
        spoilt = copy.deepcopy(table)
        spoilt["statements"] = [s for s in spoilt["statements"] if s["conditions"] != [name]]
        answer = asked(spoilt)
        assert answer.returncode == 3 and "have none on 1 boxes" in answer.stdout
        assert [line for line in answer.stdout.splitlines() if line.startswith("level ")] == [
            f"level {level} proved" for level in levels
        ]
