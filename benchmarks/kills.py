"""Kill -9 at 200 random moments: no checkpoint is lost, and what goes on ends as if never killed.

Each command runs as a process of its own through the command line, with small settings, and is
killed with its process group at a moment drawn uniformly from its uninterrupted duration. (The
processes are forked from one that has imported the package: imports write nothing, and would be
half of all moments.) Then
every file in its folder must be whole, and those that were there before must be as they were
before or as they are afterwards; the command that the program names goes on, and the results must
be those of a command that nobody killed, bit for bit.

Asked: 0 lost, 0 half, 0 unequal, 0 stuck. `KILLS=20` kills so often; `kills.py VERB ...`
kills these alone, `kills.py replay VERB NUMBER` does one kill again.
"""

import contextlib
import hashlib
import json
import multiprocessing
import os
import shutil
import signal
import sys
import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from multiprocessing.context import ForkServerProcess
from pathlib import Path
from typing import Any

import numpy as np
from common import ROOT, show

from neuralgaits.errors import RunError
from neuralgaits.runs import from_json, read_arrays

KILLS = int(os.environ.get("KILLS", "200"))
SHARES = {
    "train": 0.22,
    "certify": 0.18,
    "fit": 0.12,
    "refine": 0.15,
    "episodes": 0.08,
    "export": 0.13,
    "report": 0.12,
}
TIMES = ("wall_s", "compile_s", "train_s", "latency_us", "sim_steps_per_s", "real_time_factor")
"""Of JSON files: what two runs of one command differ in."""
KINDS = ("lost", "half", "unequal", "stuck")
"""What can be wrong with a kill."""
DATES = ("created_utc",)
ANSWERS = (0, 1, 3)
"""Exit codes of a command that came to its end: good, no, undecided."""
LONGEST_S = 600.0
SERVER = multiprocessing.get_context("forkserver")
SERVER.set_forkserver_preload(
    ["neuralgaits.cli.verbs", "neuralgaits.cli.progress"]
    + [f"neuralgaits.workflows.{name}" for name in ("certify", "episodes", "export", "report")]
)
SPEC = f"{Path(__file__).parents[1] / 'tests' / 'support' / 'brief_spec.py'}:brief"
"""Few conditions: less to trace."""
RUN, LOG = "run", "run/simulation/walk.csv"
Words = tuple[str, ...]


@dataclass(frozen=True)
class Verb:
    """A command to kill.

    Attributes:
        words: of the command.
        then: commands that go on, the first that does not refuse is taken.
        results: files and folders that it makes.
    """

    words: Words
    then: tuple[Words, ...]
    results: tuple[str, ...]


def _verbs() -> dict[str, Verb]:
    train = ("train", "amber3m", "--spec", SPEC, "--steps", "60", "--out", "new")
    certify = ("certify", RUN, "--level", "1")
    fit = ("fit", RUN, LOG)
    refine = ("refine", RUN, "--steps", "40", "--out", "new")
    episodes = ("episodes", "amber3m", "--plant", "amber3m-tail", "--rounds", "1", "--resume")
    anew = (*episodes, RUN, "--out", "new")
    export = ("export", RUN, "--out", "c")
    report = ("report", RUN, "--out", "page.html")
    on = ("train", "--resume", "new")
    return {
        "train": Verb(train, (on, train), ("new",)),
        "certify": Verb(certify, ((*certify, "--resume"), certify), ("run/certificate",)),
        "fit": Verb(fit, (fit,), ("run/residual",)),
        "refine": Verb(refine, (on, refine), ("new",)),
        "episodes": Verb(anew, (("episodes", "--resume", "new"), anew), ("new",)),
        "export": Verb(export, (export, (*export, "--force")), ("c",)),
        "report": Verb(report, (report,), ("page.html",)),
    }


