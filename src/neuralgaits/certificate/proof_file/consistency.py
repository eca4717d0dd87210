"""Contradictions inside a proof file, independent of the bounds on its boxes.

The check of a file and the reader of a run's certificate use this list and no other, and so do
page, figures and export. Needs no JAX.
"""

from neuralgaits.certificate.levels.levels import refusals
from neuralgaits.certificate.proof_file.command_ranges import OTHER_CHART, is_beyond
from neuralgaits.certificate.proof_file.coverage import SpecOutline, contradictions
from neuralgaits.certificate.proof_file.reader import Claims
from neuralgaits.certificate.proof_file.theorem_tables import LEVELS_BY_NUMBER
from neuralgaits.certificate.proof_file.tree_text import why_no_tree


def inconsistencies(claims: Claims, outline: SpecOutline | None) -> list[str]:
    """List the contradictions in a proof file, one sentence each.

    Args:
        claims: result of `read_claims`.
        outline: conditions and regions of the spec; None if they are not known.

    Returns: an empty list if spec and theorems require every statement, every level
        that is claimed can be about the file's chart, and the parameters of theorems that margins
        have in them are the Program's constants of their names, all of them.
    """
    if claims.program.hash != claims.program_hash:
        return [f"the Program's hash is {claims.program.hash}, not {claims.program_hash}"]
    wrong = contradictions(claims.statements, claims.theorems, outline, len(claims.chart.state))
    if is_beyond(claims.chart, claims.commands):
        wrong.append(OTHER_CHART)
    wrong += filter(None, map(why_no_tree, claims.statements))
    wrong += _levels_without_subject(claims)
    wrong += _parameters_that_differ(claims)
    return wrong


def _levels_without_subject(claims: Claims) -> list[str]:
    """Name levels in the file that do not cover its chart, its robot's feet, or its commands."""
    reasons = refusals(claims.theorems.parameters, claims.chart)
    robot = {} if claims.model is None else claims.model.get("robot", {})
    if isinstance(robot, dict) and "sole" in robot:
        if claims.theorems.full is not None:
            reasons[4] = "it is about point feet"
        if claims.theorems.walking is not None and claims.theorems.walking.floor:
            reasons[2] = "floors of unknown height are about point feet"
    command_names = tuple(one.name for one in claims.commands)
    walking = claims.theorems.walking
    # A reset lands in the set of the next step, which other commands would call that of the same.
    if claims.model is not None and walking is not None and tuple(walking.told) != command_names:
        reasons[2] = "it is about other commands than those of the model's gait"
    return [f"level {number} is stated, and {reason}" for number, reason in reasons.items()]


def _parameters_that_differ(claims: Claims) -> list[str]:
    """Name parameters of theorems that differ from the Program's constants of their names.

    A constant of a theorem that the file does not have is one, too: what the Program computes with
    it is about another set, law or clock than the theorem.
    """
    constants = {constant.name: constant.array for constant in claims.program.constants}
    wrong, known = [], set[str]()
    for number, parameters in claims.theorems.parameters.items():
        level = LEVELS_BY_NUMBER[number]
        for name, values in level.constants(parameters).items():
            known.add(f"{level.part}.{name}")
            if name == "disturbance" and not any(values):
                continue  # The Program has nothing to add.
            array = constants.get(f"{level.part}.{name}")
            if array is None or array.tolist() != list(values):
                wrong.append(f"{name} of level {number} is not the Program's {level.part}.{name}")
    parts = tuple(f"{level.part}." for level in LEVELS_BY_NUMBER.values())
    stray = (name for name in constants if name is not None and name.startswith(parts))
    return wrong + [
        f"the Program's {name} is a parameter of no theorem" for name in sorted(set(stray) - known)
    ]
