"""The log of a robot that is held in a stand while its joints are moved one by one."""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from neuralgaits._names import meant
from neuralgaits._printable import printable, shown
from neuralgaits._types import Float
from neuralgaits.errors import InputError, ManyProblems
from neuralgaits.logs.formats.sheet import Text, text_of


@dataclass(frozen=True, eq=False)
class HungLog:
    """A log, motors and channels in the order of the hardware.

    Attributes:
        time: time of each row [s]. [t]
        motors: index of the motor in each column.
        position: angles of the drives [rad]. [t, motors]
        torque: torques of the drives [N m]; None if it is not in the log. [t, motors]
        pitch: pitch of the inertial unit [rad]. [t]
        channels: index of the contact channel in each column.
        contact: readings of the contact channels. [t, channels]
        moved: label of the motion in each row, as `knee_left`, `+knee_left`, `pitch` or `zero`;
            empty for nothing. [t]
    """

    time: Float[np.ndarray, " t"]
    motors: tuple[int, ...]
    position: Float[np.ndarray, "t m"]
    torque: Float[np.ndarray, "t m"] | None
    pitch: Float[np.ndarray, " t"]
    channels: tuple[int, ...]
    contact: Float[np.ndarray, "t c"]
    moved: tuple[str, ...]

    def windows(self) -> list[tuple[str, str, slice]]:
        """Return the rows in which one thing moved: its name, direction (`+`, `-`, ``), rows."""
        starts = [0]
        for i in range(1, len(self.moved)):
            if self.moved[i] != self.moved[i - 1]:
                starts.append(i)
        ends = [*starts[1:], len(self.moved)]
        rows = []
        for start, end in zip(starts, ends, strict=True):
            label = self.moved[start]
            direction = label[0] if label[:1] in ("+", "-") else ""
            if label:
                rows.append((label.removeprefix(direction), direction, slice(start, end)))
        return rows

    def when(self, rows: slice) -> str:
        """Return when rows begin, in words."""
        return f"at {self.time[rows.start]:.3g} s"


def hung_log_text(log: HungLog) -> str:
    """Return a log as the CSV text that `read_hung_log` reads."""
    head = ["t[s]"]
    columns = [log.time]
    for k, motor in enumerate(log.motors):
        head.append(f"position_{motor}[rad]")
        columns.append(log.position[:, k])
        if log.torque is not None:
            head.append(f"torque_{motor}[N m]")
            columns.append(log.torque[:, k])
    head.append("pitch[rad]")
    columns.append(log.pitch)
    for k, channel in enumerate(log.channels):
        head.append(f"contact_{channel}")
        columns.append(log.contact[:, k])
    rows = (",".join(f"{value:.9g}" for value in row) for row in np.stack(columns, axis=1))
    lines = (f"{row},{label}" for row, label in zip(rows, log.moved, strict=True))
    return "\n".join([",".join([*head, "moved"]), *lines]) + "\n"


def read_hung_log(path: str | Path, names: tuple[str, ...]) -> HungLog:
    """Read a log.

    Args:
        path: CSV file.
        names: names of what may be moved: joints, feet, `pitch`, `zero`.

    Raises: InputError in a line for a file that is none, or with a row that cannot be read;
        ManyProblems if several columns or labels are wrong.
    """
    text = text_of(Path(path))
    file = f"log {printable(Path(path))}"
    columns = {name: k for k, name in enumerate(text.header)}
    motors = _indices(columns, r"position_([0-9]{1,3})\[rad\]")
    torques = _indices(columns, r"torque_([0-9]{1,3})\[N m\]")
    channels = _indices(columns, r"contact_([0-9]{1,3})")
    problems = []
    if len(columns) != len(text.header):
        problems.append(f"{file}: expected each column once, found one twice: delete one")
    needed = ("t[s]", "pitch[rad]", "moved")
    problems += [
        f"{file}: expected a column {name}, found {', '.join(map(shown, text.header[:4]))}, ...: "
        "add it"
        for name in needed
        if name not in columns
    ]
    if not motors:
        problems.append(
            f"{file}: expected a column position_I[rad] for each motor I, found none: write the "
            "angle of each drive"
        )
    if torques and torques.keys() != motors.keys():
        problems.append(
            f"{file}: expected a column torque_I[N m] for every motor or for none, found those of "
            f"{', '.join(map(str, torques))}: add the others"
        )
    if problems:
        raise ManyProblems(problems)
    numbers = _numbers(text, columns, file)
    labels = _labels(text, columns["moved"], len(text.header), names, file)
    return HungLog(
        time=numbers[:, columns["t[s]"]],
        motors=tuple(motors),
        position=numbers[:, list(motors.values())],
        torque=numbers[:, [torques[one] for one in motors]] if torques else None,
        pitch=numbers[:, columns["pitch[rad]"]],
        channels=tuple(channels),
        contact=numbers[:, list(channels.values())],
        moved=labels,
    )


