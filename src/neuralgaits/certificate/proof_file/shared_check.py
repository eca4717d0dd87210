"""Bound the leaves of all statements of a proof file in as many processes as there are cores.

Leaves go out in pieces, shared among the processes in turn. Another process receives the statements
and returns one line a piece; pieces without an answer are bounded here. Results are taken in the
order of the file, so the answer does not depend on who bounded which piece.
"""

import contextlib
import itertools
import json
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict
from typing import Any, NamedTuple

from neuralgaits._environment import cores
from neuralgaits._own_process import command_of, environment_of
from neuralgaits.certificate.chart import CoupledAxes
from neuralgaits.certificate.proof_file.reader import Corners, Statement
from neuralgaits.certificate.proof_file.statement_check import BATCH, StatementCheck, Verdict
from neuralgaits.programs.program import Program
from neuralgaits.records.checked import Arithmetic

FEW = 512
"""Leaves that are bounded before another process starts."""


class Piece(NamedTuple):
    """Leaves of one statement, from `start` on: `BATCH` of them, or the rest."""

    statement: int
    start: int
    leaves: int


class PieceResult(NamedTuple):
    """Verdict on a piece, how many boxes it took, and how many of them were bounded in balls."""

    verdict: Verdict
    reason: str | None
    boxes: int
    boxes_in_balls: int


class PieceBounder:
    """A callable that bounds pieces in this process."""

    def __init__(
        self,
        program: Program,
        statements: Sequence[Statement],
        trees: Sequence[Corners],
        arithmetic: Arithmetic,
    ):
        self._program = program
        self._statements = statements
        self._trees = trees
        self._arithmetic: Arithmetic = arithmetic
        self._checkers: dict[int, StatementCheck] = {}

    def __call__(self, piece: Piece) -> PieceResult:
        """Bound the leaves of one piece, up to the first that fails."""
        number = piece.statement
        if number not in self._checkers:
            # One at a time: a statement's constants are folded once, and then let go.
            leaves, statement = len(self._trees[number][0]), self._statements[number]
            checker = StatementCheck.of(self._program, statement, leaves, self._arithmetic)
            self._checkers = {number: checker}
        checker, chosen = self._checkers[number], slice(piece.start, piece.start + piece.leaves)
        before = checker.boxes, checker.boxes_in_balls
        low, high = self._trees[number]
        for _ in checker.walk((low[chosen], high[chosen])):
            pass
        if checker.verdict != "holds":
            self._checkers = {}
        counts = checker.boxes - before[0], checker.boxes_in_balls - before[1]
        return PieceResult(checker.verdict, checker.reason, *counts)


def pieces_of(trees: Sequence[Corners]) -> list[Piece]:
    """Return the pieces of all leaves, in the order of the file."""
    return [
        Piece(number, start, min(BATCH, len(low) - start))
        for number, (low, _) in enumerate(trees)
        for start in range(0, len(low), BATCH)
    ]


def bound_all(
    program: Program,
    statements: Sequence[Statement],
    trees: Sequence[Corners],
    progress: Callable[[int, int], None] | None = None,
    arithmetic: Arithmetic = "doubles",
) -> PieceResult:
    """Bound every leaf, up to the first piece that is rejected.

    Args:
        program: Program of a proof file.
        statements: statements of the file.
        trees: leaves of each statement.
        progress: called with (leaves done, leaves) now and then.
        arithmetic: "balls" for boxes that are all bounded in balls.

    Returns: that all hold; or the first that is rejected; or, without one, the first undecided.
    """
    pieces, here = pieces_of(trees), PieceBounder(program, statements, trees, arithmetic)
    total = sum(piece.leaves for piece in pieces)
    count = min(cores(), 8) if total > FEW else 1
    answer = PieceResult("holds", None, 0, 0)
    boxes = 0
    in_balls = 0
    done = 0
    with contextlib.ExitStack() as stack:
        processes = [
            stack.enter_context(
                contextlib.closing(OtherProcess(program, statements, k, count, arithmetic))
            )
            for k in range(1, count)
        ]
        for piece, result in zip(pieces, _ordered_answers(pieces, here, processes), strict=False):
            boxes, in_balls = boxes + result.boxes, in_balls + result.boxes_in_balls
            done += piece.leaves
            if answer.verdict == "holds" or result.verdict == "rejected":
                answer = result
            if result.verdict == "rejected":
                break
            if progress is not None:
                progress(done, total)
    return answer._replace(boxes=boxes, boxes_in_balls=in_balls)


