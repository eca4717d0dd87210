"""Outputs onto what is there already: links, FIFOs, devices, folders, read-only places, full disks.

Every verb with an output writes onto every kind of thing through the command line. Before and
after, the folder that it works in is looked at without following links. What was there has to be
there still, unless it is a regular file that the command was asked to replace; what is refused is
refused in one line with exit code 2 and leaves no file behind; what is written is whole.

Asked: 0 destroyed, 0 half-written, 0 wrong. Devices and mounts need a superuser on Linux:
elsewhere these cases are counted as left out. `outputs.py WORD ...` carries out the cases whose
names have one of these words.
"""

import contextlib
import hashlib
import io
import json
import os
import shutil
import signal
import stat
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from common import show

from neuralgaits.cli.main import main as command_line
from support.output_places import (
    LeftOut,
    Make,
    dangling,
    device,
    file,
    folder,
    full,
    inside,
    link,
    linked_folder,
    read_only,
    ring,
    stream,
    unmounted,
)
from support.shipped_run import SHIPPED

SPEC = f"{Path(__file__).parents[1] / 'tests' / 'support' / 'brief_spec.py'}:brief"
NOTEBOOKS = Path(__file__).parents[1] / "tools" / "run_notebooks.py"
LONGEST_S = 300
"""A command that waits for a FIFO would wait for ever."""
TRAIN = ("train", "amber3m", "--spec", SPEC, "--hidden", "4", "--steps", "2", "--out")
CERTIFY = ("certify", "run", "--level", "1")
EPISODES = ("episodes", "amber3m", "--plant", "amber3m", "--rounds", "1", "--out")
SWEEP = ("sweep", "amber3m", "--specs", SPEC, "--seeds", "0:1", "--steps", "2", "--out")


@dataclass(frozen=True)
class Case:
    """A command and what lies where it writes.

    Attributes:
        name: verb and kind of place.
        words: of the command.
        make: makes the place.
        accepted: whether the command is to be carried out.
        changed: what it may make or replace, if it is carried out; names begin so.
        beside: what it may make or replace even if it ends with a refusal.
    """

    name: str
    words: Sequence[str]
    make: Make
    accepted: bool = False
    changed: Sequence[str] = ()
    beside: Sequence[str] = ()


FILES: dict[str, tuple[Make, bool, Sequence[str]]] = {
    "link": (link, True, ("place/target",)),
    "dangling link": (dangling, True, ("place/target",)),
    "file": (file, True, ("place/out",)),
    "ring of links": (ring, False, ()),
    "FIFO": (os.mkfifo, False, ()),
    "device": (device, False, ()),
    "folder": (folder, False, ()),
    "open stream": (stream, False, ()),
    "read-only disk": (read_only, False, ()),
    "full disk": (full, False, ()),
}
"""What may lie where a file is to be written: how it is made, whether it is taken, what changes."""
FOLDERS: dict[str, tuple[Make, bool, Sequence[str]]] = {
    "link to an empty folder": (linked_folder, True, ("place/elsewhere",)),
    "dangling link": (dangling, True, ("place/target",)),
    "ring of links": (ring, False, ()),
    "FIFO": (os.mkfifo, False, ()),
    "device": (device, False, ()),
    "file": (file, False, ()),
    "full folder": (folder, False, ()),
}
READ_ONLY = inside("x", read_only)
FULL = inside("x", full)


def cases() -> Iterator[Case]:
    """Make all cases."""
    for verb, words, end, beside, refused in (
        ("simulate", ("simulate", "run", "--steps", "2", "--log"), ".csv", ("run/simulation",), ()),
        ("report", ("report", "run", "--out"), ".html", ("run/figures", "run/report"), ()),
        ("robots", ("robots", "amber3m", "--out"), ".xml", (), ("link", "dangling link", "file")),
        (
            "inspect",
            ("inspect", "amber3m", "--planarise"),
            ".xml",
            (),
            ("link", "dangling link", "file"),
        ),
    ):
        for kind, (make, accepted, changed) in FILES.items():
            taken = accepted and kind not in refused
            name = f"place/out{end}"
            yield Case(f"{verb}: {kind}", (*words, name), make, taken, changed, beside)
    for kind in ("ring of links", "FIFO", "device", "folder", "read-only disk"):
        film = ("simulate", "run", "--steps", "2", "--video", "place/out.mp4")
        yield Case(f"simulate --video: {kind}", film, FILES[kind][0])
    yield from _folder_cases()
    yield from _run_cases()


