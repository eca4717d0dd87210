"""Load the compiled walk of one robot and one policy; `simulation.native_walk` compiles it."""

import ctypes
from ctypes import CDLL, byref, c_char_p, c_int, c_void_p
from pathlib import Path

import jax
import mujoco
import numpy as np

from neuralgaits.control import Controller
from neuralgaits.simulation.native.struct_layout import StructLayout, address, layout_of


class NativeError(Exception):
    """Raised when compiled code cannot be used; the message can follow the word because."""


class Library:
    """Compiled walk of one robot and one policy.

    Attributes:
        layout: types of its structures.
    """

    def __init__(self, path: Path, controller: Controller):
        """Load the library.

        Args:
            path: path of the file.
            controller: source of the library; its law and torque limits may be exchanged.

        Raises: NativeError if it does not load or was made for something else.
        """
        self._made_for = _constant_parts(controller)
        robot, policy = controller.robot, controller.policy
        self.layout: StructLayout = layout_of(
            robot.n // 2, robot.n - 1, len(policy.commands), policy.step_size
        )
        try:
            library, engine = CDLL(str(path)), CDLL(str(mujoco_library()))
        except OSError as error:
            raise NativeError(f"it does not load ({error})") from None
        self.run = library.ng_walk_run
        self.run.argtypes = [c_void_p, c_void_p, c_void_p, c_int, c_void_p, c_void_p, c_void_p]
        self.tick = library.ng_walk_tick
        self.tick.argtypes = [c_void_p] * 5
        self.start = library.ng_walk_start
        self.start.argtypes = [c_void_p, c_int, c_void_p]
        self.complaint = library.ng_walk_error
        self.complaint.restype = c_char_p
        self.clf_qp = address(library.ng_clf_qp_apply_limits)
        self.mj_step = address(engine.mj_step)
        sizes = (c_int * 3)()
        library.ng_walk_sizes(sizes)
        own = (self.layout.scene, self.layout.walk)
        expected = [*map(ctypes.sizeof, own), self.layout.record.itemsize]
        if list(sizes) != expected:
            raise NativeError(f"its structures take {list(sizes)} bytes, not {expected}")
        library.ng_walk_catch(byref(c_void_p.in_dll(engine, "mju_user_error")))

    def fits(self, controller: Controller) -> bool:
        """Return whether it was written from this controller, apart from law and torque limits."""
        return _equal(self._made_for, _constant_parts(controller))


def _constant_parts(controller: Controller) -> tuple:
    """Return the parts of a controller that its C code has as constants."""
    return (
        controller.robot,
        controller.policy,
        controller.bounds,
        controller.stance,
        controller.period_s,
        controller.reset_residual,
        controller.joints,
    )


def _equal(one: tuple, other: tuple) -> bool:
    """Return whether two trees are equal; arrays are compared outside JAX, to compile nothing."""
    (leaves, form), (other_leaves, other_form) = jax.tree.flatten(one), jax.tree.flatten(other)
    return form == other_form and all(map(np.array_equal, leaves, other_leaves))


def mujoco_library() -> Path:
    """Load MuJoCo's own library from its wheel. Raises: NativeError without it."""
    folder = Path(mujoco.__file__).parent
    libraries = [
        file
        for pattern in ("libmujoco.so*", "libmujoco*.dylib", "mujoco.dll")
        for file in sorted(folder.glob(pattern))
    ]
    if not libraries:
        raise NativeError(f"the library of MuJoCo is not in {folder}")
    return libraries[0]
