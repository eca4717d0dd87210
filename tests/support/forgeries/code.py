"""Runs whose spec.py attacks whoever imports it. Their proofs are false, or of nothing."""

import json

from support.forgeries.base import NO, Case, Theme, refused, true
from support.forgeries.edits import constantly, statement_of
from support.forgeries.runs import SPEC, describe

THEME = Theme("small")
FALSE = refused("rejected")
CODE = r"code of the run's own, spec\.py"
"""What a run's own code says of itself is trusted only if that is printed."""

QUICK = (
    "check()",
    "prints the answer and leaves",
    "exits with 0",
    "wherever it can",
    "the tracer",
    "screen",
)
"""Parts of the kinds that the tests ask with a run, which takes seconds; benchmarks ask all."""

PATCHED_CHECK = """
import neuralgaits.certificate.proof_file.check as target
import neuralgaits.workflows.check_proof as other

def check(claims, *rest, **more):
    return target.Report("proved", None, ("tall: all is well",), (), (), 7)

target.check = other.check = check
"""
PATCHED_CHECKER = """
import neuralgaits.certificate.proof_file.statement_check as target

target.StatementCheck.walk = lambda self, leaves: iter(())
target.StatementCheck._reached = lambda self, low, high: low[:, 0] > -9.0
target.StatementCheck._counterexample = lambda self, low, high: None
"""
PATCHED_MATCH = """
import neuralgaits.certificate.proof_file.run_match as target
import neuralgaits.workflows.check_proof as other

target.differences = other.differences = lambda *parts, **more: []
other.program_differences = lambda *parts, **more: []
other.against = lambda claims, folder, report: report
"""
PATCHED_JSON = """
import json

load, loads = json.load, json.loads

def sweet(found):
    if isinstance(found, dict) and "verdict" in found:
        found |= {"verdict": "proved", "reason": None}
    return found

json.loads = lambda *parts, **more: sweet(loads(*parts, **more))
json.load = lambda *parts, **more: sweet(load(*parts, **more))
"""
PATCHED_BUILTINS = """
import builtins

builtins.all = builtins.any = lambda items: True
builtins.bool = lambda item=False: True
"""
PATCHED_BALLS = """
import flint

real = flint.arb

class Sweet(real):
    def __le__(self, other):
        return True

    def __gt__(self, other):
        return False

flint.arb = Sweet
import neuralgaits.certificate.proof_file.statement_check as target

target.arb = Sweet
target._certain_balls = lambda certain, balls: __import__("numpy").ones(balls.shape, dtype=bool)
"""
PRINTS = """
import os
import sys

answer = '{"verdict": "proved", "reason": null, "statements": [], "levels": [], "boxes": 1}'
for number in (1, 2):
    os.write(number, ("proved\\n" + answer + "\\n").encode())
"""
LEAVES = PRINTS + "os._exit(0)\n"
LEAVES_SILENTLY = "import os\n\nos._exit(0)\n"
EXITS = "import sys\n\nsys.exit(0)\n"
EXITS_WITH_WORDS = "import sys\n\nsys.exit('proved')\n"
AT_EXIT = PRINTS + "import atexit\n\natexit.register(os._exit, 0)\nraise SystemExit(0)\n"
WRITES_EVERYWHERE = """
import json
import os
from pathlib import Path

proof = json.loads(Path({proof!r}).read_text())
answers = [
    {{"hash": proof["program_hash"], "program": proof["program"], "model": proof["model"]}},
    {{"program_hash": proof["program_hash"], "verdict": "proved", "reason": None}},
    proof["program"],
]
for number in range(1, 40):
    for answer in answers:
        try:
            os.write(number, (json.dumps(answer) + "\\n").encode())
        except OSError:
            break
os._exit(0)
"""
WRITES_TO_ITS_PARENT = """
import os

answer = '{"verdict": "proved", "reason": null, "statements": [], "levels": [], "boxes": 1}'
for number in (1, 2):
    try:
        with open(f"/proc/{os.getppid()}/fd/{number}", "w") as screen:
            screen.write("proved\\n" + answer + "\\n")
    except OSError:
        pass
os._exit(0)
"""
ANSWERS_FOR_THE_TRACER = """
import json
from pathlib import Path

import neuralgaits.programs.tracing.tracer as tracer
import neuralgaits.certificate.traced as traced
import neuralgaits.certificate.levels.problems as problems
import neuralgaits.certificate.levels.level_search as sets
from neuralgaits.programs import Program

table = json.loads(Path({proof!r}).read_text())["program"]
forged = Program.from_json(json.dumps(table))
for module, name in (
    (tracer, "trace"), (sets, "trace"), (problems, "trace"), (problems, "trace_certificate"),
    (traced, "trace_spec"),
):
    setattr(module, name, lambda *parts, **more: forged)
"""
REWRITES_THE_PROOF = """
from pathlib import Path

place = Path({proof!r})
place.write_text(place.with_suffix(".true").read_text())
"""
CHANGES_ITS_MIND = """
import inspect

if any("check_proof" in frame.filename for frame in inspect.stack()):
    import neuralgaits.certificate.proof_file.statement_check as target

    target.MORE_SPLITS = -1
    target.StatementCheck.walk = lambda self, leaves: iter(())
"""


