"""What a page says of a run: nothing that is not so, and nothing that is run."""

import json
import math
import re
import shlex
import shutil
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import pytest

from neuralgaits.certificate.run_certificate.verified_summary import UNCHECKED, hashes
from neuralgaits.cli.argv_parser import read as read_words
from neuralgaits.cli.argv_parser import verb_name
from neuralgaits.records.training_config import GaitOrigin
from neuralgaits.report.drawing.figure_files import MissingFigure
from neuralgaits.report.page import phrases
from neuralgaits.report.page.answer import answer, glance
from neuralgaits.report.page.closing import failures, missing, missing_parts, reproduction
from neuralgaits.report.page.document import document
from neuralgaits.report.page.markup import Html, number, tag, text
from neuralgaits.report.page.proof import certificate
from neuralgaits.report.page.training import training
from neuralgaits.report.page.walks import animation, simulations
from support.refuted_run import refute

HOSTILE = "\"><img src=x onerror=alert(1)></script><script>alert('&')</script>"
SIMULATED = {
    "plant": "amber3m",
    "controller": "pd",
    "episodes": 3,
    "start": "region",
    "push": 4.0,
    "disturb": {"friction": 0.4, "delay_ms": 0.0, "mass_scale": 1.0},
    "seed": 7,
    "steps": 20,
    "steps_walked": [20, 3, 4],
    "fell": [False, True, True],
    "fall_reasons": [None, "hip too low", "torso tipped over"],
    "speed_m_s": 0.61,
    "step_time_s": 0.5,
}

ORBIT = {"multiplier": 0.7, "period_s": 0.5, "step_length_m": 0.35}


class _Tags(HTMLParser):
    """Every element of a page with its attributes."""

    def __init__(self, page):
        super().__init__()
        self.found = []
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        self.found.append((tag, dict(attrs)))


def _change(folder, file, change):
    content = json.loads((folder / file).read_text())
    change(content)
    (folder / file).write_text(json.dumps(content))


def _simulated(folder, **changed):
    (folder / "simulation").mkdir()
    (folder / "simulation/summary.json").write_text(json.dumps(SIMULATED | changed))


def test_a_proved_run_says_what_is_proved_and_what_is_not(contents):
    page = answer(contents())
    assert "Proved, to level 3 of 5" in page and "claims nothing about" in page
    assert "nothing has been proved" not in page


def test_without_a_certificate_nothing_is_called_proved(contents, shipped):
    shutil.rmtree(shipped / "certificate")
    page = contents(shipped)
    said = answer(page)
    assert "a record and no proof" in said and "nothing has been proved" in said
    assert "Proved" not in said and ">proved<" not in document(page)
    assert f"neuralgaits certify {shipped}" in certificate(page)
    assert ("a certificate", f"neuralgaits certify {shipped}") in list(missing_parts(page))


def test_samples_that_break_a_condition_are_said_to(contents, shipped):
    def broken(summary):
        summary["conditions"]["knee"] |= {"max_violation": 0.125, "min_margin": -0.125}

    _change(shipped, "summary.json", broken)
    assert "Training left knee violated on samples, by up to 0.125" in failures(contents(shipped))


def test_a_refuted_condition_is_shown_with_its_state(contents, shipped):
    refute(shipped, "knee")
    page = contents(shipped)
    said = failures(page)
    assert "knee is refuted: at z1 = 0.0125 m, z2 = 14.25" in said
    assert "certify recorded this point" in said
    assert "Not proved." in answer(page) and "(knee)" in answer(page)
    assert "Why it stays up." not in answer(page)
    assert page.saved.proved_level == 0
    offered = dict(missing_parts(page))
    assert "a gait that can be proved: some states break knee, which more steps may mend" in offered
    assert not any(line.startswith("neuralgaits certify") for line in offered.values())


def test_an_undecided_level_is_not_proved_and_says_why(contents, shipped):
    def undecided(summary):
        # Level 3 rests on level 2.
        for level in summary["levels"]:
            level |= {"verdict": "undecided", "reason": "fences meet"}

    _change(shipped, "certificate/summary.json", undecided)
    page = contents(shipped)
    assert page.saved.proved_level == 1
    assert f"Level 2 is undecided: {UNCHECKED} “fences meet”." in failures(page)
    (what,) = [what for what, _ in missing_parts(page) if what.startswith("level")]
    assert what.startswith("level 2")


