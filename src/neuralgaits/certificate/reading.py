"""A run's certificate as its proof files bear it out: what pages and figures may call proved.

`certificate/summary.json` is what `certify` said, and a file like any other: it may be another
run's, or older than the weights beside it. So nothing in it counts but what the proof files of
the run state as well: their statements have to be about the run's own files and cover its spec, and
the levels are concluded again from them. The boxes are not bounded again here: `check-proof` does.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

from neuralgaits._digits import from_hex
from neuralgaits.certificate.ground import FORCES, IMPULSES, friction_needed, named
from neuralgaits.certificate.levels.chart import PLAIN, Chart
from neuralgaits.certificate.levels.ladder import conclude
from neuralgaits.certificate.levels.premises import proved_bounds
from neuralgaits.certificate.proof_file.coverage import Asked, contradictions, stated_roots
from neuralgaits.certificate.proof_file.reader import Claims, read_claims
from neuralgaits.certificate.proof_file.run_match import ROBOT, SPEC, WEIGHTS, differences
from neuralgaits.errors import InputError, NeuralGaitsError
from neuralgaits.records.asked import asked_of
from neuralgaits.records.certified import (
    PROOF,
    SUMMARY,
    Certified,
    Conclusion,
    ConditionVerdict,
    Verdict,
)
from neuralgaits.records.record import build, shape_of
from neuralgaits.runs import RunFolder, from_json, packed
from neuralgaits.runs.folder import file_hashes
from neuralgaits.runs.names import MAP, RESIDUAL
from neuralgaits.runs.shape import complaint

FILES = (ROBOT, SPEC, WEIGHTS, RESIDUAL, PROOF)
"""What a certificate is about, and what it rests on."""
WALKING, ABOUT_A_BOX = 2, 3
"""Levels: of walking sets; the highest that is about robots of a box."""
DAMAGED = f"{SUMMARY} is damaged or of another version"


class ProvedPart(NamedTuple):
    """What is proved of some of the commands that a gait is told, and of no others.

    Attributes:
        told: these commands, a phrase each.
        conditions: those that are proved on all of their region.
        levels: above 1, those that follow.
    """

    told: tuple[str, ...]
    conditions: tuple[str, ...]
    levels: tuple[Conclusion, ...]


class CertificateReading(NamedTuple):
    """What is known to be claimed of a run, or why that is nothing.

    Attributes:
        summary: of `certify`, with margins and levels as the proof files have them; None if there
            is no certificate of the run's own.
        reason: why there is none; None if there is, or if `certify` was never called.
        proof: the proof file.
        map_fits: whether the map of boxes is the one that was made with them.
        part: where the proof is about some commands only; nothing of `summary` is proved then.
    """

    summary: Certified | None = None
    reason: str | None = None
    proof: Claims | None = None
    map_fits: bool = False
    part: ProvedPart | None = None


class _Unfit(Exception):
    """The certificate is not borne out; the message says by what."""


def hashes(run: Path) -> dict[str, str | None]:
    """The sha256 of what a certificate is about, by file; None where there is no such file."""
    return file_hashes(run, (*FILES, MAP))


def read_certificate(folder: RunFolder) -> CertificateReading:
    """Read a run's certificate and compare it with its proof files and with the run."""
    path = folder.path / SUMMARY
    if not path.is_file():
        return CertificateReading()
    try:
        summary = from_json(path.read_bytes())
        if wrong := complaint(summary, shape_of(Certified)):
            return CertificateReading(reason=f"{DAMAGED}, {wrong}")
        return _read(folder, build(Certified, summary))
    except _Unfit as error:
        return CertificateReading(reason=str(error))
    except (OSError, ValueError, AttributeError, KeyError, TypeError):
        return CertificateReading(reason=DAMAGED)


