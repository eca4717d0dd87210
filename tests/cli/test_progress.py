"""What stands on stderr while something runs: on a terminal, without one, under --json."""

import os
import pty
import re
import subprocess
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

import pytest

import neuralgaits
from neuralgaits.cli.main import main
from neuralgaits.cli.progress import CheckProgress, ProofProgress, TrainingProgress, WorkProgress
from neuralgaits.errors import InputError
from neuralgaits.settings import Watch

SOURCE = Path(neuralgaits.__file__).parents[1]
COLUMNS = 80
RUN = """
import time
from neuralgaits.cli.progress import *
with TrainingProgress(quiet={quiet}) as progress:
    progress.stage(1, "refining")
    for step in range(0, 1401, 100):
        progress(step, 1400, 123.456)
        time.sleep(0.03)
with ProofProgress(quiet={quiet}) as progress:
    for share in range(11):
        progress(share / 10, 123456)
        time.sleep(0.03)
with CheckProgress(quiet={quiet}) as progress:
    progress(1, 4)
    time.sleep(0.2)
with WorkProgress("walking in MuJoCo", quiet={quiet}) as progress:
    progress.begun()
    time.sleep(0.3)
"""


def on_a_terminal(code: str) -> str:
    """Run Python with a pseudo terminal of 80 columns as stderr. Returns: what it was sent."""
    leader, follower = pty.openpty()
    environment = os.environ | {
        "PYTHONPATH": str(SOURCE),
        "TERM": "xterm",
        "COLUMNS": str(COLUMNS),
        "LINES": "24",
    }
    process = subprocess.Popen(
        [sys.executable, "-c", code], stderr=follower, stdout=subprocess.PIPE, env=environment
    )
    os.close(follower)
    sent = b""
    try:
        while chunk := os.read(leader, 4096):
            sent += chunk
    except OSError:
        pass  # Linux ends a pseudo terminal so.
    os.close(leader)
    assert process.communicate()[0] == b""
    assert process.returncode == 0, sent
    return sent.decode()