def test_a_proof_of_other_weights_is_not_shown(contents, shipped):
    weights = shipped / "policy.safetensors"
    content = bytearray(weights.read_bytes())
    content[-1] ^= 1
    weights.write_bytes(content)
    page = contents(shipped)
    assert page.saved.certificate is None
    assert "is about another policy.safetensors than the run&#x27;s" in failures(page)
    assert f"`neuralgaits certify {shipped}`" in failures(page)
    assert "Proved" not in answer(page)


def test_a_damaged_proof_is_named_and_not_its_summary(contents, shipped):
    """It is made already: the command that makes it again stands with the reason."""
    proof = shipped / "certificate/proof.json"
    proof.write_bytes(proof.read_bytes()[:20_000])
    page = contents(shipped)
    (reason,) = page.saved.damaged.values()
    assert list(page.saved.damaged) == ["certificate/proof.json"]
    assert reason.startswith("certificate/proof.json is damaged, or not the file that certificate/")
    assert reason.endswith(f"prove it again with `neuralgaits certify {shipped}`")
    assert "a certificate" not in [what for what, _ in missing_parts(page)]
    assert reason.split(":")[0] in answer(page) + document(page)


def test_a_certificate_without_its_proof_is_not_shown(contents, shipped):
    proof = shipped / "certificate/proof.json"
    proof.write_text("{}")
    assert contents(shipped).saved.certificate is None
    proof.unlink()
    page = contents(shipped)
    assert page.saved.certificate is None
    assert "certificate/proof.json is missing" in failures(page)


def test_the_summary_of_another_run_proves_nothing(contents, shipped, tmp_path):
    """Of a run that has no proof files of its own, and of one that has another's."""
    bare = Path(shutil.copytree(shipped, tmp_path / "bare"))
    weights = bytearray((bare / "policy.safetensors").read_bytes())
    weights[-2] ^= 1
    (bare / "policy.safetensors").write_bytes(weights)
    shutil.rmtree(bare / "certificate")
    (bare / "certificate").mkdir()
    shutil.copyfile(shipped / "certificate/summary.json", bare / "certificate/summary.json")
    page = contents(bare)
    assert page.saved.certificate is None and page.saved.proved_level == 0
    assert "Proved" not in answer(page) and ">proved<" not in document(page)
    shutil.copyfile(shipped / "certificate/proof.json", bare / "certificate/proof.json")
    _anew(bare)
    page = contents(bare)
    assert page.saved.certificate is None and "Proved" not in answer(page)
    assert "is not about this run: policy.safetensors" in failures(page)


def _more(summary):
    summary["level"] = 4
    summary["levels"].append(summary["levels"][-1] | {"level": 4})


def _better(summary):
    summary["conditions"]["knee"]["margin"] = 0.9
    summary["levels"][1]["figures"]["multiplier_at_most"] = 0.01
    summary["levels"][0]["words"] = ["it flies"]


def test_a_summary_says_no_more_than_its_proof(contents, shipped):
    _change(shipped, "certificate/summary.json", _more)
    page = contents(shipped)
    assert page.saved.certificate is None
    assert "calls level 4 proved, and no proof file claims it" in failures(page)


def test_numbers_and_words_are_those_of_the_proof_and_not_of_the_summary(contents, shipped):
    before = contents(shipped).saved.certificate
    _change(shipped, "certificate/summary.json", _better)
    assert contents(shipped).saved.certificate == before


def test_a_condition_without_its_statement_is_not_proved(contents, shipped):
    def shorter(proof):
        proof["statements"] = [s for s in proof["statements"] if "knee" not in s["conditions"]]

    _change(shipped, "certificate/proof.json", shorter)
    _anew(shipped)
    page = contents(shipped)
    assert page.saved.certificate is None
    # The first of those that were proved together with it.
    assert re.search(r"calls \S+ proved, and \S+ has no such statement", failures(page))


def _anew(run: Path) -> None:
    """The hashes of a summary that is made to fit the files as they are."""
    _change(run, "certificate/summary.json", lambda s: s.__setitem__("sha256", hashes(run)))


