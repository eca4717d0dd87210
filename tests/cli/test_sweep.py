"""The verb sweep at the edge: a line a row, where everything lies, and the exit code."""

import json
from pathlib import Path

import pytest

from neuralgaits.cli.main import main
from neuralgaits.cli.sweep_verb import line_of
from neuralgaits.engine import Serial
from neuralgaits.records.swept import RowTimes, RowWalks, SweepRow
from neuralgaits.workflows import sweep as workflow
from support import sweep_rows

WORDS = ["sweep", "amber3m", "--certify", "2", "--disturbances", "none", "--out", "s"]


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(workflow, "carry_out", sweep_rows.made_up)
    monkeypatch.setattr(workflow, "worker_pool_for", lambda workers, ray: Serial())


def test_a_line_a_row_and_the_page_at_the_end(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*WORDS, "--seeds", "0:2"]) == 0
    said = capsys.readouterr()
    begun, first, second = said.err.splitlines()
    assert begun == "2 rows in s, 1 at once"
    assert first.startswith("1/2 amber3m-walking-0: trained, proved to level 2, 4 of 4 walk at 0.7")
    assert second.startswith("2/2 amber3m-walking-1: 1 of 5 conditions broken, proved to level 2")
    assert "done: 2 of 2 rows" in said.out
    assert said.out.splitlines()[-1].split() == ["page", "s/sweep.html"]


def test_json_is_one_object_and_nothing_else(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*WORDS, "--seeds", "0:2", "--json"]) == 0
    said = capsys.readouterr()
    found = json.loads(said.out)
    assert not said.err
    assert (found["rows"], found["failed"], found["engine"]) == (2, 0, "serial")
    assert Path(found["table"]).is_file() and {"wall_s", "workers"} <= set(found)


def test_exit_codes_tell_no_from_not_done(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*WORDS, "--seeds", "2"]) == 1
    assert "1 said no, and would again" in capsys.readouterr().out
    # A row that said no is not tried again, and is no better for it.
    assert main(["sweep", "--out", "s", "--resume"]) == 1
    assert capsys.readouterr().err.splitlines() == ["1 row, 1 of them done, in s, 1 at once"]


def test_rows_in_words() -> None:
    known = {"name": "a", "robot": "amber3m", "spec": "walking", "seed": 0}
    lost = SweepRow(**known, failure="lost", reason="its worker died")
    assert line_of(lost) == "a: lost: its worker died"
    walks = tuple(
        RowWalks("pd", name, 4, 3, 20, None, None, None, None) for name in ("none", "late")
    )
    plain = SweepRow(**known, conditions=3, broken=0, walks=walks, wall_s=RowTimes(train=2.0))
    assert line_of(plain) == "a: trained, 3 of 4 walk, disturbed 3 of 4, 2 s"