def _read(folder: RunFolder, summary: Certified) -> CertificateReading:
    """Raises: _Unfit; or what Python raises where something is not as `certify` writes it."""
    run = folder.path
    found = hashes(run)
    if more := [n for n in summary.sha256 if n not in found and summary.sha256[n] is not None]:
        raise _Unfit(f"{SUMMARY} is about another file too, {more[0]}, as in earlier versions")
    for name in FILES:
        digest = found[name]
        if summary.sha256.get(name) != digest:
            raise _Unfit(
                f"{SUMMARY} is about another {name} than the run's"
                if digest is not None
                else f"{name} is missing"
            )
    config = asked_of(folder)
    asked = Asked.read(config.regions, {one.name: one.data for one in config.conditions})
    commands = config.described.get("commands", ())
    chart = _chart(commands)
    proof = _claims(run, asked, chart, config.described)
    if set(summary.conditions) != set(asked.conditions):
        raise _Unfit(f"{SUMMARY} is about other conditions than the run's")
    stated = {kind: half for kind, half in summary.parameters.items() if kind != "friction"}
    if proof is not None and _box(run, proof, chart) != stated:
        raise _Unfit(f"{SUMMARY} is about another box of robots than {PROOF}")
    _refuse_ground(summary, proof, config.described)
    # Nothing is said of a floor where the level that speaks of it is not claimed.
    if proof is None or WALKING not in proof.theorems.claimed:
        without = {kind: half for kind, half in summary.parameters.items() if kind != "floor"}
        summary = replace(summary, parameters=without)
    summary = replace(
        summary,
        conditions=dict(_conditions(summary, asked, proof)),
        levels=tuple(_levels(summary, asked, proof)),
    )
    summary = replace(summary, verdict=_verdict(summary))
    map_fits = found[MAP] is not None and summary.sha256.get(MAP) == found[MAP]
    names = [row["name"] for row in commands]
    part = None if proof is None or not names else _part(summary, asked, proof, chart, names)
    return CertificateReading(summary, None, proof, map_fits, part)


def _refuse_ground(summary: Certified, proof: Claims | None, described: Mapping[str, Any]) -> None:
    """Raises: _Unfit if a box of robots or floors is stated of what says nothing of it."""
    claimed = () if proof is None else proof.theorems.claimed
    if summary.parameters and max(claimed, default=0) > ABOUT_A_BOX:
        raise _Unfit(f"{SUMMARY} states a box of robots of level {max(claimed)}, which is of one")
    least = summary.parameters.get("friction")
    if least is None:
        return
    if not friction_needed(described) <= least:
        raise _Unfit(f"{SUMMARY} is about less friction than its conditions ask for")
    if proof is not None and proof.model is None:
        raise _Unfit(f"{SUMMARY} is about friction, and {PROOF} does not say with which cones")
    walking = None if proof is None else proof.theorems.walking
    if walking is not None and WALKING in claimed:
        cones = (*FORCES, *(IMPULSES if walking.floor else ()))
        dropped = set(named(described, cones)) - set(walking.carried)
        if dropped:
            raise _Unfit(f"{SUMMARY} is about friction, and {PROOF} drops {min(dropped)}")


def _other_spec(model: Mapping[str, Any] | None, described: Mapping[str, Any]) -> str | None:
    """What differs between the spec of a proof's model and that of the run's config; None."""
    if model is None:
        return None
    own = described["conditions"]
    rows = {row["name"]: {k: v for k, v in row.items() if k != "name"} for row in own}
    if rows != model["conditions"]:
        return "its conditions have other numbers than those of config.json"
    told = [
        {k: from_hex(v, k) if k != "name" and v is not None else v for k, v in row.items()}
        for row in model["policy"].get("commands", ())
    ]
    if told != [dict(row) for row in described.get("commands", ())]:
        return "it is about other commands than those of config.json"
    return None


def _part(
    summary: Certified, asked: Asked, proof: Claims, chart: Chart, names: Sequence[str]
) -> ProvedPart | None:
    """What a proof says of some of the commands; None if it is about all of them.

    Raises: _Unfit if the summary calls anything proved of all of them.
    """
    if proof.chart.of_commands(len(names)) == chart:
        return None
    called = [name for name, row in summary.conditions.items() if row.verdict == "proved"]
    called += [f"level {entry.level}" for entry in summary.levels if entry.proved]
    if called:
        raise _Unfit(f"{SUMMARY} calls {called[0]} proved, and {PROOF} is about some commands only")
    bounds = {root for root, _ in stated_roots(proof.statements)}
    stated = {name: True for name in asked.conditions}
    for box in asked.boxes():
        stated[box[0]] = stated[box[0]] and box in bounds
    conditions = tuple(name for name, every in stated.items() if every)
    levels = tuple(_concluded(proof, asked)) if len(conditions) == len(stated) else ()
    return ProvedPart(proof.chart.sequences(names) or (), conditions, levels)


def _chart(commands: Sequence[Mapping[str, Any]]) -> Chart:
    """Of all that a gait is told, as a spec describes it."""
    if not commands:
        return PLAIN
    from neuralgaits.gait.commands import Command  # Brings JAX.

    return Chart.of(Command(**row) for row in commands)


