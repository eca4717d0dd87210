"""The project's own logs as MCAP: the numbers of `si`, a message in JSON for each row.

Groups of columns are objects: q_stance_knee is the field `q.stance_knee`. The schema has the unit
of every field, and times are nanoseconds, so tools that plot MCAP files show it as it is.
"""

import io
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from neuralgaits._version import __version__
from neuralgaits.errors import InputError
from neuralgaits.logs.formats.column_file import PAGE
from neuralgaits.logs.formats.mcap_reader import McapFile, opened
from neuralgaits.logs.formats.sheet import Text
from neuralgaits.logs.formats.si import header_of, numbers_of
from neuralgaits.logs.walk_table import Column, Log
from neuralgaits.runs import write_bytes

TOPIC, SCHEMA = "/walk", "neuralgaits.Walk"


def write(path: Path, log: Log) -> None:
    """Write a log, whole or not at all. Raises: InputError for a log without z."""
    from mcap.writer import Writer

    heads, table = header_of(log), numbers_of(log)
    out = io.BytesIO()
    writer = Writer(out)
    writer.start(profile="", library=f"neuralgaits {__version__}")
    schema = writer.register_schema(SCHEMA, "jsonschema", json.dumps(_schema(heads)).encode())
    channel = writer.register_channel(TOPIC, "json", schema)
    # Times of an MCAP file are not negative.
    begin = min(0.0, float(table[0, 0])) if len(table) else 0.0
    for number, row in enumerate(table.tolist()):
        content: dict[str, Any] = {}
        for (name, _), value in zip(heads, row, strict=True):
            group, field = _place(name)
            whole = int(value) if name == "stance" else value
            (content.setdefault(group, {}) if group else content)[field] = whole
        log_time = round(1e9 * (row[0] - begin))
        data = json.dumps(content).encode()
        writer.add_message(channel, log_time, data, publish_time=log_time, sequence=number)
    writer.finish()
    write_bytes(path, out.getvalue())


def walk_of(path: Path) -> Text:
    """Return the table of a log that `write` wrote, with the units of its schema.

    Raises: InputError in one line for a file that is none, is damaged, or holds no such walk.
    """
    with opened(path) as file:
        channels = [one for one in file.channels.values() if one.schema[0] == SCHEMA]
        if not channels:
            raise _foreign(file)
        heads = list(_heads(json.loads(channels[0].schema[1])))
        topic = {channels[0].topic}
        rows = [
            (number, [_cell(message.content, name) for name, _ in heads])
            for number, message in enumerate(file.messages(topic), start=1)
        ]
    if not rows:
        raise InputError(f"log {path}: expected messages of {SCHEMA}, found none: walk again")
    return Text(path, tuple(f"{name}[{unit}]" for name, unit in heads), rows, head="its schema")


def _place(name: str) -> tuple[str, str]:
    """Return the group of a column, empty without one, and its name there."""
    group, _, field = name.partition("_")
    # Groups of columns, whose names begin with that of the group.
    groups = ("q", "dq", "qd", "dqd", "tau")
    return (group, field) if group in groups else ("", name)


def _schema(heads: tuple[Column, ...]) -> dict[str, Any]:
    properties: dict[str, Any] = {}
    for name, unit in heads:
        group, field = _place(name)
        within = properties
        if group:
            within = properties.setdefault(group, {"type": "object", "properties": {}})[
                "properties"
            ]
        within[field] = {"type": "number", "unit": unit, "description": f"[{unit}]"}
    return {"title": SCHEMA, "type": "object", "properties": properties}


def _heads(schema: Any) -> Iterator[Column]:
    """Yield name and unit of each field that a schema describes."""
    for name, about in schema["properties"].items():
        if about.get("type") == "object":
            for field, one in about["properties"].items():
                yield f"{name}_{field}", str(one.get("unit", "-"))
        else:
            yield name, str(about.get("unit", "-"))


def _cell(content: Mapping[str, Any], name: str) -> str:
    """Return the number of a column in a message as text; empty where there is none."""
    group, field = _place(name)
    value = (content.get(group) or {} if group else content).get(field)
    return "" if value is None else repr(value)


def _foreign(file: McapFile) -> InputError:
    topics = ", ".join(file.topics)[:160] or "none that can be read"
    return InputError(
        f"log {file.path}: expected a channel of {SCHEMA}, as `simulate --log` writes it, found "
        f"topics {topics}: say with --columns FILE what their fields are; see {PAGE}"
    )
