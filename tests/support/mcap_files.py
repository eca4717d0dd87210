"""MCAP files as a robot's own software writes them: topics in JSON, or in ROS 2's CDR."""

import io
import json
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from mcap.writer import Writer
from mcap_ros2.writer import Writer as Ros2Writer

Message = tuple[str, int, dict[str, Any]]
"""Topic, time of its logging [ns], content."""
EPOCH_NS = 1_760_000_000_123_456_789
"""A time as clocks of robots have it."""
JOINTS = ("hip_l", "knee_l", "hip_r", "knee_r")
COLUMNS = """\
time = {column = "/joint_states.header.stamp", unit = "ns"}
pitch = {column = "/imu.orientation.pitch", unit = "rad"}
[joints]
hip_left = {column = "/joint_states.position[hip_l]", unit = "deg", sign = -1}
knee_left = {column = "/joint_states.position[knee_l]", unit = "deg", offset = 3.0}
hip_right = {column = "/joint_states.position[hip_r]", unit = "deg", sign = -1, offset = -12.5}
knee_right = {column = "/joint_states.position[knee_r]", unit = "deg"}
[contact]
foot_left = {column = "/feet.data[0]"}
foot_right = {column = "/feet.data[1]"}
"""
"""Columns of `robot_messages`; those of `own_columns` by other names."""
_HEADER = """\
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""
DEFINITIONS = {
    "/joint_states": (
        "sensor_msgs/msg/JointState",
        "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\n"
        f"float64[] effort\n{_HEADER}",
    ),
    "/imu": (
        "sensor_msgs/msg/Imu",
        f"std_msgs/Header header\ngeometry_msgs/Quaternion orientation\n{_HEADER}"
        f"{'=' * 80}\nMSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n",
    ),
    "/feet": ("example_msgs/msg/Feet", "bool[] data\n"),
}


def robot_messages(
    columns: dict[str, np.ndarray], order: tuple[str, ...] = JOINTS
) -> list[Message]:
    """The columns of `own_columns` as messages; joints in some order."""
    found: list[Message] = []
    for k, t_ms in enumerate(columns["t_ms"]):
        now = EPOCH_NS + round(1e6 * float(t_ms))
        header = {"stamp": {"sec": now // 10**9, "nanosec": now % 10**9}, "frame_id": "base"}
        half = 0.5 * np.deg2rad(float(columns["imu_pitch"][k]))
        turn = {"x": 0.0, "y": float(np.sin(half)), "z": 0.0, "w": float(np.cos(half))}
        feet = [bool(columns[name][k]) for name in ("contact_l", "contact_r")]
        joints = {
            "header": header,
            "name": list(order),
            "position": [float(columns[name][k]) for name in order],
            "velocity": [],
            "effort": [],
        }
        found += [
            ("/imu", now, {"header": header, "orientation": turn}),
            ("/feet", now, {"data": feet}),
            ("/joint_states", now, joints),
        ]
    return found


def write_json(
    path: Path, messages: Iterable[Message], unused: Sequence[str] = (), **settings: Any
) -> Path:
    """Write messages in JSON; topics in `unused` have none."""
    out = io.BytesIO()
    writer = Writer(out, **settings)
    writer.start()
    channels = {topic: writer.register_channel(topic, "json", 0) for topic in unused}
    for topic, time, content in messages:
        if topic not in channels:
            channels[topic] = writer.register_channel(topic, "json", 0)
        writer.add_message(channels[topic], time, json.dumps(content).encode(), time)
    writer.finish()
    path.write_bytes(out.getvalue())
    return path


def write_ros2(path: Path, messages: Iterable[Message]) -> Path:
    """Write messages as ROS 2 does."""
    out = io.BytesIO()
    writer = Ros2Writer(out)
    schemas = {topic: writer.register_msgdef(*text) for topic, text in DEFINITIONS.items()}
    for topic, time, content in messages:
        writer.write_message(topic, schemas[topic], content, log_time=time, publish_time=time)
    writer.finish()
    path.write_bytes(out.getvalue())
    return path
