"""Plain words exist for everything that the package itself defines."""

import inspect as introspection
import json

import pytest

from neuralgaits.barriers import functions, specs
from neuralgaits.records import certificate_sentences
from neuralgaits.records.level_words import ON_TARGET, WORDS
from neuralgaits.report.page import phrases
from neuralgaits.robots import load_robot
from neuralgaits.simulation.setup.disturbance import PlantChanges
from support.shipped_run import SHIPPED


@pytest.mark.parametrize("name", sorted(specs.BUILT_IN))
def test_every_condition_of_a_built_in_spec_has_words(name):
    robot = load_robot("amber3m-feet" if "flat" in name else "amber3m")
    for condition in specs.load(name, robot).describe()["conditions"]:
        said = phrases.condition(condition)
        assert "written by the user" not in said and "_" not in said, condition["name"]
        assert not said.startswith(("at least", "at most")), condition["name"]
        assert phrases.region(condition["region"])


@pytest.mark.parametrize("folder", ["demo_run", "demo_speed_run"])
def test_every_condition_of_a_shipped_run_has_words(folder):
    config = json.loads((SHIPPED.with_name(folder) / "config.json").read_text())
    for condition in config["described"]["conditions"]:
        assert "written by the user" not in phrases.condition(condition), condition["name"]


def test_every_quantity_has_words_and_a_unit():
    plain = [
        name
        for name, value in vars(functions).items()
        if introspection.isfunction(value) and value.__module__ == functions.__name__
    ]
    assert len(plain) > 15
    for name in plain:
        inner = {"function": "at_least", "of": {"function": name}, "bound": 0.5}
        said = phrases.quantity(inner)
        assert said.endswith(("m", "s", "rad", "N", "m²", "rad²", "kg m²/s", "m²/s²")), said
        assert name not in said.split(" ≥")[0].split() or "_" not in name


def test_a_barrier_says_how_fast_it_may_be_approached():
    inner = {"function": "at_most", "of": {"function": "torso_angle"}, "bound": 0.08}
    said = phrases.condition({"kind": "Barrier", "quantity": inner, "alpha": [4.0, 9.0]})
    assert said.startswith("lean of the torso backwards ≤ 0.08 rad")
    forwards = inner | {"function": "at_least", "bound": -0.25}
    assert phrases.quantity(forwards) == "lean of the torso forwards ≤ 0.25 rad"
    # A torso that must lean is bounded by its angle.
    assert "≥ 0.1 rad" in phrases.quantity(forwards | {"bound": 0.1})
    assert "≤ 0.08 rad" in said and "at 4 or 9 per second times" in said


def test_conditions_of_one_sentence_are_told_apart_by_their_regions():
    described = specs.load("walking", load_robot("amber3m")).describe()["conditions"]
    said = phrases.told_apart({one["name"]: one for one in described})
    assert len(set(said.values())) == len(described)
    assert said["foot-falls"].startswith("end of the step: vertical velocity")
    assert said["guard-transversal"].startswith("at touchdown: vertical velocity")


def test_a_users_own_condition_is_named_and_not_explained():
    assert "mine" in phrases.condition({"user": "mine", "name": "x"})
    inner = {"function": "at_least", "of": {"user": "my_quantity"}, "bound": 1.0}
    assert "my_quantity" in phrases.condition({"kind": "Pointwise", "quantity": inner})


def test_the_gist_of_a_spec_names_only_what_it_asks_for():
    robot = load_robot("amber3m")
    asked = phrases.gist(specs.load("walking", robot).describe()["conditions"])
    assert "ground that only pushes" in asked and len(asked) == len(set(asked))
    papers = phrases.gist(specs.load("paper", robot).describe()["conditions"])
    # The paper bounds no contact force.
    assert papers and not {"ground that only pushes", "feet that do not slip"} & set(papers)


def test_every_disturbance_has_words():
    changed = {name: 0.5 for name in vars(PlantChanges())}
    said = phrases.changes(changed)
    assert len(said) == len(changed)
    assert not {f"{name} 0.5" for name in changed} & set(said)
    assert phrases.changes(vars(PlantChanges())) == []
    assert phrases.disturbances(vars(PlantChanges())) == {}


def test_ten_words_and_five_levels():
    assert len(phrases.GLOSSARY) == 10
    assert set(WORDS) == {1, 2, 3, 4, 5}
    assert "linearisation" in " ".join(certificate_sentences.assumptions(4))
    assert "linearisation" not in " ".join(certificate_sentences.assumptions(3))


@pytest.mark.parametrize("with_commands", [False, True])
def test_no_level_is_stated_without_its_premise_about_joints_or_its_control_law(with_commands):
    for level in (1, 2, 3):
        assert certificate_sentences.states(level, with_commands).startswith(ON_TARGET)
    for law, words in ("exact linearisation in continuous time", WORDS[4]), ("law", WORDS[5]):
        assert law in words.states
    assert "exact linearisation in continuous time" in WORDS[4].asks
    joined = certificate_sentences.states_with_commands((1, 2, 3))
    assert joined.count(ON_TARGET) == 1 and "walk for ever" in joined