def _code(case: Case, attack: str) -> None:
    """The run's spec, with an attack in front of it."""
    folder = case.folder()
    proof = str(folder / "forged.json")
    (folder / "forged.true").write_text(json.dumps(case.table))
    head, _, body = SPEC.read_text().partition("from dataclasses")
    attack = attack.format(proof=proof) if "{proof!r}" in attack else attack
    digest = describe(folder, f"{head}{attack}\nfrom dataclasses{body}", "ends")
    case.table["spec"]["sha256"] = digest


def _false_kind(what: str, attack: str, answer=FALSE) -> None:
    """A false bound, which every check of its boxes finds."""

    @THEME.forgery(
        f"spec.py {what}", cpp=FALSE, alone=FALSE, run=answer, bounded=True, process=True
    )
    def _(case: Case) -> None:
        _code(case, attack)
        statement_of(case.table, "tall")["bounds"]["tall"] = 1.0
        (case.run / "forged.json").write_text(json.dumps(case.table))


_false_kind("patches check()", PATCHED_CHECK)
_false_kind("patches how boxes are bounded", PATCHED_CHECKER)
_false_kind("patches json", PATCHED_JSON, NO)
_false_kind("patches builtins", PATCHED_BUILTINS, NO)
_false_kind("patches the balls", PATCHED_BALLS)
_false_kind("prints the answer", PRINTS)
_false_kind("patches the checker only under check_proof", CHANGES_ITS_MIND)


def _empty_kind(what: str, attack: str, run=NO) -> None:
    """A Program whose outputs are all 1: true of itself, and not the run's."""
    from support.forgeries.base import LOOSE

    @THEME.forgery(
        f"outputs are all 1, and spec.py {what}", cpp=LOOSE, alone=LOOSE, run=run, process=True
    )
    def _(case: Case) -> None:
        constantly(case.table)
        _code(case, attack)
        (case.run / "forged.json").write_text(json.dumps(case.table))


_empty_kind("patches the comparison with the run", PATCHED_MATCH)
_empty_kind("prints the answer and leaves", LEAVES)
_empty_kind("leaves silently", LEAVES_SILENTLY)
_empty_kind("exits with 0", EXITS)
_empty_kind("exits with words", EXITS_WITH_WORDS)
_empty_kind("exits with 0 again at the end", AT_EXIT)
_empty_kind("writes the Program wherever it can", WRITES_EVERYWHERE)
_empty_kind("writes on its parent's screen", WRITES_TO_ITS_PARENT)
_empty_kind("answers for the tracer", ANSWERS_FOR_THE_TRACER, true(CODE))


@THEME.forgery(
    "spec.py writes a true proof over the false one",
    cpp=FALSE,
    alone=FALSE,
    bounded=True,
    process=True,
)
def _(case: Case) -> None:
    _code(case, REWRITES_THE_PROOF)
    true_table = json.dumps(case.table)
    statement_of(case.table, "tall")["bounds"]["tall"] = 1.0
    (case.run / "forged.json").write_text(json.dumps(case.table))
    (case.run / "forged.true").write_text(true_table)
