"""Write `modelDescription.xml` of the controller's FMU, for FMI 2.0 and 3.0."""

import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence

from neuralgaits.export import controller_prose
from neuralgaits.export.design import Design
from neuralgaits.export.fmu.fmu_variables import FmuVariable, Role, VariableType, references
from neuralgaits.export.source import commented

_BASES: Mapping[str, Mapping[str, int]] = {
    "1": {},
    "rad": {"rad": 1},
    "rad/s": {"rad": 1, "s": -1},
    "m": {"m": 1},
    "m/s": {"m": 1, "s": -1},
    "s": {"s": 1},
    "N": {"kg": 1, "m": 1, "s": -2},
    "N.m": {"kg": 1, "m": 2, "s": -2},
    "N.m/rad": {"kg": 1, "m": 2, "s": -2, "rad": -1},
    "N.m.s/rad": {"kg": 1, "m": 2, "s": -1, "rad": -1},
    "kg.m2/s": {"kg": 1, "m": 2, "s": -1},
}
"""Units of variables, and the powers of the SI's units that they are."""


def model_description(
    design: Design,
    variables: Sequence[FmuVariable],
    version: str,
    model: str,
    token: str,
    sources: Sequence[str],
) -> str:
    """Return the text of `modelDescription.xml`.

    Args:
        design: design of the controller.
        variables: its variables, in the order of their value references.
        version: `2.0` or `3.0`.
        model: name of the binary.
        token: token that an importer gives back.
        sources: C files to compile; only FMI 2.0 lists them here.
    """
    three = version == "3.0"
    period = _text(design.controller.period_s)
    root = ET.Element(
        "fmiModelDescription",
        {
            "fmiVersion": version,
            "modelName": f"{_printable_text(design.controller.robot.name)}, controller",
            ("instantiationToken" if three else "guid"): token,
            "description": _description(design),
            "generationTool": f"neuralgaits {design.origin.version}",
            "variableNamingConvention": "structured",
        },
    )
    ability = {"modelIdentifier": model, "canHandleVariableCommunicationStepSize": "false"}
    if three:
        ability |= {"fixedInternalStepSize": period, "canGetAndSetFMUState": "true"}
    else:
        ability |= {
            "canBeInstantiatedOnlyOncePerProcess": "false",
            "canGetAndSetFMUstate": "true",
        }
    simulation = ET.SubElement(root, "CoSimulation", ability)
    if not three:
        files = ET.SubElement(simulation, "SourceFiles")
        for name in sources:
            ET.SubElement(files, "File", {"name": name})
    _units(root, variables)
    _log_categories(root)
    ET.SubElement(root, "DefaultExperiment", {"startTime": "0.0", "stepSize": period})
    if three:
        _variables3(root, variables)
        _structure3(root, variables)
        _annotation(ET.SubElement(root, "Annotations"), "Annotation", "type", design)
    else:
        _annotation(ET.SubElement(root, "VendorAnnotations"), "Tool", "name", design)
        _variables2(root, variables)
        _structure2(root, variables)
    return _document(root)


def _log_categories(root: ET.Element) -> None:
    """Add the kinds of messages that the FMU logs."""
    categories = ET.SubElement(root, "LogCategories")
    described = {
        "logStatusError": "calls that are refused, always logged",
        "logEvents": "faults of the controller",
    }
    for name, text in described.items():
        ET.SubElement(categories, "Category", {"name": name, "description": text})


def build_description(model: str, sources: Sequence[str]) -> str:
    """Return the text of `sources/buildDescription.xml`, which FMI 3.0 asks for."""
    root = ET.Element("fmiBuildDescription", {"fmiVersion": "3.0"})
    configuration = ET.SubElement(root, "BuildConfiguration", {"modelIdentifier": model})
    files = ET.SubElement(configuration, "SourceFileSet", {"language": "C99"})
    for name in sources:
        ET.SubElement(files, "SourceFile", {"name": name})
    return _document(root)


def _document(root: ET.Element) -> str:
    ET.indent(root)
    text = ET.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'


def _printable_text(text: str) -> str:
    """Return a text without signs that XML cannot hold."""
    return "".join(sign if sign.isprintable() else "?" for sign in text)


def _text(value: float | int | bool) -> str:
    """Return a start value as XML has it; numbers read back exactly."""
    return str(value).lower() if isinstance(value, bool) else repr(value)


