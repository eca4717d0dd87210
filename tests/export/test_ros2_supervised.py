"""The ROS 2 package with the supervisor: requests by a parameter, ticks as those of the C."""

import shutil
from dataclasses import replace

import pytest

from neuralgaits.control import Pd
from support import monitored
from support.designs import design_for
from support.ros2_package import built, package_of, report_of

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(shutil.which("g++") is None, reason="g++ is not installed"),
]


@pytest.fixture(scope="module", params=["plain", "monitored"])
def driver(tmp_path_factory, request):
    """The driver; of the gait with a monitor against later interfaces."""
    if request.param == "plain":
        made, flags = design_for("amber3m", {"pd": Pd()}), ()
    else:
        made, flags = monitored.made_up()[2], ("-DSTUB_OF_LATER_RELEASE",)
    folder = tmp_path_factory.mktemp(request.param)
    _, folder = package_of(folder, replace(made, supervised=True), 5)
    return built(folder, request.path.parent, *flags, main="ros2_supervised_main.cpp")


@pytest.mark.parametrize("word", ["effort", "impedance"])
def test_it_does_what_the_supervisor_in_c_does(driver, word):
    found, everything = report_of(driver, word)
    # A broken sensor is a fault: joints damp, and the plugin stays active.
    assert (found["ok"], found["faults"]) == ("1", "1")
    assert float(found["worst"]) / 41.0 <= 1e-12 < 1e-3 < float(found["largest"])
    assert float(found["beyond"]) < 1e-9
    assert min(map(int, found["modes"].split(","))) > 100
    for line in ("value mode: walk", "value mode: stand", "value mode: damp"):
        assert line in everything
    assert "value reason of the last change: a fault" in everything
    assert "status 2 a reading is NaN or infinite" in everything


def test_requests_are_words_and_activation_begins_with_damping(driver):
    found, _ = report_of(driver, "effort")
    assert found["refused"] == "0 request: expected damp, stand or walk, found 'run'"
    assert found["number"] == "0"
    assert float(found["after"]) == 0.0
    assert (found["again"], found["later"]) == ("0", "1")


def test_a_word_that_is_no_request_is_refused_at_configuration(driver):
    _, said = report_of(driver, "bad")
    assert said.count("\n") == 1
    assert "request: expected damp, stand or walk, found 'sit'" in said
