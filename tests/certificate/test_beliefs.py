"""Proofs of gaits that are told a lean: about robots near what they believe, and no others."""

import copy
import json
import shutil
from dataclasses import replace

import numpy as np
import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.barriers import specs
from neuralgaits.certificate.chart import NEAR_BELIEF, Chart
from neuralgaits.certificate.levels.levels import conclude
from neuralgaits.certificate.levels.walking_set.find import PAIRS, over_all
from neuralgaits.certificate.levels.walking_set.theorem import (
    WalkingSetConstants,
    walking_premises,
)
from neuralgaits.certificate.proof_file.theorem_tables import Theorems
from neuralgaits.certificate.run_certificate.retrace import describe_run
from neuralgaits.errors import InputError
from neuralgaits.records import certificate_sentences
from neuralgaits.robots import load_robot
from neuralgaits.robots.mjcf.parameters import axes_of, box_of
from neuralgaits.settings.forms import box_word
from neuralgaits.workflows.certify import certify
from neuralgaits.workflows.check_proof import check_proof
from support.commanded_run import LEANS, SPEED, make
from support.own_spec import run_with

OWN = """
from dataclasses import replace

from neuralgaits.barriers import Pointwise, functions as f, specs
from neuralgaits.gait.commands import Command


def mine(robot):
    spec = specs.commanded(robot, (Command("lean", -0.012, 0.012, 0.0048),))
    inertia = Pointwise("transversal", "guard", 10.0, f.at_least(f.transversal_inertia, 1.0))
    fall = Pointwise("fall", "guard", 10.0, f.at_least(moment, 1.0))
    return replace(spec, name="mine", conditions=(inertia, fall), weights={}, aims=(),
                   recipe=replace(spec.recipe, samples={"guard": 4}))


def moment(p):
    return p.dz[1]
"""


@pytest.fixture(scope="module")
def near():
    """The axis of how far the robot is from the belief."""
    return tuple(axes_of(load_robot("amber3m"), {"lean": 0.003}))


@pytest.fixture(scope="module")
def bounds():
    """Constants of a walking set of a gait that is told a lean, and bounds that prove it."""
    shape = WalkingSetConstants(1e-3, 2e-3, 0.1, 0.8, (0.0, 0.0), (), (), ("lean",))
    constants = {"set/reset-place": -1e-5, "set/steepness": -0.1}
    found = {
        (p.output, p.low, p.high): constants.get(p.output, 0.25) for p in walking_premises(shape)
    }
    return shape, found


def test_what_follows_is_about_robots_near_their_belief(near, bounds):
    shape, proved = bounds
    (found,) = conclude({2: shape}, [], proved, Chart.of((LEANS,), near))
    assert found.verdict == "proved" and "lean from -0.012 to 0.012" in found.words[-2]
    assert found.words[-1] == (
        "this holds for every robot whose lean stays within 0.003 m of what it believes at each "
        "touchdown, whatever sequence of beliefs it is told; of a robot further from its belief it "
        "says nothing"
    )


@pytest.mark.parametrize("axes", ["none", "mass", "both"])
def test_nothing_follows_of_a_robot_that_is_where_it_believes_to_be(near, bounds, axes):
    """A true lean that changes with every belief is no robot's."""
    shape, proved = bounds
    mass = axes_of(load_robot("amber3m"), {"mass": 0.01})
    errors = {"none": (), "mass": mass, "both": (*mass, *near)}[axes]
    (found,) = conclude({2: shape}, [], proved, Chart.of((LEANS,), errors))
    assert found.verdict == "undecided" and "distance from a belief" in str(found.reason)


def test_nothing_follows_of_a_distance_from_what_is_not_told(near, bounds):
    shape, proved = bounds
    speeds = replace(shape, told=("speed",))
    (found,) = conclude({2: speeds}, [], proved, Chart.of((SPEED,), near))
    assert found.verdict == "undecided" and "distance from a belief" in str(found.reason)
    (plain,) = conclude({2: speeds}, [], proved, Chart.of((SPEED,)))
    assert plain.verdict == "proved" and "believes" not in " ".join(plain.words)


