"""Robot files as strangers have them, written out small: humanoids, URDFs, planar robots with arms.

Structure and sizes are like those of public models; no file of theirs is copied.
"""

from support import walkers

_INERTIA = '<inertia ixx="{0}" iyy="{0}" izz="{0}" ixy="0" ixz="0" iyz="0"/>'


def link(name, mass, inertia, com=(0, 0, 0), shape=""):
    """A link of a URDF."""
    if not mass:
        return f'<link name="{name}">{shape}</link>'
    place = " ".join(map(str, com))
    return (
        f'<link name="{name}"><inertial><origin xyz="{place}"/><mass value="{mass}"/>'
        f"{_INERTIA.format(inertia)}</inertial>{shape}</link>"
    )


def joint(name, kind, parent, child, place=(0, 0, 0), axis=(0, 1, 0), limit=None, more=""):
    """A joint of a URDF; a limit is (lower, upper, effort)."""
    ends = ""
    if limit is not None:
        ends = '<limit lower="{}" upper="{}" effort="{}" velocity="10"/>'.format(*limit)
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{" ".join(map(str, place))}"/><axis xyz="{" ".join(map(str, axis))}"/>'
        f"{ends}{more}</joint>"
    )


def urdf(name, *parts):
    """A URDF of links and joints."""
    return f'<robot name="{name}">{"".join(parts)}</robot>'


def shape(geometry, place=(0, 0, 0), kind="collision"):
    """A collision or visual of a link."""
    xyz = " ".join(map(str, place))
    return f'<{kind}><origin xyz="{xyz}"/><geometry>{geometry}</geometry></{kind}>'


MESH = shape('<mesh filename="package://robot/meshes/{}.stl"/>', kind="visual")


def rabbit_urdf(base="floating"):
    """A five-link walker; base is floating, none, or chain (massless carriages of slides)."""
    legs = [
        part
        for side in ("left", "right")
        for part in (
            link(f"thigh_{side}", 6.8, 0.47, (0, 0, -0.11), MESH.format("thigh")),
            link(f"shin_{side}", 3.2, 0.2, (0, 0, -0.24)),
            link(f"tip_{side}", 0, 0, shape=shape('<sphere radius="0.01"/>')),
            joint(f"hip_{side}", "revolute", "torso", f"thigh_{side}", limit=(-1.5, 1.5, 150)),
            joint(
                f"knee_{side}",
                "revolute",
                f"thigh_{side}",
                f"shin_{side}",
                (0, 0, -0.4),
                limit=(0.0, 2.0, 150),
                more='<dynamics damping="0.1" friction="0"/>',
            ),
            joint(f"end_{side}", "fixed", f"shin_{side}", f"tip_{side}", (0, 0, -0.4)),
        )
    ]
    torso = link("torso", 12, 1.33, (0, 0, 0.24), shape('<box size="0.1 0.2 0.5"/>', (0, 0, 0.3)))
    if base == "none":
        return urdf("rabbit_like", torso, *legs)
    if base == "floating":
        root = (link("world", 0, 0), joint("base", "floating", "world", "torso"))
        return urdf("rabbit_like", *root, torso, *legs)
    chain = (
        link("world", 0, 0),
        link("rail_x", 0, 0),
        link("rail_z", 0, 0),
        joint("base_x", "prismatic", "world", "rail_x", axis=(1, 0, 0), limit=(-10, 10, 0)),
        joint("base_z", "prismatic", "rail_x", "rail_z", axis=(0, 0, 1), limit=(-10, 10, 0)),
        joint("base_pitch", "continuous", "rail_z", "torso"),
    )
    return urdf("rabbit_like", *chain, torso, *legs)


def bolt_urdf():
    """A point-foot biped in space: hip abduction, hip and knee; feet are frames without shapes."""
    parts = [link("base_link", 0.61, 0.0058, (0, 0, 0.05), MESH.format("base"))]
    for side, y in (("FL", 0.0637), ("FR", -0.0637)):
        parts += [
            link(f"{side}_SHOULDER", 0.14, 0.0001, (0, 0.1 * y, 0)),
            link(f"{side}_UPPER_LEG", 0.15, 0.0004, (0, y * 0.2, -0.08)),
            link(f"{side}_LOWER_LEG", 0.05, 0.0002, (0, y * 0.1, -0.1)),
            link(f"{side}_ANKLE", 0.01, 1e-6),
            link(f"{side}_FOOT", 0, 0),
            joint(
                f"{side}_HAA",
                "revolute",
                "base_link",
                f"{side}_SHOULDER",
                (0, y, 0),
                (1, 0, 0),
                (-1, 1, 2.5),
            ),
            joint(
                f"{side}_HFE",
                "revolute",
                f"{side}_SHOULDER",
                f"{side}_UPPER_LEG",
                (0, 0.01, 0),
                limit=(-1.4, 1.4, 2.5),
            ),
            joint(
                f"{side}_KFE",
                "revolute",
                f"{side}_UPPER_LEG",
                f"{side}_LOWER_LEG",
                (0, 0, -0.2),
                limit=(-0.3, 2.4, 2.5),
            ),
            joint(f"{side}_fix", "fixed", f"{side}_LOWER_LEG", f"{side}_ANKLE", (0, 0.008, -0.2)),
            joint(f"{side}_end", "fixed", f"{side}_ANKLE", f"{side}_FOOT", (0, 0, -0.016)),
        ]
    return urdf("bolt_like", *parts)


