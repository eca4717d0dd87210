"""Walking logs: files in and out, and the strides, windows and touchdowns that are learned from."""

from neuralgaits.logs.formats.log_reader import CleanedLog, read, read_all
from neuralgaits.logs.formats.log_writer import refuse_unwritable_log, write
from neuralgaits.logs.strides import SETTLING_S, Cut, Split, State, Stride, cut, split
from neuralgaits.logs.touchdowns import Touchdowns, touchdowns
from neuralgaits.logs.walk_table import Log
from neuralgaits.logs.windows import Windows, windows

__all__ = [
    "SETTLING_S",
    "CleanedLog",
    "Cut",
    "Log",
    "Split",
    "State",
    "Stride",
    "Touchdowns",
    "Windows",
    "cut",
    "read",
    "read_all",
    "refuse_unwritable_log",
    "split",
    "touchdowns",
    "windows",
    "write",
]