def test_bars_on_a_terminal_fit_and_go_away() -> None:
    sent = on_a_terminal(RUN.format(quiet=False))
    frames = re.split(r"[\r\n]+", re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", sent))
    bars = [frame.rstrip() for frame in frames if "ETA" in frame or "boxes" in frame]
    # A line that ends in the middle of its last column was cut.
    assert any(re.match(r"loss 123 .*1400/1400 steps 0:00:0\d ETA 0:00:00$", bar) for bar in bars)
    assert any(
        re.match(r"proved .*100\.0 %  123456 boxes bounded in the search 0:00:0\d$", bar)
        for bar in bars
    )
    assert any(
        re.match(r"checked .*25\.0 %  1/4 boxes of the proof file 0:00:0\d ETA ", bar)
        for bar in bars
    )
    assert any("walking in MuJoCo 0:00:0" in frame for frame in frames)
    assert max(len(frame) for frame in frames) <= COLUMNS
    assert "…" not in sent
    # What stays is the sentence: every bar is erased (ESC [ 2 K) when it is done.
    assert "round 1: refining" in sent
    assert sent.count("\x1b[2K") >= 4


def test_json_is_silent_on_a_terminal() -> None:
    assert on_a_terminal(RUN.format(quiet=True)) == ""


def test_training_without_a_terminal_is_a_few_lines(capsys: pytest.CaptureFixture[str]) -> None:
    with TrainingProgress() as progress:
        for step in range(1, 1001):
            progress(step, 1000, 1.0 / step)
    out, err = capsys.readouterr()
    assert out == ""
    lines = err.splitlines()
    assert 10 <= len(lines) <= 12
    assert lines[-1].startswith("step 1000/1000  loss 0.001  ETA 0 s")


def test_a_proof_without_a_terminal_is_a_few_lines(capsys: pytest.CaptureFixture[str]) -> None:
    """However many rounds its search has, and the last line says that it is done."""
    with ProofProgress() as progress:
        for k in range(1001):
            progress(k / 1000, 10 * k)
    lines = capsys.readouterr().err.splitlines()
    assert 10 <= len(lines) <= 12
    assert lines[0] == "proved 0.0 %  0 boxes bounded in the search"
    assert lines[-1] == "proved 100.0 %  10000 boxes bounded in the search"
    with CheckProgress() as progress:
        for done in range(501):
            progress(done, 500)
    lines = capsys.readouterr().err.splitlines()
    assert 10 <= len(lines) <= 12
    assert lines[-1] == "checked 100.0 %  500/500 boxes of the proof file"


def test_a_search_that_stands_still_says_so_now_and_then(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """99 % for five minutes, a round a second: a line every half minute."""
    now = iter(range(10_000))
    monkeypatch.setattr("neuralgaits.cli.progress.time.monotonic", lambda: float(next(now)))
    progress = ProofProgress()
    for _ in range(300):
        progress(0.99, 7)
    assert len(capsys.readouterr().err.splitlines()) == 10


def test_a_training_says_without_a_terminal_that_it_compiles(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """One line once it begins, none under --json; what is refused before has only its own."""

    def begins(*_: object, watch: Watch, **__: object) -> None:
        assert watch.begun is not None
        watch.begun()
        raise InputError("refused later")

    monkeypatch.setattr(import_module("neuralgaits.workflows.train"), "train", begins)
    monkeypatch.setattr(
        import_module("neuralgaits.workflows.train_seeds"),
        "train_seeds",
        lambda *_, begun, **__: begins(watch=Watch(begun=begun)),
    )
    for words in (["train", "amber3m"], ["train", "amber3m", "--seeds", "0:2"]):
        assert main(words) == 2
        begun, refused = capsys.readouterr().err.splitlines()
        assert begun.startswith("compiling, ") and refused == "neuralgaits: refused later"
        assert main([*words, "--json"]) == 2
        assert capsys.readouterr() == ("", "neuralgaits: refused later\n")


def test_work_without_countable_steps_has_one_line_without_a_terminal(
    capsys: pytest.CaptureFixture[str],
) -> None:
    for quiet in (False, True):
        with WorkProgress("walking", quiet=quiet) as progress:
            progress.begun()
    assert capsys.readouterr() == ("", "walking\n")


WAITING = {
    "export.export_controller": ["export", "run", "--out", "c"],
    "import_gait.import_gait": ["import-gait", "gait.json", "--robot", "amber3m"],
    "optimise.optimise": ["optimise", "amber3m", "--speed", "0.7"],
    "report.write_report": ["report", "run"],
    "simulate.simulate": ["simulate", "run"],
    "sweep.sweep": ["sweep", "amber3m"],
}


@pytest.mark.parametrize("function", WAITING)
def test_a_verb_says_what_it_does_once_it_begins(
    function: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """One line without a terminal, none under --json; what is refused before has only its own."""

    def begins(*_: object, begun: Callable[..., None], **__: object) -> None:
        begun(*(["2 rows"] if function == "sweep.sweep" else []))
        raise InputError("refused later")

    module, name = function.split(".")
    monkeypatch.setattr(import_module(f"neuralgaits.workflows.{module}"), name, begins)
    assert main(WAITING[function]) == 2
    begun, refused = capsys.readouterr().err.splitlines()
    assert begun and refused == "neuralgaits: refused later"
    assert main([*WAITING[function], "--json"]) == 2
    assert capsys.readouterr() == ("", "neuralgaits: refused later\n")


@pytest.mark.parametrize("quiet", [False, True])
def test_a_bar_is_silent_without_a_terminal(
    capsys: pytest.CaptureFixture[str], quiet: bool
) -> None:
    with WorkProgress("walking", quiet=quiet), TrainingProgress(quiet=True) as progress:
        progress(1, 1, 0.0)
        progress.stage(0, "walking")
    assert capsys.readouterr() == ("", "")
