"""Trace a JAX function to a Program: the only file that walks a jaxpr (`jaxprs` reads its parts).

It follows the equations of `jax.make_jaxpr`, inlines calls, and hands arithmetic to `lowering` and
data movement to `movement`. Numbers that are no float64 (masks, indices) must be known while
tracing and are computed on the spot.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import jax
import numpy as np
from jax.errors import JAXTypeError

from neuralgaits.errors import SpecError
from neuralgaits.programs.program import Program
from neuralgaits.programs.tracing import jaxprs, refusals
from neuralgaits.programs.tracing.builder import Builder, Elements
from neuralgaits.programs.tracing.lowering import ARITHMETIC
from neuralgaits.programs.tracing.movement import INDEXED, MOVEMENT, outside


@dataclass(frozen=True)
class _Real:
    """A float64 array being traced; every other array is a plain NumPy array."""

    elements: Elements


_Value = _Real | np.ndarray

EXACT = frozenset(
    "abs max min sign clamp floor ceil round reduce_max reduce_min sort".split()
    + "gt ge lt le eq ne is_finite argmax argmin and or not".split()
)
"""Primitives that round nothing: on constants without a name they are computed right away."""


def trace(
    function: Callable[..., Mapping[str, Any]],
    inputs: Mapping[str, Sequence[int]],
    *,
    parameters: Any = None,
) -> Program:
    """Trace a function into a Program.

    Args:
        function: takes float64 arrays by name and returns a dict of float64 arrays.
        inputs: the shape of each argument.
        parameters: a pytree; where the function uses one of its array leaves, the constant of
            the Program carries the leaf's path as its name. Scalars stay without a name.

    Returns: the Program, the same for the same mathematics in every version of JAX tried.

    Raises: SpecError naming the operation and the line that cannot be traced.
    """
    if not jax.config.jax_enable_x64:  # pyright: ignore[reportAttributeAccessIssue]
        raise SpecError(f"a spec is traced in float64, found x64 off; {refusals.FLOAT32}")
    shapes = {name: tuple(int(n) for n in shape) for name, shape in sorted(inputs.items())}
    closed = _jaxpr(function, shapes)
    tracer = _Tracer(Builder(), _names(parameters))
    arguments = [_Real(tracer.build.input(name, shape)) for name, shape in shapes.items()]
    outputs = tracer.run(closed.jaxpr, closed.consts, arguments, ())
    return tracer.build.finish(dict(zip(closed.names, outputs, strict=True)))


@dataclass(frozen=True)
class _ClosedJaxpr:
    jaxpr: Any
    consts: Sequence[Any]
    names: list[str]


def _jaxpr(function: Callable[..., Mapping[str, Any]], shapes: Mapping[str, tuple]) -> _ClosedJaxpr:
    """Run JAX's tracer on the function."""
    names: list[str] = []

    def flat(arrays):
        outputs = function(**arrays)
        if not isinstance(outputs, Mapping) or not all(isinstance(name, str) for name in outputs):
            type_name = type(outputs).__name__
            raise SpecError(f"a traced function must return a dict by name, found {type_name}")
        names[:] = sorted(outputs)
        return [jax.numpy.asarray(outputs[name]) for name in names]

    arrays = {name: jax.ShapeDtypeStruct(s, np.float64) for name, s in shapes.items()}
    try:
        closed = jax.make_jaxpr(flat)(arrays)
    except JAXTypeError as error:
        frames = []
        place = error.__traceback__
        while place is not None:
            frames.insert(0, (place.tb_frame.f_code.co_filename, place.tb_lineno))
            place = place.tb_next
        where = refusals.source_line(frames) or "the spec"
        problem = type(error).__name__
        raise SpecError(f"{where}: cannot trace ({problem}): {refusals.PYTHON}") from error
    return _ClosedJaxpr(closed.jaxpr, closed.consts, list(names))


def _names(parameters: Any) -> dict[tuple, str]:
    """Return the paths of the array leaves of a pytree, by content."""
    names: dict[tuple, str] = {}
    for path, leaf in jax.tree_util.tree_leaves_with_path(parameters):
        if isinstance(leaf, np.ndarray | jax.Array) and leaf.ndim and leaf.dtype == np.float64:
            array = np.asarray(leaf)
            names.setdefault((array.shape, array.tobytes()), _path(path))
    return names


