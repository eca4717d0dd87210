"""A thousand altered proof files through the C++ checker, and policies with planted violations.

The default policy's proof is altered: made unreadable, made to contradict itself, made false (with
other weights, bounds, regions, robots) or barely so; of level 3, its premises are made false and
its conclusions are claimed without what they need. Evidence that a statement is false comes from
values at points, never from a checker. Planted policies break one condition by a little; their
forged proofs go through both checkers.

Asked: no altered file is accepted. A false one must be rejected; one that is barely false may be
left undecided. 20 planted policies: every forged proof is rejected, or left undecided by a checker
that is too coarse for it.
"""

# pyright: reportMissingImports=false
# Altered proofs lie with the tests of the other checker, on a path set at run time.

import itertools
import json
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterable
from pathlib import Path

from common import show, trained

from neuralgaits.workflows.certify import PROOF, certify
from neuralgaits.workflows.check_proof import check_proof
from neuralgaits.workflows.run import open_run

# What alters the files is that of the tests.
sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "certificate"))

from mutations.base import Base, Mutation
from mutations.generate import CONCLUSIONS, PREMISES, mutations
from mutations.planted import planted

REPOSITORY = Path(__file__).parents[1]
LEVEL_1, FALSE_PREMISES, NOT_FOLLOWING, POLICIES = 600, 150, 250, 20
CODES = {"proved": 0, "rejected": 1, "undecided": 3}
EVERYTHING = 10**9
"""Bits of the largest tree kept: all statements stay in the file."""


def main() -> None:
    """Print how many files of each kind got which answer, and how long the checker took."""
    subprocess.run(["make", "--silent", "proofcheck"], cwd=REPOSITORY, check=True)
    with tempfile.TemporaryDirectory() as folder:
        first, third = (certified(level, Path(folder) / str(level)) for level in (1, 3))
    whole = Base(third.table, third.run, most=EVERYTHING)
    suites = {
        "level 1": mutations(first, "model", LEVEL_1),
        "level 3, premises": mutations(third.premises(), "model", FALSE_PREMISES, groups=PREMISES),
        "level 3, conclusions": mutations(whole, "model", NOT_FOLLOWING, groups=CONCLUSIONS),
    }
    for name, suite in suites.items():
        report(name, suite)
    report_planted(first)


def certified(level: int, folder: Path) -> Base:
    """The default policy's proof of a level; the run is copied to the folder."""
    run = open_run(shutil.copytree(trained("amber3m", 0).path, folder))
    certify(run, level=level)
    return Base(json.loads((run.path / PROOF).read_text()), run)


def answer(content: bytes, folder: Path) -> tuple[int, float]:
    """Exit code of the C++ checker, and seconds."""
    file = folder / "proof.json"
    file.write_bytes(content)
    start = time.perf_counter()
    found = subprocess.run([REPOSITORY / "build" / "proofcheck", file], capture_output=True)
    return found.returncode, time.perf_counter() - start


def report(name: str, suite: Iterable[Mutation]) -> None:
    """Print answers by kind of alteration."""
    seen: Counter[tuple[str, int]] = Counter()
    seconds, wrong = [], []
    with tempfile.TemporaryDirectory() as folder:
        for mutation in suite:
            code, taken = answer(mutation.text, Path(folder))
            seen[mutation.kind, code] += 1
            seconds.append(taken)
            if code not in mutation.allowed:
                wrong.append(f"{mutation.name}: exit {code}")
    for kind, rows in itertools.groupby(sorted(seen.items()), key=lambda row: row[0][0]):
        codes = ", ".join(f"{count} x exit {code}" for (_, code), count in rows)
        show(f"{name}: {kind}", codes, "1 rejected, 2 no proof file, 3 undecided")
    show(f"{name}: files, answered wrongly", f"{len(seconds)}, {len(wrong)}", "0 wrong")
    for line in wrong:
        print("  ", line)
    show(f"{name}: seconds in all, slowest", f"{sum(seconds):.1f}, {max(seconds):.2f}")


def report_planted(base: Base) -> None:
    """Forged proofs of policies that break a condition by a little, through both checkers."""
    seen: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "proof.json"
        for gait in planted(base, POLICIES):
            code, _ = answer(gait.forged(base).text, Path(folder))
            balls = CODES[check_proof(file)["verdict"]]
            seen[f"C++ {code}, balls {balls}"] += 1
    show("planted violations: exit codes", "; ".join(f"{n} x {k}" for k, n in seen.items()), "no 0")


if __name__ == "__main__":
    main()
