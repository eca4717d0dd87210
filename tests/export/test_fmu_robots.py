"""FMUs of other robots and of gaits with commands, and the verb that writes them."""

import io
import re
import zipfile
from functools import partial

import mujoco
import numpy as np
import pytest
from fmpy import read_model_description
from fmpy.validation import validate_fmu

from neuralgaits.export import build, output_folder
from neuralgaits.export.fmu.fmu_archive import fmu_file
from neuralgaits.export.fmu.fmu_sources import headers
from neuralgaits.export.fmu.fmu_variables import identifier, variables_of
from neuralgaits.export.reference import Reference
from neuralgaits.export.source import gait_files
from neuralgaits.records.exported import UncheckedExport
from neuralgaits.robots import load_robot
from neuralgaits.workflows import demo, export_formats
from neuralgaits.workflows.export import export_controller
from support.designs import FOOTHOLDS, LAWS, SPEED, commanded_design, design_for
from support.fmu_host import VERSIONS, FmuPlant, UnpackedFmu, made_fmu
from support.random_biped import random_biped

PD = {"pd": LAWS["pd"]}


@pytest.fixture(scope="module")
def awkward(tmp_path_factory):
    """A robot without a torso whose joints and motors turn either way, and its FMU."""
    file = tmp_path_factory.mktemp("robot") / "legs.xml"
    file.write_text(random_biped(4, 2, torso=False))
    design = design_for(str(file), PD)
    folder = tmp_path_factory.mktemp("fmu")
    path = made_fmu(design, "3.0", folder)
    return design, path, UnpackedFmu(path, folder / "unpacked")


def test_signs_are_those_of_the_robot_file(awkward):
    """What MuJoCo makes of the motor commands are the torques of the FMU."""
    design, path, fmu = awkward
    assert validate_fmu(str(path)) == []
    plant = FmuPlant(design, np.zeros(2 * design.controller.robot.n))
    middle = {name: np.mean(plant.model.joint(name).range) for name in plant.joints}
    for name, angle in middle.items():
        plant.data.joint(name).qpos[0] = angle
    mujoco.mj_forward(plant.model, plant.data)
    reading = plant.reading(rates=True)
    signs = {sign for leg in design.controller.robot.layout.leg_joint_signs for sign in leg}
    assert signs == {1.0, -1.0} and len(middle) == 3
    with fmu.instance(estimate=False, **reading) as one:
        for tick in range(5):
            one.step(1e-3 * tick)
        found = one.outputs()
    assert found["fault"] == 0
    for joints, actuators in zip(
        design.controller.robot.layout.leg_joints,
        design.controller.robot.layout.actuators,
        strict=True,
    ):
        for joint, actuator in zip(joints, actuators, strict=True):
            plant.data.actuator(actuator).ctrl[0] = found[f"motor.{joint}"]
    mujoco.mj_forward(plant.model, plant.data)
    for name in middle:
        dof = plant.model.joint(name).dofadr[0]
        expected = plant.data.qfrc_actuator[dof]
        assert found[f"torque.{name}"] == pytest.approx(expected, rel=1e-9, abs=1e-12)
        assert abs(expected) > 0.1


def test_joints_have_the_order_of_the_robot_file(awkward):
    design = awkward[0]
    model = mujoco.MjModel.from_xml_string(design.controller.robot.layout.xml)
    order = [model.joint(k).name for k in range(model.njnt)]
    names = [one.name for one in variables_of(design) if one.name.startswith("angle.")]
    places = [order.index(name.removeprefix("angle.").strip("'")) for name in names]
    assert places == sorted(places)


@pytest.mark.parametrize("version", VERSIONS)
def test_names_of_robot_files_become_no_markup(version, tmp_path):
    """And none is lost: where a name of a variable cannot have it, its description does."""
    text = load_robot("amber3m").layout.xml
    names = {"knee_left": "knee &lt;b&gt; &amp;amp; ]]&gt;", "hip_left": "Hüfte 'links' &quot;/*"}
    for name, other in names.items():
        text = text.replace(f'"{name}"', f'"{other}"')
    file = tmp_path / "robot %s.xml"
    file.write_text(text)
    design = design_for(str(file), PD)
    files = output_folder.shipped() | gait_files(design)
    name, content = fmu_file(design, version, files, [])
    (tmp_path / name).write_bytes(content)
    assert validate_fmu(str(tmp_path / name)) == []
    described = read_model_description(str(tmp_path / name)).modelVariables
    angles = {one.name: str(one.description) for one in described if one.name[:6] == "angle."}
    assert [key for key, about in angles.items() if "knee <b> &amp; ]]>" in about] == [
        "angle.'knee <b> &amp; ]]>'"
    ]
    (hip,) = (key for key, about in angles.items() if "Hüfte 'links' \"/*" in about)
    assert re.fullmatch(r"angle\.joint\d", hip)


