"""Altered inputs are refused in one line, or read; a hundred thousand: benchmarks/fuzz.py."""

import sys

import numpy as np
import pytest

from support.fuzzing import cases, commands
from support.fuzzing.alter import altered_bytes, altered_json
from support.fuzzing.doors import KINDS, inputs, readers
from support.fuzzing.formats import altered
from support.fuzzing.paths import ALLOWED, WORDS_OF_PATHS
from support.fuzzing.watch import Block, watch

pytestmark = pytest.mark.filterwarnings("ignore")
CASES = {
    "proof files": 60,
    "run folders": 25,
    "robot files": 60,
    "spec files": 30,
    "names and settings": 60,
    "paths": 60,
}
HELD = """
import json, os, pathlib, sys, time
ANSWER = dict(read=1, refused=0, told=0, tracebacks=[], lost=[], s=0.0)
print('"ready"', flush=True)
for number in range(int(sys.argv[3]), int(sys.argv[4])):
    print(number, flush=True)
    if number == 2:
        pathlib.Path(f"held-{{os.getpid()}}").touch()
        {what}
    print(json.dumps(ANSWER), flush=True)
"""


@pytest.fixture(autouse=True)
def back(monkeypatch, tmp_path):
    """Cases change the working directory."""
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("kind", CASES)
def test_no_input_gives_a_traceback_or_costs_a_file(place, kind):
    answers = [cases.carry(place, kind, number) for number in range(CASES[kind])]
    assert [line for answer in answers for line in answer.tracebacks + answer.lost] == []
    # A whole input is read wherever it lies.
    expected = "read" if kind == "paths" else "refused"
    assert sum(getattr(answer, expected) for answer in answers) > 0


def test_every_input_is_read_when_it_is_whole(place):
    for kind in KINDS:
        for name in inputs(place, kind):
            for reader in readers(name):
                reader(place, place.root / name)
    place.put_back(None)


def test_a_door_that_fails_and_one_that_loses_a_file_are_seen(place, monkeypatch):
    def fails(place, path):
        raise KeyError("no such field")

    def loses(place, path):
        (place.root / "run" / "policy.safetensors").unlink()

    monkeypatch.setattr(cases, "readers", lambda name: (fails, loses))
    answer = cases.carry(place, "spec files", 0)
    assert len(answer.tracebacks) == 1 and "KeyError" in answer.tracebacks[0]
    assert answer.lost == ["run/policy.safetensors"]
    monkeypatch.undo()
    assert (place.root / "run" / "policy.safetensors").is_file()


@pytest.mark.parametrize(("what", "found"), [("time.sleep(60)", "hang"), ("os.abort()", "crash")])
def test_a_case_that_never_ends_or_kills_its_process_is_named(
    place, tmp_path, monkeypatch, what, found
):
    monkeypatch.setattr("support.fuzzing.watch._note", _told := _Notes())
    # No clock: patience ends once the case holds the process.
    monkeypatch.setattr(
        "support.fuzzing.watch.Patience.spent",
        lambda self: (tmp_path / f"held-{self.pid}").exists(),
    )
    script = tmp_path / "worker.py"
    script.write_text(HELD.format(what=what))
    block = Block("spec files", 0, 5)
    findings = watch([block], [sys.executable, str(script)], 1, tmp_path / "kept")
    assert [(at, line.partition(":")[0]) for line, at in _told.seen] == [(2, found)]
    assert findings["spec files"].inputs == 5


class _Notes:
    """What is noted of cases, without the inputs."""

    def __init__(self):
        self.seen = []

    def __call__(self, what, block, at, *rest):
        self.seen.append((what, at))


@pytest.mark.parametrize("number", range(4))
def test_the_command_line_answers_in_one_line(place, number):
    code, complaints = commands.answer_of(place, number)
    assert complaints == [] and code in (0, 1, 2, 3)


def test_a_number_gives_one_input(place):
    for kind in CASES:
        one, other = (cases.case_of(place, kind, 7) for _ in range(2))
        assert one == other


@pytest.mark.parametrize("name", ["a.json", "a.csv", "a.xml", "a.safetensors", "a.py"])
def test_alterations_bear_anything(name):
    draw = np.random.default_rng(0)
    for content in (b"", b"\x00", b"{", b'{"a": [1, {"b": null}]}', b"a,b\n1,2\n", b'<a b="1"/>'):
        seen = {altered(name, content, draw) for _ in range(20)}
        assert len(seen) > 1
    assert altered_bytes(b"", draw) is not None and altered_json(b"[]", draw) != b""


def test_paths_have_every_byte_that_a_path_can_have(place):
    paths = [cases.case_of(place, cases.PATHS, number).content for number in range(len(ALLOWED))]
    assert set().union(*paths) == set(range(1, 256))
    for path in paths:
        first, *parts = path.split(b"/")
        assert first == b"odd" and parts and not {b"", b".", b".."} & set(parts)


def test_whole_inputs_at_odd_paths_are_read_and_written(place):
    """Those that are text here; of all others the benchmark tells."""
    numbers = [number for number in range(100) if _is_text(place, number)][:8]
    answers = [cases.carry(place, cases.PATHS, number) for number in numbers]
    assert [line for answer in answers for line in answer.tracebacks + answer.lost] == []
    assert sum(answer.read for answer in answers) > 20
    assert not (place.root / "odd").exists()


def _is_text(place, number):
    try:
        cases.case_of(place, cases.PATHS, number).content.decode()
    except UnicodeDecodeError:
        return False
    return True


def test_commands_about_odd_paths_leave_nothing(place, monkeypatch):
    seen = []
    monkeypatch.setattr(commands, "main", lambda words: seen.append(words) or 0)
    for number in range(len(WORDS_OF_PATHS)):
        at = commands.ODD_ONE * (number + 1) - 1
        commands.answer_of(place, at)
    assert [words[0] for words in seen] == [words("x")[0] for _, _, words in WORDS_OF_PATHS]
    assert all("odd/" in " ".join(words) for words in seen)
    assert not (place.root / "odd").exists()
