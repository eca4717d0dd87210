"""The robot files that come with the package hold the published numbers."""

from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest

from neuralgaits.robots import PlanarBiped, built_in, describe, load_robot


def test_amber_has_the_published_link_data(amber: PlanarBiped) -> None:
    assert amber.link_names == (
        "stance_shin",
        "stance_thigh",
        "torso",
        "swing_thigh",
        "swing_shin",
    )
    assert amber.joint_names == (
        "stance_shin",
        "stance_knee",
        "stance_hip",
        "swing_hip",
        "swing_knee",
    )
    np.testing.assert_allclose(amber.hip[:2], [0.4667, 0.4064])
    np.testing.assert_allclose(amber.hip_gradient, [-0.8731, -0.4064, 0, 0, 0], atol=1e-15)
    np.testing.assert_allclose(amber.inertia[:3], [0.019286025, 0.0389, 0.194])
    np.testing.assert_allclose(amber.mass, 13.0 + 2 * (3.4261 + 0.85216))
    np.testing.assert_allclose(amber.armature[1:], 91.4286**2 * 5.1e-5, rtol=1e-5)
    np.testing.assert_allclose(amber.torque_limit, 41.0)
    np.testing.assert_allclose(amber.joint_lower, [0.0, -1.6, -1.6, 0.0])
    np.testing.assert_allclose(amber.joint_upper, [1.5, 1.6, 1.6, 1.5])
    assert (float(amber.friction), float(amber.foot_radius)) == (0.6, 0.003)
    assert amber.torso == 2


def test_rabbit_has_the_published_link_data() -> None:
    rabbit = load_robot("rabbit")
    np.testing.assert_allclose(rabbit.mass, 12.0 + 2 * (6.8 + 3.2))
    np.testing.assert_allclose(rabbit.armature[1:], 50.0**2 * 3.32e-4)
    upright = rabbit.centre_of_mass(np.zeros(5))
    height = (12.0 * 1.04 + 2 * 6.8 * 0.69 + 2 * 3.2 * 0.16) / 32.0
    np.testing.assert_allclose(upright, [0.0, height], atol=1e-15)


@pytest.mark.parametrize(
    ("variant", "torso", "armature"),
    [("amber3m-paper", "0 0 0.28507", False), ("amber3m-tail", "-0.03 0 0.21483", True)],
)
def test_variants_differ_from_amber_only_as_they_say(
    variant: str, torso: str, armature: bool
) -> None:
    root = ElementTree.fromstring(load_robot("amber3m").layout.xml)
    root.set("model", variant)
    inertial = root.find(".//body[@name='torso']/inertial")
    assert inertial is not None
    inertial.set("pos", torso)
    if not armature:
        leg = root.find(".//default[@class='leg']")
        assert leg is not None
        leg.remove(leg[0])
    expected = ElementTree.canonicalize(
        ElementTree.tostring(root, encoding="unicode"), strip_text=True
    )
    assert ElementTree.canonicalize(load_robot(variant).layout.xml, strip_text=True) == expected


def test_the_knee_bends_like_a_human_knee(amber: PlanarBiped) -> None:
    """A positive knee angle puts the knee ahead of the line from foot to hip."""
    bent = np.array([-0.3, 0.6, 0.0, 0.0, 0.0])
    knee_x = -0.4667 * np.sin(bent[0])
    hip_x = knee_x - 0.4064 * np.sin(bent[0] + bent[1])
    assert knee_x > max(hip_x, 0.0)


@pytest.mark.parametrize("name", built_in())
def test_files_show_the_robot(name: str) -> None:
    assert describe(name)
    model = mujoco.MjModel.from_xml_string(load_robot(name).layout.xml)
    assert model.ncam and model.nlight
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("home").id)
    mujoco.mj_forward(model, data)
    lowest = min(data.geom(name).xpos[2] for name in load_robot(name).layout.feet)
    assert 0.0 < lowest < 0.06
    assert data.ncon == 0