def _hashes(design: Design) -> dict[str, str]:
    origin = design.origin
    digests = {"robot": origin.robot_sha256, "policy": origin.policy_sha256}
    return digests if origin.proof_sha256 is None else digests | {"proof": origin.proof_sha256}


def _description(design: Design) -> str:
    origin = design.origin
    hashes = ", ".join(f"{name} sha256 {value}" for name, value in _hashes(design).items())
    proof = "none" if origin.proof_verdict is None else f"stated {origin.proof_verdict}"
    name = design.controller.robot.name
    return _printable_text(
        f"Controller of a walking gait of {name}, spec {origin.spec}; {hashes}; "
        f"proof of gait and model, not of this code: {proof}"
    )


def _annotation(parent: ET.Element, tag: str, key: str, design: Design) -> None:
    """Add what `gait.h` says of the controller: hashes, joint order, limits, laws."""
    tool = ET.SubElement(parent, tag, {key: "neuralgaits"})
    entry = ET.SubElement(tool, "controller")
    for name, value in _hashes(design).items():
        ET.SubElement(entry, "hash", {"of": name, "sha256": value})
    facts = ET.SubElement(entry, "facts")
    facts.text = "\n".join(
        ["", *(_printable_text(commented(one)) for one in controller_prose.prose(design)), ""]
    )


def _units(root: ET.Element, variables: Sequence[FmuVariable]) -> None:
    used = {one.unit for one in variables} | {"s"}
    definitions = ET.SubElement(root, "UnitDefinitions")
    for name, powers in _BASES.items():
        if name in used:
            unit = ET.SubElement(definitions, "Unit", {"name": name})
            ET.SubElement(unit, "BaseUnit", {base: str(power) for base, power in powers.items()})


def _type_attributes(one: FmuVariable) -> dict[str, str]:
    """Return the attributes that follow from type and range."""
    attributes = {} if one.unit is None else {"unit": one.unit}
    attributes |= {} if one.low is None else {"min": _text(one.low)}
    attributes |= {} if one.high is None else {"max": _text(one.high)}
    # The values before the first tick are computed: the importer does not give them.
    return attributes if one.role is Role.OUTPUT else attributes | {"start": _text(one.start)}


def _part(one: FmuVariable) -> dict[str, str]:
    """Return the attributes that follow from the part of a variable."""
    _, causality, variability = one.role.value
    if one.role is Role.INPUT and one.type is not VariableType.REAL:
        variability = "discrete"
    exact = "calculated" if one.role is Role.OUTPUT else "exact"
    attributes = {"causality": causality, "variability": variability}
    return attributes if one.role is Role.INPUT else attributes | {"initial": exact}


def _variables3(root: ET.Element, variables: Sequence[FmuVariable]) -> None:
    parent = ET.SubElement(root, "ModelVariables")
    time = {"name": "time", "valueReference": "0", "description": "simulation time"}
    time |= {"causality": "independent", "variability": "continuous", "unit": "s"}
    ET.SubElement(parent, "Float64", time)
    places = references(variables)
    for one in variables:
        about = {"name": one.name, "valueReference": str(places[one.name])}
        about |= {"description": _printable_text(one.description)}
        ET.SubElement(parent, one.type.value[0], about | _part(one) | _type_attributes(one))


def _structure3(root: ET.Element, variables: Sequence[FmuVariable]) -> None:
    parent = ET.SubElement(root, "ModelStructure")
    places = references(variables)
    outputs = [str(places[one.name]) for one in variables if one.role is Role.OUTPUT]
    for tag in ("Output", "InitialUnknown"):
        for place in outputs:
            ET.SubElement(parent, tag, {"valueReference": place})


def _variables2(root: ET.Element, variables: Sequence[FmuVariable]) -> None:
    parent = ET.SubElement(root, "ModelVariables")
    places = references(variables)
    for one in variables:
        about = {"name": one.name, "valueReference": str(places[one.name])}
        about |= {"description": _printable_text(one.description)}
        scalar = ET.SubElement(parent, "ScalarVariable", about | _part(one))
        ET.SubElement(scalar, one.type.value[1], _type_attributes(one))


def _structure2(root: ET.Element, variables: Sequence[FmuVariable]) -> None:
    parent = ET.SubElement(root, "ModelStructure")
    outputs = [k for k, one in enumerate(variables, start=1) if one.role is Role.OUTPUT]
    for tag in ("Outputs", "InitialUnknowns"):
        group = ET.SubElement(parent, tag)
        for place in outputs:
            ET.SubElement(group, "Unknown", {"index": str(place)})
