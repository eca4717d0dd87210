"""One result or one line, on the right stream, with the right exit code."""

import errno
import io
import json
import logging
import os
import subprocess
import sys
import warnings
from pathlib import Path
from typing import Any

import pytest

import neuralgaits
from neuralgaits import errors
from neuralgaits._cache import cache_folder
from neuralgaits.barriers import specs
from neuralgaits.cli import argv_parser, misspelt, verbs
from neuralgaits.cli import main as entry
from neuralgaits.cli.main import main
from neuralgaits.cli.outcome import Outcome
from neuralgaits.robots import load_robot
from neuralgaits.runs import RUNS_ROOT, RunFolder, finish
from neuralgaits.workflows import simulate as simulating
from neuralgaits.workflows import train as training

Captured = pytest.CaptureFixture[str]


@pytest.fixture
def answer(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Replace the work of every verb by a function without arguments."""

    def replace(work: Any) -> None:
        monkeypatch.setattr(verbs, "carry_out", lambda verb: work())

    return replace


def _raise(error: BaseException) -> Any:
    def work() -> Outcome:
        raise error

    return work


def _only_line(capfd: Captured) -> str:
    out, err = capfd.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert err.startswith("neuralgaits: ")
    return err


@pytest.mark.parametrize(
    ("arguments", "found"),
    [
        (["walk"], "no command walk: expected one of train, simulate, certify, check-proof, fit"),
        (["trian", "amber3m"], "no command trian; did you mean train?"),
        (["check-prof", "x"], "did you mean check-proof?"),
        (["train"], "ROBOT"),
        (
            ["train", "amber3m", "--init", "zero"],
            "--init: expected posture or random, found 'zero'\n",
        ),
        (
            ["simulate", "r", "--controller=fbln"],
            "expected pd, fblin, paper, clf-qp, scheduled-pd or c, found 'fbln'; did you mean",
        ),
        (["train", "amber3m", "--steps", "many"], "'many'"),
        (["train", "amber3m", "--hidden", "32,"], "32,32"),
        (
            ["simulate", "latest", "--controller"],
            "--controller: expected pd, fblin, paper, clf-qp, scheduled-pd or c, found none\n",
        ),
        (
            ["simulate", "latest", "--steps", "--json"],
            "--steps: expected a whole number, found none",
        ),
        (["simulate", "latest", "--disturb"], "--disturb: expected a value, found none\n"),
        (
            ["certify", "r", "--level", "٣"],
            "--level: expected the digits 0 to 9, found '٣': write 3",
        ),
        (["view", "latest", "--port=８０８０"], "expected the digits 0 to 9, found '８０８０'"),
        (
            ["simulate", "r", "--push", "１.5"],
            "expected the digits 0 to 9, found '１.5': write 1.5",
        ),
        (["train", "amber3m", "--speed", "0.5:٠.9"], "found '٠.9': write 0.9"),
        (["train", "amber3m", "--seeds", "0:٣"], "found '٣': write 3"),
        (["train", "amber3m", "--hidden", "32,٣٢"], "found '٣٢': write 32"),
        (["simulate", "r", "--disturb", "friction=٠.5"], "found '٠.5': write 0.5"),
        (["certify", "r", "--within", "speed=0.7:०.8"], "found '०.8': write 0.8"),
        (["simulate", "r", "--steps", "1_0"], "--steps: expected the digits 0 to 9, found '1_0'"),
        (["simulate", "r", "--push", "1_0.5"], "found '1_0.5': write 10.5"),
        (["simulate", "r", "--disturb", "friction=0.1_5"], "found '0.1_5': write 0.15"),
        (["train", "amber3m", "--speed", "0_7"], "found '0_7': use a point for decimals, and no _"),
        (["train", "amber3m", "--speed", "0_0.5:1"], "found '0_0.5': write 0.5"),
        (["train", "amber3m", "--seeds", "0:1_000_000"], "found '1_000_000': write 1000000"),
        (["train", "amber3m", "--hidden", "3_2"], "found '3_2': write 32"),
        (["train", "amber3m", "--hidden", "9" * 5000], "--hidden as positive whole numbers"),
        (["train", "amber3m", "--seeds", "9" * 5000], "--seeds A:B or one seed, found"),
        (["simulate", "r", "--seed", "9" * 400], "found a number of 400 digits"),
        (["simulate", "latest", "--disturb="], "--disturb: expected a value, found ''\n"),
        (["simulate", "latest", "--link", " "], "--link: expected a value, found ' '\n"),
        (["sweep", "amber3m", "--specs", ""], "--specs: expected a value, found ''\n"),
        (["view", "latest", "--no-browser=1"], "--no-browser: expected no value, found '1'\n"),
        (["export", "latest"], "expected --out DIR, found none; see `neuralgaits export --help`\n"),
        (["export"], "expected RUN, found none: name one, as in `neuralgaits export latest`\n"),
        (["fit", "latest"], "expected LOG.csv..., found none: see `neuralgaits fit --help`\n"),
        (["train", "amber3m", "rabbit"], "train takes ROBOT beside its options, found 'rabbit'"),
        (["doctor", "x"], "doctor takes no word beside its options, found 'x'"),
        (["view", "latest", "-p"], "unknown option -p of view; see `neuralgaits view --help`\n"),
        (["simulate", "latest", "--speed", "3"], "--speed"),
        (
            ["train", "amber3m", "--stpes", "5"],
            "option --stpes of train; did you mean --steps?",
        ),
        (["train", "amber3m", "--step_lenth=1"], "did you mean --step-length?"),
        (["view", "latest", "--prot", "1"], "unknown option --prot of view; did you mean --port?"),
        (["demo", "--zzz"], "unknown option --zzz of demo; see `neuralgaits demo --help`"),
        (
            ["certify", "r", "--within", "a=0:1", "--within=b=0:1"],
            "expected --within once, found it twice: leave one out, or join NAME=... by commas",
        ),
        (["simulate", "latest", "--push", "abc"], "--push: expected a number, found 'abc'"),
        (["simulate", "latest", "--push=abc"], "--push: expected a number, found 'abc'"),
        (["view", "latest", "--port", "1.5"], "--port: expected a whole number, found '1.5'"),
    ],
)
def test_bad_usage_is_one_line_and_2(capfd: Captured, arguments: list[str], found: str) -> None:
    assert main(arguments) == 2
    assert found in _only_line(capfd)


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (errors.RobotError("expected\n  two feet"), 2),
        (errors.RunError("expected a run"), 2),
        (errors.NonFiniteError("loss is NaN"), 1),
        (PermissionError(13, "Permission denied", "runs"), 2),
        (OSError(errno.ENOSPC, "No space left on device"), 2),
        (ZeroDivisionError("division by zero"), 70),
        (KeyboardInterrupt(), 130),
    ],
)
def test_errors_have_their_codes(capfd: Captured, answer: Any, error: Any, code: int) -> None:
    answer(_raise(error))
    assert main(["robots", "--json"]) == code
    assert "Traceback" not in _only_line(capfd)


@pytest.mark.parametrize("arguments", [["-v", "robots"], ["robots", "--verbose"]])
def test_verbose_adds_the_traceback(capfd: Captured, answer: Any, arguments: list[str]) -> None:
    answer(_raise(errors.RunError("expected a run")))
    assert main(arguments) == 2
    out, err = capfd.readouterr()
    assert out == ""
    assert "Traceback" in err
    assert err.splitlines()[-1] == "neuralgaits: expected a run"


@pytest.mark.parametrize(
    ("arguments", "error", "told"),
    [
        (
            ["train", "my robot.xml"],
            KeyboardInterrupt(),
            "; nothing is kept yet, begin again with `neuralgaits train 'my robot.xml'`",
        ),
        (
            ["train", "amber3m"],
            errors.Interrupted("neuralgaits train --resume runs/x"),
            "; go on with `neuralgaits train --resume runs/x`",
        ),
        # Before it has begun, what was to be gone on with is as it was.
        (
            ["train", "--resume", "runs/x"],
            KeyboardInterrupt(),
            "; go on with `neuralgaits train --resume runs/x`",
        ),
        (["simulate", "runs/x"], KeyboardInterrupt(), ""),
    ],
)
def test_after_an_interrupt_only_what_is_kept_can_be_gone_on_with(
    capfd: Captured, answer: Any, arguments: list[str], error: BaseException, told: str
) -> None:
    answer(_raise(error))
    assert main(arguments) == 130
    assert _only_line(capfd) == f"neuralgaits: interrupted{told}\n"


@pytest.mark.parametrize("flags", [[], ["-v"]])
def test_an_error_that_cannot_be_written_has_its_code(
    answer: Any, monkeypatch: pytest.MonkeyPatch, flags: list[str]
) -> None:
    answer(_raise(errors.InputError("expected A, found B")))

    class Full(io.StringIO):
        def write(self, text: str) -> int:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(sys, "stderr", Full())
    assert main(["doctor", *flags]) == 2


def test_an_error_keeps_the_blanks_of_a_path(capfd: Captured, answer: Any) -> None:
    """One line, but a path in it must stay the path."""
    answer(_raise(errors.RunError("expected a run\n   in `two  blanks`")))
    assert main(["robots"]) == 2
    assert _only_line(capfd) == "neuralgaits: expected a run in `two  blanks`\n"


@pytest.mark.parametrize(("place", "told"), [(None, ""), ("runs/x", " at runs/x")])
def test_a_full_disk_is_named_with_what_to_do(
    capfd: Captured, answer: Any, place: str | None, told: str
) -> None:
    answer(_raise(OSError(errno.ENOSPC, "No space left on device", place)))
    assert main(["robots"]) == 2
    line = f"neuralgaits: expected room to write{told}, found none (No space left on device): "
    assert _only_line(capfd).startswith(line + "free some")


@pytest.mark.parametrize(("good", "code"), [(True, 0), (False, 1)])
def test_json_stands_alone_on_stdout(capfd: Captured, answer: Any, good: bool, code: int) -> None:
    def chatter() -> Outcome:
        print("from python")
        os.write(1, b"from a C library\n")
        return Outcome({"value": float("nan"), "list": (1, 2)}, good=good, table=print)

    answer(chatter)
    assert main(["robots", "--json"]) == code
    out, err = capfd.readouterr()
    assert json.loads(out) == {"value": None, "list": [1, 2]}
    assert "from python" in err
    assert "from a C library" in err


@pytest.mark.parametrize("arguments", [["--help"], []])
def test_help_is_on_stdout_and_good(capfd: Captured, arguments: list[str]) -> None:
    assert main(arguments) == 0
    out, err = capfd.readouterr()
    assert "simulate" in out
    assert err == ""


def test_the_help_says_a_default_where_there_is_one(capfd: Captured) -> None:
    assert main(["simulate", "--help"]) == 0
    out = " ".join(capfd.readouterr().out.split())
    assert "(default: None)" not in out
    assert "(default: False)" not in out
    assert "(default: 50)" in out


def test_the_help_breaks_lines_where_the_terminal_ends(
    capfd: Captured, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "400")
    assert main(["train", "--help"]) == 0
    out = capfd.readouterr().out
    # The second breaks after "or", the third in settings that several verbs have.
    assert "rugged (faster, for pushes and uneven floors), paper" in out
    assert "its folder, or latest for the last one started. All other settings" in out
    assert main(["certify", "--help"]) == 0
    assert "auto on a machine that is part of one, or local for one" in capfd.readouterr().out


def test_every_option_of_every_verb_is_known_to_the_speller() -> None:
    """The parser and the look-out for misspelt words read the same classes."""
    for name, verb in argv_parser._VERBS.items():
        for option, one in misspelt.options_of(verb).items():
            value = one.kind[0] if isinstance(one.kind, tuple) else "1"
            given = [option] if one.kind is bool else [option, value]
            misspelt.refuse_misspelt([name, *given, "--help"], argv_parser._VERBS)
    options = misspelt.options_of(argv_parser._VERBS["train"])
    assert {"--step-length", "--certify", "--json"} <= set(options)
    assert "--robot" not in options


@pytest.mark.parametrize("words", [["simulate", "latest"], ["simulate", "-v", "latest"]])
def test_the_help_of_a_verb_is_whole_whatever_is_given(capfd: Captured, words: list[str]) -> None:
    assert main([words[0], "--help"]) == 0
    whole = capfd.readouterr().out
    assert "RUN" in whole.splitlines()[0]
    assert main([*words, "--help"]) == 0
    assert capfd.readouterr().out == whole


def test_the_help_names_every_spec_and_how_to_reach_the_supervisor(
    capfd: Captured, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "2000")
    assert main(["train", "--help"]) == 0
    out = capfd.readouterr().out
    assert all(name in out for name in specs.BUILT_IN)
    assert main(["simulate", "--help"]) == 0
    assert "To walk with the supervisor, use c with --link address=" in capfd.readouterr().out


def test_help_is_a_word_too(capfd: Captured) -> None:
    assert main(["help", "simulate"]) == 0
    assert "Walk a trained gait at full order" in capfd.readouterr().out
    assert main(["help"]) == 0
    assert "check-proof" in capfd.readouterr().out


def test_version(capfd: Captured) -> None:
    assert main(["--version"]) == 0
    assert capfd.readouterr().out == f"neuralgaits {neuralgaits.__version__}\n"


def test_a_crash_of_compiled_code_is_not_silent() -> None:
    script = (
        "import ctypes, sys; from neuralgaits.cli import main as entry\n"
        "entry.main = lambda _: ctypes.string_at(0)\n"
        "sys.argv = ['neuralgaits']; entry.run()"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert done.returncode < 0 and "Fatal Python error" in done.stderr


def test_environment_keeps_what_the_user_set(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    environment = {"JAX_COMPILATION_CACHE_DIR": "mine", "XDG_CACHE_HOME": str(tmp_path)}
    monkeypatch.setattr(os, "environ", dict(environment))
    entry.prepare()
    assert os.environ["JAX_COMPILATION_CACHE_DIR"] == "mine"
    assert os.environ["JAX_ENABLE_X64"] == "1"
    assert cache_folder() == tmp_path / "neuralgaits"
    # One thread of NumPy is ours; another number is the user's.
    assert os.environ["OPENBLAS_NUM_THREADS"] == "1"
    os.environ["OPENBLAS_NUM_THREADS"] = "3"
    entry.prepare()
    assert os.environ["OPENBLAS_NUM_THREADS"] == "3"


def test_warnings_of_libraries_are_shown_to_who_asks_for_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(os, "environ", dict(os.environ))
    monkeypatch.setattr(sys, "warnoptions", ["default"])
    entry.prepare()
    with pytest.raises(RuntimeWarning):
        warnings.warn("All-NaN slice encountered", RuntimeWarning, stacklevel=1)
    monkeypatch.setattr(sys, "warnoptions", [])
    entry.prepare()
    warnings.warn("All-NaN slice encountered", RuntimeWarning, stacklevel=1)


def test_lines_of_libraries_stay_off_the_screen(
    monkeypatch: pytest.MonkeyPatch, capfd: Captured
) -> None:
    monkeypatch.setattr(os, "environ", dict(os.environ))
    monkeypatch.setattr(sys, "warnoptions", [])
    monkeypatch.setattr(logging, "lastResort", logging.lastResort)
    entry.prepare()
    # No handler is in the way, as outside of pytest.
    monkeypatch.setattr(logging.getLogger(), "handlers", [])
    logging.getLogger("matplotlib.font_manager").warning("findfont: Font family not found.")
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("backend", ["module://matplotlib_inline.backend_inline", "nonsense"])
def test_the_back_end_of_a_notebook_is_none_of_the_command_line_s(
    monkeypatch: pytest.MonkeyPatch, backend: str
) -> None:
    monkeypatch.setattr(os, "environ", {**os.environ, "MPLBACKEND": backend})
    entry.prepare()
    assert os.environ["MPLBACKEND"] == "agg"


@pytest.mark.parametrize(
    ("flag", "value"),
    [
        ("--spec", "walking"),
        ("--seed", "0"),
        ("--steps", "5"),
        ("--init", "posture"),
        ("--hidden", "8,8"),
        ("--budget", "9"),
        ("--out", "elsewhere"),
    ],
)
def test_resume_refuses_the_settings_a_run_has_of_its_own(
    capfd: Captured, flag: str, value: str
) -> None:
    assert main(["train", "amber3m", "--resume", "latest", flag, value]) == 2
    assert f"found it with {flag}:" in _only_line(capfd)


def test_resume_latest_says_which_run_it_took(
    capfd: Captured, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    folder = RunFolder.create({"robot": "amber3m"}, {}, name="amber3m", seed=3, root=RUNS_ROOT)

    def halt(robot: Any, **settings: Any) -> None:
        assert settings["resume"] == folder.path
        assert {name for name, value in settings.items() if value} == {
            *("resume", "progress", "watch", "root")
        }
        raise errors.RunError("halted")

    monkeypatch.setattr(training, "train", halt)
    assert main(["train", "amber3m", "--resume", "latest"]) == 2
    out, err = capfd.readouterr()
    assert out == ""
    assert err == f"resuming {folder.path}\nneuralgaits: halted\n"


@pytest.mark.parametrize("flags", [[], ["--json"]])
def test_a_verb_says_which_run_latest_is(
    capfd: Captured, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, flags: list[str]
) -> None:
    """A failed training leaves `latest` with another robot's run; programs need no such line."""
    monkeypatch.chdir(tmp_path)
    done = RunFolder.create({"robot": "amber3m"}, {}, name="amber3m", seed=0, root=RUNS_ROOT)
    finish(done, {}, RUNS_ROOT)
    failed = RunFolder.create({"robot": "walker2d"}, {}, name="walker2d", seed=0, root=RUNS_ROOT)
    monkeypatch.setattr(simulating, "simulate", lambda *_, **__: _raise(errors.RunError("no"))())
    assert main(["simulate", "latest", *flags]) == 2
    told = f"latest is {done.path}, robot amber3m; {failed.path}, started later, has not finished\n"
    assert capfd.readouterr().err == ("" if flags else told) + "neuralgaits: no\n"
    assert main(["simulate", str(done.path)]) == 2
    assert capfd.readouterr().err == "neuralgaits: no\n"


@pytest.mark.parametrize(
    ("words", "found"),
    [
        ("simulate latest", "train one first"),
        ("simulate runs/none", "expected a run folder at runs/none, found nothing"),
        (
            "robots rabbit --out runs/latest/x.xml",
            "a folder at runs/latest, found a file: move it away, or name",
        ),
        ("inspect runs/file/x.xml", "cannot read runs/file/x.xml (Not a directory): give an MJCF"),
        ("robots rabitt", "unknown robot rabitt: did you mean rabbit? use one of amber3m"),
        ("robots rabbit", "found none: write `neuralgaits robots rabbit --out rabbit.xml`"),
        ("train amber3m --parameters mass=2", "mass as a share such as 2% or 0.02, found 2: write"),
        ("view latest --port 99999", "expected --port from 1 to 65535, found 99999"),
    ],
)
def test_what_cannot_be_used_is_one_line(
    capfd: Captured, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, words: str, found: str
) -> None:
    monkeypatch.chdir(tmp_path)
    if "latest/" in words or "file/" in words:
        (tmp_path / "runs").mkdir()
        for name in ("latest", "file"):
            (tmp_path / "runs" / name).write_text("amber3m/one\n")
    assert main(words.split()) == 2
    assert found in _only_line(capfd)


LONG = "x" * 9999


@pytest.mark.parametrize(
    "words",
    [
        [LONG],
        ["train", f"--{LONG}"],
        ["train", "amber3m", "--spec", LONG],
        ["train", "amber3m", "--speed", LONG],
        ["train", "amber3m", "--hidden", LONG],
        ["train", "amber3m", "--seed", LONG],
        ["train", "amber3m", "--parameters", f"{LONG}=1%"],
        ["train", "amber3m", "--parameters", f"mass={' x' * 9999}"],
        ["train", LONG[:300]],
        ["simulate", LONG[:300]],
        ["inspect", "robot.xml"],
    ],
)
def test_a_message_shows_only_the_beginning_of_a_long_name(
    capfd: Captured, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, words: list[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    robot = load_robot("amber3m").layout.xml.replace("hip_left", LONG)
    named = f'name="{LONG}"'
    Path("robot.xml").write_text(robot.replace(named, f'{named} frictionloss="1"', 1))
    assert main(words) == 2
    line = _only_line(capfd)
    assert len(line) < 1000 and ("characters)" in line or "a name of 300 bytes" in line)


def test_a_path_that_can_be_there_is_shown_whole() -> None:
    path = "/".join(["x" * 255] * 15)
    assert str(errors.RunError(f"expected a run at {path}")).endswith(path)
