"""Check a proof file independently, with the standard library, NumPy and Arb only.

The search that wrote the file is not trusted. Every tree is walked from its root and every leaf is
bounded again; the file's further claims are concluded anew. Without a run to compare with, nothing
says what the file's Program is about, and the best verdict is `consistent`.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from neuralgaits._digits import at_least, at_most
from neuralgaits.certificate.levels.levels import conclude
from neuralgaits.certificate.premises import level_one_boxes, proved_bounds
from neuralgaits.certificate.proof_file.command_ranges import why_part
from neuralgaits.certificate.proof_file.consistency import inconsistencies
from neuralgaits.certificate.proof_file.coverage import SpecOutline, unstated, why_incomplete
from neuralgaits.certificate.proof_file.reader import FIBRE, Claims, InconsistentError, Statement
from neuralgaits.certificate.proof_file.shared_check import bound_all
from neuralgaits.certificate.proof_file.theorem_tables import LEVELS_BY_NUMBER
from neuralgaits.records.certified import Conclusion
from neuralgaits.records.checked import Arithmetic

Verdict = Literal["proved", "consistent", "rejected", "undecided"]
Progress = Callable[[int, int], None]

NAMED_EACH = 6
"""Largest number of axes beside the state's that each statement names; more are named once."""
DIGITS = 4
"""Significant digits of bounds in sentences; the file has all of them."""
SHOWN = 3
"""Largest number of contradictions or names that a message gives."""

NOT_TIED = (
    "not compared with a run: every statement and conclusion follows from the Program in the file; "
    "whether that Program is of the robot, policy and spec that it names was not checked, "
    "`check-proof FILE --run RUN` does that"
)
DERIVED_ELSEWHERE = (
    "the Program in the file is the spec's conditions for the robot and weights named: without a "
    "run to compare with, it is not traced again, and the verdict is about whatever it computes"
)
OWN_SPEC = (
    "the spec is code of the run's own, spec.py, which was run in a process of its own to trace "
    "it: read it, for it says what its conditions are and could say anything"
)
TRUSTED: dict[Arithmetic, str] = {
    "doubles": "trusted: this checker, its bounds on the rounding of doubles, that +, -, x, / and "
    "square roots in NumPy are those of IEEE 754 and its sums sums of these, python-flint (Arb) "
    "where doubles do not decide, Python",
    "balls": "trusted: this checker, python-flint (Arb), NumPy's handling of arrays, Python",
}
"""What a check rests on, by its arithmetic: the last of the assumptions of every family."""
ASSUMPTIONS = (
    "the Program was traced rightly from the formulas of robot, policy and spec: derivatives by "
    "JAX's forward mode and the activations' own rules, which are not derived again here",
    "the model is the rigid-body zero dynamics, with the residuals that the run carries if there "
    "are any, with the stored float64 numbers, in exact real arithmetic: the float32 evaluation on "
    "a robot is outside, so are sampling and disturbances but for what is stated of them",
    "levels 2 and 3 are about the projected hybrid zero dynamics: outputs are zero, and set to "
    "zero again at each impact; level 1 alone says nothing of trajectories",
    "level 4 is about the full order under exact input-output linearisation in continuous time, "
    "with rigid contact; level 5 about the same with errors of the outputs' acceleration up to a "
    "bound, or with torques held between ticks, one of them at each touchdown",
    TRUSTED["doubles"],
)


@dataclass(frozen=True)
class CheckResult:
    """Result of the check of a proof file.

    Attributes:
        verdict: "consistent", "rejected" or "undecided"; once tied to a run, "proved".
        reason: why the verdict is no better; None if it is proved.
        statements: each statement of the file in words.
        levels: the conclusions of the levels above 1 that the file claims.
        unclaimed: conditions that are not claimed on all of their region.
        boxes: number of boxes that were bounded.
        boxes_in_balls: number of those that were bounded in balls.
        holds: whether every statement holds and every claimed level follows, complete or not.
        reasons: each reason of a rejection that has several; `reason` has all in one line.
    """

    verdict: Verdict
    reason: str | None
    statements: tuple[str, ...]
    levels: tuple[Conclusion, ...]
    unclaimed: tuple[str, ...]
    boxes: int
    boxes_in_balls: int = 0
    holds: bool = False
    reasons: tuple[str, ...] = ()

    def rejected(self, reasons: Sequence[str]) -> "CheckResult":
        """Return this report with a rejection, for one reason or more."""
        several = tuple(reasons) if len(reasons) > 1 else ()
        return replace(self, verdict="rejected", reason="; ".join(reasons), reasons=several)


def check(
    claims: Claims, progress: Progress | None = None, arithmetic: Arithmetic = "doubles"
) -> CheckResult:
    """Check every statement of a proof file; stop at the first that is wrong.

    Args:
        claims: result of `read_claims`.
        progress: called with (leaves done, leaves) now and then.
        arithmetic: "balls" for boxes that are all bounded in balls.
    """
    report = CheckResult(
        verdict="consistent",
        reason=NOT_TIED,
        statements=all_in_words(claims),
        levels=(),
        unclaimed=_unclaimed(claims),
        boxes=0,
    )
    if wrong := inconsistencies(claims, claims.outline):
        return report.rejected(wrong[:SHOWN])
    try:
        trees = [statement.leaves() for statement in claims.statements]
    except InconsistentError as error:
        return replace(report, verdict="rejected", reason=str(error))
    bounds = bound_all(claims.program, claims.statements, trees, progress, arithmetic)
    report = replace(report, boxes=bounds.boxes, boxes_in_balls=bounds.boxes_in_balls)
    if bounds.verdict != "holds":
        return replace(report, verdict=bounds.verdict, reason=bounds.reason)
    return _with_conclusions(claims, report)


