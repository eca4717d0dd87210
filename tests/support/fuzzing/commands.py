"""Altered inputs through the command line itself: its exit codes, and one line where it refuses."""

import contextlib
import json
import os
import tempfile
from collections.abc import Callable, Iterator

import numpy as np

from neuralgaits._printable import PRINTABLE
from neuralgaits.cli.main import main
from support.fuzzing.doors import inputs
from support.fuzzing.formats import altered
from support.fuzzing.paths import WORDS_OF_PATHS, odd_path, placed, remove_odd
from support.fuzzing.place import FILES, RUN, Place

CODES = (0, 1, 2, 3)
UTF8, EVERY = "utf-8", ""
"""Encoding of a process's streams, their line ends kept."""
ODD_ONE = 5
"""One command in so many is about a path of any bytes."""
Words = Callable[[str], list[str]]

COMMANDS: tuple[tuple[tuple[str, ...], Words], ...] = (
    (("robot files",), lambda name: ["inspect", name]),
    (("robot files",), lambda name: ["inspect", name, "--json"]),
    (("small proof",), lambda name: ["check-proof", name]),
    (("small proof",), lambda name: ["check-proof", name, "--json"]),
    (("run",), lambda name: ["simulate", RUN, "--steps", "1", "--json"]),
    (("run",), lambda name: ["check-proof", f"{FILES}/small.json", "--run", RUN]),
    (("boxes",), lambda name: ["certify", RUN, "--resume", "--level", "1", "--budget", "2"]),
    (("logs",), lambda name: ["fit", RUN, name, "--json"]),
    (("checkpoint",), lambda name: ["train", "amber3m", "--resume", RUN, "--json"]),
)
"""Sorts of input, and the words of a command about an altered one."""
_FILES = {
    "small proof": (f"{FILES}/small.json",),
    "run": tuple(f"{RUN}/{name}" for name in ("config.json", "policy.safetensors", "robot.xml")),
    "boxes": tuple(f"{RUN}/certificate/boxes-{number}.safetensors" for number in range(5)),
    "checkpoint": tuple(f"{RUN}/{name}" for name in ("state.safetensors", "metrics.csv")),
}


def answer_of(place: Place, number: int) -> tuple[int, list[str]]:
    """Give a command about an altered input. Returns: its code, and what is wrong with that."""
    draw = np.random.default_rng([1000, number])
    if number % ODD_ONE == ODD_ONE - 1:
        return _about_odd_path(place, number // ODD_ONE, draw)
    (sort,), words = COMMANDS[number % len(COMMANDS)]
    names = _FILES[sort] if sort in _FILES else tuple(inputs(place, sort))
    name = names[int(draw.integers(len(names)))]
    (place.root / name).write_bytes(altered(name, (place.kept / name).read_bytes(), draw))
    if sort == "checkpoint":
        (place.root / RUN / "summary.json").unlink()
    code, found = _given(place, words(name))
    place.put_back(name)
    return code, [f"about {name}: {what}" for what in found]


def _about_odd_path(place: Place, number: int, draw: np.random.Generator) -> tuple[int, list[str]]:
    """Give a command about a whole input at a path of any bytes."""
    source, suffix, words = WORDS_OF_PATHS[number % len(WORDS_OF_PATHS)]
    path = os.fsdecode(odd_path(draw, number))
    (place.root / path).parent.mkdir(parents=True, exist_ok=True)
    if source:
        placed(place, path, source, suffix)
    try:
        return _given(place, words(path + suffix))
    finally:
        remove_odd(place)
        place.put_back(None)


def _given(place: Place, arguments: list[str]) -> tuple[int, list[str]]:
    os.chdir(place.root)
    with _captured() as printed:
        code = main(arguments)
    out, err = printed
    words = " ".join(map(ascii, arguments))
    told = _complaints(code, out, err, "--json" in arguments, many=arguments[0] == "inspect")
    return code, [f"{words}: {what}" for what in told]


def _is_told(lines: list[str]) -> bool:
    """Return whether there is a line at least, and each is one of the program's own."""
    return bool(lines) and all(
        line.startswith("neuralgaits: ") and "\n" not in line for line in lines
    )


def _complaints(
    code: int, out: str, err: str, as_json: bool, *, many: bool = False
) -> Iterator[str]:
    """Yield what is wrong with an answer; `many` may be the problems of a file, a line each."""
    lines = err.splitlines() if many else [err.removesuffix("\n")]
    if code not in CODES:
        yield f"code {code}: {err.strip()[:300]}"
    elif code == 2 and (out or not _is_told(lines)):
        yield f"not one line: {out[:200]!r} {err[:300]!r}"
    elif code != 2 and as_json:
        try:
            json.loads(out)
        except ValueError:
            # A "no" without a result, as of a loss that is NaN, is a line on stderr.
            if code != 1 or err.count("\n") != 1:
                yield f"code {code} and no JSON: {out[:200]!r} {err[:300]!r}"


@contextlib.contextmanager
def _captured() -> Iterator[list[str]]:
    """What is printed on stdout and stderr, by C libraries too, in the list afterwards."""
    found: list[str] = []
    kept = [os.dup(1), os.dup(2)]
    # As `cli.main.run` sets up the streams of its process.
    with (
        tempfile.TemporaryFile("w+", encoding=UTF8, newline=EVERY, errors=PRINTABLE) as out,
        tempfile.TemporaryFile("w+", encoding=UTF8, newline=EVERY, errors=PRINTABLE) as err,
    ):
        try:
            for number, file in ((1, out), (2, err)):
                os.dup2(file.fileno(), number)
            with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
                yield found
        finally:
            for number, (old, file) in enumerate(zip(kept, (out, err), strict=True), start=1):
                file.flush()
                os.dup2(old, number)
                os.close(old)
                file.seek(0)
                found.append(file.read())
