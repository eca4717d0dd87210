"""Kill -9 in a sweep at 100 random moments: the command, a worker, a Ray head, a Ray node.

Each sweep is small and on two workers: three gaits of few gradient steps, with one walk each, or,
with ROWS=made-up, fourteen rows whose numbers follow from the seed, each a tenth of a second, in a
command forked from one that has imported the package. (Then imports, which write nothing, are not
most of all moments.) A command that lost a worker, or one of the two nodes of its cluster, has to
come to its end; one that was killed, or lost the head, is given again with `--resume`. Then the
table must be that of a sweep that nobody killed, bit for bit, and rows that were done before the
kill must be the same files.

Asked: 0 stuck, 0 unequal, 0 lost. `KILLS=20` kills so often; `sweep_kills.py command worker` kills
these alone. `head` and `node` need the extra `ray` and are left out without it.
"""

import contextlib
import importlib.util
import multiprocessing
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from multiprocessing.context import ForkServerProcess
from pathlib import Path
from types import ModuleType

import numpy as np
from common import ROOT, show

KILLS = int(os.environ.get("KILLS", "100"))
SHARES = {"command": 0.35, "worker": 0.35, "head": 0.15, "node": 0.15}
ON_RAY = ("head", "node")
KINDS = ("stuck", "unequal", "lost")
MADE_UP = os.environ.get("ROWS", "trained") == "made-up"
# Seed 2 of those that are made up is refused, which is not asked here.
ASKED = ["--seeds", "3:17"] if MADE_UP else "--seeds 0:3 --steps 60 --walks 1".split()
PORT = 26379
LONGEST_S = 900.0
# Without a token for this one cluster, which listens for as long as a kill takes.
ENVIRONMENT = {
    "RAY_AUTH_MODE": "disabled",
    "RAY_USAGE_STATS_ENABLED": "0",
    # A head that was killed never comes back: Ray would wait a minute for it.
    "RAY_gcs_rpc_server_reconnect_timeout_s": "5",
    # Ray's workers have a path of their own.
    "PYTHONPATH": os.pathsep.join(sys.path),
}
SERVER = multiprocessing.get_context("forkserver")
SERVER.set_forkserver_preload(
    [f"neuralgaits.{name}" for name in ("cli.main", "cli.verbs", "cli.progress", "workflows.sweep")]
    if MADE_UP
    else []
)


class Bench:
    """A folder in which a sweep is killed again and again."""

    def __init__(self, kind: str):
        self.kind, self.killed = kind, 0
        self.folder = ROOT / "sweep-kills" / kind
        self.engine = ["--ray", f"127.0.0.1:{PORT}"] if kind in ON_RAY else ["--workers", "2"]
        # The first compiles; the second says how long it takes.
        self.finish("reference")
        start_time = time.perf_counter()
        self.finish("reference")
        self.duration = time.perf_counter() - start_time
        self.wanted = (self.folder / "reference" / "table.csv").read_bytes()

    def start(self, out: str, *, resume: bool = False) -> ForkServerProcess:
        """Start the sweep in a process group of its own."""
        words = ["sweep", "amber3m", *ASKED, "--disturbances", "none", *self.engine, "--out", out]
        words += ["--resume"] if resume else []
        process = SERVER.Process(target=sweep, args=(words, self.folder.absolute(), MADE_UP))
        process.start()
        return process

    def finish(self, out: str) -> None:
        """A sweep that nobody kills."""
        self.folder.mkdir(parents=True, exist_ok=True)
        shutil.rmtree(self.folder / out, ignore_errors=True)
        with cluster(self.kind):
            if code := self.ended(self.start(out)):
                raise SystemExit(f"exit {code}: {self.said()}")

    def ended(self, command: ForkServerProcess) -> int | None:
        """The exit code of a command; None if it is stuck."""
        command.join(LONGEST_S)
        code = command.exitcode
        if code is None:
            _kill_group(command)
        return code

    def said(self) -> str:
        """The end of what the last command said on stderr."""
        return (self.folder / "stderr").read_text()[-300:]

    def kill(self, number: int) -> list[str]:
        """Kill once, and go on. Returns: what was wrong."""
        out = self.folder / "killed"
        shutil.rmtree(out, ignore_errors=True)
        draw = np.random.default_rng([list(SHARES).index(self.kind), number])
        moment = draw.uniform(0.0, self.duration)
        code = 0
        with cluster(self.kind) as killable:
            command = self.start("killed")
            command.join(moment)
            if self.kind == "command":
                _kill_group(command)
            else:
                self.killed += _kill_one(killable or workers_of(command.pid), draw)
            code = self.ended(command)
        if code is None:
            return [f"stuck: after a kill at {moment:.1f} s"]
        if self.kind in ("worker", "node") and code:
            return [f"stuck: exit {code}: {self.said()}"]
        done = {path: _bytes(path) for path in _rows(out)}
        if code:
            with cluster(self.kind):
                again = self.ended(self.start("killed", resume=True))
            if again != 0:
                return [f"stuck: exit {again}: {self.said()}"]
        wrong = [f"lost: {path}" for path, was in done.items() if _bytes(path) != was]
        table = out / "table.csv"
        if not table.is_file() or table.read_bytes() != self.wanted:
            wrong.append(f"unequal: table after a kill at {moment:.1f} s")
        return wrong


