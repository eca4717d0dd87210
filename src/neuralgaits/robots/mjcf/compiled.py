"""Compilation of MJCF text by MuJoCo, whatever the robot."""

import mujoco

from neuralgaits.errors import RobotError
from neuralgaits.robots.mjcf.counts import refuse_large_counts
from neuralgaits.robots.mjcf.physical_numbers import refuse_negative_mass


def compile_text(text: str, name: str) -> mujoco.MjModel:
    """Compile MJCF text.

    Raises: RobotError with MuJoCo's reason, warnings included, and the remedy.
    """
    refuse_large_counts(text)
    refuse_negative_mass(text)
    warnings: list[str] = []
    # Unasked, MuJoCo prints its warnings, and logs them to a file in the caller's folder.
    mujoco.set_mju_user_warning(warnings.append)
    try:
        model = mujoco.MjModel.from_xml_string(text)
        if warnings:
            raise ValueError("; ".join(warnings))
        return model
    except (ValueError, RuntimeError, MemoryError, mujoco.FatalError) as error:
        reason = " ".join(str(error).split())
        remedy = "mend the file"
        if "opening file" in reason:
            remedy = "put that file there, or remove what names it from the robot file"
        if "mass and inertia" in reason:
            remedy = "give that body an <inertial>, or geoms with mass"
        raise RobotError(f"MuJoCo cannot compile robot {name} ({reason}): {remedy}") from None
    finally:
        mujoco.set_mju_user_warning(None)
