"""Sweeps: the same table however they are carried out and stopped, and what they refuse."""

import errno
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from neuralgaits.cli.main import main
from neuralgaits.engine import Processes, Serial
from neuralgaits.errors import InputError, Interrupted
from neuralgaits.runs import write_bytes
from neuralgaits.sweeps import sweep_folder
from neuralgaits.sweeps.disturbances import disturbances_of
from neuralgaits.workflows import sweep as workflow
from neuralgaits.workflows.sweep import sweep
from support import sweep_rows

ASKED: dict[str, Any] = {
    "seeds": (0, 5),
    "certify": 2,
    "controllers": ["pd", "fblin"],
    "disturbances": {"heavy": {"mass_scale": 1.2}, "late": "delay_ms=4"},
}

ONE: dict[str, Any] = ASKED | {"seeds": (0, 1)}
"""The same with one row."""


@pytest.fixture(autouse=True)
def made_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(workflow, "carry_out", sweep_rows.made_up)


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """Of the sweep of all these tests, carried out without a stop."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(workflow, "carry_out", sweep_rows.made_up)
        out = tmp_path_factory.mktemp("whole") / "sweep"
        done = sweep(["amber3m"], engine=Serial(), out=out, **ASKED).summary
        return Path(done.table).read_bytes()


def test_a_table_has_a_row_a_combination_and_a_column_a_disturbance(table: bytes) -> None:
    head, *rows = table.decode().splitlines()
    assert [row.split(",")[0] for row in rows] == [f"amber3m-walking-{n}" for n in range(5)]
    ends = ["none", "heavy", "late"]
    stays = [f"{law}:stays_up:{name}" for law in ("pd", "fblin") for name in ends]
    assert [name for name in head.split(",") if "stays_up" in name] == stays
    assert '2,refused,"train: expected a <gait>, found none"' in rows[2]
    assert rows[0].endswith("1.0,0.75,1.0,0.7,0.1,40.0,90.0,1.0,0.75,1.0")


def test_processes_give_the_same_table(table: bytes, tmp_path: Path) -> None:
    done = sweep(["amber3m"], engine=Processes(2), out=tmp_path / "s", **ASKED).summary
    assert Path(done.table).read_bytes() == table
    assert (done.rows, done.failed, done.lost, done.workers) == (5, 1, 0, 2)


@pytest.mark.parametrize("after", [1, 3])
def test_what_is_interrupted_goes_on_to_the_same_table(
    after: int, table: bytes, tmp_path: Path
) -> None:
    def stop(row: Any, done: int, every: int) -> None:
        if done == after:
            raise KeyboardInterrupt

    out = tmp_path / "s"
    with pytest.raises(Interrupted, match="--resume"):
        sweep(["amber3m"], engine=Serial(), out=out, tell=stop, **ASKED)
    assert len(list((out / "rows").iterdir())) == after
    # What a kill may leave of a row that was being written.
    (out / "rows" / ".half").mkdir()
    (out / "rows" / ".half" / "config.json").write_text("{")
    done = sweep(engine=Serial(), out=out, resume=True).summary
    assert done.before == after
    assert Path(done.table).read_bytes() == table
    assert not (out / "rows" / ".half").exists()


def test_a_sweep_that_is_killed_goes_on_to_the_same_table(table: bytes, tmp_path: Path) -> None:
    out = tmp_path / "s"
    script = (
        "import sys; from pathlib import Path; sys.path[:0] = sys.argv[2:]\n"
        "from neuralgaits._environment import prepare; prepare()\n"
        "from neuralgaits.engine import Serial\n"
        "from neuralgaits.workflows import sweep as workflow\n"
        "from support import sweep_rows\n"
        "workflow.carry_out = sweep_rows.made_up\n"
        f"workflow.sweep(['amber3m'], engine=Serial(), out=sys.argv[1], **{ASKED!r})\n"
    )
    hold = tmp_path / "s" / sweep_rows.HOLD
    out.mkdir()
    # An empty folder is what a sweep wants; the file that holds it back comes with its first row.
    words = [sys.executable, "-c", script, str(out), *sys.path]
    with subprocess.Popen(words, stderr=subprocess.PIPE) as running:
        while not (out / "sweep.json").exists():
            assert running.poll() is None, running.stderr.read().decode()  # type: ignore[union-attr]
            time.sleep(0.01)
        hold.touch()
        while not (out / "rows" / "amber3m-walking-0").exists():
            time.sleep(0.01)
        os.kill(running.pid, signal.SIGKILL)
    hold.unlink()
    done = sweep(engine=Serial(), out=out, resume=True).summary
    assert done.before >= 1
    assert Path(done.table).read_bytes() == table


def test_a_full_disk_ends_a_sweep_that_goes_on_to_the_same_table(
    table: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "s"

    def full(path: Path, content: bytes) -> None:
        if len(list(out.glob("rows/[!.]*"))) == 3:
            raise OSError(errno.ENOSPC, "No space left on device")
        write_bytes(path, content)

    with monkeypatch.context() as patch:
        patch.setattr(sweep_folder, "write_bytes", full)
        with pytest.raises(OSError, match="No space"):
            sweep(["amber3m"], engine=Serial(), out=out, **ASKED)
    done = sweep(engine=Serial(), out=out, resume=True).summary
    assert done.before == 3
    assert Path(done.table).read_bytes() == table


def test_rows_that_met_a_defect_are_tried_again_and_those_that_said_no_are_not(
    table: bytes, tmp_path: Path
) -> None:
    out = tmp_path / "s"

    def break_it(row: Any, done: int, every: int) -> None:
        (out / sweep_rows.BROKEN).touch()

    first = sweep(["amber3m"], engine=Serial(), out=out, tell=break_it, **ASKED)
    assert [row.failure for row in first.rows] == [None, "defect", "refused", "defect", None]
    assert (first.summary.failed, first.summary.lost) == (3, 2)
    assert "ZeroDivisionError: a defect" in Path(first.summary.page).read_text()
    (out / sweep_rows.BROKEN).unlink()
    again = sweep(["amber3m"], engine=Serial(), out=out, resume=True, **ASKED).summary
    assert again.before == 3
    assert Path(again.table).read_bytes() == table


def test_a_page_shows_the_rows_and_fetches_nothing(tmp_path: Path) -> None:
    done = sweep(["amber3m", "rabbit"], engine=Serial(), out=tmp_path / "s", **ASKED).summary
    page = Path(done.page).read_text()
    assert "A sweep of 10 runs" in page and "8 are proved at level 2" in page
    assert "expected a &lt;gait&gt;, found none" in page
    assert "rabbit, fblin" in page and 'href="rows/rabbit-walking-4/row.json"' in page
    assert "http" not in page.replace("http-equiv", "")
    # Its one script says of a wide table that it can be moved; the policy lets nothing be fetched.
    assert page.count("<script") == 1 and "default-src 'none'" in page


def test_another_sweep_at_work_in_the_folder_is_left_alone(tmp_path: Path) -> None:
    out = tmp_path / "s"

    def meanwhile(row: Any, done: int, every: int) -> None:
        with pytest.raises(InputError, match="expected nobody else at work"):
            sweep(engine=Serial(), out=out, resume=True)

    sweep(["amber3m"], engine=Serial(), out=out, tell=meanwhile, **ONE)


def test_resuming_with_other_settings_is_refused(tmp_path: Path) -> None:
    out = tmp_path / "s"
    sweep(["amber3m"], engine=Serial(), out=out, **ONE)
    with pytest.raises(InputError, match=r"expected the seeds .* \[0, 1\], found \[0, 2\]"):
        sweep(engine=Serial(), out=out, resume=True, seeds=(0, 2))
    with pytest.raises(InputError, match="expected the robots"):
        sweep(["rabbit"], engine=Serial(), out=out, resume=True)
    with pytest.raises(InputError, match="expected a new or empty folder for the sweep"):
        sweep(["amber3m"], engine=Serial(), out=out, **ONE)
    (out / "inputs" / "robot-0.xml").write_text("<mujoco/>")
    (out / "rows" / "amber3m-walking-0").rename(out / "gone")
    with pytest.raises(InputError, match="as it was when the sweep began"):
        sweep(engine=Serial(), out=out, resume=True)


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ([], "expected ROBOT, found none: name one or more"),
        (
            ["amber3m", "amber3m"],
            "expected robots of different names, which name the rows, found amber3m twice: amber3m "
            "and amber3m; leave one out\n",
        ),
        (
            ["amber3m", "mine/amber3m.xml"],
            "expected robots of different names, which name the rows, found amber3m twice: amber3m "
            "and mine/amber3m.xml; leave one out, or rename a file\n",
        ),
        (["amber3m", "--speeds", "0.5,0.50"], "expected speeds of different values, found 0.5"),
        (
            ["amber3m", "--walks", "9" * 400],
            "walks: expected a number of at most 308 digits",
        ),
        (["amber3n"], "unknown robot amber3n: did you mean amber3m?"),
        (["amber3m", "--seeds", "4:2"], "expected seeds A:B with A < B, found 4:2"),
        (["amber3m", "--seeds", "a"], "expected --seeds A:B or one seed, found 'a'"),
        (["amber3m", "--certify", "7"], "expected --certify 1 to 5, found 7"),
        (["amber3m", "--specs", "walkin"], "unknown spec 'walkin': did you mean walking?"),
        (["amber3m", "--specs", "walking,"], "expected --specs as A,B,..., found 'walking,'"),
        (["amber3m", "--controllers", "pid"], "unknown controller 'pid'"),
        (["amber3m", "--speeds", "fast"], "--speeds: expected numbers or LOW:HIGH in m/s"),
        (["amber3m", "--budget", "5"], "expected a budget with --certify, found it alone"),
        (["amber3m", "--workers", "0"], "expected at least 1 worker, found 0"),
        (["amber3m", "--disturbances", "no.toml"], "expected --disturbances standard, none or"),
        (["--resume"], "expected --out DIR with --resume, found none"),
        (["--resume", "--out", "nowhere"], "expected sweep.json in nowhere, found none"),
    ],
)
def test_bad_input_is_one_line_and_leaves_nothing(
    words: list[str],
    line: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["sweep", *words]) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"neuralgaits: {line}") and said.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_disturbances_come_from_a_file(tmp_path: Path) -> None:
    file = tmp_path / "own.toml"
    file.write_text('["floor +-1 cm"]\nfloor_height = 0.01\n[late]\ndelay_ms = 4\n')
    found = disturbances_of(file)
    assert list(found) == ["floor +-1 cm", "late"]
    assert found["late"]["delay_ms"] == 4.0 and found["late"]["floor_height"] == 0.0
    assert len(disturbances_of("standard")) == 18 and not disturbances_of("none")


def test_a_disturbance_has_a_text_for_a_name() -> None:
    other: Any = {1: {}}
    with pytest.raises(InputError, match="a name of one line, found 1"):
        disturbances_of(other)


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("", "expected disturbances in "),
        ("late = 3\n", "disturbance 'late': expected a table of names and numbers, found 3"),
        ('[[disturbances]]\nname = "late"\ndelay_ms = 4\n', "disturbance 'disturbances': "),
        ("[disturbances.late]\ndelay_ms = 4\n", "disturbance 'disturbances': "),
        ("[late]\ndelai_ms = 4\n", "unknown disturbance 'delai_ms'"),
        ("[late\n", "expected TOML in "),
        ("[none]\ndelay_ms = 4\n", "expected disturbances of other names than 'none'"),
    ],
)
def test_files_that_hold_no_disturbances_are_refused(text: str, line: str, tmp_path: Path) -> None:
    file = tmp_path / "own.toml"
    file.write_text(text)
    with pytest.raises(InputError) as refused:
        disturbances_of(file)
    said = str(refused.value)
    assert said.startswith(line) and "\n" not in said
    if "expected a table" in line or "[disturbances" in text:
        assert said.endswith('as in ["floor +-1 cm"] with floor_height = 0.01 below it')