def humanoid_urdf(meshes=False):
    """A humanoid with yaw, roll and pitch hips, knees, ankles of two axes, waist and arms.

    Args:
        meshes: whether every shape is a mesh that is not there, but for the feet's.
    """
    parts = [link("pelvis", 6, 0.06), link("torso", 14, 0.2, (0, 0, 0.2))]
    parts.append(
        joint("waist_yaw", "revolute", "pelvis", "torso", (0, 0, 0.1), (0, 0, 1), (-2, 2, 80))
    )
    foot = shape('<box size="0.2 0.06 0.03"/>', (0.03, 0, -0.045))
    for side, s in (("left", 1), ("right", -1)):
        picture = MESH.format(side) if meshes else ""
        names = [
            f"{side}_{part}"
            for part in ("hip_pitch", "hip_roll", "hip_yaw", "knee", "ankle_pitch", "ankle_roll")
        ]
        above = ["pelvis", *names[:-1]]
        axes = [(0, 1, 0), (1, 0, 0), (0, 0, 1), (0, 1, 0), (0, 1, 0), (1, 0, 0)]
        places = [
            (0, 0.06 * s, -0.1),
            (0, 0.05 * s, -0.03),
            (0, 0, -0.12),
            (0, 0, -0.18),
            (0, 0, -0.3),
            (0, 0, -0.017),
        ]
        masses = [1.35, 1.5, 1.7, 1.9, 0.07, 0.6]
        inertias = [0.002, 0.002, 0.006, 0.012, 0.0001, 0.0016]
        lows = [-2.5, -0.5, -2.7, -0.087, -0.87, -0.26]
        highs = [2.8, 2.9, 2.7, 2.88, 0.52, 0.26]
        efforts = [88, 88, 88, 139, 50, 50]
        for i, name in enumerate(names):
            com = (0.003, 0.004 * s, -0.06 if i in (2, 3) else -0.01)
            parts.append(
                link(f"{name}_link", masses[i], inertias[i], com, foot if i == 5 else picture)
            )
            parent = above[i] if i == 0 else f"{above[i]}_link"
            limit = (lows[i], highs[i], efforts[i])
            parts.append(
                joint(
                    f"{name}_joint", "revolute", parent, f"{name}_link", places[i], axes[i], limit
                )
            )
        arm = [f"{side}_shoulder", f"{side}_elbow"]
        parts += [
            link(f"{arm[0]}_link", 1.5, 0.01, (0, 0, -0.1)),
            link(f"{arm[1]}_link", 1.0, 0.005, (0, 0, -0.1)),
            joint(
                f"{arm[0]}_joint",
                "revolute",
                "torso",
                f"{arm[0]}_link",
                (0, 0.2 * s, 0.3),
                limit=(-3, 2, 25),
            ),
            joint(
                f"{arm[1]}_joint",
                "revolute",
                f"{arm[0]}_link",
                f"{arm[1]}_link",
                (0, 0, -0.2),
                limit=(-1, 2, 25),
            ),
        ]
    return urdf("humanoid_like", *parts)


