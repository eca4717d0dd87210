"""Structures of `c/walk.h` for one robot: ctypes for shared data, NumPy for records.

Sizes are compared with the library's own when it is loaded, so the two cannot drift apart.
"""

import ctypes
from ctypes import POINTER, Structure, c_char_p, c_double, c_int, c_uint32, c_void_p
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

_Fields = list[tuple[str, Any]]


class StructLayout(NamedTuple):
    """Types of the C structures for one robot."""

    scene: type[Structure]
    """Type of the C structure `ng_scene`."""
    walk: type[Structure]
    """Type of the C structure `ng_walk`."""
    law: type[Structure]
    """Type of the C structure `ng_law`."""
    record: np.dtype
    """Type of the C structure `ng_record`."""


def _structure(name: str, fields: _Fields) -> type[Structure]:
    return type(name, (Structure,), {"_fields_": fields})


def _reals(*names: str) -> _Fields:
    return [(name, c_double) for name in names]


def _told(commands: int) -> _Fields:
    """Return the fields of a walk's coming commands."""
    return [
        ("orders", c_void_p),
        ("orders_used", c_int),
        ("seen", c_void_p),
        ("seen_rows", c_int),
        ("told", c_double * commands),
    ]


@lru_cache
def layout_of(leg_joints: int, actuated: int, commands: int = 0, step: int = 0) -> StructLayout:
    """Return the types of a robot and a gait.

    Args:
        leg_joints: number of joints of a leg.
        actuated: number of actuated joints of both legs.
        commands: number of the gait's commands.
        step: how many numbers the gait computes once a step.
    """
    m, n = actuated, actuated + 1
    by_leg, pair, of_joints = c_double * leg_joints * 2, c_double * 2, c_double * m
    places, told = c_int * leg_joints * 2, c_double * commands
    law = _structure(
        "ng_law",
        [
            ("name", c_char_p),
            ("stiffness", of_joints),
            ("damping", of_joints),
            ("model", c_int),
            ("bandwidth", c_double),
            ("hold_ticks", c_int),
            ("measure_z2", c_int),
            ("uses_impact_consistent_rates", c_int),
            ("apply_limits", c_void_p),
            ("own", c_void_p),
        ],
    )
    clf_qp = _structure(
        "ng_clf_qp",
        _reals("bandwidth", "price", "contact_price", "friction", "least_normal"),
    )
    config = _structure(
        "ng_config",
        [
            ("law", POINTER(law)),
            ("torque_limit", of_joints),
            *_reals("torque_rate", "blend_s", "hold_stiffness", "hold_damping", "largest_pitch"),
            *_reals("angle_margin", "largest_rate", "largest_speed", "largest_force"),
            *_reals("contact_force", "airborne_s"),
            ("gap_us", c_uint32),
        ],
    )
    held = _structure("ng_desired", [(name, of_joints) for name in ("y", "dy", "slope", "drift")])
    state = _structure(
        "ng_state",
        [
            ("leg", c_int),
            ("since_touchdown", c_double),
            ("ticks_to_policy", c_int),
            ("held", held),
            ("running", c_int),
            ("last_us", c_uint32),
            ("elapsed", c_double),
            ("posture", by_leg),
            ("torque", by_leg),
            ("airborne", c_double),
            ("fault", c_int),
            *((name, told) for name in ("requested", "before", "after") if commands),
            *([("step", c_double * step)] if commands else []),
        ],
    )
    measurement = _structure(
        "ng_measurement",
        [
            ("time_us", c_uint32),
            *_reals("pitch", "dpitch"),
            *((name, by_leg) for name in ("angles", "rates")),
            *((name, pair) for name in ("hip_velocity", "normal_force")),
        ],
    )
    estimator = _structure(
        "ng_estimator",
        [("started", c_int), ("estimate", measurement), ("accelerations", by_leg)],
    )
    scene = _structure(
        "ng_scene",
        [
            ("model", c_void_p),
            ("step", c_void_p),
            ("root", c_int * 3),
            ("joints", places),
            ("motors", places),
            *_reals("pitch_sign", "root_angle"),
            ("root_to_hip", pair),
            ("root_origin", pair),
            ("joint_sign", by_leg),
            ("joint_offset", by_leg),
            ("gear", by_leg),
            *_reals("angle_noise", "rate_noise", "pitch_noise", "pitch_offset"),
            ("estimator", c_int),
            ("encoder_step", c_double),
            ("delay_ticks", c_int),
            ("substeps", c_int),
            ("slope", c_double),
            ("uneven", c_int),
            ("told_height", c_int),
            ("room_under_foot", c_double),
            *((name, c_int) for name in ("course", "stones", "told_length", "told_slope")),
            *_reals("gap_depth", "foot_radius", "push_force", "push_s"),
            ("push_after", c_int),
            ("steps", c_int),
            *_reals("lowest_hip", "largest_pitch", "patience_s"),
            ("start_up_steps", c_int),
            ("settling_s", c_double),
            ("law", law),
            ("clf_qp", clf_qp),
            ("config", config),
        ],
    )
    extremes = _structure(
        "ng_extremes",
        _reals("output_error", "settled_torque", "torque", "joint_rate", "normal_force"),
    )
    milestone = _structure("ng_milestone", _reals("time", "hip", "energy"))
    walk = _structure(
        "ng_walk",
        [
            ("controller", state),
            ("estimator", estimator),
            ("time_us", c_uint32),
            *_reals("age", "clock"),
            ("touch", pair),
            ("floor", pair),
            ("feet", pair * 2),
            ("rises", c_void_p),
            ("rises_used", c_int),
            ("rise_pending", c_int),
            *_reals("next_rise", "push_start", "push_wait"),
            ("late", c_void_p),
            ("believed", c_void_p),
            ("speed_error", c_double),
            ("strides", c_void_p),
            ("strides_used", c_int),
            *(_told(commands) if commands else []),
            *((name, c_int) for name in ("ticks", "steps", "saturated")),
            ("relaxed", c_int * 2),
            *((name, c_int) for name in ("ending", "plant_steps")),
            *_reals("energy", "peak_torque"),
            ("first", milestone),
            ("last", milestone),
            ("steady", extremes),
            ("running", extremes),
        ],
    )
    shapes: list[tuple[str, tuple[int, ...]]] = [
        ("time", ()),
        ("torque", (2, leg_joints)),
        ("actuated", (m,)),
        *((name, (n,)) for name in ("q", "dq")),
        *((name, (m,)) for name in ("y_d", "dy_d")),
        ("z", (2,)),
        *((name, ()) for name in ("leg", "since_touchdown", "touchdown", "saturated")),
        ("relaxed", (2,)),
        *((name, ()) for name in ("pitch", "dpitch")),
        *((name, (2, leg_joints)) for name in ("angles", "rates")),
        *((name, (2,)) for name in ("hip_velocity", "normal_force", "floor")),
        ("clearance", ()),
        ("feet", (2, 2)),
        *([("told", (2, commands))] if commands else []),
    ]
    record = np.dtype([(name, np.float64, shape) for name, shape in shapes])
    return StructLayout(scene, walk, law, record)


def pointer(array: np.ndarray | None) -> c_void_p:
    """Return the address of an array's first element; null without one."""
    return c_void_p(None) if array is None else c_void_p(array.ctypes.data)


def address(function: Any) -> int:
    """Return the address of a function of a loaded library."""
    value = ctypes.cast(function, c_void_p).value
    assert value is not None
    return value
