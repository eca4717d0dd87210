"""Walking logs: files in and out, and the strides, windows and touchdowns that are learned from."""

from neuralgaits.logs.strides import (
    SETTLING_S,
    Cut,
    Split,
    Stride,
    Touchdowns,
    Windows,
    cut,
    split,
    touchdowns,
    windows,
)
from neuralgaits.logs.table import Log

__all__ = [
    "SETTLING_S",
    "Cut",
    "Log",
    "Split",
    "Stride",
    "Touchdowns",
    "Windows",
    "cut",
    "split",
    "touchdowns",
    "windows",
]
