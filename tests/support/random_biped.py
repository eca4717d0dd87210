"""Random planar bipeds as MJCF text, written as awkwardly as the format allows.

The two legs are equal as mechanisms but not as text: frames are tilted and shifted, joint axes
point either way, gears have either sign, a foot may be a body of its own. Centres of mass lie
off the links' lines. What the loader makes of it must not depend on any of that.
"""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class LegDesign:
    """One leg's numbers, lowest link first, joint ranges as angles of upper minus lower link."""

    length: np.ndarray
    mass: np.ndarray
    inertia: np.ndarray
    com: np.ndarray
    armature: np.ndarray
    damping: np.ndarray
    limit: np.ndarray
    ranges: np.ndarray
    radius: float
    foot_mass: float


def random_biped(seed: int, leg_links: int, *, torso: bool) -> str:
    """MJCF of a random biped with `leg_links` links a leg, with or without a torso."""
    return _Writer(np.random.default_rng(seed), leg_links, torso).document()


def catalogue(count: int) -> dict[str, str]:
    """`count` random bipeds by name, cycling through 2, 4, 6 and 1, 3, 5 actuators."""
    kinds = [(1, True), (2, True), (3, True), (1, False), (2, False), (3, False)]
    texts = {}
    for seed in range(count):
        links, torso = kinds[seed % len(kinds)]
        actuators = 2 * links if torso else 2 * links - 1
        texts[f"random{seed}-{actuators}"] = random_biped(seed, links, torso=torso)
    return texts


def _rotate(vector: complex, angle: float) -> complex:
    return vector * np.exp(1j * angle)