def tied(report: CheckResult, claims: Claims, outline: SpecOutline) -> CheckResult:
    """Return a report once the Program is known to be a run's: proved, or with the obstacle.

    Args:
        report: result of `check`.
        claims: claims of the file.
        outline: conditions and regions of the run's spec.
    """
    if not report.holds:
        return report
    if wrong := inconsistencies(claims, outline):
        return replace(report.rejected(wrong[:SHOWN]), levels=())
    report = replace(report, unclaimed=_not_on_all(claims, outline))
    levels = tuple(replace(level, verdict="proved") for level in report.levels)
    if missing := unstated(claims.statements, outline, len(claims.chart.state)):
        reason = why_incomplete(missing, len(outline.conditions))
        if any(not LEVELS_BY_NUMBER[level.level].full_order for level in levels):
            return replace(report, verdict="rejected", reason=reason, levels=())
        return replace(report, verdict="undecided", reason=reason, levels=levels)
    if report.verdict == "undecided":
        return report
    return replace(report, verdict="proved", reason=None, levels=levels)


def all_in_words(claims: Claims) -> tuple[str, ...]:
    """Return every statement of a file in words, and the chart if they do not name its axes."""
    lines = (line for one in claims.statements for line in in_words(one, claims))
    return (*chart_in_words(claims), *lines)


def _unclaimed(claims: Claims) -> tuple[str, ...]:
    """Return the conditions that are not claimed, by box where the boxes are known."""
    if claims.outline is not None:
        return _not_on_all(claims, claims.outline)
    claimed = {name for statement in claims.statements for name in statement.conditions}
    return tuple(o.name for o in claims.program.outputs if o.name not in claimed)


def _not_on_all(claims: Claims, outline: SpecOutline) -> tuple[str, ...]:
    left = unstated(claims.statements, outline, len(claims.chart.state))
    return tuple(dict.fromkeys(name for name, *_ in left))


def _with_conclusions(claims: Claims, report: CheckResult) -> CheckResult:
    """Draw the conclusions that the file claims from its statements, all of which hold by now."""
    theorems, outline = claims.theorems, claims.outline
    boxes = level_one_boxes(claims.statements) if outline is None else outline.boxes()
    bounds = proved_bounds(claims.statements, len(claims.chart.state))
    try:
        conclusions = conclude(theorems.parameters, boxes, bounds, claims.chart)
    except (OverflowError, ZeroDivisionError) as error:
        reason = f"the parameters of its theorems leave the range of doubles: {error}"
        return replace(report, verdict="rejected", reason=reason)
    claimed = [answer for answer in conclusions if answer.level in theorems.claimed]
    wrong = [answer for answer in claimed if answer.verdict != "proved"]
    if wrong:
        reason = f"level {wrong[0].level} does not follow: {wrong[0].reason}"
        return replace(report, verdict="rejected", reason=reason)
    levels = tuple(replace(answer, verdict="consistent") for answer in claimed)
    report = replace(report, levels=levels, holds=True)
    reason = _why_incomplete(claims) or why_part(claims.chart, claims.commands)
    return report if reason is None else replace(report, verdict="undecided", reason=reason)


def _why_incomplete(claims: Claims) -> str | None:
    """Name the conditions that a complete proof would claim and this one does not; or None."""
    if claims.outline is not None:
        missing = unstated(claims.statements, claims.outline, len(claims.chart.state))
        return why_incomplete(missing, len(claims.outline.conditions)) if missing else None
    conditions = {name for statement in claims.statements for name in statement.conditions}
    names = [o.name for o in claims.program.outputs if "/" not in o.name]
    left = [name for name in names if name not in conditions]
    if not left:
        return None
    named = ", ".join(left[:SHOWN]) + (f" and {len(left) - SHOWN} more" if left[SHOWN:] else "")
    return (
        f"every statement of the file holds, but {len(left)} of {len(names)} conditions are not "
        f"claimed: {named}"
    )


def chart_in_words(claims: Claims) -> Iterator[str]:
    """Describe the chart's axes beside phase and level if they are too many for each statement."""
    axes = claims.chart.parameters
    if len(axes) > NAMED_EACH:
        yield f"the chart's other axes: {' and '.join(claims.chart.intervals())}"


def in_words(statement: Statement, claims: Claims) -> Iterator[str]:
    """Return one sentence for each condition of a statement."""
    ends = list(zip(claims.chart.axes, statement.low, statement.high, strict=True))
    state = len(claims.chart.state)
    many = len(ends) > state + NAMED_EACH
    where = " and ".join(
        f"{axis.name} in [{low!r}, {high!r}]"
        + ("" if axis.change is None else f", at most {axis.change!r} from the one before")
        for axis, low, high in (ends[:state] if many else ends)
    )
    if many:  # Their roots are whole in them.
        where += f" and all of the chart's other {len(ends) - state} axes"
    for name in statement.conditions:
        fibre = f", and {FIBRE} of the unit ball" if name in claims.off_zero else ""
        bound, scale = statement.bounds[name], statement.scales[name]
        # Fewer digits than the file has, to the side on which the product stays true.
        size = (at_least if bound >= 0.0 else at_most)(scale, 6)
        yield (
            f"{name}: the margin is at least {at_least(bound, DIGITS)} of its scale {size} at "
            f"every {where}{fibre} (region {statement.region})"
        )