_H1_LEG = """
<body name="{s}_hip_yaw_link" pos="0 {y} -0.1742">
  <inertial pos="-0.0492 {y1} 0.0072" mass="2.244" diaginertia="0.0030 0.0026 0.0024"/>
  <joint name="{s}_hip_yaw" axis="0 0 1" range="-0.43 0.43"/>
  <body name="{s}_hip_roll_link" pos="0.0395 0 0">
    <inertial pos="-0.0058 {y2} -0.0063" mass="2.232" diaginertia="0.0020 0.0019 0.0021"/>
    <joint name="{s}_hip_roll" axis="1 0 0" range="-0.43 0.43"/>
    <body name="{s}_hip_pitch_link" pos="0 {y3} 0">
      <inertial pos="0.0075 {y2} -0.0819" mass="4.152" diaginertia="0.0829 0.0821 0.0052"/>
      <joint name="{s}_hip_pitch" axis="0 1 0" range="-1.57 1.57"/>
      <geom class="visual" type="capsule" fromto="0 0 0 0 0 -0.4" size="0.05"/>
      <body name="{s}_knee_link" pos="0 0 -0.4">
        <inertial pos="-0.0014 {y4} -0.1384" mass="1.721" diaginertia="0.0125 0.0123 0.0019"/>
        <joint name="{s}_knee" axis="0 1 0" range="-0.26 2.05"/>
        <body name="{s}_ankle_link" pos="0 0 -0.4">
          <inertial pos="0.0672 {y4} -0.045" mass="0.446" diaginertia="0.0022 0.0022 0.0003"/>
          <joint name="{s}_ankle" axis="0 1 0" range="-0.87 0.52"/>
          {foot}
        </body>
      </body>
    </body>
  </body>
</body>"""
_H1_ARM = """
<body name="{s}_shoulder_pitch_link" pos="0.0055 {y} 0.43">
  <inertial pos="0.005 {y4} 0.005" mass="1.033" diaginertia="0.0013 0.0011 0.0011"/>
  <joint name="{s}_shoulder_pitch" axis="0 1 0" range="-2.87 2.87"/>
  <body name="{s}_elbow_link" pos="0 {y4} -0.3">
    <inertial pos="0.1 0 -0.02" mass="0.8" diaginertia="0.002 0.002 0.002"/>
    <joint name="{s}_elbow" axis="0 1 0" range="-1.25 2.61"/>
  </body>
</body>"""
_H1_FEET = {
    "capsules": "".join(
        f'<geom class="foot" type="capsule" fromto="-0.03 {{{y}}} -0.05 0.14 {{{y}}} -0.05" '
        'size="0.02"/>'
        for y in ("y5", "y6")
    ),
    "spheres": "".join(
        f'<geom class="foot" type="sphere" pos="{x} {{{y}}} -0.065" size="0.005"/>'
        for x in (-0.035, 0.15)
        for y in ("y5", "y6")
    ),
    "box": '<geom class="foot" type="box" pos="0.055 0 -0.06" size="0.1 0.03 0.01"/>',
}


def humanoid(feet="capsules", actuator="motor", asymmetry=0.0, key=""):
    """A humanoid as in a catalogue of MJCF files, like an H1.

    Args:
        feet: key of its shapes of feet.
        actuator: motor, position (servos with force ranges), or both.
        asymmetry: relative difference of the knees' masses.
        key: of a <key>, "" for none.
    """
    limits = {"hip_yaw": 200, "hip_roll": 200, "hip_pitch": 200, "knee": 300, "ankle": 40}
    limits |= {"shoulder_pitch": 40, "elbow": 18}
    bodies, motors = [], []
    for side, s in (("left", 1), ("right", -1)):
        y = {"y": 0.0875 * s, "y1": 0.0001 * s, "y2": -0.005 * s, "y3": 0.11536 * s, "y4": 0.02 * s}
        y |= {"y5": 0.02, "y6": -0.02, "s": side}
        leg = _H1_LEG.replace("{foot}", _H1_FEET[feet]).format(**y)
        if s < 0:
            leg = leg.replace('mass="1.721"', f'mass="{1.721 * (1 + asymmetry)}"')
        bodies += [leg, _H1_ARM.format(**(y | {"y": 0.155 * s}))]
        for name, limit in limits.items():
            servo = (
                f'<position name="{side}_{name}_servo" joint="{side}_{name}" kp="100" '
                f'forcerange="-{limit} {limit}"/>'
            )
            motor = (
                f'<motor name="{side}_{name}" joint="{side}_{name}" ctrlrange="-{limit} {limit}"/>'
            )
            motors += {"motor": [motor], "position": [servo], "both": [servo, motor]}[actuator]
    return f"""<mujoco model="humanoid_like">
    <compiler angle="radian" autolimits="true"/>
    <default><joint damping="1" armature="0.1"/><geom contype="0" conaffinity="0" mass="0"/>
    <default class="visual"><geom rgba="0.3 0.3 0.3 1"/></default>
    <default class="foot"><geom contype="1" conaffinity="1" friction="0.8"/></default></default>
    <worldbody><geom name="floor" type="plane" size="0 0 0.1" contype="1" conaffinity="1"/>
    <body name="pelvis" pos="0 0 1.06"><freejoint name="floating_base"/>
    <inertial pos="-0.0002 0 -0.0452" mass="5.39" diaginertia="0.049 0.041 0.038"/>
    <body name="torso"><inertial pos="0.0005 0.0028 0.2" mass="17.8" diaginertia="0.49 0.41 0.13"/>
    <joint name="waist" axis="0 0 1" range="-2.35 2.35"/>{bodies[1]}{bodies[3]}</body>
    {bodies[0]}{bodies[2]}</body></worldbody>
    <actuator>{"".join(motors)}</actuator>
    <sensor><gyro site="imu"/></sensor>{key}</mujoco>""".replace(
        '<freejoint name="floating_base"/>', '<freejoint name="floating_base"/><site name="imu"/>'
    )


