"""A controller that is told commands: C against Python, wishes and touchdowns among the cases."""

import re

import numpy as np
import pytest

from neuralgaits.errors import MismatchError
from neuralgaits.export import build
from neuralgaits.export.compare import agree, float_bound, limits, model_questions, questions
from neuralgaits.export.programs import policy_in_one, policy_rate
from neuralgaits.export.reference import Reference
from neuralgaits.export.selftest import selftest_file
from neuralgaits.export.source import gait_files
from neuralgaits.gait.commands import Command
from neuralgaits.programs import evaluate
from neuralgaits.programs.point_algebra import POINT
from support.compiled import folder_with
from support.designs import FOOTHOLDS, LAWS, SPEED, commanded_design

pytestmark = pytest.mark.slow
STATES = 500


def files_of(design, reference):
    return gait_files(design) | {"gait_selftest.h": selftest_file(design, reference)}


LEAN = Command("lean", -0.02, 0.02, 0.0048)


def compiled(folder, files, flags=()):
    return build.build("gcc", folder_with(folder, files), "check", build.CHECKED, ("-O2", *flags))


@pytest.fixture(scope="module")
def told():
    """One command that may change so far, and one that may be any after any.

    Under the law that needs most of a policy: laws are compared in test_controller.py.
    """
    return commanded_design("amber3m", {"fblin": LAWS["fblin"]}, (SPEED, FOOTHOLDS[0]))


@pytest.fixture(scope="module")
def files(told):
    return files_of(told, Reference(told))


@pytest.fixture(scope="module")
def asked(told):
    return questions(told, Reference(told), STATES)


def test_c_does_what_python_does(told, files, asked, tmp_path):
    for precision, defines in build.PRECISIONS.items():
        agreement = agree(told, asked, compiled(tmp_path, files, defines), precision)
        allowed = limits(told, precision)
        assert max(agreement.output, agreement.rate) <= allowed.output
        assert 0.0 < agreement.torque <= allowed.torque


@pytest.mark.slow
def test_a_gait_that_is_told_a_lean_has_the_torques_of_the_robot_that_it_believes_in(tmp_path):
    """Where momentum, feed-forward or the step's start forget the lean, they are of the file's."""
    told = commanded_design("amber3m", {"fblin": LAWS["fblin"]}, (SPEED, LEAN))
    files = files_of(told, Reference(told))
    asked = questions(told, Reference(told), STATES)
    assert np.ptp(asked.ticks.after[:, 1]) > 0.01
    agreement = agree(told, asked, compiled(tmp_path, files), "double")
    allowed = limits(told, "double")
    assert max(agreement.output, agreement.rate) <= allowed.output
    assert 0.0 < agreement.torque <= allowed.torque
    own = (tmp_path / "controller.c").read_text()
    place = "command->lean = state->after[NG_LEAN_COMMAND - 1];"
    assert place in own
    (tmp_path / "controller.c").write_text(own.replace(place, ""))
    program = build.build("gcc", tmp_path, "check", build.CHECKED, ("-O0",))
    with pytest.raises(MismatchError, match=r"disagree|selftest"):
        agree(told, asked, program, "double")


PLANTED = {
    "a wish that is not clamped": (
        r"state->requested\[i\] = ng_clamp\(given, ng_command_low\[i\], ng_command_high\[i\]\)",
        "state->requested[i] = given",
    ),
    "a NaN that is taken": (r"if \(given == given\)", "if (1)"),
    "a change at once": (
        r"ng_clamp\(state->requested\[i\], last - change, last \+ change\)",
        "last + 0 * change",
    ),
    "a step that is not computed": (
        r"last \+ change\);\n    \}\n    ng_policy_step\([^;]*;",
        "last + change);\n    }",
    ),
    "before and after exchanged": (
        r"ng_policy_step\(state->after, state->before, state->step\);\n}\n#else",
        "ng_policy_step(state->before, state->after, state->step);\n}\n#else",
    ),
}


@pytest.mark.parametrize("name", PLANTED)
def test_a_planted_error_is_found(told, files, asked, tmp_path, name):
    folder = folder_with(tmp_path, files)
    pattern, text = PLANTED[name]
    before = (folder / "controller.c").read_text()
    after = re.sub(pattern, text, before, count=1)
    assert after != before
    (folder / "controller.c").write_text(after)
    program = build.build("gcc", folder, "check", build.CHECKED, ("-O0",))
    with pytest.raises(MismatchError, match=r"disagree|selftest"):
        agree(told, asked, program, "double")


def test_the_cases_meet_every_wish(told, asked):
    cases, ticks = asked.cases, asked.ticks
    low, high = (np.array([getattr(c, end) for c in told.commands]) for end in ("low", "high"))
    assert np.isnan(cases.given).any() and (cases.given < low).any() and (cases.given > high).any()
    down = (ticks.fault == 0) & (ticks.touchdown > 0.5)
    np.testing.assert_array_equal(ticks.before[down], cases.after[down])
    reached = np.abs(ticks.after[down] - ticks.requested[down]) < 1e-6
    assert reached.any()
    # Only where a change is limited does a wish wait for further steps.
    assert reached.all() == all(c.largest_change is None for c in told.commands)


@pytest.mark.parametrize("flags", [("-fsanitize=address,undefined", "-fno-sanitize-recover=all")])
def test_hostile_commands_under_sanitizers(files, tmp_path, flags):
    program = compiled(tmp_path, files, ("-g", "-O0", *flags))
    assert b"broken 0" in build.run(program, "fuzz", "20000", "3")


def test_one_function_of_the_commands_is_the_policy(told):
    """What ONNX is written from: no state, the commands before and after among its inputs."""
    program = policy_in_one(told.controller).program
    assert {item.name: item.shape for item in program.inputs} == {
        "commands": (2, len(told.commands)),
        "dz": (2,),
        "z": (2,),
    }
    given, expected = model_questions(told, 20)
    found = evaluate(program, given, POINT)
    found = np.stack([found["y"], found["dy"]], axis=1)
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9)


def test_float_is_inside_its_bound(told, files, asked, tmp_path):
    program = compiled(tmp_path, files, build.PRECISIONS["float"])
    agreement = agree(told, asked, program, "float")
    bound = float_bound(told, policy_rate(told.gait.policy), asked)
    assert agreement.output <= bound.output < 1e-3
    assert agreement.rate <= bound.rate < 2e-3


def test_a_gait_without_commands_has_the_c_that_it_had(design):
    """No word of commands in its own files; the shared ones leave them out."""
    text = "".join(gait_files(design).values())
    for word in ("COMMANDS", "ng_command", "policy_step", "NG_STEP"):
        assert word not in text
    assert "void ng_policy_rate(const ng_real dz[2], const ng_real z[2]," in " ".join(text.split())