def test_proved_bounds_are_rounded_to_the_safe_side(contents, shipped):
    def nearly(proof):
        for statement in proof["statements"]:
            if "knee" in statement["bounds"] and statement["region"] == "tube":
                statement["bounds"]["knee"] = 0.019999

    _change(shipped, "certificate/proof.json", nearly)
    _anew(shipped)
    page = contents(shipped)
    assert "at least 1.9 % of its typical size" in answer(page)
    said = certificate(page)
    assert "0.0199<" in said and "0.02<" not in said
    levels = json.loads((shipped / "certificate/summary.json").read_text())["levels"]
    figures = next(level["figures"] for level in levels if level["level"] == 3)
    least, most = (figures[f"z2_at_mid_step_at_{side}"] for side in ("least", "most"))
    assert 10 < least < most < 100  # Six digits of it are four behind the point.
    assert f"{math.floor(1e4 * least) / 1e4:.4f} kg" in said
    assert f"{math.ceil(1e4 * most) / 1e4:.4f} kg" in said


def test_falls_stand_in_the_answer_and_with_their_reasons(contents, shipped, walk):
    _simulated(shipped)
    page = contents(shipped, walk=walk)
    said = answer(page)
    assert "1 of 3 walks stayed up" in said and "hip too low" in said
    assert "friction of the feet 0.4" in said and "a push of 4 N s" in said
    assert "How it is meant to stay up." in said and "Why it stays up." not in said
    assert "In simulation 1 of 3 walks fell: torso tipped over." in failures(page)
    assert "falls after 1 step: torso tipped over" in animation(page)
    assert "hip too low" in simulations(page.saved)


def test_a_walk_of_other_weights_is_not_shown(contents, shipped):
    own = {file: hashes(shipped)[file] for file in ("robot.xml", "policy.safetensors")}
    _simulated(shipped, sha256=own)
    assert "1 of 3 walks stayed up" in answer(contents(shipped))
    shutil.rmtree(shipped / "simulation")
    _simulated(shipped, sha256=own | {"policy.safetensors": "0" * 64})
    page = contents(shipped)
    assert page.saved.simulation is None and "1 of 3 walks" not in answer(page)
    assert "is about another policy.safetensors than the run" in failures(page)


def test_every_command_on_the_page_is_one_that_the_command_line_takes(contents, shipped):
    _simulated(shipped)
    page = contents(shipped)
    unescaped = [line for _, line in missing_parts(page)]
    block = re.search(r"<pre[^>]*><code>(.*?)</code>", reproduction(page), re.S)
    assert block is not None
    unescaped += block.group(1).split("\n")
    verbs = []
    for line in unescaped:
        name, *words = shlex.split(line)
        assert name == "neuralgaits"
        verbs.append(verb_name(type(read_words(words))))
    assert verbs == ["certify", "train", "certify", "simulate", "report"]


def _certifying(page):
    (line,) = re.findall(r"neuralgaits certify [^\n<]*-again[^\n<]*", reproduction(page))
    return line.partition("-again")[2]


def test_the_level_to_prove_again_is_the_one_that_the_proof_bears_out(contents, shipped):
    """Nothing confirms the level that a summary says was requested."""
    _change(shipped, "certificate/summary.json", lambda summary: summary.update(level=5))
    page = contents(shipped)
    assert page.saved.certificate.level == 5
    assert _certifying(page) == " --level 3"
    assert "claims nothing about ticks of a computer," not in certificate(page)
    assert "claims nothing about control in ticks of a computer," in certificate(page)
    assert "at level 5" not in certificate(page).split("What it assumes")[1]


def test_where_nothing_is_confirmed_no_level_is_named(contents, shipped):
    saved = contents(shipped).saved
    rows = {name: replace(row, verdict="undecided") for name, row in saved.conditions.items()}
    nothing = replace(saved.certificate, conditions=rows, levels=(), level=4)
    assert _certifying(contents(saved=replace(saved, certificate=nothing))) == ""
    first = replace(saved.certificate, levels=(), level=4)
    disturbed = replace(saved, certificate=first, disturbance=(0.01, 0.5))
    assert _certifying(contents(saved=disturbed)) == " --level 1"


def test_a_command_repeats_the_simulation(contents, shipped):
    _simulated(shipped)
    block = reproduction(contents(shipped))
    assert "--episodes 3" in block and "--push 4.0 --disturb friction=0.4" in block


