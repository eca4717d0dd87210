"""The whole control step in C against Python, on states, touchdowns and faults."""

import re

import jax
import numpy as np
import pytest

from neuralgaits.barriers import specs
from neuralgaits.control import Fblin
from neuralgaits.control.controlled_gait import ControlledGait
from neuralgaits.control.pd import BANDWIDTH
from neuralgaits.control.safeguard import Fault
from neuralgaits.errors import MismatchError
from neuralgaits.export import build
from neuralgaits.export.compare import agree, float_bound, limits, questions
from neuralgaits.export.design import Design
from neuralgaits.export.programs import policy_rate
from neuralgaits.export.reference import Reference
from neuralgaits.export.selftest import selftest_file
from neuralgaits.export.source import gait_files
from neuralgaits.gait.joint_inertia import JointResponse
from neuralgaits.simulation.setup.starts import momentum_range
from support.compiled import folder_with
from support.designs import design_for
from support.random_biped import random_biped

pytestmark = pytest.mark.slow

STATES = 2000


def files_of(design, reference):
    return gait_files(design) | {"gait_selftest.h": selftest_file(design, reference)}


def compiled(folder, files, flags=()):
    return build.build("gcc", folder_with(folder, files), "check", build.CHECKED, ("-O2", *flags))


@pytest.fixture(scope="module")
def files(design, reference):
    return files_of(design, reference)


@pytest.fixture(scope="module")
def asked(design, reference):
    return questions(design, reference, STATES)


@pytest.fixture(scope="module")
def agreements(design, files, asked, tmp_path_factory):
    """How far C is from Python, by precision."""
    folder = tmp_path_factory.mktemp("c")
    return {
        precision: agree(design, asked, compiled(folder, files, defines), precision)
        for precision, defines in build.PRECISIONS.items()
    }


@pytest.mark.parametrize("precision", build.PRECISIONS)
def test_c_does_what_python_does(design, agreements, precision):
    agreement = agreements[precision]
    allowed = limits(design, precision)
    assert max(agreement.output, agreement.rate) <= allowed.output
    assert agreement.torque <= allowed.torque
    # The error is not 0: the two sides are computed differently.
    assert agreement.torque > 0.0


def test_the_cases_meet_every_decision(asked):
    """Every fault, both legs, touchdowns, clipping, held outputs and blending occur."""
    ticks, cases = asked.ticks, asked.cases
    assert set(ticks.fault.astype(int)) == set(Fault)
    going = ticks.fault == Fault.NONE
    for column in (ticks.leg, ticks.touchdown, ticks.saturated, ticks.ticks, cases.blend_s > 0):
        assert len(np.unique(column[going])) == 2
    assert np.all(ticks.torque[~going] == 0.0)
    changed = np.abs(ticks.torque - cases.torque.reshape(cases.count, -1)).max(axis=1)
    slow = going & (cases.torque_rate < 1e9)
    assert np.max(changed[slow]) <= 1e4 * 1e-3 * (1.0 + 1e-12)
    assert np.any(changed[slow] > 0.999 * 1e4 * 1e-3)


def test_float_is_inside_its_bound(design, agreements, asked):
    """The bound over the region covers what is measured, and says something."""
    agreement = agreements["float"]
    bound = float_bound(design, policy_rate(design.gait.policy), asked)
    assert agreement.output <= bound.output < 1e-3
    assert agreement.rate <= bound.rate < 1e-3


PLANTED = {
    "a gain": (r"(\.stiffness = \{NG\(\d+\.\d\d\d)\d", r"\1", "gait.c"),
    "a table": (r"(schedule_inertia\[\d+\] = \{NG\(0\.\d\d\d)\d", r"\g<1>", "gait.c"),
    "a weight": (r"(network_weights_1_columns.*\n *\{NG\()(-?)0\.(\d)", r"\1\g<2>0.1\3", "gait.c"),
    "a sign": (r"moment \+= mass", "moment -= mass", "controller.c"),
    "bounds at a touchdown": (r"(POLICY_RATE\(by_z2, )at", r"\1z", "controller.c"),
    "rates that settle": (r"balanced\(mass, z\[1\]", "balanced(mass, -z[1]", "controller.c"),
    "the hold": (r"ticks_to_policy <= 0", "ticks_to_policy <= 1", "controller.c"),
    "a threshold": (r"(NG_TOUCHDOWN_FORCE NG\()", r"\g<1>1", "gait.h"),
    "the blend": (r"NG\(3\.0\) - NG\(2\.0\) \* s", "NG(2.0) - s", "controller.c"),
}


