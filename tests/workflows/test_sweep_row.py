"""A row of a sweep, carried out: its files are a run that other verbs open where it will lie."""

from pathlib import Path

import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.errors import NonFiniteError
from neuralgaits.robots.mjcf.loader import robot_text
from neuralgaits.workflows import sweep_row
from neuralgaits.workflows.check_proof import check_proof
from support import brief_spec


@pytest.fixture
def settings(tmp_path: Path) -> dict:
    return {
        "name": "amber3m-brief-3",
        "robot": "amber3m",
        "spec": f"{brief_spec.__file__}:brief",
        "speed": None,
        "seed": 3,
        "spec_file": brief_spec.__file__,
        "place": str(tmp_path / "rows" / "amber3m-brief-3"),
        "steps": 2,
        "certify": 1,
        "budget": 0.5,
        "controllers": ["pd"],
        "disturbances": {"heavy": {"mass_scale": 1.1}},
        "walks": 2,
        "walk_steps": 3,
    }


@pytest.fixture
def files() -> dict[str, bytes]:
    spec = Path(brief_spec.__file__).read_bytes()
    return {"robot.xml": robot_text("amber3m")[0].encode(), "spec.py": spec}


@pytest.mark.slow
def test_its_files_are_a_run(settings: dict, files: dict[str, bytes]) -> None:
    made = dict(sweep_row.carry_out(settings, files))
    row = sweep_row.row_of(made.pop("row.json"))
    assert row.failure is None and row.steps == 2 and row.verdict is not None
    assert [(one.disturbance, one.walks) for one in row.walks] == [("none", 2), ("heavy", 2)]
    place = Path(settings["place"])
    for name, content in made.items():
        (place / name).parent.mkdir(parents=True, exist_ok=True)
        (place / name).write_bytes(content)
    run = open_run(place)
    assert run.summary.run == str(place) and run.config.seed == 3
    assert run.config.spec == settings["spec"]
    told = "".join(path.read_text() for path in place.rglob("*.json"))
    assert "neuralgaits-row-" not in told
    if (place / "certificate" / "proof.json").is_file():
        checked = check_proof(place / "certificate" / "proof.json", run=str(place))
        assert checked.verdict != "rejected"


def test_a_part_that_says_no_ends_a_row_in_one_line(
    settings: dict, files: dict[str, bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    def train(*given, out: Path, **more):
        (out / "nan.json").write_text(f'{{"at": "{out}"}}')
        raise NonFiniteError(f"loss is NaN,\n see {out}/nan.json")

    monkeypatch.setattr(sweep_row, "train", train)
    made = sweep_row.carry_out(settings, files)
    row = sweep_row.row_of(made["row.json"])
    assert row.failure == "refused"
    assert row.reason == "train: loss is NaN, see /run/nan.json"
    assert made["nan.json"].decode() == f'{{"at": "{settings["place"]}"}}'