def test_a_refined_run_is_made_again_by_refining(contents, shipped):
    """From the run it began with, there or moved together with it; or not at all."""
    parent = shipped.parent / "a b"

    def refined(config):
        config |= {"parent": str(parent), "disturbance": [0.01, 0.5]}

    _change(shipped, "config.json", refined)
    told = "No command makes this run again: the run that it was refined from is not where it was"
    assert told in reproduction(contents(shipped))
    shutil.copytree(shipped, parent)
    said = reproduction(contents(shipped))
    assert f"refine &#x27;{parent}&#x27;" in said and "--disturbance 0.01,0.5" in said
    moved = shutil.copytree(shipped.parent, shipped.parent / "elsewhere")
    shutil.rmtree(parent)
    assert f"refine &#x27;{moved}/a b&#x27;" in reproduction(contents(moved / "run"))


def test_a_run_of_a_spec_in_no_file_is_not_said_to_be_made_again(contents, shipped):
    _change(shipped, "config.json", lambda config: config.update(spec="my own"))
    said = reproduction(contents(shipped))
    assert "its spec, my own, was made in Python and is in no file" in said
    assert "neuralgaits train" not in said


def test_a_proof_of_many_robots_is_not_given_up_for_one(contents):
    """What is missing asks for no level that would take the place of the box's proof."""
    saved = contents().saved
    assert ["--level 4" in line for _, line in missing_parts(contents())].count(True) == 1
    box = {"mass": 0.01, "floor": 0.002}
    page = contents(saved=replace(saved, certificate=replace(saved.certificate, parameters=box)))
    assert not any("certify" in line for _, line in missing_parts(page))
    assert "ends as soon as something is to spare" in answer(page)
    assert "--level 3 --parameters mass=0.01,floor=0.002m" in reproduction(page)
    lower = replace(page.saved.certificate, levels=page.saved.certificate.levels[:1])
    lines = [line for _, line in missing_parts(contents(saved=replace(saved, certificate=lower)))]
    assert any("--level 3 --parameters mass=0.01,floor=0.002m" in line for line in lines)


def test_robots_that_were_drawn_are_said_to_be(contents, shipped):
    box = {"mass": 0.02, "floor": 0.002, "friction": 0.5}
    disturb = {"floor_height": 0.002, "friction": 0.5, "delay_ms": 3.0}
    _simulated(shipped, parameters=box, disturb=disturb, errors={"mass of shin": [0.01] * 3})
    page = contents(shipped)
    said = simulations(page.saved)
    drawn = "robots drawn from the box mass=2%,floor=2mm,friction=0.5, torques late by 3 ms"
    assert f"changed: {drawn}," in said and "floor uneven" not in said
    assert "drawn from the box mass=2%,floor=2mm,friction=0.5" in answer(page)


@pytest.mark.parametrize(
    ("speed", "force", "other", "left"), [(0.61, 0.0, True, True), (0.68, 9.0, False, False)]
)
def test_walks_unlike_the_model_are_pointed_out(contents, shipped, speed, force, other, left):
    _simulated(shipped, poincare=ORBIT, speed_m_s=speed, min_normal_force_n=force)
    said = simulations(contents(shipped).saved)
    assert ("orbit has 0.7 m/s" in said) is other
    assert ("it left the floor" in said) is left


def test_of_a_gait_that_was_given_nothing_is_said_to_be_trained(contents, shipped):
    saved = contents().saved
    given = replace(saved.config, given=GaitOrigin("optimise", 5, 0.7))
    broken = contents(saved=replace(saved, config=given, certificate=None)).saved
    page = contents(saved=replace(saved, config=given))
    whole = document(page)
    for word in ("network", "What was trained", "was trained so that", "gait was trained"):
        assert word not in whole, word
    assert "What was made" in whole and "How the policy was made" in whole
    summary = broken.summary
    worse = replace(summary.conditions["knee"], max_violation=0.1, min_margin=-0.1)
    summary = replace(summary, conditions=dict(summary.conditions) | {"knee": worse})
    found = dict(missing_parts(contents(saved=replace(broken, summary=summary))))
    assert not any("more steps" in what for what in found)
    assert any("one that is trained need not" in what for what in found)