def _folder_cases() -> Iterator[Case]:
    export = ("export", "run", "--format", "c", "--out", "place/out")
    for kind, (make, accepted, changed) in FOLDERS.items():
        yield Case(f"export: {kind}", export, make, accepted, changed)
        beside = ("runs",)
        yield Case(f"train: {kind}", (*TRAIN, "place/out"), make, accepted, changed, beside)
        if not accepted:
            words = (*EPISODES, "place/out")
            yield Case(f"episodes: {kind}", words, make, False, (), beside)
            yield Case(f"sweep: {kind}", (*SWEEP, "place/out"), make, False, (), beside)
            words = ("optimise", "amber3m", "--speed", "0.6", "--out", "place/out")
            yield Case(f"optimise: {kind}", words, make, False, (), beside)
    force = (*export, "--force")
    yield Case("export --force: link in it", force, inside("gait.h", link), True, ("place/out/",))
    for kind, make in (("FIFO", os.mkfifo), ("device", device), ("folder", folder)):
        yield Case(f"export --force: {kind} in it", force, inside("gait.h", make))
    yield Case("export --force: full disk", force, inside("gait.h", full))
    yield Case("export --force: read-only disk", force, inside("gait.h", read_only))
    for verb, words in (("train", TRAIN), ("sweep", SWEEP), ("episodes", EPISODES)):
        for kind, make in (("read-only", READ_ONLY), ("full", FULL)):
            place = "place/out/new"
            yield Case(f"{verb}: {kind} disk", (*words, place), make, False, (), ("runs",))


def _run_cases() -> Iterator[Case]:
    """Outputs within a run, whose names the command chooses."""
    fit = ("fit", "run", "walk.csv")
    for verb, words, name in (
        ("certify", CERTIFY, "run/certificate/proof.json"),
        ("certify, map", CERTIFY, "run/certificate/map.safetensors"),
        ("certify, summary", CERTIFY, "run/certificate/summary.json"),
        ("fit", fit, "run/residual/residual.safetensors"),
    ):
        for kind in ("link", "FIFO", "device", "folder", "read-only disk", "full disk"):
            make, accepted, _ = FILES[kind]
            beside = ("run/certificate/boxes-", "run/certificate/filler")
            changed = (str(Path(name).parent),)
            made = _in_run(name, make)
            yield Case(f"{verb}: {kind}", words, made, accepted, changed, beside)
    words = ("python", str(NOTEBOOKS), "place/out.ipynb")
    yield Case("run_notebooks: link", words, _notebook, True, ("place/target",))


def _in_run(name: str, make: Make) -> Make:
    """Put something in the place of a run's own file; a disk takes all that lies beside it."""

    def made(place: Path) -> None:
        path = place.parents[1] / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if make not in (full, read_only):
            path.unlink(missing_ok=True)
        make(path)

    return made


def _notebook(place: Path) -> None:
    target = place.with_name("target.ipynb")
    cell = {"cell_type": "code", "source": ["1 + 1"], "metadata": {}, "outputs": []}
    table = {"cells": [cell], "metadata": {}, "nbformat": 4, "nbformat_minor": 5}
    target.write_text(json.dumps(table))
    place.symlink_to(target.name)


def seen(area: Path) -> dict[str, str]:
    """Look at all that lies in a folder, by name: kind, and content, target or number."""
    found = {}
    for path in sorted(area.rglob("*")):
        state, name = path.lstat(), str(path.relative_to(area))
        kind = stat.filemode(state.st_mode)[0]
        if kind == "l":
            found[name] = f"l {os.readlink(path)}"
        elif kind == "-":
            found[name] = f"- {hashlib.sha256(path.read_bytes()).hexdigest()}"
        else:
            found[name] = kind if kind == "d" else f"{kind} {state.st_ino} {state.st_rdev}"
    return found


