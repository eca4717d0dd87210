"""A hundred thousand altered inputs: proofs, run folders, robots, logs, specs, names, paths.

Bytes are flipped, cut, doubled; values of JSON, cells of CSV, attributes of XML and headers of
safetensors are exchanged for what does not belong there; whole inputs lie at paths of any bytes.
Each input is carried through the functions that the verbs call, in processes that are watched. A
share of the proof files goes through the C++ checker too, and through one built with sanitizers; a
sample of all through the command line.

Asked: 0 tracebacks, 0 hangs over 10 s, 0 files lost. `INPUTS=1000` alters so many;
`fuzz.py KIND ...` alters these alone; `fuzz.py replay KIND NUMBER` shows one again.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from common import ROOT, show, trained

from support.fuzzing.cases import PROOFS, carry, case_of
from support.fuzzing.commands import COMMANDS, answer_of
from support.fuzzing.place import Place
from support.fuzzing.watch import Block, watch, work

REPOSITORY = Path(__file__).parents[1]
SHARES = {
    "proof files": 0.20,
    "run folders": 0.08,
    "robot files": 0.27,
    "logs": 0.20,
    "spec files": 0.05,
    "names and settings": 0.15,
    "paths": 0.05,
}
"""Of all inputs."""
INPUTS = int(os.environ.get("INPUTS", "100000"))
CHECKED, SANITIZED, TYPED = 0.06, 0.03, 0.004
"""Shares of all inputs, on top: through the C++ checker, the sanitized one, the command line."""
BLOCK, WORKERS = 7000, int(os.environ.get("WORKERS", os.cpu_count() or 1))
KEPT = Path("runs") / "fuzz-findings"
CHECKER_S = 60.0
"""A small share of altered files are still proofs, whose boxes take the checker some seconds."""
ENVIRONMENT = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "XLA_FLAGS": "--xla_cpu_multi_thread_eigen=false",
    "PYTHONWARNINGS": "ignore",
}


def main(kinds: Sequence[str]) -> None:
    """Print a row a kind, and every input that something is wrong with."""
    os.environ.update(ENVIRONMENT)
    run, episodes = base()
    blocks = [
        Block(kind, first, min(first + BLOCK, count))
        for kind in kinds
        for count in [round(SHARES[kind] * INPUTS)]
        for first in range(0, count, BLOCK)
    ]
    command = [sys.executable, __file__, "work", str(run), str(episodes)]
    found = watch(blocks, command, WORKERS, KEPT)
    for kind, findings in found.items():
        seen = findings.seen
        counts = ", ".join(f"{seen[name]} {name}" for name in ("read", "refused", "told"))
        show(f"{kind}: inputs; doors", f"{findings.inputs}; {counts}")
        bad = ", ".join(str(seen[name]) for name in ("traceback", "crash", "hang", "lost"))
        show(f"{kind}: tracebacks, crashes, hangs, files lost", bad, "0, 0, 0, 0")
        show(f"{kind}: slowest [s of processor time]", findings.slowest_s, "< 10")
    show("inputs in all", sum(findings.inputs for findings in found.values()), f"{INPUTS}")
    with tempfile.TemporaryDirectory() as folder:
        place = Place.make(Path(folder), run, episodes)
        report_checker(place, Path(folder))
        report_commands(place)


def base() -> tuple[Path, Path]:
    """A run with everything that verbs leave in it, and episodes; made once."""
    folder = ROOT / "fuzz"
    run, episodes = folder / "run", folder / "episodes"
    if not (episodes / "summary.json").is_file():
        from neuralgaits.workflows.certify import certify
        from neuralgaits.workflows.episodes import episodes as go_round
        from neuralgaits.workflows.fit import fit
        from neuralgaits.workflows.report import write_report
        from neuralgaits.workflows.simulate import simulate

        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(trained("amber3m", 0).path, run)
        log = run / "simulation" / "walk.csv"
        simulate(run, steps=30, log=log)
        certify(run, level=4)
        fit(run, [log])
        write_report(run)
        robot = trained("amber3m", 0).robot
        go_round(robot, plant="amber3m-tail", rounds=1, steps=5, out=episodes, root=folder)
    return run, episodes


def report_checker(place: Place, folder: Path) -> None:
    """Exit codes of the C++ checker: 0 proved, 1 rejected, 2 no proof file, 3 undecided."""
    source, plain, strict = "tools/proofcheck/proofcheck.cpp", folder / "plain", folder / "strict"
    compiler = ["g++", "-std=c++17", "-frounding-math", "-ffp-contract=off", "-pthread", source]
    sanitize = ["-O1", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
    subprocess.run([*compiler, "-O2", "-o", plain], cwd=REPOSITORY, check=True)
    subprocess.run([*compiler, *sanitize, "-o", strict], cwd=REPOSITORY, check=True)
    for name, program, share in (("C++", plain, CHECKED), ("sanitized C++", strict, SANITIZED)):
        codes: Counter[str] = Counter()
        file = folder / "proof.json"
        for number in range(round(share * INPUTS)):
            file.write_bytes(case_of(place, PROOFS, number).content)
            try:
                done = subprocess.run([program, file], capture_output=True, timeout=CHECKER_S)
                code = str(done.returncode)
            except subprocess.TimeoutExpired:
                code = "hang"
            codes[code] += 1
            if code not in ("0", "1", "2", "3"):
                print(f"   {PROOFS} {number}: {name} checker: {code}", flush=True)
        told = ", ".join(f"{count} x {code}" for code, count in sorted(codes.items()))
        show(f"{name} checker: exit codes", told, "0 to 3")


def report_commands(place: Place) -> None:
    """Exit codes of the command line, and what it printed that it must not."""
    codes: Counter[int] = Counter()
    wrong = []
    for number in range(round(TYPED * INPUTS)):
        code, complaints = answer_of(place, number)
        codes[code] += 1
        wrong += [f"command {number}: {line}" for line in complaints]
    told = ", ".join(f"{count} x {code}" for code, count in sorted(codes.items()))
    show(f"command line, {len(COMMANDS)} commands: exit codes", told, "0, 1, 2, 3")
    show("command line: answers that are not one line", len(wrong), "0")
    for line in wrong:
        print("  ", line)


def replay(kind: str, number: int) -> None:
    """Show what becomes of one input, and leave it in the folder of the findings."""
    run, episodes = base()
    with tempfile.TemporaryDirectory() as folder:
        place = Place.make(Path(folder), run, episodes)
        case = case_of(place, kind, number)
        print(case.name, len(case.content), "bytes:", carry(place, kind, number))


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["work", run, episodes, folder, kind, first, last]:
            work(Path(folder), Path(run), Path(episodes), Block(kind, int(first), int(last)))
        case ["replay", kind, number]:
            replay(kind, int(number))
        case kinds:
            main(kinds or list(SHARES))