@pytest.mark.parametrize("name", PLANTED)
def test_a_planted_error_is_found(design, files, asked, tmp_path, name):
    pattern, text, file = PLANTED[name]
    folder = folder_with(tmp_path, files)
    before = (folder / file).read_text()
    after = re.sub(pattern, text, before, count=1)
    assert after != before
    (folder / file).write_text(after)
    program = build.build("gcc", folder, "check", build.CHECKED, ("-O0",))
    with pytest.raises(MismatchError, match=r"disagree|selftest"):
        agree(design, asked, program, "double")


def test_a_biped_without_a_torso(tmp_path):
    """One hip joint for both legs, centres of mass off the links, gears of either sign."""
    file = tmp_path / "odd.xml"
    file.write_text(random_biped(4, 2, torso=False))
    odd = design_for(str(file), {"fblin": Fblin(bandwidth=20.0, hold_ticks=3)})
    reference = Reference(odd)
    program = compiled(tmp_path / "c", files_of(odd, reference))
    agreement = agree(odd, questions(odd, reference, 1000), program, "double")
    assert agreement.torque <= 1e-12


def test_what_runs_on_the_robot_calls_nothing_and_keeps_nothing(files, tmp_path):
    folder = folder_with(tmp_path, files)
    core = build.inspect("gcc", folder, ("-O2",))
    assert core.foreign == () and core.static_bytes == 0
    assert core.stack_bytes is not None and 500 < core.stack_bytes <= 4096
    text = (folder / "controller.c").read_text()
    leaky = text.replace('#include "controller.h"', '#include "controller.h"\n#include <stdlib.h>')
    leaky = leaky.replace("ng_step(const", "kept(void);\nvoid ng_step(const", 1)
    leaky += "\nstatic int count;\nvoid *kept(void)\n{\n    return malloc((size_t)++count);\n}\n"
    (folder / "controller.c").write_text(leaky.replace("void kept(void);", "void *kept(void);"))
    spoilt = build.inspect("gcc", folder, ("-O2",))
    assert spoilt.foreign == ("malloc",) and spoilt.static_bytes >= 4


def test_deepest_chain_of_calls():
    """A diamond: the longer way down counts, a function met twice counts once a way."""
    graph = "".join(
        f'node: {{ title: "{name}" label: "{name}\\nf.c:1\\n{size} bytes (static)" }}\n'
        for name, size in {"top": 100, "left": 10, "right": 50, "low": 7}.items()
    )
    pairs = [("top", "left"), ("top", "right"), ("left", "low"), ("right", "low")]
    graph += "".join(
        f'edge: {{ sourcename: "{a}" targetname: "{b}" label: "x" }}\n' for a, b in pairs
    )
    assert build.deepest(graph) == 157


@pytest.mark.parametrize("flags", [(), ("-DNG_FLOAT",)], ids=["double", "float"])
def test_hostile_inputs_under_sanitizers(files, tmp_path, flags):
    """No torque beyond its limit, none after a fault, no undefined step, whatever comes in."""
    sanitize = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-g1", "-O0")
    program = compiled(tmp_path, files, (*sanitize, *flags))
    words = build.run(program, "fuzz", "20000", "7").decode().split()
    counts = dict(zip(words[::2], map(int, words[1::2]), strict=True))
    assert counts["broken"] == 0
    assert counts["spoilt"] > 3_000 and 300 < counts["faults"] < 17_000
    assert build.run(program, "selftest") == b"selftest 0\n"


def test_facts_are_in_the_header(design, files):
    text = files["gait.h"]
    for name in (
        *design.controller.robot.joint_names,
        "knee_left",
        "hip_right",
        "0" * 64,
        "1" * 64,
    ):
        assert name in text
    stiffness = BANDWIDTH**2 * JointResponse(design.controller.robot).inertia
    gains = "/".join(f"{gain:.4g}" for gain in stiffness) + " N m/rad"
    for fact in (gains, "578 N m/rad", "30 rad/s", "41 N m", "0.001 s", "-1.6 to 1.6 rad"):
        assert fact in text
    assert re.search(r"#define NG_PROOF_SHA256 \"\"", text)


def test_other_gaits_have_other_headers(design):
    """The header says which policy; nothing of it is a fixed text."""
    robot = design.controller.robot
    gait = specs.walking(robot).new_gait(jax.random.key(4), "posture", None)
    controlled = ControlledGait(robot, gait, momentum_range(gait))
    other = Design.of(controlled, {k: c.law for k, c in design.controllers.items()}, design.origin)
    assert gait_files(other)["gait.c"] != gait_files(design)["gait.c"]
