"""The C that `export` writes, and the law that level 5 of a proof is about."""

# pyright: reportAttributeAccessIssue=false
# MuJoCo ships no type stubs.

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import jax
import mujoco
import numpy as np
import pytest

from neuralgaits.analysis.run import open_run
from neuralgaits.certificate.levels.disturbed.theorem import DisturbedConstants
from neuralgaits.certificate.levels.full_order.model import FullOrderModel
from neuralgaits.certificate.run_certificate.proved_law import law_proofs
from neuralgaits.certificate.run_certificate.verified_summary import read_certificate
from neuralgaits.cli.export_screen import show_export
from neuralgaits.control import ScheduledPd
from neuralgaits.control.joint_model import JointModel
from neuralgaits.errors import InputError
from neuralgaits.export import build
from neuralgaits.export.cases import NEVER, of_region
from neuralgaits.export.fmu.fmu_variables import variables_of
from neuralgaits.export.reference import results_of
from neuralgaits.export.source import gait_files
from neuralgaits.gait.output_laws import ScheduledLaw
from neuralgaits.gait.scheduled_gains import ScheduledGains
from neuralgaits.records.exported import UncheckedExport
from neuralgaits.records.law_proof import LawProof, summary_of
from neuralgaits.robots.mjcf_state import StateMap
from neuralgaits.simulation.linked.config import LinkConfig
from neuralgaits.workflows import proved_controller
from neuralgaits.workflows.export import design_of, export_controller, with_monitor
from neuralgaits.workflows.proved_controller import proved_bandwidth, with_proved_law
from support import monitored
from support.compiled import folder_with
from support.full_case import in_the_ball
from support.shipped_run import SHIPPED

W, STATES = 50.0, 400
ENDS = (-0.0075, 1.006)
"""Phases between which sets of level 5 of AMBER-3M lie."""
CLOCK = {"touchdown": 0.0, "free": 0.008}


@pytest.fixture(scope="module")
def run():
    return open_run(SHIPPED)


@pytest.fixture(scope="module")
def design(run):
    return design_of(run, bandwidth=W)


@pytest.fixture(scope="module")
def stated(run, design):
    """Constants of levels 4 and 5, as they are in a proof about scheduled-pd."""
    names = FullOrderModel(run.robot, run.gait, run.spec).names
    full = replace(monitored.full_order_constants(names), bandwidth=W, radius=0.0065)
    gains = design.controllers["scheduled-pd"].law.schedule.gains
    shape = DisturbedConstants(
        push=(0.5, 0.0), peak=(1.0, 0.0), hold=0.001111, error=0.0, jerk=1.0, growth_slope=1.0,
        jerk_push=1.0, barriers=(), torque_gains=tuple(np.ravel(gains.torque).tolist()),
        inertia_gains=tuple(np.ravel(gains.inertia).tolist()),
    )  # fmt: skip
    return full, shape


def certificate_with(full, shape) -> Any:
    """A reading that bears out level 5 with these constants."""
    proof = SimpleNamespace(theorems=SimpleNamespace(parameters={4: full, 5: shape}))
    levels = [SimpleNamespace(level=5, proved=True)]
    summary = SimpleNamespace(levels=levels, level=5, verdict="proved")
    return SimpleNamespace(proof=proof, summary=summary, part=None)


def proofs(run, design, full, shape):
    found = law_proofs(run, certificate_with(full, shape), design.controllers)
    assert [one.law for one in found] == list(design.controllers)
    return {one.law: one for one in found}


def state(run, u, xi, theorem):
    """q, dq and the theorem's torque at a chart point of D, which may lie beyond the step."""
    full, shape = theorem
    model = FullOrderModel(run.robot, run.gait, run.spec, full.bandwidth, full.weights)
    m = run.robot.n - 1
    law = None
    if shape.scheduled:
        lists = np.array(shape.torque_gains), np.array(shape.inertia_gains)
        law = ScheduledLaw(ScheduledGains.from_lists(*lists, m), run.gait)

    @jax.jit
    @jax.vmap
    def at(u, xi):
        point = model.point(u, full.radius * xi)
        torque = point.torque if law is None else law.torque(point, u)
        return point.q, point.dq, torque

    return map(np.asarray, at(u, xi))