def judged(case: Case, before: dict[str, str], after: dict[str, str], area: Path) -> list[str]:
    """Say what was destroyed or half-written."""
    allowed = (*case.beside, *(case.changed if case.accepted else ()))
    wrong = []
    for name, what in before.items():
        ours = bool(allowed) and name.startswith(tuple(allowed)) and what[0] in "-d"
        if after.get(name) != what and not ours:
            wrong.append(f"destroyed: {name}: {what} became {after.get(name)}")
    for name in after.keys() - before.keys():
        if name.endswith(".tmp") or "/." in name or not (allowed and name.startswith(allowed)):
            if after[name] != "d" and name != "run":
                wrong.append(f"half-written: {name}")
    # A file with the content of one from before is a copy of it: whole, whatever it is.
    known = set(before.values())
    for name, what in after.items():
        if what[0] == "-" and what not in known and not _whole(area / name):
            wrong.append(f"half-written: {name} is not whole")
    return wrong


def _whole(path: Path) -> bool:
    content = path.read_bytes()
    ends = {".html": b"</html>\n", ".csv": b"\n", ".xml": b">", ".json": b"}\n", ".h": b"\n"}
    return content.rstrip(b"\n ").endswith(ends.get(path.suffix, b"").rstrip(b"\n"))


def carried_out(case: Case, area: Path) -> list[str]:
    """Carry out a case in an empty folder. Returns: what was wrong."""
    shutil.copytree(SHIPPED, area / "run")
    if "walk.csv" in case.words:
        shutil.copy(walk(), area / "walk.csv")
    (area / "place").mkdir()
    last = case.words[-2] if case.words[-1] == "--force" else case.words[-1]
    name = last if last.startswith("place/") else "place/out"
    case.make(area / ("place/out" if name.endswith("/new") else name))
    before = seen(area)
    code, said = answered(case.words, area)
    wrong = judged(case, before, seen(area), area)
    wanted = (0, 1, 3) if case.accepted else (2,)
    if code not in wanted or (code == 2 and said.count("\n") != 1):
        wrong.append(f"wrong: exit {code}: {said[-300:].strip()}")
    return wrong


def answered(words: Sequence[str], area: Path) -> tuple[int, str]:
    """Return the exit code of a command in a folder, and what it said on stderr."""
    if words[0] == "python":
        line = [sys.executable, *words[1:]]
        done = subprocess.run(line, cwd=area, capture_output=True, text=True, timeout=LONGEST_S)
        return done.returncode, done.stderr
    said = io.StringIO()
    signal.alarm(LONGEST_S)
    try:
        with contextlib.chdir(area), contextlib.redirect_stderr(said):
            with contextlib.redirect_stdout(io.StringIO()):
                code = command_line([*words, "--json"])
    finally:
        signal.alarm(0)
    return code, said.getvalue()


def walk() -> Path:
    """A log of a walk of the shipped run, made once."""
    place = Path(tempfile.gettempdir()) / f"neuralgaits-outputs-{os.getpid()}"
    log = place / "walk.csv"
    if not log.is_file():
        shutil.copytree(SHIPPED, place / "run")
        assert answered(("simulate", "run", "--steps", "12", "--log", "walk.csv"), place)[0] == 0
    return log


def main(words: Sequence[str]) -> None:
    """Print a row a case, and the totals."""
    signal.signal(signal.SIGALRM, signal.default_int_handler)
    total: Counter[str] = Counter()
    for case in cases():
        if words and not any(word in case.name for word in words):
            continue
        with tempfile.TemporaryDirectory() as place:
            area = Path(place)
            try:
                wrong = carried_out(case, area)
            except LeftOut as reason:
                show(case.name, f"left out: {reason}")
                total["left out"] += 1
                continue
            finally:
                unmounted(area)
        show(case.name, "; ".join(wrong) or "as it should be")
        total["cases"] += 1
        total.update({line.partition(":")[0] for line in wrong})
    for kind in ("cases", "left out"):
        show(kind, total[kind])
    for kind in ("destroyed", "half-written", "wrong"):
        show(f"cases with something {kind}", total[kind], "0")


if __name__ == "__main__":
    main(sys.argv[1:])
