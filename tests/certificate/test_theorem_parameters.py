"""Parameters of theorems are claims: one that is altered is refused by all who read a proof."""

import json
import shutil
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.certificate.chart import PLANE_ONLY, Axis, Chart
from neuralgaits.certificate.levels.level_search import find_sets
from neuralgaits.certificate.levels.levels import LEVELS, conclude, labelled_premises, refusals
from neuralgaits.certificate.levels.problems import trace_certificate
from neuralgaits.certificate.proof_file.consistency import inconsistencies
from neuralgaits.certificate.proof_file.reader import read_claims
from neuralgaits.certificate.proof_file.theorem_tables import Theorems
from neuralgaits.certificate.run_certificate.verified_summary import hashes, read_certificate
from neuralgaits.errors import SpecError
from neuralgaits.export.source import gait_files
from neuralgaits.records.certified import PROOF
from neuralgaits.records.level_words import HIGHEST_OF_MANY, WORDS
from neuralgaits.report.certificate import certificate_of
from neuralgaits.runs import RunFolder
from neuralgaits.viewer.sureness import how_sure
from neuralgaits.workflows import demo
from neuralgaits.workflows.export import design_of
from support.forgeries.quick import programs_read_once

FACTORS = 0.0, 0.9, 1.1, 1.4


def altered(value: Any) -> Iterator[tuple[str, Any]]:
    """Copies of JSON data in each of which one number is another, with the place of it."""
    if isinstance(value, dict):
        for key in value:
            for place, other in altered(value[key]):
                yield f"{key} {place}", value | {key: other}
    elif isinstance(value, list):
        for index, item in enumerate(value):
            for place, other in altered(item):
                yield f"{index} {place}", [*value[:index], other, *value[index + 1 :]]
    elif isinstance(value, str):
        try:
            number = float.fromhex(value)
        except ValueError:
            return
        for factor in FACTORS:
            if (changed := number * factor) != number:
                yield f"times {factor}", changed.hex()


@pytest.fixture(scope="module")
def forged(tmp_path_factory):
    """Writes theorems into a copy of the demo's run, with every sha256 made anew."""
    path = shutil.copytree(demo.FOLDER, tmp_path_factory.mktemp("forged") / "run")
    proof, summary = (path / "certificate" / name for name in ("proof.json", "summary.json"))
    table = json.loads(proof.read_text())

    def write(theorems):
        proof.write_text(json.dumps(table | {"theorems": theorems}))
        told = json.loads(summary.read_text()) | {"sha256": hashes(path)}
        summary.write_text(json.dumps(told))
        return RunFolder.open(path)

    return table["theorems"], write


def test_no_altered_parameter_of_levels_2_and_3_is_shown_proved(forged):
    theorems, write = forged
    with programs_read_once({}):
        assert read_certificate(write(theorems)).summary is not None
        for number, theorem in enumerate(theorems):
            for place, parameters in altered(theorem["parameters"]):
                others = [*theorems]
                others[number] = theorem | {"parameters": parameters}
                found = read_certificate(write(others))
                assert found.summary is None, (theorem["level"], place)


def test_no_page_figure_or_export_shows_an_altered_parameter(forged):
    theorems, write = forged
    place, parameters = next(
        (place, changed)
        for place, changed in altered(theorems[1]["parameters"])
        if place.startswith("expansion")
    )
    folder = write([theorems[0], theorems[1] | {"parameters": parameters}])
    run = open_run(folder.path)
    assert certificate_of(run).level == 0, place
    assert not how_sure(run).certified
    assert "proved" not in "".join(gait_files(design_of(run)).values())
    write(theorems)
    assert certificate_of(run).level == 3 and how_sure(run).certified


def test_a_constant_of_a_theorem_that_the_file_lacks_is_a_contradiction():
    """What the Program computes with it is about another theorem than the file's."""
    claims = replace(read_claims(demo.FOLDER / PROOF), statements=())
    assert inconsistencies(claims, None) == []
    below = Theorems({2: claims.theorems.parameters[2]}, (2,))
    wrong = inconsistencies(replace(claims, theorems=below), None)
    assert "the Program's orbit.lower is a parameter of no theorem" in wrong


