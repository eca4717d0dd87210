"""Random planar bipeds as robot files: proportions within those of people and of small robots."""

import numpy as np

KINDS = ((2, True), (3, True), (2, False), (2, True), (3, False))
"""Links of a leg, and whether there is a torso, in turn."""


def random_robot(seed: int) -> str:
    """MJCF of a biped of 3 to 60 kg with legs of 0.4 to 1.2 m, random masses, inertias and limits.

    Three of five have two links a leg and a torso or none, two have three; every other one
    has no rotors to speak of.
    """
    rng = np.random.default_rng(seed)
    links, torso = KINDS[seed % len(KINDS)]
    mass, leg = float(np.exp(rng.uniform(np.log(3.0), np.log(60.0)))), rng.uniform(0.4, 1.2)
    shares = rng.uniform(0.45, 0.55, links)
    lengths = leg * shares / np.sum(shares)  # From the hip down.
    masses = rng.uniform(0.05, 0.15, links) * np.linspace(1.0, 0.5, links) * mass
    trunk = mass - 2.0 * float(np.sum(masses))
    if not torso:
        masses, trunk = masses * 0.5 * mass / np.sum(masses), 0.0
    centres = rng.uniform(0.35, 0.65, links) * lengths
    inertias = rng.uniform(0.8, 1.3, links) * masses * (0.29 * lengths) ** 2
    armature = rng.uniform(0.005, 0.03) * mass * leg**2 if seed % 2 else 0.0
    torque = rng.uniform(0.4, 0.7) * mass * 9.81 * leg
    rotor = f' armature="{armature}"' if armature else ""

    def inertial(height: float, body_mass: float, value: float) -> str:
        return (
            f'<inertial pos="0 0 {height}" mass="{body_mass}" '
            f'diaginertia="{value} {value} {0.5 * value}"/>'
        )

    def one_leg(side: str, inside: str = "") -> str:
        """A leg from its top link down; `inside` stands in the top link, for its joints."""
        text = (
            f'<geom name="foot_{side}" type="sphere" size="0.003" pos="0 0 {-lengths[-1]}" '
            'friction="0.6" solref="0.002 1" priority="1" contype="0" conaffinity="1"/>'
        )
        for i in range(links - 1, -1, -1):
            place = -lengths[i - 1] if i else 0.0
            bend = "-1.6 1.6" if i == 0 else "0 1.5"
            joint = f'<joint name="joint{i}_{side}" axis="0 1 0" range="{bend}"{rotor}/>'
            text = (
                f'<body name="link{i}_{side}" pos="0 0 {place}">{inside if i == 0 else ""}'
                f"{'' if i == 0 and inside else joint}"
                f"{inertial(-centres[i], masses[i], inertias[i])}{text}</body>"
            )
        return text

    root = (
        '<joint name="x" type="slide" axis="1 0 0"/><joint name="z" type="slide" axis="0 0 1"/>'
        '<joint name="pitch" axis="0 1 0"/>'
    )
    names = [f"joint{i}_{side}" for side in "lr" for i in range(links)]
    if torso:
        above = rng.uniform(0.2, 0.35) * leg
        own = inertial(above, trunk, trunk * (0.15 * leg) ** 2)
        body = f'<body name="torso" pos="0 0 {leg}">{root}{own}{one_leg("l")}{one_leg("r")}</body>'
    else:
        # One hip joint between the legs: the first is the root.
        names.remove("joint0_l")
        body = one_leg("l", root + one_leg("r"))
    motors = "".join(
        f'<motor name="{n}" joint="{n}" forcerange="{-torque} {torque}"/>' for n in names
    )
    return f"""<mujoco model="random{seed}">
  <compiler angle="radian"/>
  <worldbody>
    <geom name="floor" type="plane" size="0 0 1" contype="1" conaffinity="0"/>
    {body}
  </worldbody>
  <actuator>{motors}</actuator>
</mujoco>"""
