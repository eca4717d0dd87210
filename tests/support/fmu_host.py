"""An FMU of a controller, loaded by FMPy, alone or in the loop with a robot in MuJoCo."""

# pyright: reportAttributeAccessIssue=false, reportCallIssue=false, reportOptionalMemberAccess=false
# MuJoCo ships no type stubs, and the two kinds of FMPy's instances have other parameters.

import ctypes
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

import mujoco
import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave

from neuralgaits.export import output_folder
from neuralgaits.export.design import Design
from neuralgaits.export.fmu.fmu_archive import fmu_file
from neuralgaits.export.monitor_source import monitor_files
from neuralgaits.export.source import gait_files
from neuralgaits.simulation.setup.plant import SUBSTEPS, build

VERSIONS = ("3.0", "2.0")
Reading = dict[str, float]
"""Inputs by name."""


def made_fmu(design: Design, version: str, folder: Path) -> Path:
    """Write the FMU of a design, without the comparison of its controller."""
    files = output_folder.shipped() | gait_files(design) | monitor_files(design)
    name, content = fmu_file(design, version, files, ["gcc"])
    (folder / name).write_bytes(content)
    return folder / name


class UnpackedFmu:
    """An FMU on disk, of which there may be several instances."""

    def __init__(self, path: Path, folder: Path):
        """Unpack an FMU."""
        self.folder = extract(str(path), unzipdir=str(folder))
        self.described = read_model_description(str(path))
        self.variables = {one.name: one for one in self.described.modelVariables}
        self.three = self.described.fmiVersion == "3.0"

    @contextmanager
    def instance(self, **parameters: float) -> Iterator["FmuInstance"]:
        """Provide an instance, started with these parameters; it is freed afterwards."""
        made = FmuInstance(self)
        try:
            made.start(**parameters)
            yield made
        finally:
            made.slave.freeInstance()


class FmuInstance:
    """An instance of an FMU. Attributes: messages: what it has logged."""

    def __init__(self, fmu: UnpackedFmu):
        """Instantiate it."""
        self.fmu = fmu
        self.messages: list[str] = []
        kind = FMU3Slave if fmu.three else FMU2Slave
        self.slave = kind(
            guid=fmu.described.guid,
            unzipDirectory=fmu.folder,
            modelIdentifier=fmu.described.coSimulation.modelIdentifier,
            instanceName="controller",
        )
        self.instantiate()

    def instantiate(self) -> None:
        """Instantiate it in its library, with a logger that keeps messages."""
        if self.fmu.three:
            from fmpy.fmi3 import fmi3LogMessageCallback

            def log3(environment, status, category, message):
                del environment, status, category
                self.messages.append(message.decode())

            self._log = fmi3LogMessageCallback(log3)
            self.slave.instantiate(loggingOn=True, logMessage=self._log)
            return
        from fmpy.fmi2 import (
            fmi2CallbackAllocateMemoryTYPE,
            fmi2CallbackFreeMemoryTYPE,
            fmi2CallbackFunctions,
            fmi2CallbackLoggerTYPE,
        )

        def log2(environment, name, status, category, message):
            del environment, name, status, category
            self.messages.append(message.decode())

        self._log = fmi2CallbackFunctions()
        self._log.logger = fmi2CallbackLoggerTYPE(log2)
        self._log.allocateMemory = fmi2CallbackAllocateMemoryTYPE(0)
        self._log.freeMemory = fmi2CallbackFreeMemoryTYPE(0)
        self.slave.instantiate(loggingOn=True, callbacks=self._log)

    def start(self, **parameters: float) -> None:
        """Initialise it at time 0."""
        if not self.fmu.three:
            self.slave.setupExperiment(startTime=0.0)
        self.set(parameters)
        if self.fmu.three:
            self.slave.enterInitializationMode(startTime=0.0)
        else:
            self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()

    def set(self, values: Mapping[str, float]) -> None:
        """Set variables by name."""
        for name, value in values.items():
            one = self.fmu.variables[name]
            kind, args = one.type, ([one.valueReference], [value])
            getattr(self.slave, f"set{kind}")(*args)

    def get(self, name: str) -> float:
        """Return a variable's value."""
        one = self.fmu.variables[name]
        return getattr(self.slave, f"get{one.type}")([one.valueReference])[0]

    def outputs(self) -> dict[str, float]:
        """Return all outputs by name."""
        names = [one.name for one in self.fmu.variables.values() if one.causality == "output"]
        return {name: float(self.get(name)) for name in names}

    def step(self, time: float, size: float = 1e-3) -> None:
        """Do one step."""
        self.slave.doStep(time, size)


