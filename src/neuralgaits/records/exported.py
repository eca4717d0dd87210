"""Result of `export`, and how it compares with Python."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass

from neuralgaits.records.law_proof import LawProof
from neuralgaits.records.link_figures import Percentiles
from neuralgaits.records.record import Count, Record, Texts


@dataclass(frozen=True)
class ExportTolerance:
    """Limits on the difference between C and Python.

    Attributes:
        output: limit for y_d and its rate, as shares of their ranges.
        torque: limit for torques, as a share of the torque limit.
    """

    output: float
    torque: float


@dataclass(frozen=True)
class Agreement:
    """Largest differences between one build and Python.

    Attributes:
        output: difference of the policy's outputs, as a share of each one's range.
        rate: difference of their rates, likewise.
        slope: difference of their slopes and accelerations, likewise.
        torque: difference of a whole control tick from encoders on, as a share of the torque limit.
        absolute: largest difference of any torque or output (N m, rad, rad/s).
    """

    output: float
    rate: float
    slope: float
    torque: float
    absolute: float


@dataclass(frozen=True)
class Build:
    """Results for one compiler, precision and optimisation.

    Attributes:
        latency_us: time of the policy alone, and of whole control ticks by law.
    """

    compiler: str
    precision: str
    flags: str
    agreement: Agreement
    latency_us: Mapping[str, Percentiles]


@dataclass(frozen=True)
class MonitorBuild:
    """The monitor under one compiler and precision.

    Attributes:
        distance: largest distance of a margin m from Python's, in units of 1 + |m|.
        set_us: time of the margins of each set, in the order of the levels.
        answer_us: time of a whole answer.
    """

    compiler: str
    precision: str
    distance: float
    set_us: tuple[Percentiles, ...]
    answer_us: Percentiles


@dataclass(frozen=True)
class MonitorExport:
    """The monitor beside a controller.

    Attributes:
        levels: levels of the proof that it answers about.
        states: number of states on which it was compared; 0 for none.
        builds: results by compiler and precision.
    """

    levels: tuple[Count, ...]
    states: Count = 0
    builds: tuple[MonitorBuild, ...] = ()


@dataclass(frozen=True)
class Memory:
    """Memory use of one precision [bytes]. Attributes: structs: sizes of the caller's, by name."""

    flash_bytes: int
    ram_bytes: int | None
    stack_bytes: int | None
    structs: Mapping[str, int]


@dataclass(frozen=True)
class FloatBound:
    """Upper bounds on errors in single precision, as shares of the ranges of y_d and its rate.

    They come from an error analysis in double precision: neither samples nor a proof.
    """

    output: float
    rate: float


@dataclass(frozen=True)
class ModelLimits:
    """Limits on the difference between a model and Python, as a share of each output's range."""

    output: float


@dataclass(frozen=True)
class ModelAgreement:
    """Largest differences between a model and Python: shares of ranges; absolute: rad, rad/s."""

    output: float
    rate: float
    absolute: float


@dataclass(frozen=True)
class Model:
    """Agreement, time and size of one ONNX file."""

    runtime: str
    precision: str
    file: str
    agreement: ModelAgreement
    latency_us: Percentiles
    model_bytes: int


@dataclass(frozen=True, eq=False, kw_only=True)
class ExportRecord(Record):
    """Result of an export.

    Attributes:
        run, format, out: run, format and folder as requested.
        files: names of the written files.
        laws: control laws of the controller.
        warnings: reasons against using the gait on a robot.
        checked: whether it was compared with Python.
        max_abs_error: largest error of the build in double precision (N m, rad, rad/s).
        latency_us: time of its slowest law, or of the model.
        flash_bytes, ram_bytes: memory use; None if unknown.
        monitor: monitor beside the controller; None if nothing is proved, or in another format.
        deployment_sha256: hash of the deployment file whose map is beside it; None without one.
        bandwidth: requested double pole of output errors [rad/s]; None for each law's own.
        law_proofs: whether level 5 of the proof is about each law; empty if it is not proved.
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
    monitor: MonitorExport | None = None
    deployment_sha256: str | None = None
    bandwidth: float | None = None
    law_proofs: tuple[LawProof, ...] = ()

    def omitted(self) -> Collection[str]:
        """Return the fields that `--json` omits: those of what the export does not have."""
        names = ("monitor", "deployment_sha256", "bandwidth")
        proofs = () if self.law_proofs else ("law_proofs",)
        return (*(name for name in names if getattr(self, name) is None), *proofs)


@dataclass(frozen=True, eq=False, kw_only=True)
class UncheckedExport(ExportRecord):
    """A controller without any comparison. Attributes: reason: why there is none."""

    checked: bool = False
    reason: str


@dataclass(frozen=True, eq=False, kw_only=True)
class ControllerExport(ExportRecord):
    """A controller in C.

    Attributes:
        states: number of states on which it was compared.
        limits, sizes: limits and memory use, by precision.
        float_bound: error bounds of single precision.
        step_latency_us: time of the work done once in each walking step; None without commands.
        builds: results by compiler, precision and flags.
    """

    states: int
    limits: Mapping[str, ExportTolerance]
    float_bound: FloatBound
    sizes: Mapping[str, Memory]
    builds: tuple[Build, ...]
    step_latency_us: Percentiles | None = None

    def omitted(self) -> Collection[str]:
        """Return the fields that `--json` omits: monitor and time of a step's work, if none."""
        more = ("step_latency_us",) if self.step_latency_us is None else ()
        return (*super().omitted(), *more)


@dataclass(frozen=True, eq=False, kw_only=True)
class ModelExport(ExportRecord):
    """A policy in ONNX.

    Attributes:
        states: number of states on which it was compared.
        limits: limits by precision.
    """

    states: int
    limits: Mapping[str, ModelLimits]
    builds: tuple[Model, ...]


@dataclass(frozen=True)
class QueryModel:
    """The model of one condition.

    Attributes:
        condition: name of the condition.
        file, queries: names of the model, and of a query for each box.
        difference: largest distance from Python in double precision, in scales of the condition or
            shares of larger margins.
        float_difference: the same of that model in single precision, which is not written.
        model_bytes: size of the model.
    """

    condition: str
    file: str
    queries: Texts
    difference: float
    float_difference: float
    model_bytes: int


@dataclass(frozen=True, eq=False, kw_only=True)
class QueryExport(ExportRecord):
    """Conditions for other provers.

    Attributes:
        states: number of points on which models were compared, of all conditions.
        limit: limit on `difference`.
        runtime: program that ran the models.
        models: one for each condition.
    """

    states: int
    limit: float
    runtime: str
    models: tuple[QueryModel, ...]
