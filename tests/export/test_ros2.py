"""The ROS 2 package, compiled against stubs of the few headers it uses: no ROS is here."""

import re
import shutil
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest

from neuralgaits.control import Pd
from neuralgaits.export.ros2_source import package_name, ros2_files
from support import monitored
from support.deployments import plain
from support.designs import commanded_design, design_for
from support.ros2_package import built, package_of, report_of

pytestmark = pytest.mark.skipif(shutil.which("g++") is None, reason="g++ is not installed")


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    """Design and folder of a package."""
    return package_of(tmp_path_factory.mktemp("ros2"), design_for("amber3m", {"pd": Pd()}), 4)


@pytest.fixture(scope="module")
def driver(package, request):
    """The driver, against interfaces as ros2_control first had them."""
    return built(package[1], request.path.parent)


@pytest.fixture(scope="module", params=["monitor", "commands"])
def further(tmp_path_factory, request):
    """The driver of a gait with a monitor or commands, against later interfaces."""
    if request.param == "monitor":
        made = monitored.made_up()[2]
    else:
        made = commanded_design("amber3m", {"pd": Pd()})
    _, folder = package_of(tmp_path_factory.mktemp(request.param), made, 6)
    return request.param, built(folder, request.path.parent, "-DSTUB_OF_LATER_RELEASE")


def _share(found: dict[str, str]) -> float:
    """The largest difference as a share of the torque limit; the pitch goes by a quaternion."""
    return float(found["worst"]) / 41.0


@pytest.mark.slow
@pytest.mark.parametrize("word", ["estimated", "measured", "estimated impedance"])
def test_it_gives_the_torques_of_the_controller_in_c(driver, word):
    found, everything = report_of(driver, word)
    assert int(found["ticks"]) == 2000
    assert _share(found) <= 1e-12 < 1e-3 < float(found["largest"])
    assert int(found["touchdowns"]) > 3
    # It publishes nothing before the first tick, then what the tick said.
    assert found["silent"] == "0"
    assert "status 0 walking" in everything and "value fault: no fault" in everything


@pytest.mark.slow
def test_monitor_and_commands_go_along(further):
    kind, program = further
    found, everything = report_of(program, "measured")
    assert int(found["ticks"]) == 2000 and _share(found) <= 1e-12
    if kind == "monitor":
        assert "value level 2 inside: " in everything and "value proof sha256: " in everything
        assert "walking, outside of a proved set" in everything


@pytest.mark.slow
@pytest.mark.parametrize("word", ["estimated", "estimated impedance"])
def test_after_a_fault_it_returns_error_and_lets_go(driver, word):
    found, everything = report_of(driver, word)
    assert found["refused"] == "1" and float(found["held"]) == 0.0
    # Drives with a loop of their own damp until the controller is deactivated.
    assert found["damping"] == str(int("impedance" in word))
    assert float(found["after"]) == 0.0
    assert "status 2 a reading is NaN or infinite" in everything


@pytest.mark.slow
def test_bad_parameters_are_named_in_one_line(driver):
    _, said = report_of(driver, "bad")
    assert said.count("\n") == 1
    for one in (
        "joints: expected",
        "contacts: expected 4 state interfaces, found 0",
        "base_velocity: expected two state interfaces (x, z) or none, found 1",
        "imu: expected the name of a sensor, found none",
        "mode: expected effort or impedance, found 'force'",
        "blend_s: expected 0 to 60, found -1",
        "stance_leg: expected 0 or 1, found 2",
        "law: expected one of pd, found 'pid'",
        "update_rate: expected 1000 Hz, found 200",
    ):
        assert one in said, said


@pytest.mark.slow
def test_parameters_of_another_type_and_lacking_interfaces_are_refused(driver):
    for word, part in (("type", "another type"), ("lacking", "correct joints, imu and contacts")):
        _, said = report_of(driver, word)
        assert said.count("\n") == 1 and part in said


def test_the_manifest_of_a_supervised_package_has_what_it_uses(package):
    files = ros2_files(replace(package[0], supervised=True), {"supervisor.c": "", "link.c": ""})
    assert "<depend>rcl_interfaces</depend>" in files["package.xml"]
    assert "find_package(rcl_interfaces REQUIRED)" in files["CMakeLists.txt"]
    assert "supervisor.c" in files["CMakeLists.txt"] and "link.c" not in files
    plain_files = ros2_files(package[0], {"supervisor.c": ""})
    assert "rcl_interfaces" not in plain_files["package.xml"] + plain_files["CMakeLists.txt"]
    assert "supervisor.c" not in plain_files


def test_names_agree_across_the_files_of_the_package(package):
    design, folder = package
    name = package_name(design)
    assert name == "neuralgaits_amber3m"
    manifest = ElementTree.parse(folder / "package.xml").getroot()
    assert manifest.findtext("name") == name
    plugin = ElementTree.parse(folder / "plugin.xml").getroot()
    assert plugin.get("path") == name
    (one,) = plugin.iter("class")
    assert (one.get("name"), one.get("type")) == (
        f"{name}/GaitController",
        f"{name}::GaitController",
    )
    cmake = (folder / "CMakeLists.txt").read_text()
    needed = {depend.text for depend in manifest.iter("depend")}
    assert set(re.findall(r"find_package\((\w+) REQUIRED\)", cmake)) == needed | {"ament_cmake"}
    for source in folder.glob("*"):
        if source.suffix in (".cpp", ".hpp", ".txt", ".xml", ".yaml"):
            text = source.read_text()
            assert not re.search("@[A-Z]+@|neuralgaits_package", text), source.name


@pytest.mark.parametrize("supervised", [False, True])
def test_the_yaml_has_every_parameter(package, supervised):
    import yaml

    design, _ = package
    files = ros2_files(replace(design, supervised=supervised), {})
    given = yaml.safe_load(files["controllers.yaml"])
    parameters = given["gait_controller"]["ros__parameters"]
    # ROS 2 reads no empty list, so this one stands in a comment.
    assert "# base_velocity: [" in files["controllers.yaml"]
    branch = r"#if NG_ROS2_SUPERVISOR\n(.*?)(?:#else\n(.*?))?#endif"
    kept = r"\1" if supervised else r"\2"
    code = re.sub(branch, kept, files["gait_controller.cpp"], flags=re.DOTALL)
    declared = re.findall(r'auto_declare<[^(]*>\(\s*"(\w+)"', code)
    assert {*parameters, "base_velocity"} == set(declared)
    assert ("request" in parameters) == supervised
    manager = given["controller_manager"]["ros__parameters"]
    assert manager["update_rate"] == 1000
    by_motor = {one.motor: one.joint for one in design.deployment.joints}
    assert parameters["joints"] == [by_motor.get(i, "") for i in range(max(by_motor) + 1)]


def test_a_robot_of_any_name_makes_a_package(package):
    design, _ = package
    robot = replace(design.controller.robot, name='My Robot "2"</name>')
    controllers = {law: replace(one, robot=robot) for law, one in design.controllers.items()}
    odd = replace(design, controllers=controllers, deployment=plain(design.controller.robot))
    files = ros2_files(odd, {})
    assert package_name(odd) == "neuralgaits_my_robot_2_name"
    ElementTree.fromstring(files["package.xml"])
    ElementTree.fromstring(files["plugin.xml"])
    assert np.all([ord(c) < 128 for c in files["ros2_facts.h"]])
