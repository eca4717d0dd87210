"""Bytes altered as discs, editors and other programs do it, and JSON altered in its structure."""

import json
from collections.abc import Callable
from typing import Any

import numpy as np

Draw = np.random.Generator

BYTES = (0x00, 0x0A, 0x1B, 0x22, 0x2C, 0x2D, 0x30, 0x3C, 0x5B, 0x7B, 0x7F, 0x80, 0xEF, 0xFF)
PIECES = (b"\x00" * 64, b"\xef\xbb\xbf", b"\xff\xfe", b"\n\n", b"\r\n", b"nan", b"-1e999", b"{}")
DEEP = 100_000
"""Brackets in one another, more than any reader recurses."""
LARGE = 1e300
ODD: tuple[Any, ...] = (
    None,
    True,
    False,
    0,
    -1,
    1,
    2**31,
    2**63,
    -(2**64),
    10**400,
    0.5,
    -0.0,
    1e-320,
    1e308,
    float("nan"),
    float("inf"),
    float("-inf"),
    "",
    "0",
    "nan",
    "latest",
    "../../../etc/hostname",
    "\x00",
    "a\x1b[31m\r\nb\x85\u2028",
    "\ud800",
    "<script>&\"'</script>",
    "é" * 300,
    "x" * 5000,
    "[bold red]{0}%s${x}`",
    [],
    {},
    [None],
    [[]],
    [0, 1],
    [[[[["deep"]]]]],
    [1e308, -1e308],
    {"": None},
    {"verdict": "proved"},
    list(range(300)),
)
"""Values that stand where they do not belong."""


def altered_bytes(content: bytes, draw: Draw) -> bytes:
    """One to three accidents."""
    for _ in range(int(draw.integers(1, 4))):
        content = _ACCIDENTS[int(draw.integers(len(_ACCIDENTS)))](content, draw)
    return content


def _span(content: bytes, draw: Draw) -> tuple[int, int]:
    """A short piece of the file."""
    start = int(draw.integers(0, len(content) + 1))
    return start, min(start + int(draw.integers(1, 200)), len(content))


def _flip(content: bytes, draw: Draw) -> bytes:
    data = bytearray(content)
    for _ in range(int(draw.integers(1, 9))):
        if data:
            data[int(draw.integers(len(data)))] ^= 1 << int(draw.integers(8))
    return bytes(data)


def _overwrite(content: bytes, draw: Draw) -> bytes:
    start, end = _span(content, draw)
    return content[:start] + bytes([int(draw.choice(BYTES))]) * (end - start) + content[end:]


def _insert(content: bytes, draw: Draw) -> bytes:
    start, _ = _span(content, draw)
    noise = draw.integers(0, 256, int(draw.integers(1, 40)), dtype=np.uint8).tobytes()
    piece = (*PIECES, noise)[int(draw.integers(len(PIECES) + 1))]
    return content[:start] + piece + content[start:]


def _delete(content: bytes, draw: Draw) -> bytes:
    start, end = _span(content, draw)
    return content[:start] + content[end:]


def _double(content: bytes, draw: Draw) -> bytes:
    start, end = _span(content, draw)
    return content[:end] + content[start:end] * int(draw.integers(1, 5)) + content[end:]


def _move(content: bytes, draw: Draw) -> bytes:
    start, end = _span(content, draw)
    rest = content[:start] + content[end:]
    place = int(draw.integers(0, len(rest) + 1))
    return rest[:place] + content[start:end] + rest[place:]


def _cut(content: bytes, draw: Draw) -> bytes:
    return content[: int(draw.integers(0, len(content) + 1))]


def _nothing(content: bytes, draw: Draw) -> bytes:
    """What a full disc or a crash of the file system leaves."""
    return b"" if draw.random() < 0.5 else b"\x00" * len(content)


def _twice(content: bytes, draw: Draw) -> bytes:
    return content + content if draw.random() < 0.5 else content + b"\n"


_ACCIDENTS: tuple[Callable[[bytes, Draw], bytes], ...] = (
    *(_flip, _flip, _overwrite, _insert, _delete, _double, _move, _cut, _nothing, _twice),
)


def altered_json(content: bytes, draw: Draw) -> bytes:
    """The same tree of values with one to three of them altered; other bytes if it is no JSON."""
    try:
        tree = json.loads(content)
    except ValueError:
        return altered_bytes(content, draw)
    for _ in range(int(draw.integers(1, 4))):
        tree = _alter_tree(tree, draw)
    text = json.dumps(tree)
    if draw.random() < 0.02:
        place = text.find(":") + 1
        text = text[:place] + "[" * DEEP + "]" * DEEP + "," + text[place:]
    return text.encode("utf-8", "surrogatepass")


def _alter_tree(tree: Any, draw: Draw) -> Any:
    """Alter a value somewhere, the nearer to the root the likelier."""
    if not isinstance(tree, dict | list) or not tree or draw.random() < 0.03:
        return _other(tree, draw)
    keys = list(tree) if isinstance(tree, dict) else list(range(len(tree)))
    key = keys[int(draw.integers(len(keys)))]
    if isinstance(tree[key], dict | list) and tree[key] and draw.random() < 0.8:
        return _with(tree, key, _alter_tree(tree[key], draw))
    kind = draw.random()
    if kind < 0.15:
        rest = list(tree.items()) if isinstance(tree, dict) else list(enumerate(tree))
        kept = [(k, value) for k, value in rest if k != key]
        return dict(kept) if isinstance(tree, dict) else [value for _, value in kept]
    if kind < 0.2 and isinstance(tree, dict):
        return {("é " + k if k == key else k): value for k, value in tree.items()}
    if kind < 0.25 and isinstance(tree, list):
        return [*tree, tree[key]] if draw.random() < 0.5 else tree[::-1]
    if kind < 0.35:
        other = keys[int(draw.integers(len(keys)))]
        return _with(_with(tree, key, tree[other]), other, tree[key])
    return _with(tree, key, _other(tree[key], draw))


def _with(tree: Any, key: Any, value: Any) -> Any:
    copy = dict(tree) if isinstance(tree, dict) else list(tree)
    copy[key] = value
    return copy


def _other(value: Any, draw: Draw) -> Any:
    """Another value: of the same kind but off, or of any kind."""
    if isinstance(value, bool) or draw.random() < 0.6:
        return ODD[int(draw.integers(len(ODD)))]
    if isinstance(value, int | float) and abs(value) < LARGE:
        changes = (-value, value + 1, value * 1e9, value / 3, str(value), [value])
        return changes[int(draw.integers(len(changes)))]
    if isinstance(value, str):
        return altered_bytes(value.encode("utf-8", "replace"), draw).decode("utf-8", "replace")
    return ODD[int(draw.integers(len(ODD)))]
