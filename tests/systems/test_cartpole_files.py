"""Files of cart-poles: which are read, and what is said of others, all of it at once."""

import pytest

from neuralgaits.cli.main import main
from neuralgaits.errors import RobotError
from neuralgaits.robots import registry
from neuralgaits.systems.cartpole.mjcf import cartpole_text, is_cartpole, read_cartpole

PLAIN, _ = cartpole_text("cartpole")
GYMNASIUM = """<mujoco model="inverted pendulum">
  <compiler inertiafromgeom="true"/>
  <default><joint armature="0" damping="1" limited="true"/></default>
  <option gravity="0 0 -9.81" integrator="RK4" timestep="0.02"/>
  <worldbody>
    <body name="cart" pos="0 0 0">
      <joint axis="1 0 0" limited="true" name="slider" range="-1 1" type="slide"/>
      <geom type="capsule" size="0.1 0.1" quat="0.707 0 0.707 0"/>
      <body name="pole" pos="0 0 0">
        <joint axis="0 1 0" name="hinge" range="-90 90" type="hinge"/>
        <geom fromto="0 0 0 0.001 0 0.6" size="0.049 0.3" type="capsule"/>
      </body>
    </body>
  </worldbody>
  <actuator><motor ctrllimited="true" ctrlrange="-3 3" gear="100" joint="slider"/></actuator>
</mujoco>"""
"""A file like Gymnasium's InvertedPendulum: angles in degrees, a pole that leans at zero."""
FAULTS = {
    "no rail": ('range="-1.8 1.8" ', "", "joint slider has no range"),
    "no limit": ('ctrlrange="-1 1"', "", "motor drive has no limit"),
    "motor on the pole": ('joint="slider"', 'joint="hinge"', "acts on the pole (hinge)"),
    "two motors": ("</actuator>", '<motor joint="slider" ctrlrange="-1 1"/></actuator>', "found 2"),
    "a servo": ("<motor name", "<position name", "is no plain motor"),
    "dry friction": ('damping="5e-4"', 'frictionloss="0.1"', "frictionloss"),
    "a spring": ('damping="2e-6"', 'stiffness="1"', "stiffness"),
    "a slope": ('axis="1 0 0"', 'axis="1 0 0.1"', "is not level"),
    "a hinge along the rail": ('axis="0 1 0"', 'axis="1 0 0"', "out of the rail's plane"),
    "air": ("timestep", 'density="1.2" timestep', "air or water"),
    "a negative mass": ('mass="1"', 'mass="-1"', "expected 0 or more; mend that number"),
    "no gravity": ("0 0 -9.81", "0 0 0", "gravity is zero"),
    "a second pole": ("</body>", '<body><joint/><geom size="1"/></body></body>', "two joints"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_file_that_is_none_is_refused_with_the_reason(name):
    old, new, said = FAULTS[name]
    assert old in PLAIN
    with pytest.raises(RobotError) as caught:
        read_cartpole(PLAIN.replace(old, new, 1), name)
    assert said in str(caught.value)


def test_all_problems_are_told_at_once():
    text, names = PLAIN, ("no rail", "no limit", "dry friction")
    for name in names:
        text = text.replace(*FAULTS[name][:2])
    with pytest.raises(RobotError) as caught:
        read_cartpole(text, "odd")
    assert all(FAULTS[name][2] in str(caught.value) for name in names)


def test_a_file_like_gymnasiums_is_read():
    robot, data = read_cartpole(GYMNASIUM, "x")
    assert robot.name == "inverted pendulum"
    assert robot.force_limit == 300.0
    # Its pole leans by 1/600 rad at zero, and its joint has a quarter turn on either side of that.
    assert data.upright == pytest.approx(-0.001 / 0.6, rel=1e-3)
    assert robot.lean < data.lean + 1e-12 < 1.5708


def test_a_walker_is_none(tmp_path):
    walker = tmp_path / "walker.xml"
    walker.write_text(registry.model_file("rabbit").read_text(encoding="utf-8"), encoding="utf-8")
    own = tmp_path / "own.xml"
    own.write_text(GYMNASIUM, encoding="utf-8")
    assert is_cartpole("cartpole") and is_cartpole(own)
    assert not is_cartpole(walker) and not is_cartpole("rabbit")


def test_the_command_line_shows_a_file_or_its_fault_in_one_line(tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    assert main(["robots", "cartpole", "--out", "own.xml"]) == 0
    assert main(["inspect", "own.xml"]) == 0
    assert "up to 10 N on the cart" in capfd.readouterr().out
    text = PLAIN.replace(*FAULTS["no limit"][:2])
    (tmp_path / "own.xml").write_text(text, encoding="utf-8")
    assert main(["train", "own.xml"]) == 2
    err = capfd.readouterr().err
    assert "motor drive has no limit" in err
    assert err.count("\n") == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["own.xml"]
