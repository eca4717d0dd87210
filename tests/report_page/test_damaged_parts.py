"""Parts of a run that hold something else than their writer put there, through the whole page."""

import json

import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.certificate.run_certificate.verified_summary import read_certificate
from neuralgaits.errors import RunError
from neuralgaits.report.page.closing import failures
from neuralgaits.report.page.document import document
from neuralgaits.runs import RunFolder
from neuralgaits.runs.array_tree import write_tree
from neuralgaits.workflows.export import _origin
from neuralgaits.workflows.export_warnings import unproved_of_export
from neuralgaits.workflows.report import saved_of, write_report

SIMULATED = {
    "plant": "amber3m",
    "controller": "pd",
    "start": "centre",
    "seed": 0,
    "episodes": 1,
    "disturb": {"slope_deg": 2.0},
    "steps_walked": [3],
    "fell": [True],
    "fall_reasons": ["torso tipped over"],
}
LEARNED = {
    "logs": ["walk.csv"],
    "walked_s": 3.0,
    "strides": {"train": 3, "heldout": 1},
    "heldout_error": 0.1,
    "nominal_heldout_error": 0.2,
    "binned_floor": None,
    "error_bound": [0.1, 0.2],
    "wall_s": 1.0,
}
PARTS = {
    "certificate/summary.json": None,
    "simulation/summary.json": SIMULATED,
    "residual/summary.json": LEARNED,
}


def _written(run, file, value):
    path = run / file
    path.parent.mkdir(exist_ok=True)
    path.write_text(value if isinstance(value, str) else json.dumps(value))


@pytest.mark.parametrize("file", PARTS)
def test_a_field_that_is_gone_or_of_another_kind_is_named(contents, shipped, file):
    whole = PARTS[file] or json.loads((shipped / file).read_text())
    folder = RunFolder.open(shipped)
    # The certificate is read once where it is another part that changes.
    known = read_certificate(folder) if PARTS[file] else None

    def page_of_parts():
        return contents(saved=saved_of(folder, known))

    _written(shipped, file, whole)
    assert page_of_parts().saved.damaged == {}
    for name in whole:
        for other in (["x"], {"x": "y"}, 1e300, "x"):
            _written(shipped, file, whole | {name: other})
            page = page_of_parts()
            assert document(page)
            about = {"sha256": "about another"}.get(name, f"is about {name}")
            named = f"in {name}", about
            assert not page.saved.damaged or any(words in failures(page) for words in named)
    for broken in ('{"a": ' + "[" * 100_000, '{"boxes": NaN}', "[]"):
        _written(shipped, file, broken)
        page = page_of_parts()
        assert (document(page) and "damaged" in failures(page)) or "expected" in failures(page)


def test_what_was_learned_is_told_of_its_own_residual_only(contents, shipped):
    write_tree(shipped / "residual" / "residual.safetensors", [1.0])
    _written(shipped, "residual/summary.json", LEARNED | {"residual_sha256": "of another"})
    page = contents()
    assert page.saved.residual is None and "about another residual" in failures(page)


def test_rounds_of_a_robots_own_logs_know_of_no_falls(contents, shipped):
    entry = {
        "round": 0,
        "loss": 0.1,
        "steps_walked": [12, 7],
        "share_that_walks": None,
        "speed_range_m_s": None,
        "barriers": {"tube": 1.0, "all": 0.9, "conditions": {"torso-lower": 0.9}},
        "heldout_error": None,
        "nominal_heldout_error": None,
        "binned_floor": None,
    }
    told = {"robot": "amber3m", "plant": None, "controller": "pd", "logs": "/robot/logs"}
    (shipped.parent / "episodes.json").write_text("{}")
    (shipped.parent / "summary.json").write_text(json.dumps(told | {"rounds": [entry]}))
    page = contents()
    assert page.saved.damaged == {} and "7 to 12" in document(page)
    (shipped.parent / "summary.json").write_text(json.dumps(told | {"rounds": [{"round": 0}]}))
    assert "in rounds: in entry 1: there is no loss" in failures(contents())


@pytest.mark.parametrize("gone", ["speed_m_s", "step_time_s"])
def test_a_figure_that_a_simulation_lacks_is_not_told(contents, shipped, gone):
    figures = {"speed_m_s": 0.625, "step_time_s": 0.4375}
    kept = {name: value for name, value in figures.items() if name != gone}
    _written(shipped, "simulation/summary.json", SIMULATED | {"fell": [False]} | kept)
    page = contents()
    assert page.saved.damaged == {} and document(page)
    assert ("at 0.62\u00a0m/s" in document(page)) == (gone == "step_time_s")


def test_walks_of_different_numbers_are_no_simulation(contents, shipped):
    _written(shipped, "simulation/summary.json", SIMULATED | {"fall_reasons": []})
    page = contents()
    assert document(page) and "have 1, 1, 0 entries" in failures(page)


@pytest.mark.parametrize("changed", [{"loss": "low"}, {"conditions": []}, {"steps": -1}])
def test_a_run_without_a_summary_that_can_be_read_is_refused(shipped, changed):
    summary = json.loads((shipped / "summary.json").read_text())
    _written(shipped, "summary.json", summary | changed)
    again = f"neuralgaits train --resume {shipped}"
    with pytest.raises(RunError, match=again):
        saved_of(RunFolder.open(shipped))
    with pytest.raises(RunError, match=again):
        _ = open_run(shipped).summary


@pytest.mark.parametrize(
    "changed",
    [
        {"robot": 3},
        {"spec": ["walking"]},
        {"hidden": [10**12]},
        {"hidden": "32"},
        {"seed": None},
        {"init": "lying"},
        {"described": {"conditions": []}},
        {"certify": {"budget_s": "an hour"}},
    ],
)
def test_a_config_that_asks_for_no_training_is_refused(shipped, changed):
    config = json.loads((shipped / "config.json").read_text())
    _written(shipped, "config.json", config | changed)
    for use in (open_run, write_report):
        with pytest.raises(RunError, match=f"config.json is damaged .* in {next(iter(changed))}"):
            use(shipped)


def test_more_than_the_spec_has_is_another_spec(shipped):
    config = json.loads((shipped / "config.json").read_text())
    config["described"]["note"] = "mine"
    _written(shipped, "config.json", config)
    with pytest.raises(RunError, match="found other fields in 'walking'"):
        open_run(shipped)


def test_an_export_does_not_quote_a_damaged_certificate(shipped):
    run = open_run(shipped)
    assert _origin(run, read_certificate(run.folder)).proof_verdict == "proved at level 3"
    summary = json.loads((shipped / "certificate/summary.json").read_text())
    for file, value in (
        ("certificate/summary.json", summary | {"level": 9}),
        ("certificate/proof.json", '{"weights_sha256"'),
    ):
        _written(shipped, file, value)
        found = read_certificate(run.folder)
        assert _origin(run, found).proof_verdict is None
        (warning,) = unproved_of_export(found)
        assert warning.startswith("nothing is proved of this gait: certificate/")
