"""C written from Programs against the Programs themselves, operation by operation."""

import numpy as np
import pytest

from neuralgaits.export.float_bound import largest_errors
from neuralgaits.export.programs import path, rate
from neuralgaits.programs import POINT, evaluate
from neuralgaits.programs.c99.constant_arrays import Tables
from neuralgaits.programs.c99.function import emit
from neuralgaits.programs.c99.operation_layout import BLOCK, WIDEST
from neuralgaits.programs.ops import KINDS
from neuralgaits.programs.tracing.tracer import trace
from support.compiled import DOUBLE, FLOAT, filter_program, filter_source, through
from support.program_cases import CASES, network, points_of


def _compiled(program, folder, flags):
    table = Tables("ng")
    emitted = emit(program, "ng_case", "A test.", table)
    sizes = [int(np.prod(item.shape)) for item in program.inputs]
    outs = [max(1, int(np.prod(item.shape))) for item in program.outputs]
    starts = np.cumsum([0, *sizes[:-1]]), np.cumsum([0, *outs[:-1]])
    arguments = [f"in + {i}" for i in starts[0]] + [f"out + {i}" for i in starts[1]]
    call = f"ng_case({', '.join(arguments)});"
    before = "\n".join([f"{emitted.prototype};", *table.texts.values(), emitted.body])
    return filter_program(folder, filter_source(before, call, sum(sizes), sum(outs)), flags)


def _flat(program, values, count=200):
    """Inputs or outputs side by side. [count, ...]."""
    return np.concatenate([values[item.name].reshape(count, -1) for item in program], axis=1)


@pytest.mark.parametrize("name", CASES)
def test_c_computes_what_the_program_says(name, tmp_path):
    """In double to rounding, in float within the bound of the running error analysis."""
    function, shapes = CASES[name]
    program = trace(function, shapes)
    points = points_of(program)
    expected = _flat(program.outputs, evaluate(program, points, POINT))
    inputs = _flat(program.inputs, points)
    found = through(_compiled(program, tmp_path / "double", DOUBLE), inputs)
    np.testing.assert_allclose(found.reshape(200, -1), expected, rtol=1e-13, atol=1e-13)
    single = through(_compiled(program, tmp_path / "float", FLOAT), inputs).reshape(200, -1)
    lows = {item.name: np.full(int(np.prod(item.shape)), -1.0) for item in program.inputs}
    cuts = {item.name: [4] + [1] * (int(np.prod(item.shape)) - 1) for item in program.inputs}
    errors = largest_errors(program, lows, {name: -low for name, low in lows.items()}, cuts)
    bound = np.concatenate(
        [np.broadcast_to(errors[o.name], max(1, int(np.prod(o.shape)))) for o in program.outputs]
    )
    apart = np.max(np.abs(single - expected), axis=0)
    assert np.all(apart <= bound)
    assert np.max(bound) < 1e-2


def test_every_operation_is_emitted():
    """The cases above use every kind."""
    used = {op.kind for f, shapes in CASES.values() for op in trace(f, shapes).operations}
    assert used == set(KINDS)


def work(widths):
    """Numbers on the stack of y_d and its rate."""
    program = trace(rate(network(widths)), {"z": (2,), "dz": (2,)})
    return emit(program, "f", "A test.", Tables("ng")).work


def test_arrays_are_lent_on():
    """Eight layers need no more memory than four: arrays of one layer serve the next."""
    assert work((32,) * 8) == work((32,) * 4) < 6 * 32


def test_a_first_layer_needs_no_array():
    """Two wide layers: values and rates of the second, a block of the first, little else."""
    assert work((WIDEST, WIDEST)) < 2 * WIDEST + 2 * BLOCK + 32
    assert work((WIDEST, WIDEST)) - work((32, 32)) == 2 * (WIDEST - 32)


def test_wide_layers_stand_whole():
    """Where strips of a matrix would cost time: values and rates of both layers."""
    wide = 2 * WIDEST
    assert 4 * wide <= work((wide, wide)) < 6 * wide


def test_a_matrix_stands_once():
    """Two functions of one policy share its tables."""
    policy, table = network((16, 16)), Tables("ng")
    emit(trace(rate(policy), {"z": (2,), "dz": (2,)}), "f", "A test.", table)
    numbers = table.numbers
    emit(trace(path(policy), {"z": (2,), "dz": (2,), "ddz": (2,)}), "g", "A test.", table)
    assert table.numbers - numbers < 4 * 16
    assert numbers >= 2 * 16 + 16 * 16 + 16 * 4
