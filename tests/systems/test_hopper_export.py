"""The hopper's controller in C hops in MuJoCo as Python's does, tick by tick."""

import ctypes

import numpy as np
import pytest

from neuralgaits._compiler import Compiler, SharedLibrary
from neuralgaits.systems.controller_export import c_files, controller_program
from neuralgaits.systems.family_run import open_family_run
from neuralgaits.systems.hopper.hop_episodes import HopSimulation, trace_hops
from neuralgaits.systems.hopper.hop_export import header_of
from neuralgaits.systems.hopper.hopper_verbs import SYSTEM

pytestmark = pytest.mark.slow
HOPS, LIMIT_N = 3, 600.0
REALS = "lean length turning sliding momentum wheel_momentum foot_height time".split()


class Reading(ctypes.Structure):
    """`ng_hopper_reading`."""

    _fields_ = [*((name, ctypes.c_double) for name in REALS), ("contact", ctypes.c_int)]


class Tick(ctypes.Structure):
    """`ng_hopper`."""

    _fields_ = [("flying", ctypes.c_int), *((f"memory{k}", ctypes.c_double) for k in range(7))]


@pytest.fixture(scope="module")
def run(small_hopper):
    return open_family_run(SYSTEM, small_hopper)


@pytest.fixture(scope="module")
def library(run, tmp_path_factory):
    compiler = Compiler.for_c()
    if compiler is None:
        pytest.skip("no C compiler")
    files = c_files(run, controller_program(SYSTEM, run), header_of(run))
    sources = tuple(name for name in files if name.endswith(".c"))
    flags = ("-std=c99", "-O2", "-Wall", "-Wextra", "-Werror", "-pedantic", "-fPIC", "-shared")
    folder = tmp_path_factory.mktemp("hopper")
    return ctypes.CDLL(
        str(compiler.compile(SharedLibrary("hopper", files, sources, flags), folder))
    )


class ComparedHops(HopSimulation):
    """Hops of Python's controller, at each step of which C is asked, too."""

    def __init__(self, run, library):
        super().__init__(run)
        self.library, self.tick, self.off = library, Tick(), []
        library.ng_hopper_start(ctypes.byref(self.tick))

    def step(self, torque, force, *, stance):
        foot = float(self.world.geom_xpos[self.data.foot][2]) - self.data.foot_radius
        measured = (*self.leg(), self.momentum(), self.wheel_momentum(), foot, self.world.time)
        reading = Reading(*measured, self.world.ncon)
        answers = ctypes.c_double(), ctypes.c_double()
        self.library.ng_hopper_tick(
            ctypes.byref(self.tick), ctypes.byref(reading), *map(ctypes.byref, answers)
        )
        assert bool(self.tick.flying) is not stance
        self.off.append([answers[0].value - force, answers[1].value - torque])
        super().step(torque, force, stance=stance)


def test_the_tick_is_pythons_through_stances_and_flights(run, library):
    simulation = ComparedHops(run, library)
    trace = trace_hops(simulation, 0.3, HOPS)
    assert not trace.fell and len(trace.touchdowns) == HOPS + 1
    assert len(simulation.off) == len(trace.ticks) > 1000
    assert np.abs(simulation.off).max() < 1e-9 * LIMIT_N


def test_the_tick_takes_no_contact_for_a_touchdown_while_the_foot_leaves_the_floor(library):
    tick, forces = Tick(), (ctypes.c_double(), ctypes.c_double())
    library.ng_hopper_start(ctypes.byref(tick))

    def at(time: float, lean: float) -> int:
        reading = Reading(lean, 0.6, 2.0, 0.5, 4.0, 0.0, 0.0, time, 1)
        library.ng_hopper_tick(
            ctypes.byref(tick), ctypes.byref(reading), *map(ctypes.byref, forces)
        )
        return tick.flying

    assert [at(0.0, 0.1), at(0.1, 0.31), at(0.102, 0.31), at(0.5, 0.0)] == [0, 1, 1, 0]