@pytest.mark.slow
def test_torques_of_c_are_those_of_the_theorem(run, design, stated, tmp_path):
    """For both laws, at states of a set: its strips before and after the step, outputs off."""
    full, shape = stated
    files = gait_files(design) | {"gait_selftest.h": "#define NG_SELFTEST_CASES 0\n"}
    folder = folder_with(tmp_path, files)
    sources = tuple(name for name in build.CHECKED if name != "selftest.c")
    (folder / "none.c").write_text("int ng_selftest(void) { return 0; }\n")
    program = build.build("gcc", folder, "check", (*sources, "none.c"), ("-O1",))
    draw = np.random.default_rng(0)
    u = np.stack([draw.uniform(*ENDS, STATES), draw.uniform(size=STATES)], axis=1)
    u[:80, 0], u[80:160, 0] = draw.uniform(ENDS[0], 0.0, 80), draw.uniform(1.0, ENDS[1], 80)
    xi = in_the_ball(draw, STATES, 2 * (run.robot.n - 1))
    layout = run.robot.layout
    map_ = StateMap.build(mujoco.MjModel.from_xml_string(layout.xml), layout)
    base = of_region(design, STATES, 0)
    stands = np.arange(2) == base.leg[:, None]
    for name, theorem in (
        ("fblin", (full, replace(shape, torque_gains=(), inertia_gains=()))),
        ("scheduled-pd", stated),
    ):
        q, dq, torque = state(run, u, xi, theorem)
        # The theorem pins the centre of a foot, which on a robot rolls.
        rolling = np.stack([-float(run.robot.foot_radius) * dq[:, 0], np.zeros(STATES)], axis=1)
        qpos, qvel = map_.to_mjcf(q, dq, base.leg, (0.0, 0.0), rolling)
        ones = np.ones(STATES, dtype=int)
        cases = replace(
            base,
            law=list(design.controllers).index(name) * ones,
            ticks=0 * ones,
            since=NEVER * np.ones(STATES),
            blend_s=np.zeros(STATES),
            running=0 * ones,
            pitch=qpos[:, map_.root[2]],
            dpitch=qvel[:, map_.root[2]],
            base_velocity=qvel[:, map_.root[:2]],
            force=np.where(stands, 400.0, 0.0),
            joints=qpos[:, map_.joints],
            djoints=qvel[:, map_.joints],
        )
        cases.records().tofile(folder / "cases")
        found = results_of(
            design,
            np.frombuffer(build.run(program, "compare", str(folder / "cases"))).reshape(STATES, -1),
        )
        assert np.all(found.fault == 0)
        limit = np.asarray(design.controller.torque_limit)
        expected = np.clip(torque, -limit, limit)
        assert np.abs(expected).max() > 5.0
        np.testing.assert_allclose(found.actuated, expected, atol=1e-8)


def test_a_proof_is_about_one_law_one_bandwidth_and_one_clock(run, design, stated):
    full, shape = stated
    found = proofs(run, design, full, shape)
    assert [name for name, one in found.items() if one.proved] == ["scheduled-pd"]
    assert found["scheduled-pd"] == LawProof(
        "scheduled-pd", W, "scheduled-pd", 0.001111, "touchdown"
    )
    assert found["fblin"].reason == "the proof is about scheduled-pd"
    exact = replace(shape, torque_gains=(), inertia_gains=(), kick_end=0.008)
    found = proofs(run, design, full, exact)
    assert found["fblin"] == LawProof("fblin", W, "fblin", 0.001111, "free")
    assert found["pd"].bandwidth is None and not found["pd"].proved
    assert not found["scheduled-pd"].proved


def test_another_bandwidth_hold_or_table_is_not_what_is_proved(run, design, stated):
    full, shape = stated
    other = design_of(run).controllers
    reasons = {
        "--bandwidth 50": proofs(run, replace(design, controllers=other), full, shape),
        "1 ms apart, and the proof is about 0.797 ms": proofs(
            run, design, full, replace(shape, hold=0.000797)
        ),
        "gains are not those of the proof": proofs(
            run, design, full, replace(shape, inertia_gains=(9.0, *shape.inertia_gains[1:]))
        ),
        "it bounds z inside the set": proofs(
            run, design, replace(full, start_strip=0.025), shape
        ),
    }  # fmt: skip
    for words, found in reasons.items():
        assert words in str(found["scheduled-pd"].reason)
        assert not any(one.proved for one in found.values())
    # A hold of the very period is enough.
    assert proofs(run, design, full, replace(shape, hold=1e-3))["scheduled-pd"].proved


def test_what_changes_a_torque_is_not_what_is_proved(run, design, stated):
    full, shape = stated
    one = design.controllers["scheduled-pd"]
    m = run.robot.n - 1
    joints = JointModel(run.robot.armature[1:], run.robot.damping[1:], np.zeros(m))
    laws = {
        "every tick": replace(one, law=replace(one.law, hold_ticks=2)),
        "measured state": replace(one, law=replace(one.law, predicts_rates=True)),
        "identified joints": replace(one, joints=joints),
        "gains are not": replace(one, law=ScheduledPd(bandwidth=W)),
    }
    for words, controller in laws.items():
        changed = replace(design, controllers={"scheduled-pd": controller})
        assert words in str(proofs(run, changed, full, shape)["scheduled-pd"].reason)


