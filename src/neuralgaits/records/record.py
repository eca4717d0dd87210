"""Records: named fields with types, which JSON data must match to become a record.

The annotations of a record are its format. `float` is any number, `Count` a whole number
that is not negative, `X | None` may be null, a field with a default may be missing, and
`Annotated[X, shape]` has another shape of `runs.shape`. Further fields of a file are ignored.
"""

import dataclasses
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Self, Union, get_args, get_origin, get_type_hints

from neuralgaits.runs import shape as shapes
from neuralgaits.runs.json_files import read_object, refuse_misshapen
from neuralgaits.runs.plain import plain

Count = Annotated[int, shapes.COUNT]
Share = Annotated[float, shapes.SHARE]
Texts = tuple[str, ...]
Pair = tuple[float, float]
Disturb = Annotated[Mapping[str, Any], shapes.table_of(shapes.may(shapes.NUMBER))]
"""Changes of a plant, by name: see `simulation.setup.disturbance`."""


class Record(Mapping[str, Any]):
    """A frozen dataclass that acts as a mapping of what `--json` prints."""

    def omitted(self) -> Collection[str]:
        """Return the names of fields that `--json` omits."""
        return ()

    def __getitem__(self, name: str) -> Any:
        if name not in self._shown_fields():
            raise KeyError(name)
        return plain(getattr(self, name))

    def __iter__(self) -> Iterator[str]:
        return iter(self._shown_fields())

    def __len__(self) -> int:
        return len(self._shown_fields())

    def _shown_fields(self) -> list[str]:
        names = (field.name for field in dataclasses.fields(self))  # type: ignore[arg-type]
        omitted = self.omitted()
        return [name for name in names if name not in omitted]

    @classmethod
    def of(cls, value: Any) -> Self:
        """Make a record from JSON data. Raises: ValueError that says what is wrong."""
        if wrong := shapes.complaint(value, shape_of(cls)):
            raise ValueError(wrong)
        return build(cls, value)

    @classmethod
    def read(cls, path: Path) -> Self:
        """Read a record from a file. Raises: RunError if it is missing, damaged or another kind."""
        value = read_object(path)
        refuse_misshapen(value, shape_of(cls), path)
        return build(cls, value)


def shape_of(kind: Any) -> shapes.Shape:
    """Return the shape that JSON data must have to become a value of a type."""
    origin, inner = get_origin(kind), get_args(kind)
    if origin is Annotated:
        return inner[1]
    if origin is Literal:
        return shapes.one_of(*inner)
    if origin in (Union, UnionType):
        (some,) = (part for part in inner if part is not NoneType)
        return shapes.may(shape_of(some))
    if origin is tuple:
        return shapes.list_of(shape_of(inner[0]), *([] if inner[-1] is ... else [len(inner)]))
    if origin is not None:
        return shapes.table_of(shape_of(inner[1]))
    if not dataclasses.is_dataclass(kind):
        plain_kinds = {
            float: shapes.NUMBER,
            int: shapes.kind("a whole number", int),
            str: shapes.TEXT,
            bool: shapes.FLAG,
        }
        return plain_kinds.get(kind, lambda value: None)
    kinds = get_type_hints(kind, include_extras=True)
    shape = {}
    missing = dataclasses.MISSING
    for field in dataclasses.fields(kind):
        required = field.default is missing and field.default_factory is missing
        shape[field.name if required else f"{field.name}?"] = shape_of(kinds[field.name])
    same = getattr(kind, "SAME_LENGTH", ())
    return shapes.same_length(shape, *same) if same else shape


def build(kind: Any, value: Any) -> Any:
    """Build a value of a type from JSON data of its shape."""
    origin, inner = get_origin(kind), get_args(kind)
    if value is None or kind is Any:
        return value
    if origin is Annotated:
        return build(inner[0], value)
    if origin in (Union, UnionType):
        return build(next(part for part in inner if part is not NoneType), value)
    if origin is tuple:
        return tuple(build(inner[0], item) for item in value)
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return {name: build(inner[1], item) for name, item in value.items()}
    if not dataclasses.is_dataclass(kind):
        return value
    kinds, names = get_type_hints(kind, include_extras=True), dataclasses.fields(kind)
    values = {f.name: build(kinds[f.name], value[f.name]) for f in names if f.name in value}
    return kind(**values)  # type: ignore[operator]
