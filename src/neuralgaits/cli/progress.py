"""Progress on stderr: bars of a training and of a proof, or lines without a terminal."""

import sys
import time
from contextlib import AbstractContextManager
from types import TracebackType
from typing import TYPE_CHECKING, Self

from rich.console import Console
from rich.progress import (
    BarColumn,
    Progress,
    ProgressColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

if TYPE_CHECKING:
    from neuralgaits.workflows.proof_rounds import Round

_LINES = 10
_NAMED = 3
"""Conditions that a line names before it counts."""


class _OnTerminal:
    """A bar on stderr, shown while the context is open and only on a terminal."""

    def __init__(self, *columns: ProgressColumn | str) -> None:
        self._console = Console(stderr=True)
        self._bar = Progress(*columns, console=self._console, transient=True)

    def __enter__(self) -> Self:
        if self._console.is_terminal:
            self._bar.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        if self._console.is_terminal:
            self._bar.stop()


class TrainingProgress(_OnTerminal):
    """A callback `(step, total, loss)` for the workflow, open while it runs."""

    def __init__(self) -> None:
        super().__init__(
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.fields[count]}"),
            TimeElapsedColumn(),
            TextColumn("{task.fields[eta]}"),
            TimeRemainingColumn(),
        )
        self._task = self._bar.add_task("compiling", total=None, count="", eta="")
        self._next_line = 0.0
        self._first: tuple[int, float] | None = None

    def __call__(self, step: int, total: int, loss: float) -> None:
        """Show that `step` of `total` gradient steps are done, with the loss there."""
        if self._console.is_terminal:
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
            print(f"step {step}/{total}  loss {loss:.3g}{self._eta(step, total)}", file=sys.stderr)

    def proved(self, share: float, boxes: int) -> None:
        """Show the proved share of all conditions' regions, on a terminal."""
        if self._console.is_terminal:
            self._bar.update(
                self._task,
                completed=share,
                total=1.0,
                count=f"{100.0 * share:.1f} % of {boxes} boxes",
                eta="",
                description="proved",
            )

    def round_ended(self, ended: "Round") -> None:
        """Print what a certificate found, in a line that stays."""
        line = f"certificate after {ended.steps} steps: {ended.verdict}"
        if ended.failing:
            worst = sorted(ended.failing, key=lambda name: -ended.failing[name])
            more = f" and {len(worst) - _NAMED} more" if len(worst) > _NAMED else ""
            line += f", {ended.open_boxes} boxes open: {', '.join(worst[:_NAMED])}{more}"
        if ended.smallest_margin is not None:
            line += f", smallest margin {ended.smallest_margin:.3g} of its scale"
        # The bar stays below it.
        self._console.print(line, highlight=False, markup=False, soft_wrap=True)
        self._next_line, self._first = 0.0, None

    def _eta(self, step: int, total: int) -> str:
        """Time left at the mean pace since the first call, which came after compiling."""
        now = time.monotonic()
        if self._first is None:
            self._first = (step, now)
        first_step, start = self._first
        if step == first_step:
            return ""
        return f"  ETA {(total - step) * (now - start) / (step - first_step):.0f} s"


class ProofProgress(_OnTerminal):
    """A callback `(proved share, boxes)` for the workflow, open while it runs."""

    def __init__(self) -> None:
        super().__init__(
            TextColumn("proved"),
            BarColumn(),
            TextColumn("{task.percentage:.1f} %  {task.fields[boxes]} boxes"),
            TimeElapsedColumn(),
        )
        self._task = self._bar.add_task("", total=1.0, boxes=0)
        self._last = ""

    def __call__(self, share: float, boxes: int) -> None:
        """Show the proved share of all conditions' regions."""
        line = f"proved {100.0 * share:.1f} %"
        if self._console.is_terminal:
            self._bar.update(self._task, completed=share, boxes=boxes)
        elif line != self._last:
            self._last = line
            print(f"{line}  {boxes} boxes", file=sys.stderr)


def waiting(what: str) -> AbstractContextManager[object]:
    """A sign of life while something without steps to count runs; silent without a terminal."""
    return Console(stderr=True).status(what)
