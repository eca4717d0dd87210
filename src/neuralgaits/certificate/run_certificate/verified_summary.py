"""Read a run's certificate as far as its proof files confirm it, for pages and figures.

`certify` writes `certificate/summary.json`, but the file may be another run's, or older than the
weights beside it. So only those of its results count that the run's proof files state as well:
their statements have to be about the run's own files and cover its spec, and the levels are
concluded again from them. The boxes are not bounded again here: `check-proof` does.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

from neuralgaits._inputs import MOST_BYTES
from neuralgaits.certificate.levels.levels import conclude
from neuralgaits.certificate.premises import proved_bounds
from neuralgaits.certificate.proof_file.consistency import inconsistencies
from neuralgaits.certificate.proof_file.coverage import unstated
from neuralgaits.certificate.proof_file.reader import Claims, read_claims
from neuralgaits.certificate.proof_file.run_match import differences
from neuralgaits.certificate.proof_file.sampled_bounds import first_broken_bound
from neuralgaits.certificate.run_certificate.confirmed_conditions import (
    ProofOfRun,
    Unfit,
    confirmed_conditions,
)
from neuralgaits.certificate.run_certificate.friction_requirement import friction_needed
from neuralgaits.certificate.run_certificate.run_comparison import compare_with_run
from neuralgaits.errors import InputError, RunError, TimeLimitError
from neuralgaits.records.certified import (
    PROOF,
    SUMMARY,
    CertificateRecord,
    Conclusion,
    Verdict,
)
from neuralgaits.records.level_words import HIGHEST_OF_MANY, ORBIT_LEVEL, WALKING_SET_LEVEL
from neuralgaits.records.record import build, shape_of
from neuralgaits.records.training_config import config_of
from neuralgaits.runs import RunFolder, from_json, packed
from neuralgaits.runs.file_content import refuse_large
from neuralgaits.runs.hashes import file_hashes
from neuralgaits.runs.names import MAP, RESIDUAL, ROBOT, SPEC, WEIGHTS
from neuralgaits.runs.shape import complaint

FILES = (ROBOT, SPEC, WEIGHTS, RESIDUAL, PROOF)
"""Files that a certificate is about or rests on."""
UNCHECKED = f"{SUMMARY} has as its reason, which is not checked:"


class ProvedPart(NamedTuple):
    """Proved results for some of the commands that a gait takes, and for no others.

    Attributes:
        sequences: these commands, one phrase each.
        conditions: conditions that are proved on all of their region.
        levels: levels above 1 that follow.
    """

    sequences: tuple[str, ...]
    conditions: tuple[str, ...]
    levels: tuple[Conclusion, ...]


class CertificateReading(NamedTuple):
    """Confirmed claims about a run, or the reason why there are none.

    Attributes:
        summary: summary of `certify`, with margins and levels of the proof files; None if the run
            has no certificate of its own.
        reason: why there is none; None if there is, or if `certify` was never called.
        proof: the proof file.
        map_fits: whether the map of boxes is the one that was made with them.
        part: results of a proof about some commands only; `summary` then has no proved result.
    """

    summary: CertificateRecord | None = None
    reason: str | None = None
    proof: Claims | None = None
    map_fits: bool = False
    part: ProvedPart | None = None


def hashes(run: Path) -> dict[str, str | None]:
    """Return the sha256 of each file that a certificate is about; None for an unreadable file."""
    return file_hashes(run, (*FILES, MAP))


def read_certificate(folder: RunFolder) -> CertificateReading:
    """Read a run's certificate and compare it with its proof files and with the run.

    Raises: TimeLimitError if the run's own spec does not come to an end.
    """
    path = folder.path / SUMMARY
    if not path.is_file():
        return CertificateReading()
    try:
        refuse_large(path, MOST_BYTES)
    except RunError as error:
        return CertificateReading(reason=str(error))
    damaged = f"{SUMMARY} is damaged or of another version"
    try:
        summary = from_json(path.read_bytes())
        if wrong := complaint(summary, shape_of(CertificateRecord)):
            return CertificateReading(reason=f"{damaged}, {wrong}")
        return _read(folder, build(CertificateRecord, summary))
    except Unfit as error:
        return CertificateReading(reason=str(error))
    except (OSError, ValueError, AttributeError, KeyError, TypeError):
        return CertificateReading(reason=damaged)


def _read(folder: RunFolder, summary: CertificateRecord) -> CertificateReading:
    """Read a certificate. Raises: Unfit, or any Python error on malformed data."""
    run = folder.path
    digests = hashes(run)
    if more := [n for n in summary.sha256 if n not in digests and summary.sha256[n] is not None]:
        raise Unfit(f"{SUMMARY} is about another file too, {more[0]}, as in earlier versions")
    for name in FILES:
        digest = digests[name]
        if unreadable := packed.why_unreadable(run / name):
            raise Unfit(f"certificate cannot be read: {unreadable}")
        if summary.sha256.get(name) != digest:
            if digest is None:
                raise Unfit(f"{name} is missing")
            if name == PROOF:
                raise Unfit(f"{PROOF} is damaged, or not the file that {SUMMARY} was written with")
            raise Unfit(f"{SUMMARY} is about another {name} than the run's")
    _refuse_disorder(summary)
    config = config_of(folder)
    described = config.described
    for what, named in {"robot": summary.robot, "spec": summary.spec}.items():
        if named not in ("", getattr(config, what)):
            raise Unfit(f"{SUMMARY} is about {what} {named!r}, not {getattr(config, what)!r}")
    if set(summary.conditions) != {row["name"] for row in described["conditions"]}:
        raise Unfit(f"{SUMMARY} is about other conditions than the run's")
    proof = _proof_of(run)
    claims = None if proof is None else proof.claims
    if summary.within is not None and not described.get("commands"):
        raise Unfit(f"{SUMMARY} is about ranges of commands, and the run's gait takes none")
    robot_box = {kind: half for kind, half in summary.parameters.items() if kind != "friction"}
    if proof is not None and _box(run, proof) != robot_box:
        raise Unfit(f"{SUMMARY} is about another box of robots than {PROOF}")
    _refuse_ground(summary, claims, described)
    # Nothing is said of a floor where the level that speaks of it is not claimed.
    if claims is None or WALKING_SET_LEVEL not in claims.theorems.claimed:
        without = {kind: half for kind, half in summary.parameters.items() if kind != "floor"}
        summary = replace(summary, parameters=without)
    part = None if proof is None else _part(summary, proof)
    in_part = () if part is None else part.conditions
    summary = replace(
        summary,
        conditions=dict(confirmed_conditions(summary.conditions, proof, in_part)),
        levels=tuple(_levels(summary, proof)),
    )
    summary = replace(summary, verdict=_verdict(summary))
    map_fits = digests[MAP] is not None and summary.sha256.get(MAP) == digests[MAP]
    return CertificateReading(summary, None, claims, map_fits, part)


def _refuse_disorder(summary: CertificateRecord) -> None:
    """Raise Unfit if levels do not rise by one, from 2 to no more than was requested."""
    numbers = [entry.level for entry in summary.levels]
    if numbers != list(range(2, 2 + len(numbers))) or max(numbers, default=1) > summary.level:
        raise Unfit(f"{SUMMARY} is about levels {numbers} where level {summary.level} was asked")


def _refuse_ground(
    summary: CertificateRecord, claims: Claims | None, described: Mapping[str, Any]
) -> None:
    """Raise Unfit if the proof does not cover the summary's box of robots or floors."""
    claimed = () if claims is None else claims.theorems.claimed
    if summary.parameters and max(claimed, default=0) > HIGHEST_OF_MANY:
        raise Unfit(f"{SUMMARY} states a box of robots of level {max(claimed)}, which is of one")
    least = summary.parameters.get("friction")
    if least is None:
        return
    if not friction_needed(described) <= least:
        raise Unfit(f"{SUMMARY} is about less friction than its conditions ask for")