class _Writer:
    def __init__(self, rng: np.random.Generator, leg_links: int, torso: bool) -> None:
        self.rng, self.k, self.torso = rng, leg_links, torso
        k = leg_links
        ranges = np.stack([rng.uniform(-1.5, -0.5, k), rng.uniform(0.5, 1.5, k)], axis=1)
        if not torso:
            ranges[-1] = [-1.1, 1.1]
        self.leg = LegDesign(
            length=rng.uniform(0.2, 0.6, k),
            mass=rng.uniform(0.3, 5.0, k),
            inertia=rng.uniform(0.005, 0.1, k),
            com=rng.uniform(0.05, 0.3, k) + 1j * rng.uniform(-0.05, 0.05, k),
            armature=rng.uniform(0.0, 0.5, k),
            damping=rng.uniform(0.0, 0.5, k),
            limit=rng.uniform(20.0, 90.0, k),
            ranges=ranges,
            radius=float(rng.uniform(0.002, 0.01)),
            foot_mass=float(rng.uniform(0.05, 0.3)),
        )
        self.motors: list[str] = []

    def document(self) -> str:
        body = self.torso_body() if self.torso else self.leg_body(0, self.k - 1, 0j, 0.0, None)
        order = self.rng.permutation(len(self.motors))
        motors = "\n".join(self.motors[i] for i in order)
        return f"""<mujoco><compiler angle="radian"/>
<option gravity="0 0 -{self.rng.uniform(1.6, 9.81):.17g}"/>
<worldbody><geom type="plane" size="0 0 0.1" friction="0.3"/>
{body}</worldbody>
<actuator>{motors}</actuator></mujoco>"""

    def root_joints(self) -> str:
        sign = self.rng.choice([-1, 1])
        return f"""<joint name="x" type="slide" axis="1 0 0"/>
<joint name="z" type="slide" axis="0 0 1" ref="{self.rng.uniform(0, 1):.17g}"/>
<joint name="pitch" axis="0 {sign} 0" pos="{self.vector(self.shift())}"/>"""

    def torso_body(self) -> str:
        rng = self.rng
        com = complex(rng.uniform(-0.1, 0.1), rng.uniform(0.1, 0.4))
        hip = self.shift()
        legs = "".join(self.leg_body(leg, self.k - 1, hip, 0.0, 0.0) for leg in (0, 1))
        return f"""<body name="torso" pos="{self.vector(self.shift())}">{self.root_joints()}
{self.inertial(hip + com, rng.uniform(2, 20), rng.uniform(0.05, 1.0))}{legs}</body>"""

    def leg_body(
        self, leg: int, link: int, anchor: complex, parent_tilt: float, parent_angle: float | None
    ) -> str:
        """A link whose upper joint is at `anchor` in the parent's frame, and all below it.

        Tilts and angles are counter-clockwise and absolute at zero coordinates.
        """
        rng, design = self.rng, self.leg
        angle = float(rng.uniform(-0.5, 0.5))
        is_root = parent_angle is None
        tilt = 0.0 if is_root else float(rng.uniform(-3.0, 3.0))
        shift = self.shift()
        along = _rotate(1j, angle - tilt)
        upper = -shift
        lower = upper - along * design.length[link]
        joints = (
            self.root_joints() if is_root else self.joint(leg, link, upper, parent_angle, angle)
        )
        inertial = self.inertial(
            lower + along * design.com[link], design.mass[link], design.inertia[link]
        )
        if link > 0:
            below = self.leg_body(leg, link - 1, lower, tilt, angle)
        else:
            below = self.foot(leg, lower)
        if is_root:
            below += self.leg_body(1, self.k - 1, upper, tilt, angle)
        position = anchor + _rotate(shift, tilt - parent_tilt)
        return f"""<body name="link{link}_{leg}" pos="{self.vector(position)}"
euler="0 {parent_tilt - tilt:.17g} 0">{joints}{inertial}{below}</body>
"""

    def joint(self, leg: int, link: int, at: complex, parent: float, angle: float) -> str:
        rng, design = self.rng, self.leg
        sign = rng.choice([-1, 1])
        low, high = sorted(sign * (design.ranges[link] - (parent - angle)))
        name = f"joint{link}_{leg}"
        gear = rng.choice([-1, 1]) * rng.uniform(0.5, 100.0)
        limit = design.limit[link]
        kind = rng.choice(["ctrlrange", "forcerange"])
        bound = limit / abs(gear)
        self.motors.append(
            f'<motor name="{name}" joint="{name}" gear="{gear:.17g}" '
            f'{kind}="{-bound:.17g} {bound:.17g}"/>'
        )
        return f"""<joint name="{name}" axis="0 {sign} 0" pos="{self.vector(at)}"
armature="{design.armature[link]:.17g}" damping="{design.damping[link]:.17g}"
range="{low:.17g} {high:.17g}"/>"""

    def foot(self, leg: int, at: complex) -> str:
        """The foot sphere on a welded body of its own with a little mass."""
        offset = self.shift()
        mass = self.leg.foot_mass
        tilt = float(self.rng.uniform(-3.0, 3.0))
        local = _rotate(-offset, -tilt)
        return f"""<body pos="{self.vector(at + offset)}" euler="0 {-tilt:.17g} 0">
{self.inertial(local, mass, 0.001)}<geom name="foot_{leg}" type="sphere" friction="0.7"
size="{self.leg.radius:.17g}" pos="{self.vector(local)}"/></body>"""

    def inertial(self, at: complex, mass: float, inertia: float) -> str:
        # Any out-of-plane inertia does, so long as a rigid body can have it.
        wide = inertia * self.rng.uniform(0.6, 1.4)
        return (
            f'<inertial pos="{self.vector(at)}" mass="{mass:.17g}" '
            f'diaginertia="{wide:.17g} {inertia:.17g} {wide:.17g}"/>\n'
        )

    def shift(self) -> complex:
        return complex(*self.rng.uniform(-0.1, 0.1, 2))

    def vector(self, at: complex) -> str:
        return f"{at.real:.17g} {self.rng.uniform(-0.1, 0.1):.17g} {at.imag:.17g}"