def _box(run: Path, proof: Claims, chart: Chart) -> dict[str, float]:
    """The box of robots that a proof is about, by the names and widths of its axes.

    Raises: _Unfit where they are no box of robots like the run's.
    """
    errors = proof.chart.parameters[len(chart.parameters) :]
    walking = proof.theorems.walking
    floor = {} if walking is None or not walking.floor else {"floor": walking.floor}
    if not errors:
        return floor
    from neuralgaits.robots import load_robot  # Brings JAX.
    from neuralgaits.robots.parameters import Axis, box_of

    try:
        axes = tuple(Axis(one.name, one.high) for one in errors)
        return box_of(load_robot(run / ROBOT), axes) | floor
    except (ValueError, NeuralGaitsError) as error:
        raise _Unfit(f"{PROOF} is about no box of robots like the run's: {error}") from None


def _claims(run: Path, asked: Asked, chart: Chart, described: Mapping[str, Any]) -> Claims | None:
    """A proof file about the run's own files, whose statements are those of its spec."""
    if not packed.is_there(run / PROOF):
        return None
    try:
        claims = read_claims(run / PROOF)
        wrong = differences(claims, run)
    except InputError as error:
        raise _Unfit(f"{PROOF} is damaged or of another version: {error}") from None
    if claims.program.hash != claims.program_hash:
        wrong.append("its Program has another hash than it says")
    full = claims.theorems.full is not None
    rigid = claims.model is not None and "residuals" not in claims.model
    if (run / RESIDUAL).is_file() and (full or rigid):
        wrong.append("it is about the rigid model, and the run's dynamics carry a residual")
    if other := _other_spec(claims.model, described):
        wrong.append(other)
    wrong += contradictions(claims.statements, claims.theorems, asked)
    told = len(chart.parameters)
    errors = claims.chart.parameters[told:]
    if not chart.holds(Chart(claims.chart.parameters[:told])):
        wrong.append("it is about other commands")
    if any(axis.low != -axis.high or axis.change is not None for axis in errors):
        wrong.append("it is about robots of a box that the run's own is not the middle of")
    if wrong:
        raise _Unfit(f"{PROOF} is not about this run: {wrong[0]}")
    return claims


def _conditions(
    summary: Certified, asked: Asked, proof: Claims | None
) -> Iterator[tuple[str, ConditionVerdict]]:
    """Verdicts on conditions; one that is proved has a statement on each box of its region."""
    bounds = {
        root: s.bounds[root[0]] for root, s in stated_roots(proof.statements if proof else ())
    }
    boxes = asked.boxes()
    for name, row in summary.conditions.items():
        if row.verdict != "proved":
            yield name, replace(row, margin=None)
            continue
        own = [box for box in boxes if box[0] == name]
        if not all(box in bounds for box in own):
            raise _Unfit(f"{SUMMARY} calls {name} proved, and {PROOF} has no such statement")
        yield name, replace(row, margin=min(bounds[box] for box in own))


def _levels(summary: Certified, asked: Asked, proof: Claims | None) -> Iterator[Conclusion]:
    """Levels above 1; one that is proved is claimed by the proof file and follows from it."""
    concluded = [] if proof is None else _concluded(proof, asked)
    found = {one.level: one for one in concluded}
    below = True
    for entry in summary.levels:
        # Level 4 rests on no other; level 3 on level 2.
        if entry.level == 3 and not below and entry.proved:
            raise _Unfit(f"{SUMMARY} calls level 3 proved, and level 2 not")
        below = below and entry.proved
        if not entry.proved:
            yield replace(entry, words=(), figures={})
        elif entry.level in found:
            yield found[entry.level]
        else:
            raise _Unfit(f"{SUMMARY} calls level {entry.level} proved, and no proof file claims it")


def _verdict(summary: Certified) -> Verdict:
    """Of the whole, as `certify` gives it: proved if every condition and every level asked is."""
    whole = [entry.level for entry in summary.levels] == list(range(2, summary.level + 1))
    return "undecided" if summary.of_all == "proved" and not whole else summary.of_all


def _concluded(claims: Claims, asked: Asked) -> list[Conclusion]:
    """What follows from the statements of a file, as far as the file claims it."""
    theorems, bounds = claims.theorems, proved_bounds(claims.statements)
    try:
        found = conclude(theorems.parameters, asked.boxes(), bounds, claims.chart)
    except (OverflowError, ZeroDivisionError):
        return []
    return [one for one in found if one.level in theorems.claimed and one.proved]
