"""What `export` wrote, and how it compares with Python."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass

from neuralgaits.records.record import Record, Texts
from neuralgaits.records.simulated import Percentiles


@dataclass(frozen=True)
class ExportTolerance:
    """Largest differences allowed between C and Python.

    Attributes:
        output: of y_d and its rate, shares of their ranges.
        torque: share of the torque limit.
    """

    output: float
    torque: float


@dataclass(frozen=True)
class Agreement:
    """Largest distances of one build from Python.

    Attributes:
        output: of the policy's outputs, a share of each one's range.
        rate: of their rates, likewise.
        slope: of their slopes and accelerations, likewise.
        torque: of the whole control step from encoders, a share of the torque limit.
        absolute: of any torque or output (N m, rad, rad/s).
    """

    output: float
    rate: float
    slope: float
    torque: float
    absolute: float


@dataclass(frozen=True)
class Build:
    """What is known of one compiler, precision and optimisation.

    Attributes:
        latency_us: of the policy alone, and of whole control steps by law.
    """

    compiler: str
    precision: str
    flags: str
    agreement: Agreement
    latency_us: Mapping[str, Percentiles]


@dataclass(frozen=True)
class Memory:
    """Bytes of one precision. Attributes: structs: that the caller keeps, by name."""

    flash_bytes: int
    ram_bytes: int | None
    stack_bytes: int | None
    structs: Mapping[str, int]


@dataclass(frozen=True)
class FloatBound:
    """Errors in single precision at most, shares of the ranges of y_d and its rate.

    By an error analysis that is carried out in double precision: no sample, and no proof.
    """

    output: float
    rate: float


@dataclass(frozen=True)
class ModelLimits:
    """How far a model may be from Python, as a share of each output's range."""

    output: float


@dataclass(frozen=True)
class ModelAgreement:
    """Largest distances of a model from Python: shares of ranges; absolute in rad and rad/s."""

    output: float
    rate: float
    absolute: float


@dataclass(frozen=True)
class Model:
    """What is known of an ONNX file."""

    runtime: str
    precision: str
    file: str
    agreement: ModelAgreement
    latency_us: Percentiles
    model_bytes: int


@dataclass(frozen=True, eq=False, kw_only=True)
class Exported(Record):
    """What was written.

    Attributes:
        run, format, out: as asked.
        files: that were written.
        laws: that the controller has.
        warnings: what stands against putting the gait on a robot.
        checked: whether it was compared with Python.
        max_abs_error: of the build in double precision (N m, rad, rad/s).
        latency_us: of its slowest law, or of the model.
        flash_bytes, ram_bytes: of it; None if unknown.
    """

    run: str
    format: str
    out: str
    files: Texts
    laws: Texts
    warnings: Texts
    checked: bool = True
    max_abs_error: float | None = None
    latency_us: Percentiles | None = None
    flash_bytes: int | None = None
    ram_bytes: int | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class UncheckedExport(Exported):
    """A controller that was compared with nothing. Attributes: reason: why not."""

    checked: bool = False
    reason: str


@dataclass(frozen=True, eq=False, kw_only=True)
class ControllerExport(Exported):
    """A controller in C.

    Attributes:
        states: on which it was compared.
        limits, sizes: by precision.
        float_bound: of single precision.
        step_latency_us: of what is computed once a step; None for a gait without commands.
        builds: by compiler, precision and flags.
    """

    states: int
    limits: Mapping[str, ExportTolerance]
    float_bound: FloatBound
    sizes: Mapping[str, Memory]
    builds: tuple[Build, ...]
    step_latency_us: Percentiles | None = None

    def unsaid(self) -> Collection[str]:
        """Nothing of steps that are all alike."""
        return ("step_latency_us",) if self.step_latency_us is None else ()


@dataclass(frozen=True, eq=False, kw_only=True)
class ModelExport(Exported):
    """A policy in ONNX. Attributes: states: on which it was compared; limits: by precision."""

    states: int
    limits: Mapping[str, ModelLimits]
    builds: tuple[Model, ...]