class FmuPlant:
    """The robot of a design in MuJoCo, read and driven through the variables of its FMU."""

    def __init__(self, design: Design, start: np.ndarray):
        """Put the robot on leg 0 at a state x = (q, dq) (rad, rad/s). [2n]."""
        self.plant = build(design.controller.robot)
        self.layout = design.controller.robot.layout
        self.model, self.data = self.plant.model, mujoco.MjData(self.plant.model)
        radius = self.model.geom(self.layout.feet[0]).size[0]
        q, dq = np.split(start, 2)
        self.data.qpos[:], self.data.qvel[:] = self.plant.state_map.to_mjcf(q, dq, 0, (0.0, radius))
        mujoco.mj_forward(self.model, self.data)
        self.joints = sorted({name for leg in self.layout.leg_joints for name in leg})

    def reading(self, *, rates: bool) -> Reading:
        """Return the inputs of a tick; rates and velocity only if they are measured."""
        x, z, pitch = (self.model.joint(name).dofadr[0] for name in self.layout.root_joints)
        place = {name: self.model.joint(name).dofadr[0] for name in self.joints}
        qpos, qvel = self.data.qpos, self.data.qvel
        found = {"pitch": qpos[pitch]} | {f"angle.{name}": qpos[k] for name, k in place.items()}
        for leg, foot in enumerate(self.layout.feet):
            found[f"force.{foot}"] = self.data.sensor(f"_touch_{leg}").data[0]
        if rates:
            found |= {"pitch_rate": qvel[pitch], "velocity.x": qvel[x], "velocity.z": qvel[z]}
            found |= {f"rate.{name}": qvel[k] for name, k in place.items()}
        return {name: float(value) for name, value in found.items()}

    def drive(self, motors: Callable[[str], float]) -> None:
        """Hold motor commands, a function of a joint's name, for one tick."""
        for joints, actuators in zip(self.layout.leg_joints, self.layout.actuators, strict=True):
            for joint, actuator in zip(joints, actuators, strict=True):
                self.data.actuator(actuator).ctrl[0] = motors(joint)
        for _ in range(SUBSTEPS):
            mujoco.mj_step(self.model, self.data)


def walked(
    fmu: FmuInstance,
    plant: FmuPlant,
    ticks: int,
    *,
    rates: bool,
    late: bool = False,
    requests: Sequence[int] = (),
) -> tuple[int, list[Reading], list[dict[str, float]]]:
    """Walk a robot in MuJoCo with the FMU in the loop.

    Args:
        fmu: an instance that has been started.
        plant: the robot.
        ticks: how many of 1 ms.
        rates: whether rates and velocity are measured.
        late: apply the motor commands of a tick one tick later, as a host does that steps plant
            and controller at the same time.
        requests: of the operator, one a tick, for an FMU with a supervisor.

    Returns: steps (touchdowns), inputs and outputs of every tick.
    """
    steps, given, found = 0, [], []
    motors = {f"motor.{name}": 0.0 for name in plant.joints}
    for tick in range(ticks):
        given.append(plant.reading(rates=rates))
        if requests:
            given[-1]["request"] = requests[tick]
        fmu.set(given[-1])
        fmu.step(1e-3 * tick)
        found.append(fmu.outputs())
        before, motors = motors, {name: found[-1][name] for name in motors}
        applied = before if late else motors
        plant.drive(lambda joint, applied=applied: applied[f"motor.{joint}"])
        steps += bool(found[-1]["touchdown"])
    return steps, given, found


def library_of(fmu: UnpackedFmu, folder: Path) -> ctypes.CDLL:
    """Load a copy of the binary by itself, to call its functions with whatever arguments."""
    (source,) = Path(fmu.folder).glob("binaries/*/*.so")
    return ctypes.CDLL(str(shutil.copy(source, folder)))
