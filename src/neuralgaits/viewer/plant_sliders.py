"""Sliders of a live page for what a plant is, with their folder, and for what a gait is told."""

import math
from collections.abc import Callable, Mapping

import viser

from neuralgaits.gait.commands import LEAN, SLOPE, Command
from neuralgaits.viewer.limited_sliders import LimitedSliders
from neuralgaits.viewer.slider import Slider

HEARD = "heard at the next touchdown; large changes take several steps"
"""What the sliders of commands say to whoever points at them."""
AHEAD = "torso_shift_m"
"""Name of the disturbance that moves the torso's weight forward."""
MILLIMETRE = 1e-3
"""One millimetre [m]."""


def plant_sliders(friction: float, torque: float) -> dict[str, Slider]:
    """Return sliders by disturbance, well beyond what gaits tolerate.

    Args:
        friction: coefficient of the robot's file.
        torque: its largest torque limit [N m].
    """
    tilt = "uphill positive; the floor turns about the stance foot"
    slide = "sliding coefficient between feet and floor"
    heavy = "factor on all masses and inertias; the controller is not told"
    weak = "limit of every joint; the controller knows it"
    return {
        "slope_deg": Slider("slope [deg]", -6.0, 6.0, 0.0, 0.5, tilt),
        "friction": Slider("friction", 0.05, max(1.2, friction), friction, 0.01, slide),
        "mass_scale": Slider("mass ×", 0.5, 2.0, 1.0, 0.01, heavy),
        "torque_limit": Slider("torque limit [N\u00a0m]", 0.1 * torque, torque, torque, 0.5, weak),
        AHEAD: torso_slider("ahead"),
    }


def torso_slider(way: str) -> Slider:
    """Return the slider of the torso's weight; `way` is in which direction it moves."""
    hint = f"centre of mass {way} of the file's; the controller is not told"
    return Slider(f"torso's weight {way} [mm]", -50.0, 50.0, 0.0, 1.0, hint, MILLIMETRE)


def add_plant_sliders(
    gui: viser.GuiApi,
    sliders: LimitedSliders,
    settings: Mapping[str, Slider],
    disturb: Callable[[str, float], None],
) -> None:
    """Add a folder with sliders by disturbance, and a button that puts them back.

    Args:
        gui: GUI of the page.
        sliders: sliders of the page.
        settings: sliders by disturbance.
        disturb: changes one of them, in the disturbance's unit.
    """
    restore = []
    with gui.add_folder("Robot and floor"):
        for name, slider in settings.items():
            handle = sliders.add(slider)

            def change(_event: object, name=name, handle=handle, slider=slider):
                value = slider.clip(handle.value)
                if value is not None:
                    disturb(name, value * slider.unit)

            handle.on_update(change)
            restore.append((handle, slider, change))
        usual = gui.add_button("Restore robot and floor", icon=viser.Icon.RESTORE)

    @usual.on_click
    def _(event: object) -> None:
        for handle, slider, change in restore:
            handle.value = slider.first
            change(event)


def command_slider(command: Command) -> Slider:
    """Return the slider of a command: slopes in degrees, leans in millimetres."""
    units = {SLOPE: ("deg", math.radians(1.0)), LEAN: ("mm", MILLIMETRE)}
    word, unit = units.get(command.name, (command.unit, 1.0))
    low, high = command.low / unit, command.high / unit
    return Slider(f"{command.name} [{word}]", low, high, 0.5 * (low + high), unit=unit)
