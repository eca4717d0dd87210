"""Names and numbers of a controller that is exported as one function in C99."""

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class ControllerHeader:
    """Words of the header of an exported controller.

    Attributes:
        file: name of header and source file, without their endings.
        function: name of the C function.
        title: what it controls, with the robot's name.
        about: inputs and outputs in words, lines of a C comment.
        advice: what the caller has to do.
        constants: value and comment of each #define, by name.
        output: name of the output whose difference from Python is shown.
        unit: its unit.
        limit: its largest value, to which rounding is compared.
        proved: what the run's proof is about if it states a level, lines of a C comment.
        more: further C files by name, which use the function.
    """

    file: str
    function: str
    title: str
    about: str
    advice: str
    constants: Mapping[str, tuple[float, str]]
    output: str
    unit: str
    limit: float
    proved: str
    more: Mapping[str, str] = field(default_factory=dict)