def adam(servos=True, excludes=True, arms=True, chain=False):
    """A planar biped with arms, three actuators a joint and excludes, like a laboratory's own.

    Args:
        servos: whether a position and a velocity actuator stand beside each motor.
        excludes: whether bodies are excluded from contact.
        arms: whether there are arms with motors.
        chain: whether the root's joints belong to three bodies.
    """
    legs, motors = [], []
    for side, y in (("left", 0.1), ("right", -0.1)):
        legs.append(f"""
        <body name="{side}_thigh" pos="0 {y} 0">
          <joint name="{side}_hip" axis="0 1 0" range="-1.5 1.5" armature="0.08"/>
          <inertial pos="0 0 -0.1" mass="1.8" diaginertia="0.02 0.02 0.005"/>
          <geom type="capsule" fromto="0 0 0 0 0 -0.25" size="0.03" contype="0" conaffinity="0"/>
          <body name="{side}_shin" pos="0 0 -0.25">
            <joint name="{side}_knee" axis="0 1 0" range="0 2.2" armature="0.08"/>
            <inertial pos="0 0 -0.1" mass="0.8" diaginertia="0.008 0.008 0.001"/>
            <geom name="{side}_foot" type="sphere" size="0.01" pos="0 0 -0.25" friction="0.7"/>
          </body>
        </body>""")
        names = [f"{side}_hip", f"{side}_knee"]
        if arms:
            legs.append(f"""
            <body name="{side}_arm" pos="0 {1.5 * y} 0.3">
              <joint name="{side}_shoulder" axis="0 1 0" range="-2 2"/>
              <inertial pos="0 0 -0.12" mass="0.4" diaginertia="0.003 0.003 0.0005"/>
            </body>""")
            names.append(f"{side}_shoulder")
        for name in names:
            motors.append(f'<motor name="{name}" joint="{name}" ctrlrange="-40 40"/>')
            if servos:
                motors.append(f'<position name="{name}_p" joint="{name}" kp="50"/>')
                motors.append(f'<velocity name="{name}_v" joint="{name}" kv="2"/>')
    contact = '<contact><exclude body1="torso" body2="left_thigh"/></contact>' if excludes else ""
    torso = f"""<inertial pos="0 0 0.15" mass="6" diaginertia="0.1 0.1 0.05"/>
        <geom type="box" size="0.05 0.1 0.15" pos="0 0 0.15" contype="0" conaffinity="0" mass="0"/>
        {"".join(legs)}"""
    x, z, pitch = (
        '<joint name="slide_x" type="slide" axis="1 0 0"/>',
        '<joint name="slide_z" type="slide" axis="0 0 1"/>',
        '<joint name="pitch" axis="0 1 0"/>',
    )
    little = '<inertial pos="0 0 0" mass="0.001" diaginertia="1e-6 1e-6 1e-6"/>'
    root = f'<body name="torso" pos="0 0 0.6">{x}{z}{pitch}{torso}</body>'
    if chain:
        root = (
            f'<body name="rail" pos="0 0 0.6">{x}{little}<body name="lift">{z}{little}'
            f'<body name="torso">{pitch}{torso}</body></body></body>'
        )
    return f"""<mujoco model="adam_like"><compiler angle="radian" autolimits="true"/>
    <worldbody><geom name="floor" type="plane" size="0 0 0.1"/>{root}</worldbody>
    {contact}<actuator>{"".join(motors)}</actuator></mujoco>"""