@pytest.mark.slow
def test_commands_are_inputs(tmp_path):
    design = commanded_design("amber3m", PD, (SPEED, FOOTHOLDS[0]))
    path = made_fmu(design, "2.0", tmp_path)
    fmu = UnpackedFmu(path, tmp_path / "unpacked")
    assert validate_fmu(str(path)) == []
    speed = fmu.variables["command.speed"]
    assert (speed.causality, speed.unit) == ("input", "m/s")
    numbers = [float(text or "nan") for text in (speed.min, speed.start, speed.max)]
    assert numbers == [SPEED.low, 0.5 * (SPEED.low + SPEED.high), SPEED.high]

    def target(**commands):
        still = {"force.foot_left": 200.0, "angle.knee_left": 0.3, "angle.hip_left": -0.2}
        with fmu.instance(**still, **commands) as one:
            one.step(0.0)
            return one.get("target.hip_right.q_des")

    assert target(**{"command.step_length": 0.32}) != target(**{"command.step_length": 0.37})
    middle = 0.5 * (FOOTHOLDS[0].low + FOOTHOLDS[0].high)
    assert target() == target(**{"command.step_length": middle, "command.speed": np.nan})
    assert target(**{"command.speed": 99.0}) == target(**{"command.speed": SPEED.high})


@pytest.mark.parametrize(
    ("name", "part"),
    [
        ("knee_left", "knee_left"),
        ("left knee", "'left knee'"),
        ("knee.l", "'knee.l'"),
        ("2nd", "'2nd'"),
        ("knie_ü", "joint3"),
        ("it's", "joint3"),
        ("", "joint3"),
    ],
)
def test_names_of_joints_become_parts_of_structured_names(name, part):
    assert identifier(name, "joint3") == part


def test_without_a_compiler_it_has_sources_alone(awkward):
    design, path, _ = awkward
    files = output_folder.shipped() | gait_files(design)
    _, content = fmu_file(design, "3.0", files, [])
    with zipfile.ZipFile(io.BytesIO(content)) as bare, zipfile.ZipFile(path) as whole:
        more = set(whole.namelist()) - set(bare.namelist())
        assert more == {name for name in whole.namelist() if name.startswith("binaries/")}
        assert {"sources/fmu.c", "sources/gait.c", "sources/buildDescription.xml"} < set(
            bare.namelist()
        )


def test_the_controller_of_an_fmu_is_compared_with_python(tmp_path, monkeypatch):
    asked = []

    def compared(design, reference, folder, compilers, states):
        asked.append((isinstance(reference, Reference), list(compilers), states))
        assert (folder / "check.c").is_file() and (folder / "monitor.c").is_file()
        return partial(UncheckedExport, reason="not now")

    monkeypatch.setattr(build, "COMPILERS", build.COMPILERS[:1])
    monkeypatch.setattr(export_formats, "check_controller", compared)
    export_controller(demo.FOLDER, tmp_path / "out", format="fmu2", states=7)
    assert asked == [(True, ["gcc"], 7)]
    with zipfile.ZipFile(tmp_path / "out" / "neuralgaits_amber3m.fmu") as opened:
        assert any(name.startswith("binaries/") for name in opened.namelist())


def test_every_compiler_takes_the_sources_in_both_precisions(awkward, tmp_path):
    _, path, _ = awkward
    with zipfile.ZipFile(path) as opened:
        opened.extractall(tmp_path)
    folder = tmp_path / "sources"
    for name, text in headers().items():
        (folder / name).write_text(text)
    sources = tuple(one.name for one in folder.glob("*.c"))
    for compiler in build.compilers():
        for number, flags in enumerate(build.PRECISIONS.values()):
            build.build(
                compiler, folder, f"{number}.so", sources, ("-O0", "-fPIC", "-shared", *flags)
            )
