"""Compile the supervisor of a run's export into a library of this process."""

import ctypes
from collections.abc import Sequence
from ctypes import c_double, c_int, c_size_t, c_uint32, c_void_p
from importlib import resources

import numpy as np

from neuralgaits._cache import cache_folder
from neuralgaits._compiler import Compiler, SharedLibrary
from neuralgaits._types import Float
from neuralgaits.errors import InputError
from neuralgaits.export import build, output_folder
from neuralgaits.export.design import Design
from neuralgaits.export.source import gait_files


def supervisor_library(design: Design, precision: str = "double") -> ctypes.CDLL:
    """Return the compiled supervisor of a controller.

    Args:
        design: design of the controller.
        precision: `double` or `float`, of the arithmetic in C.

    Raises: InputError without a C compiler, SpecError for a policy that C cannot express.
    """
    host = "supervisor_host.c"
    compiler = Compiler.for_c()
    if compiler is None:
        raise InputError("expected a C compiler for the supervisor, found none: install gcc")
    folder = resources.files("neuralgaits.simulation.supervised") / "c"
    files = output_folder.shipped() | gait_files(design)
    files[host] = (folder / host).read_text(encoding="utf-8")
    flags = ("-std=c99", "-O2", "-fPIC", "-shared", *build.PRECISIONS[precision])
    recipe = SharedLibrary("supervisor", files, (*build.CORE, "supervisor.c", host), flags)
    library = ctypes.CDLL(str(compiler.cached(recipe, cache_folder())))
    library.ng_host_bytes.restype = c_size_t
    library.ng_host_start.argtypes = [c_void_p, c_int, c_int]
    library.ng_host_tell.argtypes = [c_void_p, c_void_p]
    library.ng_host_tick.argtypes = [
        *(c_void_p, c_uint32, c_void_p, c_int),
        *(c_void_p, c_void_p, c_void_p),
    ]
    assert ctypes.sizeof(c_double) == 8
    return library


class SupervisorTick:
    """A supervisor in C, and what its last tick has decided.

    Attributes:
        decided: mode, reason, what the request waits for, fault, whether it is new, stance leg,
            touchdown, z (m, kg m^2/s), time since a touchdown, 1e30 before the first [s]. [10]
        targets: of each drive: q_des [rad], dq_des [rad/s], kp [N m/rad], kd [N m s/rad], tau_ff
            [N m]. [2, k, 5]
        torques: torques of the file's joints [N m]. [2, k]
    """

    def __init__(self, library: ctypes.CDLL, shape: tuple[int, int]):
        """Take a library of `supervisor_library`, for legs of `shape[1]` joints."""
        self._library = library
        self._memory = ctypes.create_string_buffer(library.ng_host_bytes())
        self.decided = np.zeros(10)
        self.targets = np.zeros((*shape, 5))
        self.torques = np.zeros(shape)

    def start(self, *, estimate: bool, commands: Sequence[float] = ()) -> None:
        """Start damping.

        Args:
            estimate: whether rates and velocity are estimated, not measured.
            commands: commands of a gait that takes some.
        """
        self._library.ng_host_start(self._memory, 0, int(estimate))
        if commands:
            values = np.asarray(commands, dtype=np.float64)
            self._library.ng_host_tell(self._memory, values.ctypes.data)

    def tick(self, time_us: int, sensors: Float[np.ndarray, " s"], request: int) -> None:
        """Decide.

        Args:
            time_us: time of the reading; wraps around at 2^32 [us].
            sensors: pitch [rad], its rate [rad/s], velocity x, z [m/s], force on either foot [N],
                joints [rad], their rates [rad/s], with the signs of the robot file.
            request: request of the operator.
        """
        arrays = (self.decided, self.targets, self.torques)
        self._library.ng_host_tick(
            *(self._memory, time_us % 2**32, sensors.ctypes.data, int(request)),
            *(array.ctypes.data for array in arrays),
        )
