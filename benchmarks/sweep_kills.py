"""Kill -9 in a sweep at 100 random moments: the command, a worker, the head of a Ray cluster.

Each sweep is small (three gaits, few gradient steps, one walk each) and on two workers. A command
that lost a worker has to come to its end; a command that was killed, or lost the head, is given
again with `--resume`. Then the table must be that of a sweep that nobody killed, bit for bit, and
rows that were done before the kill must be the same files.

Asked: 0 stuck, 0 unequal, 0 lost. `KILLS=20` kills so often; `sweep_kills.py command worker` kills
these alone. `head` needs the extra `ray` and is left out without it.
"""

import contextlib
import importlib.util
import os
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from common import ROOT, show

KILLS = int(os.environ.get("KILLS", "100"))
SHARES = {"command": 0.4, "worker": 0.4, "head": 0.2}
KINDS = ("stuck", "unequal", "lost")
ASKED = "--seeds 0:3 --steps 60 --disturbances none --walks 1".split()
PROGRAM = [sys.executable, "-c", "from neuralgaits.cli.main import run; run()"]
PORT = 26379
LONGEST_S = 900.0
# Without a token for this one cluster, which listens for as long as a kill takes.
ENVIRONMENT = {**os.environ, "RAY_AUTH_MODE": "disabled", "RAY_USAGE_STATS_ENABLED": "0"}


class Bench:
    """A folder in which a sweep is killed again and again."""

    def __init__(self, kind: str):
        self.kind = kind
        self.folder = ROOT / "sweep-kills"
        self.engine = ["--ray", f"127.0.0.1:{PORT}"] if kind == "head" else ["--workers", "2"]
        self.finish("reference")
        began = time.perf_counter()
        self.finish("reference")
        self.duration = time.perf_counter() - began
        self.wanted = (self.folder / "reference" / "table.csv").read_bytes()

    def start(self, out: str, *, resume: bool = False) -> subprocess.Popen[bytes]:
        """Start the sweep in a process group of its own."""
        words = ["sweep", "amber3m", *ASKED, *self.engine, "--out", out]
        return subprocess.Popen(
            [*PROGRAM, *words, *(["--resume"] if resume else [])],
            cwd=self.folder,
            env=ENVIRONMENT,
            stdout=subprocess.DEVNULL,
            stderr=(self.folder / "stderr").open("wb"),
            start_new_session=True,
        )

    def finish(self, out: str) -> None:
        """A sweep that nobody kills."""
        self.folder.mkdir(parents=True, exist_ok=True)
        shutil.rmtree(self.folder / out, ignore_errors=True)
        with head(self.kind == "head"):
            if code := self.start(out).wait(LONGEST_S):
                raise SystemExit(f"exit {code}: {(self.folder / 'stderr').read_text()}")

    def kill(self, number: int) -> list[str]:
        """Kill once, and go on. Returns: what was wrong."""
        out = self.folder / "killed"
        shutil.rmtree(out, ignore_errors=True)
        draw = np.random.default_rng([list(SHARES).index(self.kind), number])
        moment = draw.uniform(0.0, self.duration)
        code = 0
        with head(self.kind == "head") as killable:
            command = self.start("killed")
            with contextlib.suppress(subprocess.TimeoutExpired):
                command.wait(moment)
            if self.kind == "worker":
                _kill_one(workers_of(command.pid), draw)
            elif self.kind == "command":
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(command.pid, signal.SIGKILL)
            else:
                _kill_one(killable, draw)
            try:
                code = command.wait(LONGEST_S)
            except subprocess.TimeoutExpired:
                os.killpg(command.pid, signal.SIGKILL)
                return [f"stuck: after a kill at {moment:.1f} s"]
        if self.kind == "worker" and code:
            return [f"stuck: exit {code}: {(self.folder / 'stderr').read_text()[-300:]}"]
        done = {path: _bytes(path) for path in _rows(out)}
        if code:
            with head(self.kind == "head"):
                again = self.start("killed", resume=True).wait(LONGEST_S)
            if again:
                return [f"stuck: exit {again}: {(self.folder / 'stderr').read_text()[-300:]}"]
        wrong = [f"lost: {path}" for path, was in done.items() if _bytes(path) != was]
        table = out / "table.csv"
        if not table.is_file() or table.read_bytes() != self.wanted:
            wrong.append(f"unequal: table after a kill at {moment:.1f} s")
        return wrong


@contextlib.contextmanager
def head(wanted: bool) -> Iterator[list[int]]:
    """A Ray cluster of one node. Yields: its processes."""
    if not wanted:
        yield []
        return
    ray = Path(sys.executable).with_name("ray")
    start = [ray, "start", "--head", f"--port={PORT}", "--num-cpus=2", "--include-dashboard=false"]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "env": ENVIRONMENT}
    subprocess.run([ray, "stop", "--force"], **quiet, check=False)
    subprocess.run(start, **quiet, check=True)
    try:
        yield [pid for pid, words in _processes() if "gcs_server" in words.split(" ", 1)[0]]
    finally:
        subprocess.run([ray, "stop", "--force"], **quiet, check=False)


def workers_of(parent: int) -> list[int]:
    """The processes that carry out tasks for a command."""
    return [pid for pid, words in _processes() if "spawn_main" in words and _parent(pid) == parent]


def _processes() -> Iterator[tuple[int, str]]:
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        with contextlib.suppress(OSError):
            yield int(path.parent.name), path.read_bytes().replace(b"\0", b" ").decode()


def _parent(pid: int) -> int | None:
    try:
        return int(Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[1])
    except OSError:
        return None


def _kill_one(among: Sequence[int], draw: np.random.Generator) -> None:
    """Kill one of them, if there are any yet."""
    if among:
        with contextlib.suppress(ProcessLookupError):
            os.kill(int(draw.choice(sorted(among))), signal.SIGKILL)


def _rows(out: Path) -> list[Path]:
    """Files of the rows that are done."""
    return [path for path in sorted(out.glob("rows/*/**/*")) if path.is_file()]


def _bytes(path: Path) -> bytes | None:
    return path.read_bytes() if path.is_file() else None


def main(kinds: Sequence[str]) -> None:
    """Print a row a kind."""
    total: Counter[str] = Counter()
    for kind in kinds:
        if kind == "head" and importlib.util.find_spec("ray") is None:
            show("head", "left out: no Ray")
            continue
        bench, seen, kills = Bench(kind), Counter(), round(SHARES[kind] * KILLS)
        show(f"{kind}: uninterrupted [s]", bench.duration)
        for number in range(kills):
            for line in bench.kill(number):
                seen[line.partition(":")[0]] += 1
                print(f"   {kind} {number}: {line}", flush=True)
        told = ", ".join(str(seen[name]) for name in KINDS)
        show(f"{kind}: kills; stuck, unequal, lost", f"{kills}; {told}", "0")
        total += seen + Counter(kills=kills)
    show("kills in all", total.pop("kills"))


if __name__ == "__main__":
    main(sys.argv[1:] or list(SHARES))
