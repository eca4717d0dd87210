"""The law `pd` from tick to tick for one robot: the exported C, or JAX without a C compiler."""

import ctypes
import tempfile
from pathlib import Path
from typing import Any, NamedTuple, Protocol

import jax
import numpy as np

from neuralgaits._cache import cache_folder
from neuralgaits._compiler import Compiler, CompilerError, SharedLibrary
from neuralgaits._types import Float
from neuralgaits.systems.controller_export import c_files, controller_program
from neuralgaits.systems.family_run import FamilyRun
from neuralgaits.systems.walker3d.spatial_impact import SIGNS, SWAPPED
from neuralgaits.systems.walker3d.spatial_plant import SpatialPlants
from neuralgaits.systems.walker3d.spatial_walks import LANDING, law_of_gait

_SIX, _THREE = 6 * ctypes.c_double, 3 * ctypes.c_double


class TorqueTick(NamedTuple):
    """Torques of a tick, and the state they were computed from.

    Attributes:
        torques: motors' torques, right leg first [N m]; not finite where the gait has no pose. [6]
        z: state of the zero dynamics. [4]
        left: whether the robot stands on its left foot.
    """

    torques: Float[np.ndarray, "6"]
    z: Float[np.ndarray, "4"]
    left: bool


class LiveController(Protocol):
    """A controller of one robot, with its memory."""

    def start(self) -> None:
        """Begin a step on the right foot."""
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


class CompiledController:
    """The exported controller, compiled."""

    def __init__(self, library: ctypes.CDLL):
        """Take the loaded library of `walker3d_tick.c` for one robot."""
        self._library = library
        self._memory = _Memory()
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
        library = SharedLibrary("walker3d", files, sources, flags)
        try:
            return cls(ctypes.CDLL(str(compiler.cached(library, cache_folder() / "walker3d"))))
        except CompilerError:
            return None
        except OSError:
            with tempfile.TemporaryDirectory(prefix="neuralgaits-") as folder:
                return cls(ctypes.CDLL(str(compiler.compile(library, Path(folder)))))

    def start(self) -> None:
        """Begin a step on the right foot."""
        self._library.ng_walker3d_start(ctypes.byref(self._memory), 0)

    def tick(self, plants: SpatialPlants) -> TorqueTick:
        """Read the sensors of the only robot. Returns: torques, and where it is."""
        (world,) = plants.worlds
        q, dq = world.qpos, world.qvel
        contact = (2 * ctypes.c_int)(*plants.touching(0))
        reading = _Reading(
            *q[3:5], *dq[3:5], _SIX(*q[5:]), _SIX(*dq[5:]), _THREE(*dq[:3]), 1, contact
        )
        memory = ctypes.byref(self._memory)
        lost = self._library.ng_walker3d_tick(memory, ctypes.byref(reading), self._torques)
        torques = np.full(6, np.nan) if lost else np.array(self._torques)
        return TorqueTick(torques, np.array(self._memory.z), bool(self._memory.left))


class TracedController:
    """The controller in JAX: right without a C compiler, and several times slower."""

    def __init__(self, run: FamilyRun):
        """Take the law of a run, which compiles at the first tick."""
        gait = run.controller.typical
        self._law, self._policy = law_of_gait(run.data, gait, "pd"), gait.policy
        self.start()

    def start(self) -> None:
        """Begin a step on the right foot."""
        self._phase, self._left = 0.0, False

    def tick(self, plants: SpatialPlants) -> TorqueTick:
        """Read the sensors of the only robot. Returns: torques, and where it is."""
        swing = plants.touching(0)[0 if self._left else 1]
        self._left ^= bool(swing and self._phase > LANDING)
        plants.left[:] = self._left
        demand: Any = jax.tree.map(np.asarray, self._law(plants.measured(), np.zeros((1, 2))))
        self._phase = float(self._policy.phase(demand.z[0]))
        torques = demand.torques[0]
        own = SIGNS[2:] * torques[SWAPPED[2:] - 2] if self._left else torques
        return TorqueTick(own, demand.z[0], self._left)


def controller_of(run: FamilyRun) -> LiveController:
    """Return the controller of a run: compiled C, or JAX without a C compiler."""
    return CompiledController.of(run) or TracedController(run)
