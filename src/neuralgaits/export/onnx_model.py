"""The policy and its rate as ONNX models, with the controller's facts in their metadata."""

import json

import numpy as np
from onnx import checker, helper

from neuralgaits.export import controller_facts, controller_prose
from neuralgaits.export.design import Design
from neuralgaits.export.programs import policy_in_one
from neuralgaits.export.robot_programs import Part
from neuralgaits.programs.onnx_graph import OPERATOR_SET, graph

REALS = {"double": np.float64, "float": np.float32}
FILES = {"double": "policy.onnx", "float": "policy_float.onnx"}
IR_VERSION = 8
"""Version of the file format; it came with operator set 17, and older runtimes read it, too."""


def model_files(design: Design) -> dict[str, bytes]:
    """Return a model for each precision, by file name.

    Raises: SpecError naming the primitive of a policy that has no form in ONNX.
    """
    part = policy_in_one(design.controller)
    return {FILES[precision]: _model(design, part, precision) for precision in REALS}


def metadata(design: Design) -> dict[str, str]:
    """Return the facts of the C header by name; numbers, arrays and lists are JSON.

    `units` describes each number and array.
    """
    origin, layout = design.origin, design.controller.robot.layout
    pairs = [*controller_facts.numbers(design), *controller_facts.arrays(design)]
    words = controller_facts.names(design) | {
        "about": "\n".join(controller_prose.prose(design)),
        "spec": origin.spec,
        "version": origin.version,
        "proof_verdict": origin.proof_verdict or "",
    }
    lists = {
        "coordinate_names": list(design.controller.robot.joint_names),
        "actuated_names": list(design.controller.robot.joint_names[1:]),
        "leg_joint_names": [list(names) for names in layout.leg_joints],
        "actuators": [list(names) for names in layout.actuators],
        "laws": {name: controller_prose.gains(c.law) for name, c in design.controllers.items()},
        "units": {fact.name: fact.unit for fact in pairs},
    }
    values = {fact.name: np.asarray(fact.value).tolist() for fact in pairs}
    return {name: str(word) for name, word in words.items()} | {
        name: json.dumps(value) for name, value in (lists | values).items()
    }


def _model(design: Design, part: Part, precision: str) -> bytes:
    actuated = ", ".join(design.controller.robot.joint_names[1:])
    about = {
        "z": "hip ahead of the stance foot [m], angular momentum about it [kg m^2/s]",
        "dz": "rates of z [m/s], [N m]",
        "y": f"desired angles [rad] of {actuated}",
        "commands": "of the step before, and of this one: "
        + ", ".join(f"{c.name} [{c.unit}]" for c in design.commands),
        "dy": f"their rates [rad/s]: {actuated}",
    }
    model = helper.make_model(
        graph(part.program, "policy", REALS[precision], about),
        opset_imports=[helper.make_opsetid("", OPERATOR_SET)],
        ir_version=IR_VERSION,
        producer_name="neuralgaits",
        producer_version=design.origin.version,
        doc_string=part.about,
    )
    helper.set_model_props(model, metadata(design))
    checker.check_model(model, full_check=True)
    return model.SerializeToString()
