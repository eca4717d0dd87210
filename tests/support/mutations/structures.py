"""Files that contradict themselves: hashes, Program, trees; against the model, against the run."""

import numpy as np

from support.mutations.base import BOTH, MODEL, RUN, Base, Mutation, Table, altered, with_program
from support.mutations.numbers import changed_constant, encoded

Draw = np.random.Generator


def other_hash(base: Base, draw: Draw) -> Mutation:
    """A digit of the Program's hash."""
    table = base.copy()
    digits, place = list(table["program_hash"]), int(draw.integers(64))
    digits[place] = "0123456789abcdef"[(int(digits[place], 16) + int(draw.integers(1, 16))) % 16]
    table["program_hash"] = "".join(digits)
    return altered(f"digit {place} of the hash", "inconsistent", BOTH, table)


def other_bit(base: Base, draw: Draw) -> Mutation:
    """The last bit of one number of the Program, under the old hash."""
    table = base.copy()
    rows = table["program"]["constants"]
    number = int(draw.integers(len(rows)))
    array = base.program.constants[number].array.copy()
    place = np.unravel_index(int(draw.integers(array.size)), array.shape)
    array[place] = np.nextafter(array[place], np.inf)
    rows[number][2] = encoded(array)
    what = rows[number][0] or f"constant {number}"
    return altered(f"{what} by a last place", "inconsistent", BOTH, table)


def other_operation(base: Base, draw: Draw) -> Mutation:
    """Another operation or operand, under the old hash."""
    table = base.copy()
    rows = table["program"]["operations"]
    kinds = {"add": "sub", "sub": "add", "sin": "cos", "cos": "sin", "neg": "square", "mul": "div"}
    place = int(draw.choice([k for k, row in enumerate(rows) if row[0] in kinds]))
    rows[place][0] = kinds[rows[place][0]]
    return altered(f"operation {place} is {rows[place][0]}", "inconsistent", BOTH, table)


def other_output(base: Base, draw: Draw) -> Mutation:
    """Two outputs exchanged, under the old hash."""
    table = base.copy()
    rows = [row for row in table["program"]["outputs"] if row[1] == []]
    one = int(draw.integers(len(rows)))
    # Two conditions may be one and the same operation: exchanging those changes nothing.
    two = int(draw.choice([k for k, row in enumerate(rows) if row[2] != rows[one][2]]))
    rows[one][2], rows[two][2] = rows[two][2], rows[one][2]
    return altered(f"outputs {rows[one][0]}, {rows[two][0]}", "inconsistent", BOTH, table)


def tree(base: Base, draw: Draw) -> Mutation:
    """A tree that is none: a bit turned, cut off, added or put in."""
    table = base.copy()
    statement = table["statements"][int(draw.integers(len(table["statements"])))]
    bits = statement["tree"]
    place = int(draw.integers(len(bits)))
    turned = bits[:place] + ("0" if bits[place] == "-" else "-") + bits[place + 1 :]
    changes = {
        f"bit {place} turned": turned,
        f"cut at {place}": bits[:place] or "0",
        "one leaf more": bits + "-",
        f"bit {place} twice": bits[:place] + bits[place:][:1] + bits[place:],
        "a split without end": "0" * 200 + "-" * 201,
    }
    name = str(draw.choice(sorted(changes)))
    statement["tree"] = changes[name]
    what = statement["conditions"][0]
    return altered(f"tree of {what}: {name}", "inconsistent", BOTH, table)


def model_reference(base: Base, draw: Draw) -> Mutation:
    """The model names a constant that the Program does not have."""
    table = base.copy()
    arrays = table["model"]["policy"]["arrays"]
    names = sorted(name for name, entry in arrays.items() if "constant" in entry)
    name = str(draw.choice(names))
    arrays[name] = {"constant": arrays[name]["constant"] + "s"}
    return altered(f"model refers to {arrays[name]}", "inconsistent", MODEL, table)


def model_without(base: Base, draw: Draw) -> Mutation:
    """A condition that is claimed stands nowhere in the model."""
    table = base.copy()
    statement = table["statements"][int(draw.integers(len(table["statements"])))]
    name = str(draw.choice(statement["conditions"]))
    del table["model"]["conditions"][name]
    return altered(f"no {name} in the model", "inconsistent", MODEL, table)


def model_frame(base: Base, draw: Draw) -> Mutation:
    """A statement with another scale, region or root than the model's condition."""
    table = base.copy()
    name, change = _other_frame(table, draw)
    return altered(f"{name}: {change}, unlike the model", "inconsistent", MODEL, table)


def run_frame(base: Base, draw: Draw) -> Mutation:
    """The same, unlike the run's spec."""
    table = base.copy()
    name, change = _other_frame(table, draw)
    return altered(f"{name}: {change}, unlike the run", "inconsistent", RUN, table)


def run_hash(base: Base, draw: Draw) -> Mutation:
    """The sha256 of another robot, spec or weights file."""
    table = base.copy()
    name = str(draw.choice(["robot", "spec", "weights"]))
    if name == "weights":
        table["weights_sha256"] = table["weights_sha256"][::-1]
    else:
        table[name]["sha256"] = table[name]["sha256"][::-1]
    return altered(f"sha256 of the {name}", "inconsistent", RUN, table)


def run_weights(base: Base, draw: Draw) -> Mutation:
    """Other weights than the run's, under their own hash."""
    name, program = changed_constant(base.program, draw, 1e-12)
    table = with_program(base.copy(), program)
    return altered(f"{name} unlike the run's", "inconsistent", RUN, table)


def run_model(base: Base, draw: Draw) -> Mutation:
    """Other link data for the checker that derives the dynamics: the Program stays the run's."""
    table = base.copy()
    link = table["model"]["robot"]["leg"][int(draw.integers(2))]
    name = str(draw.choice(["mass", "inertia", "length", "torque_limit"]))
    link[name] = (float.fromhex(link[name]) * 0.999).hex()
    return altered(f"{name} of a link unlike the run's", "inconsistent", RUN, table)


def _other_frame(table: Table, draw: Draw) -> tuple[str, str]:
    statement = table["statements"][int(draw.integers(len(table["statements"])))]
    name = str(draw.choice(statement["conditions"]))
    what = str(draw.choice(["scale", "region", "root"]))
    if what == "scale":
        # A smaller scale states less, of another condition.
        statement["scales"][name] *= float(draw.choice([0.5, 0.999]))
    elif what == "region":
        regions = sorted(set(table["model"]["regions"]) - {statement["region"]})
        statement["region"] = str(draw.choice(regions))
    else:
        axis = 0 if statement["root"]["low"][0] != statement["root"]["high"][0] else 1
        low, high = (float.fromhex(statement["root"][end][axis]) for end in ("low", "high"))
        statement["root"]["high"][axis] = (low + (high - low) * 0.75).hex()
    return name, f"another {what}"


INCONSISTENT = (
    other_hash,
    other_bit,
    other_operation,
    other_output,
    tree,
    model_reference,
    model_without,
    model_frame,
)
AGAINST_RUN = (run_frame, run_hash, run_weights, run_model)