def sweep(words: Sequence[str], folder: Path, made_up: bool) -> None:
    """The command line, in a process of its own."""
    os.setsid()
    os.chdir(folder)
    os.environ |= ENVIRONMENT
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    os.dup2(os.open("stderr", os.O_WRONLY | os.O_CREAT | os.O_TRUNC), 2)
    # Workers begin with what the main module imports: this one, which they have no use for.
    sys.modules["__main__"] = ModuleType("__main__")
    from neuralgaits._environment import prepare
    from neuralgaits.cli import main

    prepare()
    if made_up:
        from neuralgaits.workflows import sweep as workflow
        from support import sweep_rows

        workflow.carry_out = sweep_rows.unhurried  # pyright: ignore
    sys.exit(main.main([*words]))


@contextlib.contextmanager
def cluster(kind: str) -> Iterator[list[int]]:
    """A Ray cluster of one node, or of two. Yields: the process of it that is to be killed."""
    if kind not in ON_RAY:
        yield []
        return
    with tempfile.TemporaryDirectory(prefix="ng-", ignore_cleanup_errors=True) as own:
        try:
            cores = "--num-cpus=2" if kind == "head" else "--num-cpus=1"
            _ray(
                "--head", f"--port={PORT}", f"--temp-dir={own}", "--include-dashboard=false", cores
            )
            first = _naming(own)
            if kind == "node":
                _ray(f"--address=127.0.0.1:{PORT}", cores)
            program = {"head": "gcs_server", "node": "raylet"}[kind]
            new = [pid for pid in _naming(own) if kind == "head" or pid not in first]
            yield [pid for pid in new if _words(pid).partition(" ")[0].endswith(program)]
        finally:
            # `ray stop` would end what others run on this machine.
            while left := _naming(own):
                _kill_all(left)


def _ray(*words: str) -> None:
    """Start a node."""
    ray = str(Path(sys.executable).with_name("ray"))
    subprocess.run(
        [ray, "start", *words],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env={**os.environ, **ENVIRONMENT},
        check=True,
    )


def workers_of(parent: int | None) -> list[int]:
    """The processes that carry out tasks for a command."""
    return [pid for pid in _naming("spawn_main") if _parent(pid) == parent]


def _naming(word: str) -> list[int]:
    """Processes with a word in their command line."""
    found = (int(path.name) for path in Path("/proc").glob("[0-9]*"))
    return [pid for pid in found if word in _words(pid) and pid != os.getpid()]


def _words(pid: int) -> str:
    try:
        return Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode()
    except OSError:
        return ""


def _parent(pid: int) -> int | None:
    try:
        return int(Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[1])
    except OSError:
        return None


def _kill_one(among: Sequence[int], draw: np.random.Generator) -> int:
    """Kill one of them, if there are any yet. Returns: how many were."""
    chosen = [int(draw.choice(sorted(among)))] if among else []
    _kill_all(chosen)
    return len(chosen)


def _kill_all(processes: Sequence[int]) -> None:
    for pid in processes:
        with contextlib.suppress(ProcessLookupError):
            os.kill(pid, signal.SIGKILL)


def _kill_group(command: ForkServerProcess) -> None:
    """Kill a command and what it started, unless it has ended."""
    if command.exitcode is None and command.pid is not None:
        # Before it leads a group it has no children.
        for kill in (os.killpg, os.kill):
            with contextlib.suppress(ProcessLookupError):
                kill(command.pid, signal.SIGKILL)
        command.join()


def _rows(out: Path) -> list[Path]:
    """Files of the rows that are done."""
    return [path for path in sorted(out.glob("rows/[!.]*/**/*")) if path.is_file()]


def _bytes(path: Path) -> bytes | None:
    return path.read_bytes() if path.is_file() else None


def main(kinds: Sequence[str]) -> None:
    """Print a row a kind."""
    total: Counter[str] = Counter()
    for kind in kinds:
        if kind in ON_RAY and importlib.util.find_spec("ray") is None:
            show(kind, "left out: no Ray")
            continue
        bench, seen, kills = Bench(kind), Counter(), round(SHARES[kind] * KILLS)
        show(f"{kind}: uninterrupted [s]", bench.duration)
        for number in range(kills):
            for line in bench.kill(number):
                seen[line.partition(":")[0]] += 1
                print(f"   {kind} {number}: {line}", flush=True)
        told = ", ".join(str(seen[name]) for name in KINDS)
        met = bench.killed if kind != "command" else kills
        show(f"{kind}: kills that met a process", met)
        show(f"{kind}: kills; stuck, unequal, lost", f"{kills}; {told}", "0")
        total += seen + Counter(kills=kills)
    show("kills in all", total.pop("kills"))


if __name__ == "__main__":
    main(sys.argv[1:] or list(SHARES))
