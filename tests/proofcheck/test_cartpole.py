"""Proofs of cart-poles, by both checkers: what is derived, and what is refused."""

import copy
import json
import shutil
from pathlib import Path

import pytest

from neuralgaits.certificate.proof_file.check import check
from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.errors import InputError
from neuralgaits.systems.cartpole import LEVELS
from neuralgaits.systems.cartpole.cartpole_verbs import SYSTEM
from neuralgaits.systems.family_certificate import certify_family
from neuralgaits.systems.family_run import open_family_run

HALF = [(0.5).hex()] + [(1.0).hex()] * 3
QUICK = ("rail", "upright", "force", "inward")
"""Conditions whose statements have few boxes."""

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def proof(small_cartpole, tmp_path_factory) -> Path:
    run = shutil.copytree(small_cartpole, tmp_path_factory.mktemp("cartpole") / "run")
    return Path(str(certify_family(open_family_run(SYSTEM, run)).proof))


@pytest.fixture(scope="module")
def table(proof):
    return json.loads(proof.read_text())


def quick(table):
    """A copy without the statements of many boxes."""
    found = copy.deepcopy(table)
    found["statements"] = [s for s in found["statements"] if s["conditions"][0] in QUICK]
    return found


def written(table, tmp_path) -> Path:
    path = tmp_path / "proof.json"
    path.write_text(json.dumps(table))
    return path


def test_the_second_checker_derives_every_condition_and_both_levels(proofcheck, proof):
    answer = proofcheck(proof)
    assert answer.returncode == 0, answer.stdout
    assert "level 2 proved" in answer.stdout
    assert "level 3 proved" in answer.stdout
    assert "6 claims of 6 conditions" in answer.stdout


def test_it_bounds_the_program_as_well(proofcheck, table, tmp_path):
    answer = proofcheck("--program", written(quick(table), tmp_path))
    assert answer.returncode == 3  # Two conditions are not claimed.
    assert "level 2 consistent" in answer.stdout
    assert "level 3" not in answer.stdout


@pytest.mark.parametrize(
    ("change", "code"),
    [
        (lambda t: t["model"]["robot"].update(force_limit=(0.01).hex()), 1),
        (lambda t: t["model"]["robot"].update(rail_high=(-1.799).hex()), 1),
        (lambda t: t["model"]["robot"].update(pole_mass="0x0p+0"), 2),
        (lambda t: t["model"].update(rate=(-1.0).hex()), 2),
        (lambda t: t["model"].update(family="pendulum"), 3),
        (lambda t: t["model"].pop("ball"), 2),
        (
            lambda t: t["model"]["regions"]["set"][0].update(
                high=[(0.5).hex()] + [(1.0).hex()] * 3
            ),
            1,
        ),
        (lambda t: t["model"]["conditions"]["inward"].update(region="core"), 1),
        (lambda t: t["chart"][1].update(name="angle"), 1),
        (lambda t: t["chart"][0].update(name="phase"), 2),
        (lambda t: t["statements"][0].update(tree="-"), 3),
    ],
)
def test_the_second_checker_refuses_a_changed_file(proofcheck, table, tmp_path, change, code):
    spoilt = quick(table)
    change(spoilt)
    answer = proofcheck(written(spoilt, tmp_path))
    assert answer.returncode == code, answer.stdout + answer.stderr


FORGED = {
    "no room for the pole": lambda t: robot(t).update(lean=(-0.1).hex()),
    "a lean beyond level": lambda t: robot(t).update(lean=(3.0).hex()),
    "a turn of five": lambda t: robot(t).update(turn=(5.0).hex()),
    "no gear": lambda t: robot(t).update(gear="nan"),
    "no force": lambda t: robot(t).update(force_limit="0x0p+0"),
    "weight that pushes up": lambda t: robot(t).update(gravity=(-9.81).hex()),
    "no weight": lambda t: robot(t).update(gravity="0x0p+0"),
    "a rotor that is lighter than nothing": lambda t: robot(t).update(pole_armature=(-1.0).hex()),
    "damping that drives": lambda t: robot(t).update(cart_damping=(-5.0).hex()),
    "a pole without inertia": lambda t: robot(t).update(pole_inertia=(-1.0).hex()),
    "a rail of no length": lambda t: robot(t).update(rail_low=robot(t)["rail_high"]),
    "a number more": lambda t: robot(t).update(wheels=(2.0).hex()),
    "no rate": lambda t: t["model"].update(rate="0x0p+0"),
    "a rate of text": lambda t: t["model"].update(rate="fast"),
    "a policy of another run": lambda t: t["model"]["policy"].update(
        scale={"shape": [3], "values": [(2.0).hex()] * 3}
    ),
    "a set ten times as wide": lambda t: t["model"]["ball"].update(
        shape={"shape": [4, 4], "values": [(10.0 * (k % 5 == 0)).hex() for k in range(16)]}
    ),
    "a set that is no triangle": lambda t: t["model"]["ball"].update(
        shape={"shape": [4, 4], "values": [(0.05).hex()] * 16}
    ),
    "a decay of one number": lambda t: t["model"]["decay"].update(
        scale={"shape": [1], "values": [(1.0).hex()]}
    ),
}


def robot(table):
    return table["model"]["robot"]


@pytest.mark.parametrize("name", FORGED)
def test_the_second_checker_takes_no_forged_model(proofcheck, table, tmp_path, name):
    spoilt = quick(table)
    spoilt["statements"] = spoilt["statements"][:1]
    FORGED[name](spoilt)
    answer = proofcheck(written(spoilt, tmp_path))
    assert answer.returncode in (1, 2), answer.stdout + answer.stderr


def test_masses_of_another_robot_are_not_proved(proofcheck, table, tmp_path):
    spoilt = copy.deepcopy(table)
    spoilt["model"]["robot"]["distance"] = (2.0).hex()
    assert proofcheck(written(spoilt, tmp_path)).returncode == 1


def test_the_first_checker_bounds_the_program_and_draws_level_2(table, tmp_path):
    small = quick(table)
    claims = read_claims(written(small, tmp_path))
    report = check(claims)
    assert report.verdict == "undecided"  # Two conditions are not claimed.
    assert set(report.unclaimed) == {"descent", "settling"}
    levels = LEVELS.with_levels(report, claims).levels
    assert [(one.level, one.verdict) for one in levels] == [(2, "consistent")]


def test_the_first_checker_rejects_regions_that_are_not_the_specs(table, tmp_path):
    spoilt = quick(table)
    low = ["0x0p+0"] * 4
    spoilt["model"]["regions"]["core"][0] = {"low": low, "high": [(0.1).hex()] + [(1.0).hex()] * 3}
    claims = read_claims(written(spoilt, tmp_path))
    report = LEVELS.with_levels(check(claims), claims)
    assert (report.verdict, report.levels) == ("rejected", ())


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda t: t["model"].pop("family"), "another family"),
        (lambda t: t["chart"][0].update(name="level"), "does not begin with phase and level"),
        (lambda t: t["chart"][1].update(change="0x1p-1"), "coupled"),
    ],
)
def test_a_chart_of_another_family_than_the_model_is_refused(table, tmp_path, change, said):
    spoilt = quick(table)
    change(spoilt)
    with pytest.raises(InputError, match=said):
        read_claims(written(spoilt, tmp_path))
