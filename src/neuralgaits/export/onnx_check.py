"""Compare ONNX Runtime with Python on the same states, and measure distances and time."""

from collections.abc import Callable, Mapping
from functools import partial
from time import perf_counter_ns

import numpy as np
import onnxruntime

from neuralgaits._types import Float
from neuralgaits.errors import InputError, MismatchError
from neuralgaits.export.compare import limits, model_questions
from neuralgaits.export.design import Design
from neuralgaits.export.onnx_model import FILES, REALS
from neuralgaits.records.exported import Model, ModelAgreement, ModelExport, ModelLimits
from neuralgaits.records.link_figures import Percentiles

Given = Mapping[str, np.ndarray]
"""Inputs by name, a row a state."""
Policy = Callable[[Given], list[np.ndarray]]


def check_models(design: Design, files: Mapping[str, bytes], states: int) -> "partial[ModelExport]":
    """Run every model on random states of the region.

    Args:
        design: source of the models.
        files: models by file name.
        states: number of states.

    Returns: a record without the place of the files; `max_abs_error` and `latency_us` are
        those of the model in double precision.
    Raises: MismatchError if a model is too far from Python.
    """
    inputs, answers = model_questions(design, states)
    builds = []
    for precision, name in FILES.items():
        policy = _session(files[name])
        agreement = _agree(design, policy, inputs, answers, precision)
        builds.append(
            Model(
                runtime=f"onnxruntime {onnxruntime.__version__}",
                precision=precision,
                file=name,
                agreement=agreement,
                latency_us=_latency(policy, _as(inputs, precision)),
                model_bytes=len(files[name]),
            )
        )
    return partial(
        ModelExport,
        max_abs_error=builds[0].agreement.absolute,
        latency_us=builds[0].latency_us,
        states=states,
        limits={precision: ModelLimits(_limit(design, precision)) for precision in FILES},
        builds=tuple(builds),
    )


def _limit(design: Design, precision: str) -> float:
    """Return the largest distance of a model from Python, as a share of each output's range."""
    # Factor on the limits for C: in single precision the runtime approximates tanh and sigmoid more
    # coarsely than `ng_math.h`, and each version of it differently.
    shares = {"double": 1.0, "float": 2.0}
    return shares[precision] * limits(design, precision).output


def _session(model: bytes) -> Policy:
    """Return the model as a function of its inputs by name, on one thread."""
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.log_severity_level = 3  # Errors only.
    session = onnxruntime.InferenceSession(model, options, providers=["CPUExecutionProvider"])
    return lambda inputs: session.run(["y", "dy"], inputs)  # type: ignore[return-value]


def _as(inputs: Given, precision: str) -> Given:
    return {name: values.astype(REALS[precision]) for name, values in inputs.items()}


def _agree(
    design: Design,
    policy: Policy,
    inputs: Given,
    expected: Float[np.ndarray, "N 2 m"],
    precision: str,
) -> ModelAgreement:
    """Return the largest distances, as shares of each output's range and in rad and rad/s.

    Raises: InputError if Python's own outputs are not finite; MismatchError.
    """
    if not np.isfinite(expected).all():
        raise InputError(
            "expected a policy with finite outputs, found NaN or infinity: the run's weights are "
            "damaged; restore the run, or train again"
        )
    rows = _as(inputs, precision)
    outputs = np.array(
        [policy({name: values[i] for name, values in rows.items()}) for i in range(len(expected))]
    )
    gaps = np.max(np.abs(outputs.astype(np.float64) - expected), axis=0)
    ranges = np.ptp(expected, axis=0)
    # A policy of z1 alone may have an output that never moves.
    output, rate = np.max(gaps / np.where(ranges > 0.0, ranges, 1.0), axis=1)
    limit = _limit(design, precision)
    if not max(output, rate) <= limit:
        raise MismatchError(
            f"ONNX Runtime and Python disagree: expected outputs within {limit:g} of their range "
            f"in {precision} precision, found {max(output, rate):.3g}: do not use this model"
        )
    return ModelAgreement(float(output), float(rate), float(np.max(gaps)))


def _latency(policy: Policy, inputs: Given) -> Percentiles:
    """Measure times of calls from Python (us), one state each."""
    calls = 20_000
    times = np.empty(calls)
    for i in range(calls):
        row = {name: values[i % len(values)] for name, values in inputs.items()}
        start_time = perf_counter_ns()
        policy(row)
        times[i] = perf_counter_ns() - start_time
    p50, p99 = np.percentile(times, [50, 99]) * 1e-3
    return Percentiles(float(p50), float(p99))