def _indices(columns: dict[str, int], pattern: str) -> dict[int, int]:
    """Return columns whose name matches, by the index in it."""
    matches = ((re.fullmatch(pattern, name), column) for name, column in columns.items())
    return {int(match[1]): column for match, column in matches if match}


def _numbers(text: Text, columns: dict[str, int], file: str) -> Float[np.ndarray, "t c"]:
    """Return the numbers of all columns; those of `moved` are 0. Raises: InputError."""
    width, label = len(text.header), columns["moved"]
    values = np.zeros((len(text.cells), width))
    largest = 1e7  # Largest number in a log.
    latest = 1e12  # Largest time, which may count from any day [s].
    for k, (row, cells) in enumerate(text.cells):
        # The reader of sheets leaves out an empty cell at the end of a line.
        if len(cells) not in (width, width - (label == width - 1)):
            raise InputError(
                f"{file}, row {row}: expected {width} columns, found {len(cells)}: delete the row"
            )
        for column, cell in enumerate(cells):
            if column == label:
                continue
            try:
                values[k, column] = float(cell)
            except ValueError:
                values[k, column] = np.nan
            most = latest if column == columns["t[s]"] else largest
            if not abs(values[k, column]) <= most:
                raise InputError(
                    f"{file}, row {row}, column {text.header[column]}: expected a finite number of "
                    f"at most {most:g}, found {shown(cell)}: delete the row"
                )
    fewest = 100  # Fewest rows of a log.
    if len(values) < fewest:
        raise InputError(
            f"{file}: expected {fewest} rows or more, found {len(values)}: record longer"
        )
    steps = np.diff(values[:, columns["t[s]"]])
    if not np.all(steps > 0.0):
        row = text.cells[int(np.argmax(steps <= 0.0)) + 1][0]
        raise InputError(
            f"{file}, row {row}: expected times that increase, found one that does not: sort rows"
        )
    step, whole = float(np.median(steps)), float(np.sum(steps))
    shortest_step, longest_step = 5e-4, 0.05  # Time between two rows, by the median [s].
    longest = 3600.0  # Longest log [s].
    if not (shortest_step <= step <= longest_step and whole <= longest):
        raise InputError(
            f"{file}: expected {shortest_step:g} to {longest_step:g} s from row to row and at most "
            f"{longest:g} s, found {step:.3g} s and {whole:.3g} s: times are in seconds"
        )
    _refuse_gaps(text, steps, step, file)
    return values


def _refuse_gaps(text: Text, steps: Float[np.ndarray, " s"], usual: float, file: str) -> None:
    """Refuse a log with pauses. Raises: ManyProblems with each of them."""
    # Longest gap in a log [s], or three usual steps where those are longer: nobody knows a motion
    # that went on in it.
    longest = max(0.1, 3.0 * usual)
    gaps = [
        f"{file}, row {text.cells[k + 1][0]}: expected at most {longest:.2g} s from row to row, "
        f"found {steps[k]:.3g} s: record without a pause, and keep rows that are about nothing, "
        "with an empty label"
        for k in np.flatnonzero(steps > longest)
    ]
    if gaps:
        raise ManyProblems(gaps[:20])


def _labels(
    text: Text, column: int, width: int, names: tuple[str, ...], file: str
) -> tuple[str, ...]:
    """Return the labels of all rows. Raises: ManyProblems for those that name nothing."""
    labels = tuple(cells[column] if len(cells) == width else "" for _, cells in text.cells)
    wrong = [
        f"{file}: moved: expected one of {', '.join(names)}, found {shown(label)}: "
        f"{meant(label, names) or 'correct it'}"
        for label in dict.fromkeys(labels)
        if label and label.removeprefix("+").removeprefix("-") not in names
    ]
    if wrong:
        raise ManyProblems(wrong[:20])
    return labels