class Bench:
    """A folder in which one verb is killed again and again."""

    def __init__(self, name: str, base: Path):
        self.name, self.verb, self.base = name, _verbs()[name], base
        self.folder = (ROOT / "kills" / name).absolute()
        self.said = self.folder.with_suffix(".stderr")
        self.reset()
        # The first compiles; the second is the one that all others are compared with.
        self.finish(self.verb.words)
        self.reset()
        start_time = time.perf_counter()
        self.finish(self.verb.words)
        self.duration = time.perf_counter() - start_time
        self.wanted, self.after = self.results(), self.bytes()

    def reset(self) -> None:
        """Make the folder as it was before the command."""
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True)
        shutil.copytree(self.base, self.folder / RUN)
        self.before = self.bytes()

    def start(self, words: Words) -> ForkServerProcess:
        """Start a command in a process group of its own."""
        process = SERVER.Process(target=small, args=(words, self.folder, self.said))
        process.start()
        return process

    def finish(self, words: Words) -> tuple[int, str]:
        """Carry out a command. Returns: its exit code, and what it said on stderr."""
        process = self.start(words)
        process.join(LONGEST_S)
        if process.exitcode is None:
            _end(process)
            return -1, f"it did not end within {LONGEST_S} s"
        return process.exitcode, self.said.read_text()

    def bytes(self) -> dict[str, str]:
        """Hash of every file in the folder that is whole by its name, by that name."""
        return {
            str(path.relative_to(self.folder)): hashlib.sha256(path.read_bytes()).hexdigest()
            for path in sorted(self.folder.rglob("*"))
            if path.is_file() and path.suffix != ".tmp"
        }

    def results(self) -> dict[str, str]:
        """Content of what the command makes, by name; times left out."""
        found = {}
        for top in self.verb.results:
            for name, digest in self.bytes().items():
                if name == top or name.startswith(f"{top}/"):
                    path = self.folder / name
                    timeless = path.suffix in (".json", ".html")
                    found[name] = _timeless(path) if timeless else digest
        return found

    def kill(self, number: int) -> list[str]:
        """Kill the command once, and go on. Returns: what was wrong."""
        self.reset()
        draw = np.random.default_rng([list(SHARES).index(self.name), number])
        process = self.start(self.verb.words)
        process.join(draw.uniform(0.0, self.duration))
        _end(process)
        return [*self._damaged(), *self._went_on()]

    def _damaged(self) -> list[str]:
        """Files that are lost, or half of what they should be."""
        wrong, found = [], self.bytes()
        for name, digest in self.before.items():
            made = any(name.startswith(top) for top in self.verb.results)
            if found.get(name) != digest and not (made and name in found):
                wrong.append(f"lost: {name}")
        for name in found:
            if reason := _half(self.folder / name):
                wrong.append(f"half: {name}: {reason}")
        return wrong

    def _went_on(self) -> list[str]:
        """What is wrong with the results of the command that goes on."""
        said = ""
        for words in self.verb.then:
            code, said = self.finish(words)
            if code in ANSWERS or self.results() == self.wanted:
                return self._unequal()
            if code != 2 or said.count("\n") != 1:
                return [f"stuck: {' '.join(words)}: exit {code}: {said[-300:]}"]
        return [f"stuck: {' '.join(self.verb.then[-1])}: {said}"]

    def _unequal(self) -> list[str]:
        found = self.results()
        names = sorted(found.keys() | self.wanted.keys())
        return [f"unequal: {n}" for n in names if found.get(n) != self.wanted.get(n)]


def _timeless(path: Path) -> str:
    """A JSON file or page without the times in it, in a form to compare."""
    if path.suffix == ".html":
        # The page names what is in the run, hashes and all.
        return hashlib.sha256(path.read_bytes()).hexdigest()

    def clean(value: Any) -> Any:
        if isinstance(value, dict):
            return {k: clean(v) for k, v in value.items() if k not in (*TIMES, *DATES)}
        return [clean(v) for v in value] if isinstance(value, list) else value

    return json.dumps(clean(json.loads(path.read_bytes())), sort_keys=True)


