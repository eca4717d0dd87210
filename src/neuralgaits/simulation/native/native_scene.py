"""Constants of a simulation for compiled walks: `ng_scene` of `c/walk.h`."""

import ctypes
from typing import Any

import numpy as np

from neuralgaits.control import AbstractLaw, ClfQp, Controller
from neuralgaits.control.law import CompiledLaw, compiled_law
from neuralgaits.control.scheduled_pd import GainSchedule
from neuralgaits.errors import InputError
from neuralgaits.export.schedule_tables import TABLES, schedule_fields
from neuralgaits.gait.commands import place_of
from neuralgaits.simulation.native.compiled_walk import Library
from neuralgaits.simulation.native.struct_layout import StructLayout
from neuralgaits.simulation.setup.plant import Plant
from neuralgaits.simulation.setup.push import DURATION_S, Push
from neuralgaits.simulation.setup.uneven_floor import ROOM_UNDER_FOOT
from neuralgaits.simulation.ticks.falls import HIP_SHARE, STALL, TORSO_RAD
from neuralgaits.simulation.ticks.gauge import SETTLING_S, START_UP_STEPS


def knows(law: AbstractLaw) -> bool:
    """Return whether compiled controllers have this law."""
    return compiled_law(law) is not None


def scene_of(
    library: Library,
    plant: Plant,
    controller: Controller,
    steps: int,
    push: Push,
) -> Any:
    """Return `ng_scene` of a plant and a controller."""
    state_map = plant.state_map
    layout = plant.state_map.layout
    robot = controller.robot
    types, disturbance = library.layout, plant.disturbance
    leg_length = float(np.sum(robot.hip))
    scene = types.scene()
    scene.model, scene.step = plant.model._address, library.mj_step
    for name, values in (
        ("root", state_map.root),
        ("joints", state_map.joints),
        ("motors", state_map.actuators),
        ("root_to_hip", layout.root_to_hip),
        ("root_origin", layout.root_origin),
        ("joint_sign", layout.leg_joint_signs),
        ("joint_offset", layout.leg_joint_offsets),
        ("gear", layout.gears),
    ):
        _fill(getattr(scene, name), values)
    scene.pitch_sign, scene.root_angle = layout.pitch_sign, layout.root_angle
    scene.angle_noise, scene.rate_noise = disturbance.encoder_noise, disturbance.rate_noise
    scene.pitch_noise, scene.pitch_offset = disturbance.noise_of_pitch, disturbance.pitch_offset
    scene.estimator = int(disturbance.estimator)
    scene.encoder_step = disturbance.encoder_step
    scene.delay_ticks, scene.substeps = plant.delay_ticks, plant.substeps
    scene.drive_stiffness = disturbance.drive_stiffness
    scene.drive_damping = disturbance.drive_damping
    scene.slope, scene.room_under_foot = plant.slope, ROOM_UNDER_FOOT
    scene.foot_radius = float(plant.robot.foot_radius)
    _set_ground(scene, plant, controller)
    scene.push_force, scene.push_s, scene.push_after = push.force, DURATION_S, push.steps_before
    scene.steps = min(steps, np.iinfo(np.int32).max)
    scene.lowest_hip = HIP_SHARE * leg_length
    scene.largest_pitch = np.inf if robot.torso is None else TORSO_RAD
    scene.patience_s = STALL * float(np.sqrt(leg_length / robot.gravity))
    scene.start_up_steps, scene.settling_s = START_UP_STEPS, SETTLING_S
    form = _set_law(scene.law, controller.law)
    if isinstance(controller.law, ClfQp):
        _set_program(library, scene, controller)
    if form.schedule is not None:
        _set_schedule(types.schedule(), scene, form.schedule)
    _set_config(scene, types, controller)
    return scene


def _set_ground(scene: Any, plant: Plant, controller: Controller) -> None:
    """Set the blocks, if there are any, and mark the commands that the ground gives."""
    course = plant.course
    scene.gap_depth = np.inf if course is None else course.gap_depth
    scene.course, scene.stones = int(course is not None), int(course is not None and course.stones)
    for name in ("length", "height", "slope"):
        command = name if name == "slope" else f"step_{name}"
        at = place_of(controller.policy.commands, command)
        setattr(scene, f"told_{name}", 0 if at is None else at + 1)


def _set_law(law: Any, source: AbstractLaw) -> CompiledLaw:
    form = compiled_law(source)
    if form is None:
        raise InputError(f"expected a law of this package, found {type(source).__name__}")
    law.name = b""
    law.hold_ticks = int(source.hold_ticks)
    law.bandwidth = float(form.bandwidth)
    law.model, law.measure_z2 = int(form.model), int(form.measure_z2)
    law.uses_impact_consistent_rates = int(source.uses_impact_consistent_rates)
    _fill(law.stiffness, form.stiffness)
    _fill(law.damping, form.damping)
    return form


def _set_program(library: Library, scene: Any, controller: Controller) -> None:
    """Set the quadratic program of a law that has one in place of clipping."""
    law, program = controller.law, scene.clf_qp
    for name in ("bandwidth", "price", "contact_price", "least_normal"):
        setattr(program, name, float(getattr(law, name)))
    program.friction = float(controller.robot.friction)
    scene.law.apply_limits = library.clf_qp
    scene.law.own = ctypes.addressof(scene) + library.layout.scene.clf_qp.offset


def _set_schedule(into: Any, scene: Any, schedule: GainSchedule) -> None:
    """Set the tables of a gain schedule, which live as long as the scene."""
    fields = schedule_fields(schedule)
    for name, value in fields.items():
        if name in TABLES:
            setattr(into, name, value.ctypes.data)
        elif value.ndim:
            _fill(getattr(into, name), value.tolist())
        else:
            setattr(into, name, float(value))
    scene.law.schedule = ctypes.addressof(into)
    scene.tables = into, fields


def _set_config(scene: Any, types: StructLayout, controller: Controller) -> None:
    """Set the robot's own limits and no others: a simulation shows the law by itself."""
    config = scene.config
    config.law = ctypes.addressof(scene) + types.scene.law.offset
    _fill(config.torque_limit, controller.torque_limit)
    for name in ("torque_rate", "largest_pitch", "angle_margin", "largest_rate", "largest_speed"):
        setattr(config, name, np.inf)
    config.largest_force = config.airborne_s = np.inf
    config.gap_us = 0xFFFFFFFF  # The largest that fits.


def _fill(array: Any, values: Any) -> None:
    """Copy numbers of any nesting into a ctypes array."""
    for at, value in enumerate(values):
        if isinstance(array[at], ctypes.Array):
            _fill(array[at], value)
        else:
            array[at] = value
