"""Texts of up to 2 MB that ask a reader of proofs for more than they are worth.

Each is made from the proof of the default gait that comes with the package: a name a hundred
thousand times, a chart of as many axes, lists in lists, numbers of a million digits, statements,
boxes, parameters, Programs of few words and many numbers. None is a proof of what it says.

Printed, by kind: the size of the text, seconds of one core (user and system) and exit code of the
C++ checker, reading the model and (`--program`) the Program, and of `check-proof`. Asked: every C++
answer within 2 s, every exit code one of 0, 1, 2, 3. `hostile_proofs.py WORD ...` restricts
the kinds; `SANITIZED=1` asks a checker built with sanitizers instead, whose times say nothing.
"""

import json
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

from common import show

from support.hostile_proofs import KINDS, LARGEST, text_of

REPOSITORY = Path(__file__).parents[1]
LEAST_KINDS, MOST_SECONDS = 40, 2.0
KNOWN = (0, 1, 2, 3)
"""Exit codes of the checkers: proved, rejected, no proof, undecided."""
SANITIZED = os.environ.get("SANITIZED") == "1"


def main(words: list[str]) -> None:
    """Print the table, a line a kind, and the largest of all."""
    with tempfile.TemporaryDirectory() as folder:
        program = _sanitized(Path(folder)) if SANITIZED else _built()
        file = Path(folder) / "proof.json"
        slowest, odd = 0.0, []
        print(f"{'kind':52} {'MB':>5} {'C++':>7} {'':4} {'Program':>7} {'':4} {'Python':>7}")
        for kind in KINDS:
            if words and not any(word in kind for word in words):
                continue
            text = text_of(kind)
            assert len(text) <= LARGEST, (kind, len(text))
            file.write_bytes(text)
            answers = [_ask([program, file]), _ask([program, "--program", file])]
            python = [sys.executable, "-m", "neuralgaits", "check-proof", file]
            answers.append(_ask(python) if not SANITIZED else (0.0, 2))
            cells = " ".join(f"{taken:7.2f} ({code:2})" for taken, code in answers)
            print(f"{kind:52} {len(text) / 1e6:5.2f} {cells}", flush=True)
            slowest = max(slowest, answers[0][0], answers[1][0])
            odd += [kind for _, code in answers if code not in KNOWN]
    show("kinds of hostile text", str(len(KINDS)), f"{LEAST_KINDS} or more")
    show("slowest answer of the C++ checker [s of one core]", f"{slowest:.2f}", f"{MOST_SECONDS}")
    show("answers without a known exit code", json.dumps(sorted(set(odd))), "[]")


def _ask(command: list) -> tuple[float, int]:
    """Seconds of user and system, and the exit code."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    answer = subprocess.run(command, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if b"Sanitizer" in answer.stderr or b"runtime error" in answer.stderr:
        print(answer.stderr.decode(errors="replace")[:2000])
    taken = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return taken, answer.returncode


def _built() -> Path:
    subprocess.run(["make", "--silent", "proofcheck"], cwd=REPOSITORY, check=True)
    return REPOSITORY / "build" / "proofcheck"


def _sanitized(folder: Path) -> Path:
    flags = "-std=c++17 -O1 -g -frounding-math -ffp-contract=off -pthread".split()
    checks = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
    source = REPOSITORY / "tools" / "proofcheck" / "proofcheck.cpp"
    program = folder / "proofcheck"
    subprocess.run(["g++", *flags, *checks, source, "-o", program], check=True)
    return program


if __name__ == "__main__":
    main(sys.argv[1:])
