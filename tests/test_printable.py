"""Paths are bytes: those that are no UTF-8 are shown, written and named again."""

import json
import os
from pathlib import Path

import pytest

from neuralgaits._environment import prepare
from neuralgaits._printable import PRINTABLE, printable
from neuralgaits.runs import RunFolder, finish, resolve, to_json, write_text
from neuralgaits.runs.shell_words import command

BROKEN = os.fsdecode(b"run-\xff")


def test_text_that_utf8_can_hold_stays() -> None:
    assert printable("läuft ≤ 1") == "läuft ≤ 1"


def test_bytes_that_are_no_utf8_are_escaped() -> None:
    assert printable(BROKEN) == r"run-\xff"
    assert printable(Path(BROKEN)) == r"run-\xff"
    assert printable("half \ud800 of a character") == r"half \ud800 of a character"


def test_a_name_that_an_ascii_locale_read_is_read_as_it_is_meant() -> None:
    assert printable("l\udcc3\udca4uft") == "läuft"


@pytest.mark.parametrize(
    ("encoding", "wanted"),
    [("utf-8", r"lä \xff ä".encode()), ("ascii", rb"l\xe4 \xff \xe4")],
)
def test_streams_of_any_encoding_take_every_name(encoding: str, wanted: bytes) -> None:
    assert "lä \udcff \udcc3\udca4".encode(encoding, PRINTABLE) == wanted


def test_json_holds_paths_as_text(tmp_path: Path) -> None:
    text = to_json({BROKEN: [Path(BROKEN), BROKEN]})
    write_text(tmp_path / "found.json", text)
    found = json.loads((tmp_path / "found.json").read_bytes())
    assert found == {r"run-\xff": [r"run-\xff", r"run-\xff"]}


def test_json_for_a_stream_of_ascii_is_json() -> None:
    text = to_json({"run": "läuft", "other": BROKEN}, ascii_only=True)
    assert text.isascii()
    assert json.loads(text) == {"run": "läuft", "other": r"run-\xff"}


def test_a_command_names_the_bytes() -> None:
    assert command("report", BROKEN) == r"neuralgaits report $'run-\xff'"
    name = os.fsdecode(b"it's \\ \xff")
    assert command("report", name) == r"neuralgaits report $'it\x27s \x5c \xff'"
    assert command("report", "it's ä") == """neuralgaits report 'it'"'"'s ä'"""


def test_latest_finds_a_run_whose_name_is_no_utf8(tmp_path: Path) -> None:
    root = tmp_path / "runs"
    try:
        folder = RunFolder.create({}, {}, name="biped", seed=0, root=root, out=root / BROKEN)
    except OSError:
        pytest.skip("this file system has UTF-8 names only")
    finish(folder, {"run": str(folder.path)}, root)
    assert resolve("latest", root).path == root / BROKEN
    assert resolve("latest", root).read_json("summary.json")["run"].endswith(r"run-\xff")


@pytest.mark.parametrize("variable", ["XDG_CACHE_HOME", "JAX_COMPILATION_CACHE_DIR"])
def test_a_cache_that_xla_cannot_name_is_left_out(
    variable: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "environ", {"HOME": "/home", variable: f"/{BROKEN}"})
    prepare()
    assert "JAX_COMPILATION_CACHE_DIR" not in os.environ