def test_sets_are_looked_for_once_with_each_robot(near):
    """The belief itself and both ends of the distance from it, with every pair of beliefs."""
    spec = replace(specs.commanded(load_robot("amber3m"), (LEANS,)), parameters=near)
    rows = []

    def look(points):
        rows.append(points)
        return {"foot": points[:, 0]}

    assert len(over_all(spec, look)(np.array([[0.5, 0.0]]))["foot"]) == 3 * PAIRS**2
    (points,) = rows
    assert len(np.unique(points[:, 4])) == 3 and np.ptp(points[:, 4]) == 0.006


def test_the_axis_is_known_by_its_name(near):
    (axis,) = near
    assert axis.name.endswith(NEAR_BELIEF)
    assert box_of(load_robot("amber3m"), near) == {"lean": 0.003}
    assert box_word({"lean": 0.003}) == "lean=0.003m"


@pytest.fixture(scope="module")
def proved(tmp_path_factory):
    """A run of a spec with two conditions for a gait that is told a lean, with their proof."""
    base = tmp_path_factory.mktemp("beliefs")
    family = make(base / "family", LEANS)
    config = json.loads((family.path / "config.json").read_text())
    # A user's own spec brings its commands itself.
    (family.path / "config.json").write_text(json.dumps(config | {"commands": {}}))
    run = run_with(family, base / "run", OWN)
    done = certify(run, level=1)
    assert done.verdict == "proved"
    assert done.summary.parameters == {"lean": 0.003}
    assert done.summary.all_robots is not None
    assert "within 3 mm of where it believes it" in done.summary.all_robots
    return run


@pytest.mark.slow
def test_beliefs_are_proved_and_checked(proved):
    found = check_proof(proved / "certificate" / "proof.json", run=proved)
    assert (found.verdict, found.reason) == ("proved", None)
    assert "beyond the belief (error in m) in [-0.003, 0.003]" in found.statements[0]
    assert open_run(proved).trained.commands == (LEANS,)


def _roots(table):
    for statement in table["statements"]:
        for end in ("low", "high"):
            statement["root"][end][2:] = [axis[end] for axis in table["chart"][2:]]


def _further(table):
    table["chart"][4].update(low=(-0.3).hex(), high=(0.3).hex())
    _roots(table)


def _wider(table):
    for axis in table["chart"][2:4]:
        axis.update(low=(-0.02).hex(), high=(0.02).hex())
    _roots(table)


def _faster(table):
    table["chart"][3]["change"] = (0.0096).hex()


def _renamed(table):
    table["chart"][4]["name"] = "mass of torso (relative error)"


@pytest.mark.slow
@pytest.mark.parametrize("forge", [_further, _wider, _faster, _renamed])
def test_other_robots_or_beliefs_than_were_proved_are_refused(proved, tmp_path, forge):
    table = json.loads((proved / "certificate" / "proof.json").read_text())
    forged = copy.deepcopy(table)
    forge(forged)
    file = tmp_path / "forged.json"
    file.write_text(json.dumps(forged))
    try:
        assert check_proof(file, run=proved).verdict == "rejected"
    except InputError as error:
        assert "expected a proof about the robots of the run's gait" in str(error)


@pytest.mark.slow
def test_no_proof_is_about_a_robot_that_is_where_it_believes_to_be(proved):
    with pytest.raises(InputError, match="told a lean with a box of none"):
        describe_run(proved, Theorems(), Chart.of((LEANS,)))


@pytest.mark.slow
def test_other_boxes_are_refused_and_a_narrower_one_is_proved(proved, tmp_path, trained):
    for box, words in (
        ({}, "told a lean with a box of none: give --parameters lean=SIZE alone"),
        ({"mass": 0.01}, "a box of mass"),
        ({"mass": 0.01, "lean": 0.001}, "a box of mass, lean"),
    ):
        with pytest.raises(InputError, match=words):
            certify(proved, level=1, parameters=box)
    with pytest.raises(InputError, match="a gait that is told no lean: leave lean out"):
        certify(trained, level=1, parameters={"lean": 0.003})
    run = shutil.copytree(proved, tmp_path / "run")
    done = certify(run, level=1, parameters={"lean": 0.001})
    assert done.verdict == "proved" and done.summary.robots == "lean=1mm"


def test_a_page_says_which_robots_it_is_about():
    rigid, _ = certificate_sentences.assumptions(1, "lean=3mm")
    assert "torso's centre of mass, which is up to 3mm from where the robot believes it" in rigid
    assert "lean" not in certificate_sentences.assumptions(1, "mass=1%")[0]
