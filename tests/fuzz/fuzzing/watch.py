"""Cases in processes of their own, watched: one that hangs or crashes is named, and the rest go on.

A worker prints a line before and after every case. One that stays silent for too long is ended.
"""

import contextlib
import json
import os
import queue
import select
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

from fuzzing.cases import Answer, carry, case_of
from fuzzing.doors import KINDS, inputs, readers
from fuzzing.place import Place

HANG_S, START_S = 10.0, 300.0
"""A case may take so long; a worker reads everything unaltered first, and compiles."""


@dataclass
class Findings:
    """What became of all cases of a kind."""

    inputs: int = 0
    seen: Counter[str] = field(default_factory=Counter)
    bad: list[str] = field(default_factory=list)
    slowest_s: float = 0.0


@dataclass(frozen=True)
class Block:
    """Cases for one worker. Attributes: kind: of input; first, last: numbers, the last not."""

    kind: str
    first: int
    last: int


def work(folder: Path, run: Path, episodes: Path | None, block: Block) -> None:
    """Carry the cases of a block, telling of each on stdout."""
    place = Place.make(folder, run, episodes)
    for kind in KINDS:
        for name in inputs(place, kind):
            for reader in readers(name):
                reader(place, place.root / name)
    place.put_back(None)
    tell = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
    tell.write('"ready"\n')
    for number in range(block.first, block.last):
        tell.write(f"{number}\n")
        began = time.perf_counter()
        answer = carry(place, block.kind, number)
        found = vars(answer) | {"s": time.perf_counter() - began}
        tell.write(json.dumps(found) + "\n")


def watch(
    blocks: Iterable[Block], command: list[str], workers: int, kept: Path
) -> dict[str, Findings]:
    """Have workers carry all blocks. Returns: findings by kind.

    Args:
        blocks: of cases.
        command: starts a worker; its folder and the block's kind and numbers are added.
        workers: processes at a time.
        kept: folder for inputs that something is wrong with.
    """
    waiting: queue.SimpleQueue[Block] = queue.SimpleQueue()
    found: dict[str, Findings] = {}
    for block in blocks:
        waiting.put(block)
        found.setdefault(block.kind, Findings())

    def run() -> None:
        while True:
            try:
                block = waiting.get_nowait()
            except queue.Empty:
                return
            with tempfile.TemporaryDirectory(prefix="fuzz-") as folder:
                last = _watched(block, command, Path(folder), found[block.kind], kept)
            if last is not None and last + 1 < block.last:
                waiting.put(Block(block.kind, last + 1, block.last))

    threads = [threading.Thread(target=run) for _ in range(workers)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return found


def _watched(
    block: Block, command: list[str], folder: Path, found: Findings, kept: Path
) -> int | None:
    """One worker. Returns: the number of the case that ended it; None if it came to its end."""
    words = [*command, str(folder), block.kind, str(block.first), str(block.last)]
    worker = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert worker.stdout is not None and worker.stderr is not None
    at, rest = None, b""
    try:
        while True:
            limit = START_S if at is None else HANG_S
            if not select.select([worker.stdout], [], [], limit)[0]:
                return _ended(f"hang: silent for {limit:g} s", block, at, folder, found, kept)
            data = os.read(worker.stdout.fileno(), 1 << 16)
            if not data:
                with contextlib.suppress(subprocess.TimeoutExpired):
                    worker.wait(HANG_S)
                break
            *lines, rest = (rest + data).split(b"\n")
            for line in lines:
                told = json.loads(line)
                if isinstance(told, int):
                    at = told
                elif isinstance(told, dict):
                    _count(told, block, at, folder, found, kept)
    finally:
        worker.kill()
        errors = worker.stderr.read().decode(errors="replace")
        code = worker.wait()
    if at == block.last - 1 and code == 0:
        return None
    return _ended(f"crash: code {code}: {errors[-300:]}", block, at, folder, found, kept)


def _count(
    told: dict, block: Block, at: int | None, folder: Path, found: Findings, kept: Path
) -> None:
    seconds = told.pop("s")
    answer = Answer(**told)
    found.inputs += 1
    found.slowest_s = max(found.slowest_s, seconds)
    found.seen.update(read=answer.read, refused=answer.refused, told=answer.told)
    for line in answer.tracebacks:
        _note(f"traceback: {line}", block, at, folder, found, kept)
    for name in answer.lost:
        _note(f"lost: {name}", block, at, folder, found, kept)


def _ended(
    what: str, block: Block, at: int | None, folder: Path, found: Findings, kept: Path
) -> int | None:
    found.inputs += at is not None
    _note(what, block, at, folder, found, kept)
    # Without a case to blame there is nothing to go on after.
    return at


def _note(
    what: str, block: Block, at: int | None, folder: Path, found: Findings, kept: Path
) -> None:
    found.seen[what.partition(":")[0]] += 1
    found.bad.append(f"{block.kind} {at}: {what}")
    if at is not None:
        case = case_of(Place(folder / "inputs", folder / "kept"), block.kind, at)
        kept.mkdir(parents=True, exist_ok=True)
        file = f"{block.kind}-{at}-{case.name}".replace("/", "-").replace(" ", "-")
        (kept / file).write_bytes(case.content)
    print(found.bad[-1], file=sys.stderr, flush=True)