def _ordered_answers(
    pieces: Sequence[Piece], here: PieceBounder, processes: Sequence["OtherProcess"]
) -> Iterator[PieceResult]:
    """Yield the result of each piece in order; bound own pieces ahead while waiting for others."""
    count, results = 1 + len(processes), {}
    next_own = iter(range(0, len(pieces), count))
    for number, piece in enumerate(pieces):
        place, turn = divmod(number, count)
        other = processes[turn - 1] if turn else None
        while number not in results and not (other and len(other.results) > place):
            ahead = next(next_own, None)
            if ahead is not None:
                results[ahead] = here(pieces[ahead])
            elif other is None or other.ended:
                results[number] = here(piece)
            else:
                other.wait()
        yield results.pop(number) if number in results else other.results[place]  # pyright: ignore[reportOptionalMemberAccess]


class OtherProcess:
    """A process that bounds every `count`-th piece from `turn` on.

    Attributes:
        results: results so far, in the order of its pieces.
    """

    def __init__(
        self,
        program: Program,
        statements: Sequence[Statement],
        turn: int,
        count: int,
        arithmetic: Arithmetic,
    ):
        self.results: list[PieceResult] = []
        task = {
            "program": program.to_json(),
            "statements": [asdict(statement) for statement in statements],
            "turn": turn,
            "count": count,
            "arithmetic": arithmetic,
        }
        self._process = None
        with contextlib.suppress(OSError, TypeError):  # TypeError: Python has no executable.
            self._process = subprocess.Popen(
                command_of("neuralgaits.certificate.proof_file.shared_check"),
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                text=True,
                env=environment_of(OPENBLAS_NUM_THREADS="1"),
            )
        self._reader = threading.Thread(target=self._read, args=(json.dumps(task),), daemon=True)
        self._reader.start()

    @property
    def ended(self) -> bool:
        """Return whether the process will send no more results."""
        return not self._reader.is_alive()

    def wait(self) -> None:
        """Wait a short time for the process's next results."""
        self._reader.join(timeout=0.005)

    def close(self) -> None:
        """End the process in any state."""
        if self._process is not None:
            self._process.kill()
            self._reader.join()
            self._process.wait()

    def _read(self, task: str) -> None:
        process = self._process
        if process is None or process.stdin is None or process.stdout is None:
            return
        with contextlib.suppress(OSError, ValueError), process.stdin, process.stdout:
            process.stdin.write(task)
            process.stdin.close()
            for line in process.stdout:
                self.results.append(PieceResult(*json.loads(line)))


def _bound_share(task: dict[str, Any]) -> Iterator[PieceResult]:
    """Yield another process's results, up to its first piece that is rejected."""
    statements = [
        Statement(
            **row
            | {name: tuple(row[name]) for name in ("conditions", "low", "high")}
            | {"coupled_axes": tuple(CoupledAxes(*pair) for pair in row["coupled_axes"])}
        )
        for row in task["statements"]
    ]
    trees = [statement.leaves() for statement in statements]
    program = Program.from_json(task["program"])
    here = PieceBounder(program, statements, trees, task["arithmetic"])
    for piece in itertools.islice(pieces_of(trees), task["turn"], None, task["count"]):
        answer = here(piece)
        yield answer
        if answer.verdict == "rejected":
            return


if __name__ == "__main__":
    for one in _bound_share(json.load(sys.stdin)):
        sys.stdout.write(json.dumps(one) + "\n")
        sys.stdout.flush()
