"""The law `pd` from tick to tick for one robot: the exported C, or JAX without a C compiler."""

import ctypes
import tempfile
from pathlib import Path
from typing import Any, NamedTuple, Protocol

import jax
import numpy as np

from neuralgaits._cache import cache_folder
from neuralgaits._compiler import Compiler, CompilerError, SharedLibrary
from neuralgaits._quick_jit import quick_jit
from neuralgaits._types import Float
from neuralgaits.gait.commands import CommandLimits
from neuralgaits.systems.controller_export import c_files, controller_program
from neuralgaits.systems.family_run import FamilyRun
from neuralgaits.systems.walker3d.spatial_impact import SIGNS, SWAPPED
from neuralgaits.systems.walker3d.spatial_plant import SpatialPlants
from neuralgaits.systems.walker3d.spatial_walks import LANDING, law_of_gait
from neuralgaits.systems.walker3d.step_commands import following_pair

_SIX, _THREE = 6 * ctypes.c_double, 3 * ctypes.c_double


class TorqueTick(NamedTuple):
    """Torques of a tick, and the state they were computed from.

    Attributes:
        torques: motors' torques, right leg first [N m]; not finite where the gait has no pose. [6]
        z: state of the zero dynamics. [4]
        left: whether the robot stands on its left foot.
        pair: speeds told to the step before and to this one [m/s]; 0 if the gait takes none. [2]
    """

    torques: Float[np.ndarray, "6"]
    z: Float[np.ndarray, "4"]
    left: bool
    pair: Float[np.ndarray, "2"]


class LiveController(Protocol):
    """A controller of one robot, with its memory."""

    def start(self, speed: float | None = None) -> None:
        """Begin a step on the right foot, told this speed all the time [m/s].

        None is for a gait that takes no commands.
        """
        ...

    def tell(self, speed: float) -> None:
        """Request a speed of a gait that takes one [m/s]; touchdowns go to it, a little each."""
        ...

    def tick(self, plants: SpatialPlants) -> TorqueTick:
        """Read the sensors of the only robot. Returns: torques, and where it is."""
        ...


class _Reading(ctypes.Structure):
    """Memory of `ng_walker3d_reading`, field by field as in C."""

    _fields_ = (
        *((name, ctypes.c_double) for name in ("roll", "pitch", "roll_rate", "pitch_rate")),
        ("joints", _SIX),
        ("rates", _SIX),
        ("velocity", _THREE),
        ("velocity_known", ctypes.c_int),
        ("contact", 2 * ctypes.c_int),
    )


class _Memory(ctypes.Structure):
    """Memory of `ng_walker3d`, field by field as in C."""

    _fields_ = (("left", ctypes.c_int), ("phase", ctypes.c_double), ("z", 4 * ctypes.c_double))
    told: Any = (0.0, 0.0)


class _ToldMemory(_Memory):
    """Memory of `ng_walker3d` for a gait that is told its speed."""

    _fields_ = (("requested", ctypes.c_double), ("told", 2 * ctypes.c_double))


class CompiledController:
    """The exported controller, compiled."""

    def __init__(self, library: ctypes.CDLL, *, told: bool):
        """Take the loaded library of `walker3d_tick.c`; `told` says if the gait takes a speed."""
        self._library = library
        self._memory = _ToldMemory() if told else _Memory()
        self._torques = _SIX()
        self.start()

    @classmethod
    def of(cls, run: FamilyRun) -> "CompiledController | None":
        """Compile the controller of a run; None without a compiler that does it."""
        compiler = Compiler.for_c()
        if compiler is None:
            return None
        header = run.system.header(run)
        files = c_files(run, controller_program(run.system, run), header)
        sources = tuple(name for name in files if name.endswith(".c"))
        # A higher level takes twice the time to compile.
        flags = ("-std=c99", "-O1", "-fPIC", "-shared")
        library, told = SharedLibrary("walker3d", files, sources, flags), run.config.command
        try:
            built = compiler.cached(library, cache_folder() / "walker3d")
            return cls(ctypes.CDLL(str(built)), told=told is not None)
        except CompilerError:
            return None
        except OSError:
            with tempfile.TemporaryDirectory(prefix="neuralgaits-") as folder:
                built = compiler.compile(library, Path(folder))
                return cls(ctypes.CDLL(str(built)), told=told is not None)

    def start(self, speed: float | None = None) -> None:
        """Begin a step on the right foot, told this speed all the time [m/s]."""
        memory = ctypes.byref(self._memory)
        if speed is None:
            self._library.ng_walker3d_start(memory, 0)
        else:
            self._library.ng_walker3d_start_at(memory, 0, ctypes.c_double(speed))

    def tell(self, speed: float) -> None:
        """Request a speed of a gait that takes one [m/s]."""
        self._library.ng_walker3d_tell(ctypes.byref(self._memory), ctypes.c_double(speed))

    def tick(self, plants: SpatialPlants) -> TorqueTick:
        """Read the sensors of the only robot. Returns: torques, and where it is."""
        joints, rates, velocity = (rows[0] for rows in plants.readings())
        contact = (2 * ctypes.c_int)(*plants.touching(0))
        legs = _SIX(*joints[2:]), _SIX(*rates[2:])
        reading = _Reading(*joints[:2], *rates[:2], *legs, _THREE(*velocity), 1, contact)
        memory = ctypes.byref(self._memory)
        lost = self._library.ng_walker3d_tick(memory, ctypes.byref(reading), self._torques)
        torques = np.full(6, np.nan) if lost else np.array(self._torques)
        now = self._memory
        return TorqueTick(torques, np.array(now.z), bool(now.left), np.array(now.told))


class TracedController:
    """The controller in JAX: right without a C compiler, and several times slower."""

    def __init__(self, run: FamilyRun):
        """Take the law of a run, which compiles at the first tick."""
        gait = run.controller
        self._law = law_of_gait(run.data, gait, "pd")
        self._place = quick_jit(lambda pair, z: gait.step(pair).policy.phase(z))
        command = run.config.command
        self._limits = None if command is None else CommandLimits.of((command,))
        self.start()

    def start(self, speed: float | None = None) -> None:
        """Begin a step on the right foot, told this speed all the time [m/s]."""
        self._phase, self._left = 0.0, False
        self._requested, self._pair = np.zeros(1), np.zeros(2)
        if self._limits is not None:
            self._requested = self._limits.middle
            if speed is not None:
                self.tell(speed)
            self._pair = np.repeat(self._requested, 2)

    def tell(self, speed: float) -> None:
        """Request a speed of a gait that takes one [m/s]."""
        if self._limits is not None:
            self._requested = np.clip(np.array([speed]), self._limits.low, self._limits.high)

    def tick(self, plants: SpatialPlants) -> TorqueTick:
        """Read the sensors of the only robot. Returns: torques, and where it is."""
        swing = plants.touching(0)[0 if self._left else 1]
        if swing and self._phase > LANDING:
            self._left = not self._left
            if self._limits is not None:
                self._pair = following_pair(self._pair, self._requested, self._limits)
        plants.left[:] = self._left
        demand: Any = jax.tree.map(np.asarray, self._law(plants.measured(), self._pair[None]))
        self._phase = float(self._place(self._pair, demand.z[0]))
        torques = demand.torques[0]
        own = SIGNS[2:] * torques[SWAPPED[2:] - 2] if self._left else torques
        return TorqueTick(own, demand.z[0], self._left, self._pair)


def controller_of(run: FamilyRun) -> LiveController:
    """Return the controller of a run: compiled C, or JAX without a C compiler."""
    return CompiledController.of(run) or TracedController(run)