def test_missing_figures_stand_with_their_commands(contents, shipped):
    lost = MissingFigure("x", "A picture", "no log", "neuralgaits simulate RUN --log F.csv")
    page = contents(shipped, figures=[lost])
    assert "A picture" in document(page) and "neuralgaits simulate RUN --log F.csv" in missing(page)


def test_an_unfinished_run_says_how_to_go_on(contents, shipped):
    (shipped / "summary.json").unlink()
    page = document(contents(shipped))
    assert f"neuralgaits train --resume {shipped}" in page
    assert "Nothing is claimed" in page
    assert 'id="certificate"' not in page


def test_a_damaged_part_is_named_and_left_out(contents, shipped):
    for content in ("{", "{}"):
        (shipped / "certificate/summary.json").write_text(content)
        page = contents(shipped)
        assert "damaged" in failures(page) and page.saved.certificate is None
        assert document(page)


def test_a_disturbance_that_nothing_is_claimed_about_is_not_shown(contents, shipped):
    def pushed(proof):
        bounds = [(0.01).hex(), (0.3).hex()]
        proof["theorems"][0]["parameters"]["disturbance"] = bounds
        for theorem in proof["theorems"]:
            theorem["claimed"] = False

    def open_levels(summary):
        for level in summary["levels"]:
            level |= {"verdict": "undecided", "reason": "not asked"}

    _change(shipped, "certificate/proof.json", pushed)
    _change(shipped, "certificate/summary.json", open_levels)
    _anew(shipped)
    page = contents(shipped)
    assert page.saved.disturbance == () and page.saved.proved_level == 0
    assert "disturbance of level 2 is not the Program" in failures(page)


@pytest.mark.parametrize("hostile", [HOSTILE, "<!--<script>", "javascript:alert(1)//'"])
def test_nothing_that_a_run_says_becomes_markup(contents, shipped, walk, hostile):
    def named(config):
        config |= {"robot": hostile, "spec": hostile, "parent": hostile, "created_utc": hostile}
        config["described"]["conditions"][0] |= {"name": hostile, "region": hostile}
        config["written_by"] = {hostile: hostile}

    def told(summary):
        entry = summary["conditions"].pop("knee")
        summary["conditions"][hostile] = entry

    _change(shipped, "config.json", named)
    _change(shipped, "summary.json", told)
    _change(shipped, "certificate/summary.json", told)
    _simulated(shipped, fall_reasons=[None, hostile, hostile], plant=hostile, controller=hostile)
    walk = replace(walk, plant=hostile, fall_reason=hostile, origin=hostile, controller=hostile)
    page = contents(shipped, walk=walk, figures=[MissingFigure(hostile, hostile, hostile, hostile)])
    page = replace(page, robot=replace(page.robot, robot=hostile), assumptions=(hostile,))
    tags = _Tags(document(page)).found
    kinds = [name for name, _ in tags]
    assert kinds.count("script") == 2 and "img" not in kinds
    assert not any(key.startswith("on") for _, attributes in tags for key in attributes)
    assert not any(a.get("href", "#")[0] not in "#d" for name, a in tags if name != "link")


def test_a_recording_cannot_end_its_script(contents, shipped, walk):
    page = animation(contents(shipped, walk=replace(walk, plant=HOSTILE)))
    block = re.search(r'<script type="application/json"[^>]*>(.*?)</script>', page, re.S)
    assert block is not None and "<" not in block.group(1)
    assert json.loads(block.group(1))["plant"] == HOSTILE


def test_the_policy_of_the_page_forbids_every_request(contents):
    tags = _Tags(document(contents())).found
    policy = next(a["content"] for name, a in tags if name == "meta" and "content" in a)
    assert "default-src 'none'" in policy and "http" not in policy and "unsafe" not in policy
    sources = [a[key] for _, a in tags for key in ("src", "href") if key in a]
    assert all(source.startswith(("#", "data:")) for source in sources)


def test_escaping_happens_once():
    assert text("<b>&") == "&lt;b&gt;&amp;"
    assert tag("p", Html("<b>x</b>"), "<") == "<p><b>x</b>&lt;</p>"
    assert tag("p", title='"') == '<p title="&quot;"></p>'


