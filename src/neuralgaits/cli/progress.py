"""Progress on stderr: a bar on a terminal, a few lines without one, nothing under `--json`."""

import sys
import time
from typing import TYPE_CHECKING, Self

from rich.console import Console
from rich.progress import (
    BarColumn,
    Progress,
    ProgressColumn,
    SpinnerColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from neuralgaits.records.checked import Arithmetic

if TYPE_CHECKING:
    from neuralgaits.records.trained import ProofRound

_LINES = 10
"""Approximate number of lines in place of a bar."""
_BAR = 24
"""Width of a bar [characters], with which the whole line fits 80 columns."""
MANY_BOXES: dict[Arithmetic, int] = {"doubles": 10_000_000, "balls": 100_000}
"""From here on a proof takes this program hours to check, and the C++ checker minutes."""


class _OnTerminal:
    """A bar on stderr, shown while the context is open and only on a terminal.

    Args:
        columns: columns of the bar.
        quiet: show nothing at all, as under `--json`.
    """

    def __init__(self, *columns: ProgressColumn | str, quiet: bool = False) -> None:
        self._console = Console(stderr=True, quiet=quiet)
        self._bar = Progress(*columns, console=self._console, transient=True)
        self._quiet = quiet

    @property
    def _drawn(self) -> bool:
        return self._console.is_terminal and not self._quiet

    def __enter__(self) -> Self:
        if self._drawn:
            self._bar.start()
        return self

    def __exit__(self, *raised: object) -> None:
        if self._drawn:
            self._bar.stop()

    def say(self, line: str) -> None:
        """Print a permanent line above the bar."""
        self._console.print(line, highlight=False, markup=False, soft_wrap=True)

    def _line(self, line: str) -> None:
        """Print a line in place of a bar."""
        if not self._quiet:
            print(line, file=sys.stderr)


class TrainingProgress(_OnTerminal):
    """A callback `(step, total, loss)` for the workflow, open while it runs."""

    def __init__(self, quiet: bool = False) -> None:
        super().__init__(
            TextColumn("{task.description}"),
            BarColumn(_BAR),
            TextColumn("{task.fields[count]}"),
            TimeElapsedColumn(),
            TextColumn("{task.fields[eta]}"),
            TimeRemainingColumn(),
            quiet=quiet,
        )
        self._task = self._bar.add_task("compiling", total=None, count="", eta="")
        self._next_line = 0.0
        self._first: tuple[int, float] | None = None

    def begun(self) -> None:
        """Say without a terminal why no step is shown yet."""
        if not self._drawn:
            self._line("compiling, which takes ten seconds or more; then steps are shown")

    def __call__(self, step: int, total: int, loss: float) -> None:
        """Show that `step` of `total` gradient steps are done, with the loss at that step."""
        if self._drawn:
            self._bar.update(
                self._task,
                completed=step,
                total=total,
                count=f"{step}/{total} steps",
                eta="ETA",
                description=f"loss {loss:.3g}",
            )
        elif step >= self._next_line or step >= total:
            self._next_line = step + total / _LINES
            self._line(f"step {step}/{total}  loss {loss:.3g}{self._eta(step, total)}")

    def stage(self, number: int, what: str) -> None:
        """Say which stage of a round of episodes begins, and restart the bar."""
        self.say(f"round {number}: {what}")
        self._bar.reset(self._task, total=None, count="", eta="", description=what)
        self._next_line, self._first = 0.0, None

    def proved(self, share: float, boxes: int) -> None:
        """Show the proved share of all conditions' regions, on a terminal."""
        if self._drawn:
            self._bar.update(
                self._task,
                completed=share,
                total=1.0,
                count=f"{100.0 * share:.1f} %, {boxes} boxes bounded in the search",
                eta="",
                description="proved",
            )

    def round_ended(self, proof_round: "ProofRound") -> None:
        """Print the result of a certificate in a permanent line."""
        line = f"certificate after {proof_round.steps} steps: {proof_round.verdict}"
        named_at_most = 3  # Conditions that a line names before it gives a count.
        if proof_round.failing:
            worst = sorted(proof_round.failing, key=lambda name: -proof_round.failing[name])
            more = f" and {len(worst) - named_at_most} more" if len(worst) > named_at_most else ""
            line += (
                f", {proof_round.open_boxes} boxes open: {', '.join(worst[:named_at_most])}{more}"
            )
        if proof_round.smallest_margin is not None:
            line += f", smallest margin {proof_round.smallest_margin:.3g} of its scale"
        self.say(line)
        self._next_line, self._first = 0.0, None

    def _eta(self, step: int, total: int) -> str:
        """Return the time left at the mean pace since the first call, made after compiling."""
        now = time.monotonic()
        if self._first is None:
            self._first = (step, now)
        first_step, start = self._first
        if step == first_step:
            return ""
        return f"  ETA {(total - step) * (now - start) / (step - first_step):.0f} s"


class _Share(_OnTerminal):
    """Progress of a share from 0 to 1, with a count."""

    def __init__(self, what: str, *more: ProgressColumn, quiet: bool) -> None:
        super().__init__(
            TextColumn(what),
            BarColumn(_BAR),
            TextColumn("{task.percentage:.1f} %  {task.fields[count]}"),
            TimeElapsedColumn(),
            *more,
            quiet=quiet,
        )
        self._what = what
        self._task = self._bar.add_task("", total=1.0, count="")
        self._next_share, self._next_time = 0.0, 0.0

    def _show(self, share: float, count: str) -> None:
        now = time.monotonic()
        if self._drawn:
            self._bar.update(self._task, completed=share, count=count)
        elif share >= self._next_share or now >= self._next_time:
            # The last line is the whole: no tenth after it.
            self._next_share = min(share + 1.0 / _LINES, 1.0) if share < 1.0 else 2.0
            silence_s = 30.0  # Of a task that has not advanced by another tenth.
            self._next_time = now + silence_s
            self._line(f"{self._what} {100.0 * share:.1f} %  {count}")


class ProofProgress(_Share):
    """A callback `(proved share, boxes)` for the search of a proof, open while it runs."""

    def __init__(self, quiet: bool = False) -> None:
        super().__init__("proved", quiet=quiet)

    def __call__(self, share: float, boxes: int) -> None:
        """Show the proved share of all conditions' regions."""
        self._show(share, f"{boxes} boxes bounded in the search")


class CheckProgress(_Share):
    """A callback `(leaves done, leaves)` for the check of a proof, open while it runs."""

    def __init__(self, quiet: bool = False, many: int = MANY_BOXES["doubles"]) -> None:
        left = (TextColumn("ETA"), TimeRemainingColumn())
        super().__init__("checked", *left, quiet=quiet)
        self._warned, self._many = False, many

    def __call__(self, done: int, leaves: int) -> None:
        """Show how many leaves of the proof's trees are bounded again."""
        if leaves > self._many and not self._warned:
            self.say(
                f"{leaves} boxes of the proof file take hours here; `make proofcheck` builds a "
                "quicker checker"
            )
            self._warned = True
        self._show(done / leaves if leaves else 1.0, f"{done}/{leaves} boxes of the proof file")


class WorkProgress(_OnTerminal):
    """A spinner for work without countable steps; without a terminal it has one line."""

    def __init__(self, what: str, quiet: bool = False) -> None:
        super().__init__(SpinnerColumn(), TextColumn(what), TimeElapsedColumn(), quiet=quiet)
        self._what = what
        self._bar.add_task("", total=None)

    def begun(self) -> None:
        """Say without a terminal what is being done, once nothing stands in its way."""
        if not self._drawn:
            self._line(self._what)


class SweepProgress(_OnTerminal):
    """A callback `(line, done, all)` for a sweep: it prints a permanent line for each row."""

    def __init__(self, quiet: bool = False) -> None:
        super().__init__(
            TextColumn("rows"),
            BarColumn(_BAR),
            TextColumn("{task.completed}/{task.total}"),
            TimeElapsedColumn(),
            quiet=quiet,
        )
        self._task = self._bar.add_task("", total=None)

    def __call__(self, line: str, done: int, every: int) -> None:
        """Show the result of a row, and how many rows are done."""
        if self._drawn:
            self._bar.update(self._task, completed=done, total=every)
        self.say(f"{done}/{every} {line}")