def _part(summary: CertificateRecord, proof: ProofOfRun) -> ProvedPart | None:
    """Return a proof's results for some of the commands; None if it is about all of them.

    Raises: Unfit if the summary calls anything proved of all of them.
    """
    claims, comparison = proof
    if claims.chart == comparison.chart:
        return None
    called = [name for name, row in summary.conditions.items() if row.verdict == "proved"]
    called += [f"level {entry.level}" for entry in summary.levels if entry.proved]
    if called:
        raise Unfit(f"{SUMMARY} calls {called[0]} proved, and {PROOF} is about some commands only")
    outline = comparison.outline
    left = {name for name, *_ in unstated(claims.statements, outline)}
    conditions = tuple(name for name in outline.conditions if name not in left)
    levels = () if left else tuple(_conclusions(proof))
    return ProvedPart(claims.chart.sequences(comparison.command_names) or (), conditions, levels)


def _box(run: Path, proof: ProofOfRun) -> dict[str, float]:
    """Return the box of robots of a proof, from the names and widths of its axes."""
    walking = proof.claims.theorems.walking
    errors = proof.claims.chart.behind(len(proof.comparison.command_names)).parameters
    floor = {} if walking is None or not walking.floor else {"floor": walking.floor}
    if not errors:
        return floor
    from neuralgaits.robots.mjcf.loader import load_robot  # Brings JAX.
    from neuralgaits.robots.mjcf.parameters import ParameterAxis, box_of

    axes = tuple(ParameterAxis(one.name, one.high) for one in errors)
    return box_of(load_robot(run / ROBOT), axes) | floor