def _path(keys: Sequence[Any]) -> str:
    """Return a leaf's path as one writes it in Python."""
    text = ""
    for key in keys:
        if hasattr(key, "name"):
            text += f".{key.name}"
        elif hasattr(key, "idx"):
            text += f"[{key.idx}]"
        else:
            text += f"[{key.key!r}]" if not isinstance(key.key, str) else f".{key.key}"
    return text.removeprefix(".")


class _Tracer:
    """Follows equations; knows the names of parameters."""

    def __init__(self, build: Builder, names: Mapping[tuple, str]):
        self.build = build
        self._names = names
        self._done: dict[tuple, Elements] = {}

    def run(
        self, jaxpr: Any, consts: Sequence[Any], arguments: Sequence[_Value], calls: tuple
    ) -> list[Elements]:
        """Follow the outermost jaxpr. Returns: the elements of each output."""
        constants = [self._constant_value(value) for value in consts]
        results = self._follow(jaxpr, constants, arguments, calls)
        for result in results:
            if not isinstance(result, _Real):
                raise SpecError(
                    f"outputs must be float64, found {result.dtype}; return numbers that depend"
                    " on the inputs"
                )
        return [result.elements for result in results if isinstance(result, _Real)]

    def _follow(
        self, jaxpr: Any, consts: Sequence[_Value], arguments: Sequence[_Value], calls: tuple
    ) -> list[_Value]:
        values: dict[Any, _Value] = dict(zip(jaxpr.constvars, consts, strict=True))
        values |= dict(zip(jaxpr.invars, arguments, strict=True))

        def read(atom: Any) -> _Value:
            return self._constant_value(atom.val) if hasattr(atom, "val") else values[atom]

        for equation in jaxpr.eqns:
            operands = [read(atom) for atom in equation.invars]
            results = self._equation(equation, operands, calls)
            for variable, result in zip(equation.outvars, results, strict=True):
                values[variable] = result
        return [read(atom) for atom in jaxpr.outvars]

    def _constant_value(self, value: Any) -> _Value:
        """Return a constant of the function as a known value or a vector of reals."""
        if not isinstance(getattr(value, "dtype", np.dtype(int)), np.dtype):
            return value  # A random key, which no rule takes.
        array = np.asarray(value)
        if array.dtype != np.float64:
            return array
        name = self._names.get((array.shape, array.tobytes())) if array.ndim else None
        if name is None:
            return _Real(self.build.constant(array))
        return _Real(self.build.parameter(name, array))

    def _equation(self, equation: Any, operands: list[_Value], calls: tuple) -> list[_Value]:
        name, params = equation.primitive.name, equation.params
        calls = (*calls, equation)
        inner = jaxprs.called(equation, operands)
        if inner is not None:
            if "linalg" in jaxprs.function_file(equation):
                function = str(params.get("name", "")).lstrip("_")
                text = refusals.linalg(function)
                raise self._refusal(calls, text, f"jnp.linalg.{function}")
            jaxpr, consts, operands = inner
            return self._follow(jaxpr, [self._constant_value(c) for c in consts], operands, calls)
        # Not of a call: what it is given and does not use may be of any type.
        # Types of number that no proof can use.
        narrow = frozenset(np.dtype(name) for name in ("float32", "float16", jax.numpy.bfloat16))
        for variable in (*equation.invars, *equation.outvars):
            dtype = variable.aval.dtype
            if dtype in narrow:
                text = refusals.CAST if name == "convert_element_type" else refusals.FLOAT32
                raise self._refusal(calls, text, f"a {dtype} value ({name})")
        if name == "platform_index":
            return [np.asarray(jaxprs.default_platform(params["platforms"]))]
        real = isinstance(operands[0], _Real) if operands else False
        if name == "convert_element_type":
            return [self._convert(equation, operands[0], calls)]
        if name == "dot_general" and jaxprs.contracts_nothing(equation):
            raise self._refusal(calls, refusals.EMPTY, "a product along an axis without elements")
        if name in ARITHMETIC and real:
            return [_Real(self._arithmetic(name, params, operands))]
        if name in MOVEMENT or name in INDEXED:
            return self._move(equation, operands, calls)
        return self._number(equation, operands, calls)

    def _arithmetic(self, name: str, params: Any, operands: list[_Value]) -> Elements:
        """Apply one operation; a library call repeated on the same operands reuses its result."""
        arrays = [self._elements(operand) for operand in operands]
        settings = tuple(params[key] for key in ("y", "axes", "dimension_numbers") if key in params)
        key = (name, settings, tuple((array.shape, array.tobytes()) for array in arrays))
        if key not in self._done:
            self._done[key] = ARITHMETIC[name](self.build, arrays, params)
        return self._done[key]

    def _elements(self, value: _Value) -> Elements:
        return value.elements if isinstance(value, _Real) else self.build.constant(value)

    def _convert(self, equation: Any, operand: _Value, calls: tuple) -> _Value:
        dtype = np.dtype(equation.params["new_dtype"])
        if isinstance(operand, _Real):
            if dtype != np.float64:
                raise self._refusal(calls, refusals.CAST, f"a cast to {dtype}")
            return operand
        if dtype == np.float64:
            return _Real(self.build.constant(operand.astype(np.float64)))
        return operand.astype(dtype)

    def _move(self, equation: Any, operands: list[_Value], calls: tuple) -> list[_Value]:
        """Move elements or known numbers alike."""
        name = equation.primitive.name
        places = {"select_n": operands[:1]}.get(name, operands[1:] if name in INDEXED else [])
        if any(isinstance(place, _Real) for place in places):
            raise self._refusal(calls, refusals.advice(name), name)
        arrays = [v.elements if isinstance(v, _Real) else v for v in operands]
        if name in INDEXED and (beyond := outside(name, arrays, equation.params)):
            raise self._refusal(calls, refusals.OUTSIDE, beyond)
        parts = MOVEMENT[name](arrays, equation.params) if name in MOVEMENT else None
        if parts is None:
            out = equation.primitive.bind(*map(jax.numpy.asarray, arrays), **equation.params)
            parts = [np.asarray(out)]
        result: list[_Value] = []
        for variable, array in zip(equation.outvars, parts, strict=True):
            if np.dtype(variable.aval.dtype) != np.float64:
                result.append(array)
                continue
            if np.any(array == np.iinfo(np.int64).min):
                raise self._refusal(calls, refusals.OUTSIDE, f"{name} out of bounds")
            result.append(_Real(array))
        return result

    def _number(self, equation: Any, operands: list[_Value], calls: tuple) -> list[_Value]:
        """Compute everything else, masks and indices that are known now; or refuse."""
        name = equation.primitive.name
        if name.startswith(("random", "threefry")):
            raise self._refusal(calls, refusals.advice(name), name)
        axes_of_values = []
        for operand in operands:
            if isinstance(operand, _Real):
                if name not in EXACT or np.any(operand.elements >= 0):
                    raise self._refusal(calls, refusals.advice(name), name)
                operand = self.build.values(operand.elements)
            axes_of_values.append(jax.numpy.asarray(operand))
        out = equation.primitive.bind(*axes_of_values, **equation.params)
        results = out if equation.primitive.multiple_results else [out]
        return [self._constant_value(result) for result in results]

    def _refusal(self, calls: Sequence[Any], text: str, what: str) -> SpecError:
        """Return the error for the innermost of the calls, at the user's own line."""
        # JAX caches its own functions: the lines inside one may be those of an earlier caller.
        outer = next((call for call in calls if jaxprs.calls_library(call)), calls[-1])
        places = (refusals.source_line(jaxprs.frames(call)) for call in (outer, *reversed(calls)))
        where = next((place for place in places if place), "the spec")
        name = str(outer.params.get("name", "")).lstrip("_") if outer is not calls[-1] else ""
        within = f" inside {name}" if name not in ("", what) else ""
        return SpecError(f"{where}: cannot trace {what}{within}: {text}")
