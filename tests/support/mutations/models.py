"""Proofs whose model is another one: a robot, a tube, a stricter condition.

A checker of the model must find them false. One of the Program does not read the model. The
evidence is the Program of the spec traced for the other robot or gait.
"""

import re
from collections.abc import Callable

import equinox as eqx
import numpy as np

from neuralgaits.certificate.proof_file.model_data import model_data
from neuralgaits.certificate.traced import trace_spec
from neuralgaits.robots.mjcf.loader import robot_from_text
from support.mutations.base import MODEL, Base, Mutation, altered, corners, grid, least, violated

Draw = np.random.Generator
_NUMBERS = {
    "mass": r'(mass=")([0-9.]+)(")',
    "centre of mass": r'(<inertial pos="0 0 )(-?[0-9.]+)(")',
    "rotor inertia": r'(armature=")([0-9.]+)(")',
    "thigh": r"(-)(0\.4064)(\")",
    "shin": r"(-)(0\.4667)(\")",
    "gravity": r'(gravity="0 0 -)([0-9.]+)(")',
}
"""Numbers of the robot file. Both legs have the same ones, so each value is changed everywhere."""


def robot(base: Base, draw: Draw) -> Mutation | None:
    """Another mass, length, inertia or gravity, by 5 % to a half."""
    text = base.run.robot.layout.xml
    what = str(draw.choice(sorted(_NUMBERS)))
    values = sorted({match[1] for match in re.findall(_NUMBERS[what], text) if float(match[1])})
    value = str(draw.choice(values))
    factor = float(draw.choice([-1.0, 1.0]) * draw.uniform(0.05, 0.5) + 1.0)

    def change(match: re.Match[str]) -> str:
        old = match[2]
        new = f"{float(old) * factor:.6g}" if old == value else old
        return match[1] + new + match[3]

    other = robot_from_text(re.sub(_NUMBERS[what], change, text), base.run.robot.name)
    run = base.run
    table = base.copy()
    program = trace_spec(run.spec, other, run.gait)
    found = next(violated(program, table), None)
    data = model_data(other, run.gait, run.spec, base.program)
    if found is None or data is None:
        return None
    table["statements"] = [found[0]]
    table["model"]["robot"] = data["robot"]
    return altered(f"{what} {value} times {factor:.3g}: {found[1]}", "false", MODEL, table)


def tube(base: Base, draw: Draw) -> Mutation | None:
    """Fences in another unit: a faster or slower tube."""
    run, table = base.run, base.copy()
    factor = float(draw.choice([draw.uniform(0.3, 0.8), draw.uniform(1.3, 2.5)]))
    unit = np.asarray(run.gait.tube.unit) * factor
    gait = eqx.tree_at(lambda g: g.tube.unit, run.gait, unit)
    found = next(violated(trace_spec(run.spec, run.robot, gait), table), None)
    if found is None:
        return None
    table["statements"] = [found[0]]
    table["model"]["tube"]["unit"] = {"shape": [], "values": [float(unit).hex()]}
    return altered(f"fences times {factor:.3g}: {found[1]}", "false", MODEL, table)


def condition(base: Base, draw: Draw) -> Mutation | None:
    """A stricter condition than the one proved: its bound moved past what was seen."""
    table = base.copy()
    strict = []
    for statement in table["statements"]:
        for name in statement["conditions"]:
            entry = table["model"]["conditions"][name]
            function = entry.get("quantity", {}).get("function")
            if entry["kind"] == "Pointwise" and function in ("at_least", "at_most"):
                strict.append((statement, name, entry, function))
    if not strict:
        return None
    statement, name, entry, function = strict[int(draw.integers(len(strict)))]
    seen, _ = least(base.program, [name], grid(*corners(statement)))[name]
    # What was claimed is then missed at the point of the smallest margin.
    scale = statement["scales"][name]
    more = seen - statement["bounds"][name] * scale + float(draw.uniform(0.01, 0.5)) * scale
    entry["quantity"]["bound"] += more if function == "at_least" else -more
    table["statements"] = [statement]
    return altered(f"{name} stricter by {more:.3g}", "false", MODEL, table)


FALSE_MODELS: tuple[Callable[[Base, Draw], Mutation | None], ...] = (robot, tube, condition)
