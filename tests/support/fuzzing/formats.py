"""CSV, XML and safetensors altered in their structure."""

import re
from pathlib import PurePath

from support.fuzzing.alter import DEEP, Draw, altered_bytes, altered_json

CELLS = (
    *("", " ", "nan", "inf", "-inf", "1e999", "0", "-1", "1e308", "1e-320", "0x10", "1_0", "one"),
    *('"', "'", ";", "1;2", "1 2", "١", "\x00", "\ud800", "=1+1", "1,2", "é" * 200, "9" * 5000),
)
ATTRIBUTES = (
    *("", " ", "nan", "inf", "-inf", "0", "-0", "-1", "1e-300", "1e300", "1e999", "0 0 0", "0 0 1"),
    *("1 2", "1 2 3 4 5 6 7", "nan nan nan", "1e30 1e30 1e30", "true", "auto", "hinge", "x", "/"),
    *("2147483648", "-99999999", "4294967297", "é", "&#0;", "&lt;", "..", "world", "sphere"),
)
_ATTRIBUTE = re.compile(rb'([A-Za-z_]+)="([^"]*)"')
_TAG = re.compile(rb"<(/?)([a-z]+)")
_NUMBER = re.compile(rb"-?\d+\.?\d*(?:e-?\d+)?")
_HEADER = 8
"""Bytes of the length at the beginning of a safetensors file."""


def altered(name: str, content: bytes, draw: Draw) -> bytes:
    """A file altered after its kind, or byte by byte."""
    change = _BY_KIND.get(PurePath(name).suffix, altered_bytes)
    return (altered_bytes if draw.random() < 0.3 else change)(content, draw)


def _altered_csv(content: bytes, draw: Draw) -> bytes:
    rows = [line.split(b",") for line in content.split(b"\n")]
    for _ in range(int(draw.integers(1, 5))):
        row = int(draw.integers(len(rows))) if draw.random() < 0.8 else 0
        column, kind = int(draw.integers(len(rows[row]))), int(draw.integers(7))
        cell = str(draw.choice(CELLS)).encode("utf-8", "surrogatepass")
        if kind <= 2:
            rows[row][column] = cell
        elif kind == 3:
            for other in rows[1:]:
                if column < len(other):
                    other[column] = cell
        elif kind == 4:
            del rows[row]
        elif kind == 5:
            rows.insert(row, rows[int(draw.integers(len(rows)))])
        else:
            rows[row] = rows[row][:column] + rows[row][column + 1 :]
        if not rows:
            break
        rows = [row or [b""] for row in rows]
    return b"\n".join(b",".join(row) for row in rows)


def _altered_xml(content: bytes, draw: Draw) -> bytes:
    if draw.random() < 0.02:
        return _hollow_xml(draw)
    for _ in range(int(draw.integers(1, 5))):
        found = list(_ATTRIBUTE.finditer(content))
        tags = list(_TAG.finditer(content))
        if not found or not tags:
            return altered_bytes(content, draw)
        one, kind = found[int(draw.integers(len(found)))], draw.random()
        start, end = one.span()
        if kind < 0.35:
            value = str(draw.choice(ATTRIBUTES)).encode()
            content = content[:start] + one[1] + b'="' + value + b'"' + content[end:]
        elif kind < 0.6:
            content = content[:start] + _numbers_off(one[0], draw) + content[end:]
        elif kind < 0.75:
            content = content[:start] + content[end:]
        elif kind < 0.85:
            other = found[int(draw.integers(len(found)))]
            content = content[:start] + one[1] + b'="' + other[2] + b'"' + content[end:]
        else:
            tag, other = (tags[int(draw.integers(len(tags)))] for _ in range(2))
            if draw.random() < 0.5:
                content = content.replace(b"<" + tag[2], b"<" + other[2])
                content = content.replace(b"</" + tag[2], b"</" + other[2])
            else:
                content = content[: tag.start(2)] + other[2] + content[tag.end(2) :]
    return content


def _hollow_xml(draw: Draw) -> bytes:
    """A file without content, or with one element in another many times."""
    tag = str(draw.choice(("default", "body", "frame", "worldbody", "x"))).encode()
    depth = int(draw.choice((0, 1, 99, 101, 600, DEEP)))
    inner = (b"<" + tag + b">") * depth + (b"</" + tag + b">") * depth
    return b"<mujoco>" + inner + b"</mujoco>"


def _numbers_off(attribute: bytes, draw: Draw) -> bytes:
    def off(number: re.Match[bytes]) -> bytes:
        value = float(number[0])
        changes = (-value, 0.0, value * 1e-6, value * 1e6, value + 1.0, value * 1.01, 1e200)
        return repr(float(draw.choice(changes))).encode()

    return _NUMBER.sub(off, attribute)


def _altered_safetensors(content: bytes, draw: Draw) -> bytes:
    size = int.from_bytes(content[:_HEADER], "little")
    header, body, kind = content[_HEADER : _HEADER + size], content[_HEADER + size :], draw.random()
    if kind < 0.6:
        header = altered_json(header, draw)
        header += b" " * (-len(header) % _HEADER)
        length = len(header)
    elif kind < 0.8:
        lengths = (0, 1, size - 1, size + 1, size * 2, len(content), 2**31, 2**62, 2**64 - 1)
        length = int(lengths[int(draw.integers(len(lengths)))])
    else:
        body, length = altered_bytes(body, draw), size
    return length.to_bytes(_HEADER, "little") + header + body


_BY_KIND = {
    ".json": altered_json,
    ".csv": _altered_csv,
    ".xml": _altered_xml,
    ".safetensors": _altered_safetensors,
}