def quadruped_urdf():
    """Four legs of two joints."""
    parts = [link("trunk", 8, 0.1)]
    for name, x, y in (("FL", 0.2, 0.1), ("FR", 0.2, -0.1), ("RL", -0.2, 0.1), ("RR", -0.2, -0.1)):
        parts += [
            link(f"{name}_thigh", 1, 0.01, (0, 0, -0.1)),
            link(
                f"{name}_calf",
                0.3,
                0.002,
                (0, 0, -0.1),
                shape('<sphere radius="0.02"/>', (0, 0, -0.2)),
            ),
            joint(
                f"{name}_hip", "revolute", "trunk", f"{name}_thigh", (x, y, 0), limit=(-1, 1, 30)
            ),
            joint(
                f"{name}_knee",
                "revolute",
                f"{name}_thigh",
                f"{name}_calf",
                (0, 0, -0.2),
                limit=(-2, 0, 30),
            ),
        ]
    return urdf("quadruped", *parts)


def compass_urdf():
    """Two legs with knees that hang from each other, without a torso."""
    parts = []
    for side in ("a", "b"):
        foot = shape('<sphere radius="0.01"/>', (0, 0, -0.4))
        parts += [
            link(f"thigh_{side}", 5, 0.08, (0, 0, -0.15)),
            link(f"shin_{side}", 2, 0.03, (0, 0, -0.2), foot),
            joint(
                f"knee_{side}",
                "revolute",
                f"thigh_{side}",
                f"shin_{side}",
                (0, 0, -0.4),
                limit=(0, 2, 100),
            ),
        ]
    hip = joint("hip", "revolute", "thigh_a", "thigh_b", limit=(-1.5, 1.5, 100))
    return urdf("compass_like", *parts, hip)


def long_legs_urdf():
    """Legs of three links, and a head on a neck."""
    parts = [link("trunk", 10, 0.2, (0, 0, 0.2)), link("head", 2, 0.01)]
    parts.append(joint("neck", "revolute", "trunk", "head", (0, 0, 0.5), limit=(-1, 1, 5)))
    for side, y in (("left", 0.1), ("right", -0.1)):
        tip = shape('<cylinder radius="0.015" length="0.2"/>', (0, 0, -0.1))
        above = "trunk"
        for name, mass, length, limit in (
            ("thigh", 3, 0.35, (-1.5, 1.5, 100)),
            ("shin", 1.5, 0.35, (0, 2, 100)),
            ("pastern", 0.5, 0.2, (-1, 1, 60)),
        ):
            own = f"{side}_{name}"
            place = (0, y, 0) if above == "trunk" else (0, 0, -0.35)
            shapes = tip if name == "pastern" else ""
            parts.append(link(own, mass, 0.02, (0, 0, -length / 2), shapes))
            parts.append(joint(f"{own}_joint", "revolute", above, own, place, limit=limit))
            above = own
    return urdf("long_legs", *parts)


def with_hips_in_one_body():
    """The humanoid with yaw, roll and pitch of each hip in one body."""
    text = humanoid()
    for side in ("left", "right"):
        yaw = f'<joint name="{side}_hip_yaw" axis="0 0 1" range="-0.43 0.43"/>'
        roll = f'<joint name="{side}_hip_roll" axis="1 0 0" range="-0.43 0.43"/>'
        pitch = f'<joint name="{side}_hip_pitch" axis="0 1 0" range="-1.57 1.57"/>'
        text = text.replace(yaw, "").replace(roll, "").replace(pitch, yaw + roll + pitch)
    return text


def with_root(joints):
    """The planar biped without arms, with other joints in place of its root's."""
    text = adam(arms=False)
    start, end = text.index('<joint name="slide_x"'), text.index('<inertial pos="0 0 0.15"')
    return text[:start] + joints + text[end:]


def files():
    """Every robot of the benchmark: name of its file, and text."""
    return {
        "adam.xml": adam(),
        "adam-chain.xml": adam(chain=True),
        "adam-no-arms.xml": adam(arms=False),
        "adam-free.xml": with_root("<freejoint/>"),
        "adam-fixed.xml": with_root(""),
        "rabbit-floating.urdf": rabbit_urdf(),
        "rabbit-no-base.urdf": rabbit_urdf("none"),
        "rabbit-chain.urdf": rabbit_urdf("chain"),
        "bolt.urdf": bolt_urdf(),
        "compass.urdf": compass_urdf(),
        "long-legs.urdf": long_legs_urdf(),
        "g1.urdf": humanoid_urdf(),
        "g1-no-meshes.urdf": humanoid_urdf(meshes=True),
        "h1-capsules.xml": humanoid(),
        "h1-spheres.xml": humanoid("spheres"),
        "h1-servos.xml": humanoid("box", "position"),
        "h1-both.xml": humanoid("capsules", "both"),
        "h1-unequal.xml": humanoid(asymmetry=0.003),
        "h1-one-body-hips.xml": with_hips_in_one_body(),
        "walker2d.xml": walkers.walker2d(),
        "dm-walker.xml": walkers.dm_walker(),
    }
