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

from support.fuzzing.cases import Answer, carry, case_of
from support.fuzzing.doors import KINDS, inputs, readers, remember
from support.fuzzing.place import Place

HANG_S, START_S = 10.0, 120.0
"""Processor time that a case may take; a worker reads everything unaltered first, and compiles."""
SLOWER = 30.0
"""How many times longer it may take by the clock: others use the machine, too."""


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
    remember()
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
        start_time = time.process_time()
        answer = carry(place, block.kind, number)
        found = vars(answer) | {"s": time.process_time() - start_time}
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
            print(f"{block.kind}: {found[block.kind].inputs} done", file=sys.stderr, flush=True)
            if last is not None and last + 1 < block.last:
                waiting.put(Block(block.kind, last + 1, block.last))

    threads = [threading.Thread(target=run) for _ in range(workers)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return found


class Patience:
    """How long a process may say nothing, in processor time."""

    def __init__(self, pid: int, limit_s: float):
        self.pid, self.limit_s = pid, limit_s
        self.start_time, self.used = time.monotonic(), self._used()

    def spent(self) -> bool:
        """Whether it has been silent for too long; one that only sleeps, by the clock."""
        if time.monotonic() - self.start_time > SLOWER * self.limit_s:
            return True
        return self._used() - self.used > self.limit_s

    def _used(self) -> float:
        try:
            fields = Path(f"/proc/{self.pid}/stat").read_text().rpartition(")")[2].split()
        except OSError:
            # It has ended, or this is no Linux: the clock alone counts.
            return 0.0
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def _watched(
    block: Block, command: list[str], folder: Path, found: Findings, kept: Path
) -> int | None:
    """One worker. Returns: the number of the case that ended it; None if it came to its end."""
    words = [*command, str(folder), block.kind, str(block.first), str(block.last)]
    worker = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert worker.stdout is not None and worker.stderr is not None
    at, rest = None, b""
    patience = Patience(worker.pid, START_S)
    try:
        while True:
            if not select.select([worker.stdout], [], [], 1.0)[0]:
                if patience.spent() and not select.select([worker.stdout], [], [], 0.0)[0]:
                    return _ended("hang: it says nothing", block, at, folder, found, kept)
                continue
            data = os.read(worker.stdout.fileno(), 1 << 16)
            if not data:
                with contextlib.suppress(subprocess.TimeoutExpired):
                    worker.wait(SLOWER * HANG_S)
                break
            patience = Patience(worker.pid, HANG_S)
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
