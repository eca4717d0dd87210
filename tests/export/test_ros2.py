"""The ROS 2 package, compiled against stubs of the few headers it uses: no ROS is here."""

import re
import shutil
import subprocess
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest

from neuralgaits.control import Pd
from neuralgaits.export import build, output_folder
from neuralgaits.export.board_source import board_files
from neuralgaits.export.monitor_source import monitor_files
from neuralgaits.export.reference import Reference
from neuralgaits.export.ros2_source import package_name, ros2_files
from neuralgaits.export.selftest import selftest_file
from neuralgaits.export.source import gait_files
from support import monitored
from support.deployments import drawn, plain
from support.designs import commanded_design, design_for

pytestmark = pytest.mark.skipif(shutil.which("g++") is None, reason="g++ is not installed")
STRICT = ("-std=c++17", "-O0", "-Wall", "-Wextra", "-Werror", "-pedantic")


def _files(design) -> dict[str, str]:
    controller = output_folder.shipped() | gait_files(design) | board_files(design)
    controller |= monitor_files(design)
    controller["gait_selftest.h"] = selftest_file(design, Reference(design))
    return ros2_files(design, controller)


def _package(folder, made, seed: int):
    """Write a package for hardware that differs from the robot file in everything."""
    design = replace(made, deployment=drawn(made.robot, seed))
    for name, text in _files(design).items():
        (folder / name).write_text(text)
    return design, folder


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    """Design and folder of a package."""
    return _package(tmp_path_factory.mktemp("ros2"), design_for("amber3m", {"pd": Pd()}), 4)


def _built(folder, here, *flags: str):
    """Compile the plugin and its driver, as the package's own list of sources says."""
    cmake = (folder / "CMakeLists.txt").read_text()
    (listed,) = re.findall(r"add_library\(\S+ SHARED\s(.*?)\)", cmake, re.DOTALL)
    sources = listed.split()
    objects = []
    for name in (one for one in sources if one.endswith(".c")):
        objects.append(folder / f"{name}.o")
        command = ["gcc", *build.STRICT, "-O1", "-c", str(folder / name), "-o", str(objects[-1])]
        subprocess.run(command, check=True)
    plugins = [str(folder / one) for one in sources if one.endswith(".cpp")]
    include = ["-I", str(folder), "-I", str(here / "ros2_stubs")]
    command = ["g++", *STRICT, *flags, *include, *plugins, str(here / "ros2_main.cpp")]
    subprocess.run([*command, *map(str, objects), "-o", str(folder / "driver")], check=True)
    return folder / "driver"


@pytest.fixture(scope="module")
def driver(package, request):
    """The driver, against interfaces as ros2_control first had them."""
    return _built(package[1], request.path.parent)


@pytest.fixture(scope="module", params=["monitor", "commands"])
def further(tmp_path_factory, request):
    """The driver of a gait with a monitor or commands, against later interfaces."""
    if request.param == "monitor":
        made = monitored.made_up()[2]
    else:
        made = commanded_design("amber3m", {"pd": Pd()})
    _, folder = _package(tmp_path_factory.mktemp(request.param), made, 6)
    return request.param, _built(folder, request.path.parent, "-DSTUB_OF_LATER_RELEASE")


def _said(driver, word: str) -> tuple[dict[str, str], str]:
    done = subprocess.run([str(driver), word], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    rows = (line.split(" ", 1) for line in done.stdout.splitlines() if " " in line)
    return {key: value for key, value in rows if key != "value"}, done.stdout + done.stderr


def _share(found: dict[str, str]) -> float:
    """The largest difference as a share of the torque limit; the pitch goes by a quaternion."""
    return float(found["worst"]) / 41.0


@pytest.mark.slow
@pytest.mark.parametrize("word", ["estimated", "measured", "estimated impedance"])
def test_it_gives_the_torques_of_the_controller_in_c(driver, word):
    found, everything = _said(driver, word)
    assert int(found["ticks"]) == 2000
    assert _share(found) <= 1e-12 < 1e-3 < float(found["largest"])
    assert int(found["touchdowns"]) > 3
    # It publishes nothing before the first tick, then what the tick said.
    assert found["silent"] == "0"
    assert "status 0 walking" in everything and "value fault: no fault" in everything


@pytest.mark.slow
def test_monitor_and_commands_go_along(further):
    kind, program = further
    found, everything = _said(program, "measured")
    assert int(found["ticks"]) == 2000 and _share(found) <= 1e-12
    if kind == "monitor":
        assert "value level 2 inside: " in everything and "value proof sha256: " in everything
        assert "walking, outside of a proved set" in everything


@pytest.mark.slow
@pytest.mark.parametrize("word", ["estimated", "estimated impedance"])
def test_after_a_fault_it_returns_error_and_lets_go(driver, word):
    found, everything = _said(driver, word)
    assert found["refused"] == "1" and float(found["held"]) == 0.0
    # Drives with a loop of their own damp until the controller is deactivated.
    assert found["damping"] == str(int("impedance" in word))
    assert float(found["after"]) == 0.0
    assert "status 2 a reading is NaN or infinite" in everything


@pytest.mark.slow
def test_bad_parameters_are_named_in_one_line(driver):
    _, said = _said(driver, "bad")
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
        _, said = _said(driver, word)
        assert said.count("\n") == 1 and part in said


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


def test_the_yaml_has_every_parameter(package):
    import yaml

    design, folder = package
    given = yaml.safe_load((folder / "controllers.yaml").read_text())
    parameters = given["gait_controller"]["ros__parameters"]
    code = (folder / "gait_controller.cpp").read_text()
    # ROS 2 reads no empty list, so this one stands in a comment.
    assert "# base_velocity: [" in (folder / "controllers.yaml").read_text()
    declared = re.findall(r'auto_declare<[^(]*>\(\s*"(\w+)"', code)
    assert {*parameters, "base_velocity"} == set(declared)
    manager = given["controller_manager"]["ros__parameters"]
    assert manager["update_rate"] == 1000
    by_motor = {one.motor: one.joint for one in design.deployment.joints}
    assert parameters["joints"] == [by_motor.get(i, "") for i in range(max(by_motor) + 1)]


def test_a_robot_of_any_name_makes_a_package(package):
    design, _ = package
    robot = replace(design.robot, name='My Robot "2"</name>')
    odd = replace(design, robot=robot, deployment=plain(design.robot))
    files = ros2_files(odd, {})
    assert package_name(odd) == "neuralgaits_my_robot_2_name"
    ElementTree.fromstring(files["package.xml"])
    ElementTree.fromstring(files["plugin.xml"])
    assert np.all([ord(c) < 128 for c in files["ros2_facts.h"]])
