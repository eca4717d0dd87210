"""What a person reads of walks and tubes in three dimensions."""

import re
from types import SimpleNamespace
from typing import Any

from neuralgaits.systems.walker3d.spatial_screens import screen_of_walks
from neuralgaits.systems.walker3d.spatial_system import SYSTEM
from neuralgaits.systems.walker3d.spatial_walks import SpatialWalks

WALKS = SpatialWalks(
    run="runs/walker3d/a",
    robot="walker3d",
    controller="pd",
    episodes=2,
    steps=50,
    walked=2,
    least_steps=50,
    speed_m_s=0.66,
    largest_error_rad=0.004,
    rms_error_rad=0.001,
    largest_torque_nm=192.0,
    in_tube=0.9987,
    clamped=0.0125,
    heading_rad=None,
    push_ns=None,
    push_left_ns=None,
    disturb={},
    sensing="perfect",
    wall_s=1.0,
)


def test_shares_have_a_space_before_their_sign():
    tube: Any = SimpleNamespace(
        speed_m_s=0.66, step_m=0.239, inlet_m=0.0111, inlet_momenta=(0.041, 0.045)
    )
    facts = dict(screen_of_walks(WALKS).facts)
    words = " ".join([*facts.values(), SYSTEM.sizes(tube)])
    assert facts["torque"] == "up to 192 N m asked, 1.25 % cut"
    assert len(re.findall(r"\d %", words)) == words.count("%") == 4


def test_walks_end_with_the_next_command():
    name, line = screen_of_walks(WALKS).facts[-1]
    assert (name, line) == ("next", "neuralgaits report runs/walker3d/a")