def _half(path: Path) -> str | None:
    """Why a file is not whole, as far as its kind shows; None if it is."""
    try:
        if path.suffix == ".json":
            from_json(path.read_bytes())
        elif path.suffix == ".safetensors":
            read_arrays(path)
        elif path.suffix == ".csv" and not path.read_bytes().endswith(b"\n"):
            return "its last line has no end"
        elif path.suffix == ".html" and not path.read_bytes().endswith(b"</html>\n"):
            return "it has no end"
    except (ValueError, RunError) as error:
        return str(error)
    return None


def _end(process: ForkServerProcess) -> None:
    """Kill a process and its group, unless it has ended."""
    if process.exitcode is not None or process.pid is None:
        return
    # Before it leads a group it has no children.
    for kill in (os.killpg, os.kill):
        with contextlib.suppress(ProcessLookupError):
            kill(process.pid, signal.SIGKILL)
    process.join()


def small(words: Words, folder: Path, said: Path) -> None:
    """The command line, with less to do: shorter fits, fewer walks, fewer comparisons."""
    os.setsid()
    os.chdir(folder)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    os.dup2(os.open(said, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), 2)
    from neuralgaits._environment import prepare
    from neuralgaits.cli import main
    from neuralgaits.episode_rounds import round_walks as episode_walks
    from neuralgaits.workflows import episodes, export, fit

    prepare()
    if words[0] in ("fit", "episodes"):
        fit.FitConfig = partial(fit.FitConfig, steps=200)  # pyright: ignore
        episode_walks.STARTS, episode_walks.STEPS, episode_walks.SPEED_STEPS = 2, 8, 8
        episode_walks.SPEEDS, episode_walks.BEYOND = (0.9, 1.0, 1.1), ()
        episode_walks.LOGGED_S = 20.0
        for verb in ("train", "refine"):
            setattr(episodes, verb, partial(_few_steps, getattr(episodes, verb)))
    if words[0] == "export":
        export.export_controller = partial(export.export_controller, states=1000)
    sys.exit(main.main([*words]))


def _few_steps(function: Callable[..., Any], *arguments: Any, **settings: Any) -> Any:
    if "resume" not in settings:
        settings["steps"] = 40
    return function(*arguments, **settings)


def base() -> Path:
    """A trained run with a log of its walk, made once."""
    folder = ROOT / "kills-base"
    if not (folder / "simulation" / "summary.json").is_file():
        from neuralgaits.robots import load_robot
        from neuralgaits.workflows.fit import fit
        from neuralgaits.workflows.simulate import simulate
        from neuralgaits.workflows.train import train

        shutil.rmtree(folder, ignore_errors=True)
        train(load_robot("amber3m"), SPEC, steps=60, out=folder, root=ROOT)
        log = folder / "simulation" / "walk.csv"
        simulate(folder, steps=8, log=log)
        fit(folder, [log])
    return folder


def main(names: Sequence[str]) -> None:
    """Print a row a verb."""
    total: Counter[str] = Counter()
    for name in names:
        bench, seen, kills = Bench(name, base()), Counter(), round(SHARES[name] * KILLS)
        show(f"{name}: uninterrupted [s]", bench.duration)
        for number in range(kills):
            for line in bench.kill(number):
                seen[line.partition(":")[0]] += 1
                print(f"   {name} {number}: {line}", flush=True)
        told = ", ".join(str(seen[kind]) for kind in KINDS)
        show(f"{name}: kills; files lost, half, unequal, stuck", f"{kills}; {told}", "0")
        total += seen + Counter(kills=kills)
    show("kills in all", total.pop("kills"))
    show("files lost, half, unequal, stuck", ", ".join(str(total[kind]) for kind in KINDS), "0")


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["replay", verb, number]:
            print(Bench(verb, base()).kill(int(number)))
        case names:
            main(names or list(SHARES))