@pytest.mark.parametrize(
    ("value", "said"),
    [(None, "–"), (0.0, "0"), (-0.03251, "−0.0325"), (1400, "1\u202f400"), (float("nan"), "nan")],
)
def test_numbers_as_a_person_writes_them(value, said):
    assert number(value) == said


def test_the_tightest_conditions_are_shown_and_the_others_folded(contents, shipped):
    """The five with the smallest margins in scales; every one that is broken."""
    page = training(contents(shipped))
    shown, rest = page.split("<details>")
    assert "The 5 tightest of 27 conditions" in shown and "22 more" in rest
    summary = json.loads((shipped / "summary.json").read_text())["conditions"]
    ordered = sorted(summary, key=lambda name: summary[name]["min_margin"])
    name = r"<code class=\"quiet\">([^<]+)</code>"
    assert re.findall(name, shown) == ordered[:5]
    assert re.findall(name, rest) == ordered[5:]

    def broken(summary):
        for entry in summary["conditions"].values():
            entry |= {"max_violation": 0.125, "min_margin": -0.125}

    _change(shipped, "summary.json", broken)
    assert "<details>" not in training(contents(shipped))


def test_a_proved_table_begins_with_what_is_not_proved(contents, shipped):
    def undecided(summary):
        entry = summary["conditions"]["impulse"]
        entry |= {"verdict": "undecided", "proved_fraction": 0.5, "margin": None}

    _change(shipped, "certificate/summary.json", undecided)
    page = certificate(contents(shipped))
    assert re.findall(r"<code class=\"quiet\">([^<]+)</code>", page)[0] == "impulse"


@pytest.mark.parametrize(
    ("described", "said"),
    [
        ({"kind": "Fence", "side": "lower"}, "the region's width in a step"),
        ({"kind": "Pointwise", "quantity": {"function": "friction_forward"}}, "1 N"),
        (
            {"kind": "Barrier", "alpha": 10.0, "quantity": {"function": "torso_angle"}},
            "1 rad per second",
        ),
        ({"kind": "Pointwise", "user": "mine.py"}, "1"),
    ],
)
def test_a_scale_has_a_unit_where_it_is_known(described, said):
    assert phrases.scale(described, 1.0) == said


def test_a_robot_that_moves_comes_first_and_without_one_the_answer_does(contents, walk):
    with_walk, without = document(contents(walk=walk)), document(contents())
    assert with_walk.index('id="walk"') < with_walk.index('id="answer"')
    assert without.index('id="answer"') < without.index('id="walk"')
    for page in (with_walk, without):
        assert page.count('href="#walk"') == page.count(' id="walk"') == 1


def test_the_result_stands_on_top_in_four_lines(contents, shipped):
    def lines(page):
        return re.findall("<li><b>(.*?)</b> (.*?)</li>", glance(page))

    proved, simulated, sampled, rest = lines(contents())
    assert proved == ("Proved", "level 3 of 5, about the model, according to the proof file")
    assert simulated == ("Simulated", "nothing yet")
    assert sampled == ("Sampled", "27 of 27 conditions held at every random state")
    assert rest == ("Not shown", "how the real robot walks")
    (shipped / "certificate/summary.json").unlink()
    assert lines(contents(shipped))[0] == ("Proved", "nothing")
    (shipped / "summary.json").unlink()
    assert glance(contents(shipped)) == ""


@pytest.mark.parametrize(
    ("steps", "words"), [([50, 50, 3], "50 steps each"), ([50, 40, 3], "40 to 50 steps each")]
)
def test_walks_that_stayed_up_are_said_with_their_steps(contents, shipped, steps, words):
    """Five walks of one step and five of fifty are not the same evidence."""
    _simulated(shipped, steps_walked=steps, fell=[False, False, True], poincare=ORBIT)
    page = contents(shipped)
    assert f"2 of 3 walks stayed up, {words}, in MuJoCo, robot or floor changed" in glance(page)
    for said in (answer(page), simulations(page.saved)):
        assert f"2 of 3 walks stayed up to their last step, {words}" in said
    # Numbers of the model's orbit are of no walk.
    of_walks, _, of_orbit = simulations(page.saved).partition("For comparison, the ")
    assert "multiplier" in of_orbit and "multiplier" not in of_walks
