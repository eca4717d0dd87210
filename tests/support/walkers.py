"""Walkers of two well-known suites, written out small: their structure, and their numbers."""

_W2D_LEG = """
  <body name="thigh{s}" pos="0 0 -0.2">
    <joint name="thigh{s}_joint" axis="0 -1 0" range="-150 0"/>
    <geom name="thigh{s}_geom" type="capsule" size="0.05 0.225" pos="0 0 -0.225" friction="0.9"/>
    <body name="leg{s}" pos="0 0 -0.7">
      <joint name="leg{s}_joint" pos="0 0 0.25" axis="0 -1 0" range="-150 0"/>
      <geom name="leg{s}_geom" type="capsule" size="0.04 0.25" friction="0.9"/>
      <body name="foot{s}" pos="0.2 0 -0.35">
        <joint name="foot{s}_joint" pos="-0.2 0 0.1" axis="0 -1 0" range="-45 45"/>
        {foot}
      </body>
    </body>
  </body>"""
CAPSULE = (
    '<geom name="foot{s}_geom" type="capsule" size="0.06 0.1" pos="-0.1 0 0.1" '
    'quat="1 0 -1 0" friction="{friction}"/>'
)
BOX = '<geom type="box" size="0.12 0.05 0.03" pos="-0.1 0 0.07" friction="{friction}"/>'
HEEL_AND_TOE = (
    '<geom type="sphere" size="0.03" pos="-0.25 0 0.07" friction="{friction}"/>'
    '<geom type="sphere" size="0.03" pos="0 0 0.07" friction="{friction}"/>'
)


def walker2d(foot: str = CAPSULE, frictions: tuple[float, float] = (1.9, 1.9)) -> str:
    """Gymnasium's Walker2d: unnamed motors, no posture in which a thigh is ahead of the torso.

    Args:
        foot: geoms of a foot.
        frictions: of the right and the left one, which differ in the file of version 4.
    """
    legs = "".join(
        _W2D_LEG.replace("{foot}", foot).format(s=side, friction=friction)
        for side, friction in zip(("", "_left"), frictions, strict=True)
    )
    motors = "".join(
        f'<motor joint="{name}{side}_joint" gear="100" ctrllimited="true" ctrlrange="-1 1"/>\n'
        for side in ("", "_left")
        for name in ("thigh", "leg", "foot")
    )
    return f"""<!-- a robot -->
<mujoco model="walker2d">
  <compiler angle="degree" inertiafromgeom="true"/>
  <default>
    <joint armature="0.01" damping="0.1" limited="true"/>
    <geom conaffinity="0" contype="1" condim="3" density="1000" friction="0.7 0.1 0.1"/>
  </default>
  <option integrator="RK4" timestep="0.002"/>
  <worldbody>
    <geom name="floor" type="plane" size="40 40 40" conaffinity="1"/>
    <body name="torso" pos="0 0 1.25">
      <joint name="rootx" type="slide" axis="1 0 0" pos="0 0 -1.25" armature="0" damping="0"
             limited="false"/>
      <joint name="rootz" type="slide" axis="0 0 1" pos="0 0 -1.25" armature="0" damping="0"
             limited="false" ref="1.25"/>
      <joint name="rooty" axis="0 1 0" armature="0" damping="0" limited="false"/>
      <geom name="torso_geom" type="capsule" size="0.05 0.2" friction="0.9"/>{legs}
    </body>
  </worldbody>
  <actuator>
    {motors}
  </actuator>
</mujoco>
"""


_DM_LEG = """
  <body name="{s}_thigh" pos="0 {y} -0.3">
    <joint name="{s}_hip" range="-20 100"/>
    <geom name="{s}_thigh" pos="0 0 -0.225" size="0.05 0.225"/>
    <body name="{s}_leg" pos="0 0 -0.7">
      <joint name="{s}_knee" pos="0 0 0.25" range="-150 0"/>
      <geom name="{s}_leg" size="0.04 0.25"/>
      <body name="{s}_foot" pos="0.06 0 -0.25">
        <joint name="{s}_ankle" pos="-0.06 0 0" range="-45 45"/>
        <geom name="{s}_foot" zaxis="1 0 0" size="0.05 0.1"/>
      </body>
    </body>
  </body>"""


def dm_walker(include: str = "") -> str:
    """The planar walker of dm_control: classes of defaults, an include, a sensor of the torso.

    Args:
        include: file to include.
    """
    legs = "".join(_DM_LEG.format(s=s, y=y) for s, y in (("right", -0.05), ("left", 0.05)))
    motors = "".join(
        f'<motor name="{side}_{joint}" joint="{side}_{joint}" gear="{gear}"/>\n'
        for side in ("right", "left")
        for joint, gear in (("hip", 100), ("knee", 50), ("ankle", 20))
    )
    return f"""<mujoco model="planar walker">
  {f'<include file="{include}"/>' if include else ""}
  <option timestep="0.0025"/>
  <default>
    <joint damping="0.1" armature="0.01" limited="true" solimplimit="0 0.99 0.01"/>
    <geom contype="1" conaffinity="0" friction="0.7 0.1 0.1"/>
    <motor ctrlrange="-1 1" ctrllimited="true"/>
    <default class="walker"><geom type="capsule"/><joint axis="0 -1 0"/></default>
  </default>
  <worldbody>
    <geom name="floor" type="plane" conaffinity="1" pos="248 0 0" size="250 0.8 0.2"/>
    <body name="torso" pos="0 0 1.3" childclass="walker">
      <joint name="rootz" type="slide" axis="0 0 1" limited="false" armature="0" damping="0"/>
      <joint name="rootx" type="slide" axis="1 0 0" limited="false" armature="0" damping="0"/>
      <joint name="rooty" type="hinge" axis="0 1 0" limited="false" armature="0" damping="0"/>
      <geom name="torso" size="0.07 0.3"/>{legs}
    </body>
  </worldbody>
  <sensor><subtreelinvel name="torso_subtreelinvel" body="torso"/></sensor>
  <actuator>
    {motors}
  </actuator>
</mujoco>
"""
