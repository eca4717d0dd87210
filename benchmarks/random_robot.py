"""Random bipeds of human proportions as robot files."""

import numpy as np


def random_robot(seed: int) -> str:
    """MJCF of a five-link biped with random masses, lengths, inertias, rotors and limits."""
    rng = np.random.default_rng(seed)
    mass, leg = rng.uniform(15.0, 60.0), rng.uniform(0.6, 1.0)
    thigh = rng.uniform(0.45, 0.55) * leg
    shin = leg - thigh
    thigh_mass, shin_mass = rng.uniform(0.08, 0.16) * mass, rng.uniform(0.03, 0.08) * mass
    torso_mass = mass - 2.0 * (thigh_mass + shin_mass)
    torso_com = rng.uniform(0.2, 0.35) * leg
    thigh_com, shin_com = rng.uniform(0.35, 0.65, 2) * (thigh, shin)
    lengths, spread = np.array([0.5 * leg, thigh, shin]), rng.uniform(0.8, 1.3, 3)
    inertia = spread * np.array([torso_mass, thigh_mass, shin_mass]) * (0.29 * lengths) ** 2
    armature = rng.uniform(0.005, 0.03) * mass * leg**2
    torque = rng.uniform(0.3, 0.6) * mass * 9.81 * leg

    def inertial(below: float, body_mass: float, value: float) -> str:
        return (
            f'<inertial pos="0 0 {below}" mass="{body_mass}" '
            f'diaginertia="{value} {value} {0.5 * value}"/>'
        )

    def one_leg(side: str) -> str:
        foot = f'<geom name="foot_{side}" type="sphere" size="0.003" pos="0 0 {-shin}"'
        return f"""
      <body name="thigh_{side}">
        <joint name="hip_{side}" axis="0 1 0" range="-1.6 1.6" armature="{armature}"/>
        {inertial(-thigh_com, thigh_mass, inertia[1])}
        <body name="shin_{side}" pos="0 0 {-thigh}">
          <joint name="knee_{side}" axis="0 1 0" range="0 1.5" armature="{armature}"/>
          {inertial(-shin_com, shin_mass, inertia[2])}
          {foot} friction="0.6" solref="0.002 1" priority="1" contype="0" conaffinity="1"/>
        </body>
      </body>"""

    def motor(name: str) -> str:
        return f'<motor name="{name}" joint="{name}" forcerange="{-torque} {torque}"/>'

    motors = "".join(motor(f"{joint}_{side}") for side in "lr" for joint in ("hip", "knee"))
    return f"""<mujoco model="random{seed}">
  <compiler angle="radian"/>
  <worldbody>
    <geom name="floor" type="plane" size="0 0 1" contype="1" conaffinity="0"/>
    <body name="torso" pos="0 0 {leg}">
      <joint name="x" type="slide" axis="1 0 0"/>
      <joint name="z" type="slide" axis="0 0 1"/>
      <joint name="pitch" axis="0 1 0"/>
      {inertial(torso_com, torso_mass, inertia[0])}{one_leg("l")}{one_leg("r")}
    </body>
  </worldbody>
  <actuator>{motors}</actuator>
</mujoco>"""