def _proof_of(run: Path) -> ProofOfRun | None:
    """Return a proof about the run's own files; None if there is no file.

    Raises: Unfit if it contradicts itself, is about another run, or states more than a few
        evaluations of its Program give.
    """
    if not packed.is_there(run / PROOF):
        return None
    try:
        claims = read_claims(run / PROOF)
        wrong = differences(claims, run)
    except InputError as error:
        raise Unfit(f"{PROOF} is damaged or of another version: {error}") from None
    full = claims.theorems.full is not None
    rigid = claims.model is not None and "residuals" not in claims.model
    if (run / RESIDUAL).is_file() and (full or rigid):
        wrong.append("it is about the rigid model, and the run's dynamics carry a residual")
    if not wrong:
        wrong = inconsistencies(claims, claims.outline)
    if wrong:
        raise Unfit(f"{PROOF} is not about this run: {wrong[0]}")
    try:
        comparison = compare_with_run(claims, run, own_process=False)
    except TimeLimitError:
        raise
    except InputError as error:
        raise Unfit(f"{PROOF} could not be compared with the run: {error}") from None
    if wrong := [*comparison.wrong, *inconsistencies(claims, comparison.outline)]:
        raise Unfit(f"{PROOF} is not about this run: {wrong[0]}")
    if broken := first_broken_bound(claims):
        raise Unfit(f"{PROOF} states what is not so: {broken}")
    return ProofOfRun(claims, comparison)


def _levels(summary: CertificateRecord, proof: ProofOfRun | None) -> Iterator[Conclusion]:
    """Return levels above 1; each proved level is claimed by the proof file and follows from it."""
    concluded = [] if proof is None else _conclusions(proof)
    by_level = {one.level: one for one in concluded}
    below = True
    for entry in summary.levels:
        # Level 4 rests on no other; level 3 on level 2.
        if entry.level == ORBIT_LEVEL and not below and entry.proved:
            raise Unfit(f"{SUMMARY} calls level 3 proved, and level 2 not")
        below = below and entry.proved
        if not entry.proved:
            # Nothing bears out why a search has ended: a page must not say it as its own.
            reason = None if entry.reason is None else f"{UNCHECKED} “{entry.reason}”"
            yield replace(entry, words=(), figures={}, reason=reason)
        elif entry.level in by_level:
            yield by_level[entry.level]
        else:
            raise Unfit(f"{SUMMARY} calls level {entry.level} proved, and no proof file claims it")


def _verdict(summary: CertificateRecord) -> Verdict:
    """Return the overall verdict: proved if every condition and every requested level is."""
    whole = [entry.level for entry in summary.levels] == list(range(2, summary.level + 1))
    verdict = summary.verdict_of_all
    return "undecided" if verdict == "proved" and not whole else verdict


def _conclusions(proof: ProofOfRun) -> list[Conclusion]:
    """Return the conclusions that a file claims and that follow from its statements."""
    claims, boxes = proof.claims, proof.comparison.outline.boxes()
    theorems, bounds = claims.theorems, proved_bounds(claims.statements)
    try:
        conclusions = conclude(theorems.parameters, boxes, bounds, claims.chart)
    except (OverflowError, ZeroDivisionError):
        return []
    return [one for one in conclusions if one.level in theorems.claimed and one.proved]
