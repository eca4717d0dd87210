"""Formats of an export: what each writes of a design, and how it is compared with Python."""

from collections.abc import Callable, Mapping
from functools import partial

from neuralgaits.control.command_belief import SETTLED
from neuralgaits.control.speed_adapter import ADAPTED
from neuralgaits.errors import InputError
from neuralgaits.export import build, output_folder
from neuralgaits.export.board_source import board_files
from neuralgaits.export.c_check import check_controller
from neuralgaits.export.design import Design
from neuralgaits.export.fmu.fmu_archive import fmu_file
from neuralgaits.export.monitor_source import monitor_files
from neuralgaits.export.reference import Reference
from neuralgaits.export.ros2_source import ros2_files
from neuralgaits.export.selftest import selftest_file
from neuralgaits.export.source import gait_files
from neuralgaits.records.exported import ExportRecord, MonitorExport, UncheckedExport

NO_EXTRA = (
    "expected the packages onnx and onnxruntime for --format {}, found no {}: "
    "pip install 'neuralgaits[onnx]'"
)
MONITORED = ("c", "fmu", "fmu2", "ros2")
"""Formats of a whole controller, with torques and a monitor."""
MAPPED = ("c", "ros2")
"""Formats that have a map between motors and joints."""
QUERIED = "vnnlib"
"""Format of conditions, without a controller."""
SUPERVISED = ("fmu", "fmu2", "ros2")
"""Formats that may have the supervisor in the place of the controller alone."""
RecordFactory = Callable[..., ExportRecord]
"""Makes a record of what is known of files, once it is said where they are."""


def controller_files(design: Design, reference: Reference) -> dict[str, str]:
    """Return the files that are specific to this gait."""
    gait = gait_files(design) | {"gait_selftest.h": selftest_file(design, reference)}
    adapts = {ADAPTED, *SETTLED} & {command.name for command in design.commands}
    adaptation = output_folder.adaptation() if adapts else {}
    return gait | monitor_files(design) | adaptation | board_files(design)


def _c(design: Design, states: int) -> tuple[dict[str, str], RecordFactory]:
    """Return the files of the controller, and the factory of its record."""
    reference = Reference(design)
    files = output_folder.shipped() | controller_files(design, reference)
    return files, _check_c(design, reference, files, build.compilers(), states)


def _fmu(design: Design, states: int, version: str) -> tuple[dict[str, str | bytes], RecordFactory]:
    """Return the FMU, and the factory of its record; its controller is compared as C is."""
    reference, compilers = Reference(design), build.compilers()
    files = output_folder.shipped() | controller_files(design, reference)
    record = _check_c(design, reference, files, compilers, states)
    name, content = fmu_file(design, version, files, compilers)
    return {name: content}, record


def _check_c(
    design: Design, reference: Reference, files: dict[str, str], compilers: list[str], states: int
) -> RecordFactory:
    """Compare the controller in C with Python. Returns: the factory of its record."""
    if not compilers:
        monitor = None if design.monitor is None else MonitorExport(design.monitor.levels)
        reason = "no C compiler: the files are written and not checked; install gcc or clang"
        return partial(UncheckedExport, reason=reason, monitor=monitor)
    with output_folder.scratch(files | output_folder.harness()) as place:
        return check_controller(design, reference, place, compilers, states)


def _ros2(design: Design, states: int) -> tuple[dict[str, str], RecordFactory]:
    """Return the files of a ROS 2 package, and the factory of the record of its controller in C."""
    files, make_record = _c(design, states)
    return ros2_files(design, files), make_record


def _onnx(design: Design, states: int) -> tuple[dict[str, bytes], RecordFactory]:
    """Return the models of the policy, and the factory of their record.

    Raises: InputError without the extra.
    """
    try:
        from neuralgaits.export.onnx_check import check_models
        from neuralgaits.export.onnx_model import model_files
    except ModuleNotFoundError as error:
        raise InputError(NO_EXTRA.format("onnx", error.name)) from None
    files = model_files(design)
    return files, check_models(design, files, states)


def _vnnlib(design: Design, states: int) -> tuple[dict[str, str | bytes], RecordFactory]:
    """Return the conditions for other provers, and the factory of their record.

    Raises: InputError without the extra.
    """
    try:
        from neuralgaits.export.query_models import query_files
    except ModuleNotFoundError as error:
        raise InputError(NO_EXTRA.format("vnnlib", error.name)) from None
    return query_files(design, states)


WRITERS: dict[str, Callable[[Design, int], tuple[Mapping[str, str | bytes], RecordFactory]]] = {
    "c": _c,
    "onnx": _onnx,
    "fmu": partial(_fmu, version="3.0"),
    "fmu2": partial(_fmu, version="2.0"),
    "ros2": _ros2,
    "vnnlib": _vnnlib,
}
"""Writer of each format: takes a design and a number of test states, returns files and a record
factory."""