def test_header_and_screen_say_what_is_proved(run, design, stated, capsys):
    full, shape = stated
    found = law_proofs(run, certificate_with(full, shape), design.controllers)
    text = gait_files(replace(design, law_proofs=found))["gait.h"]
    line = "scheduled-pd at 50 rad/s: proved for ticks at most 1.111 ms apart, one of them at each"
    assert f" *   {line} touchdown\n" in text
    assert " *   pd: nothing is proved, the proof is about scheduled-pd\n" in text
    assert "proved for" not in gait_files(design)["gait.h"]
    files: dict[str, Any] = dict.fromkeys(("run", "format", "out", "reason"), "")
    files |= dict.fromkeys(("files", "laws", "warnings"), ())
    show_export(UncheckedExport(**files, law_proofs=found))
    assert f"level 5 of {line} touchdown" in " ".join(capsys.readouterr().out.split())
    slow = law_proofs(run, certificate_with(full, replace(shape, hold=5e-4)), design.controllers)
    words = summary_of(slow)
    assert words is not None and "scheduled-pd at 50 rad/s: nothing is proved, its ticks" in words
    assert summary_of(()) is None
    assert summary_of(found[:1]) == "nothing is proved, the proof is about scheduled-pd"


def test_below_level_5_no_law_is_proved(run):
    certificate = read_certificate(run.folder)
    design, _ = with_monitor(design_of(run), run, certificate)
    assert design.monitor is not None and design.law_proofs == ()
    assert design.default_law == "pd"
    assert "#define NG_LAW_DEFAULT 0\n" in gait_files(design)["gait.h"]


def test_the_law_that_is_proved_is_the_default_of_an_export(run, stated):
    """With the bandwidth of the proof, unless another one is asked for."""
    full, shape = stated
    exact = replace(shape, torque_gains=(), inertia_gains=())
    for name, theorem in (("scheduled-pd", shape), ("fblin", exact)):
        certificate = certificate_with(full, theorem)
        written = design_of(run, certificate)
        own = {"fblin": 30.0, "scheduled-pd": 40.0, name: W}
        laws: Any = written.controllers
        assert {one: laws[one].law.bandwidth for one in own} == own
        assert written.default_law == name
        number = list(written.controllers).index(name)
        assert f"#define NG_LAW_DEFAULT {number}\n" in gait_files(written)["gait.h"]
        (start,) = (one.start for one in variables_of(written) if one.name == "law")
        assert start == number
        other = design_of(run, certificate, bandwidth=35.0)
        assert not any(one.proved for one in other.law_proofs) and other.default_law == "pd"
    slow = certificate_with(full, replace(shape, hold=5e-4))
    assert design_of(run, slow).default_law == "pd"


def test_walks_use_the_law_that_is_proved(run, stated, monkeypatch):
    """The C by its default law, a law of Python by the bandwidth of the proof about it."""
    full, shape = stated
    certificate = certificate_with(full, shape)
    own = LinkConfig(lockstep=True)
    pd = replace(own, law="pd")
    assert with_proved_law(run, own, None, None) == pd
    assert proved_bandwidth(run, "scheduled-pd", None) is None
    monkeypatch.setattr(proved_controller, "read_certificate", lambda folder: certificate)
    assert with_proved_law(run, own, None, None) == replace(own, law="scheduled-pd")
    assert with_proved_law(run, own, None, 35.0) == pd
    assert with_proved_law(run, pd, None, None) == pd
    assert with_proved_law(run, None, None, None) is None
    laws = ("pd", "fblin", "scheduled-pd", ScheduledPd())
    assert [proved_bandwidth(run, law, None) for law in laws] == [None, None, W, None]
    assert proved_bandwidth(run, "scheduled-pd", own) == W
    elsewhere = replace(own, address="127.0.0.1:9000")
    assert proved_bandwidth(run, "scheduled-pd", elsewhere) is None


def test_a_bandwidth_without_control_laws_is_refused(run, tmp_path):
    with pytest.raises(InputError, match=r"--bandwidth: expected --format c or fmu or .*onnx"):
        export_controller(run, tmp_path / "out", format="onnx", bandwidth=W)
    with pytest.raises(InputError, match="expected a bandwidth of 1 to 1000 rad/s, found 0"):
        export_controller(run, tmp_path / "out", bandwidth=0.0)