@pytest.fixture(scope="module")
def highest(certified_5):
    """Level 5 with held torques, of the default gait: parameters and Program."""
    claims = read_claims(certified_5.path / PROOF)
    theorems = Theorems(claims.theorems.parameters, (4, 5))
    return replace(claims, theorems=theorems, statements=())


def follow(theorems: Theorems) -> set[int]:
    """Which of levels 4 and 5 would follow if every premise were proved."""
    known = {number: part for number, part in theorems.parameters.items() if number > 3}
    bounds = {(name, low, high): 1.0 for _, name, low, high in labelled_premises(known, [])}
    return {one.level for one in conclude(known, [], bounds) if one.proved}


@pytest.mark.slow
def test_an_altered_parameter_of_levels_4_and_5_makes_no_stronger_theorem(highest):
    """It is no constant of the Program, or moves a box that the file has no statement of.

    Left are numbers of the closing arithmetic alone: sigma, which shapes the set, and what level 5
    grants, of which less may be claimed and not more.
    """
    assert inconsistencies(highest, None) == []
    assert follow(highest.theorems) == {4, 5}
    tables, left = highest.theorems.tables(), set()
    boxes = list(labelled_premises(highest.theorems.parameters, []))
    for number, theorem in enumerate(tables):
        if theorem["level"] not in (4, 5):
            continue
        for place, parameters in altered(theorem["parameters"]):
            others = [*tables]
            others[number] = theorem | {"parameters": parameters}
            theorems = Theorems.read(others)
            if list(labelled_premises(theorems.parameters, [])) != boxes:
                continue
            wrong = inconsistencies(replace(highest, theorems=theorems), None)
            if not wrong and theorem["level"] in follow(theorems):
                left.add((theorem["level"], place))
    assert {place for level, place in left if level == 5} == {"hold times 0.9"}
    assert all("sigma" in place for level, place in left if level == 4)


@pytest.mark.slow
@pytest.mark.parametrize("axes", [(Axis("speed before", 0.5, 0.9),), (Axis("mass", -0.1, 0.1),)])
def test_full_order_is_about_one_gait_of_one_robot(highest, axes):
    chart = Chart(axes)
    claims = replace(highest, chart=chart)
    assert any("level 4 is stated" in one for one in inconsistencies(claims, None))
    assert set(refusals(highest.theorems.parameters, chart)) == {4, 5}
    known = highest.theorems.parameters
    answers = {one.level: one for one in conclude(known, [], {}, chart)}
    assert answers[4].verdict == answers[5].verdict == "undecided"
    assert "one gait of one robot" in str(answers[4].reason)


@pytest.mark.slow
def test_levels_and_their_words_are_about_the_same_gaits(highest):
    chart = Chart((Axis("speed before", 0.5, 0.9), Axis("speed after", 0.5, 0.9)))
    refused = refusals(highest.theorems.parameters, chart)
    assert set(refused) == {number for number, words in WORDS.items() if words.one_gait}
    assert HIGHEST_OF_MANY == min(refused) - 1


@pytest.mark.slow
def test_full_order_is_not_about_footholds_of_unknown_height(highest):
    known = dict(highest.theorems.parameters)
    known[2] = replace(known[2], floor=0.01)
    assert set(refusals(known, PLANE_ONLY)) == {4, 5}


@pytest.mark.slow
def test_full_order_is_not_traced_for_a_gait_with_commands(highest):
    run = open_run(demo.TOLD)
    sets = find_sets(run.spec, run.trained, run.zero_dynamics, 1, (0.0, 0.0))
    sets = replace(sets, parameters=highest.theorems.parameters)
    with pytest.raises(SpecError, match="level 4 is about"):
        trace_certificate(run.spec, run.robot, run.trained, sets)
    assert [level.number for level in LEVELS if level.full_order] == [4, 5]
