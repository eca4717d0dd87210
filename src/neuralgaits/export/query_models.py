"""Models of conditions in ONNX, and their distance from the Programs they were written from."""

from functools import partial

import numpy as np
import onnxruntime
from onnx import checker, helper

from neuralgaits._types import Float
from neuralgaits.errors import InputError, MismatchError
from neuralgaits.export.condition_query import INPUT, OUTPUT, ConditionQuery
from neuralgaits.export.design import Design
from neuralgaits.export.onnx_model import IR_VERSION, REALS
from neuralgaits.export.vnnlib_readme import README, readme
from neuralgaits.export.vnnlib_text import model_name, query_name, query_texts
from neuralgaits.programs import POINT, evaluate
from neuralgaits.programs.onnx_graph import OPERATOR_SET, graph
from neuralgaits.records.exported import QueryExport, QueryModel

LIMIT = 1e-9
"""Largest distance of a model in double precision from Python, in scales or shares of a margin."""


def query_files(
    design: Design, states: int
) -> "tuple[dict[str, str | bytes], partial[QueryExport]]":
    """Return models, queries and the page that explains them, and the factory of their record.

    Args:
        design: source of the queries.
        states: random points on which models and Python are compared, of all conditions.

    Raises: SpecError naming an operation that ONNX has no form of; InputError if Python's margins
        are not finite; MismatchError if a model is too far from Python.
    """
    queries = design.queries
    # Points of each condition that are compared: a call takes longer than that of a policy.
    points = min(max(states // len(queries), 1), 200)
    models = {model_name(query): condition_model(design, query, "double") for query in queries}
    rows = tuple(_compared(design, query, models[model_name(query)], points) for query in queries)
    record = partial(
        QueryExport,
        states=points * len(queries),
        limit=LIMIT,
        runtime=f"onnxruntime {onnxruntime.__version__}",
        models=rows,
    )
    return {**models, **query_texts(queries), README: readme(design, rows)}, record


def condition_model(design: Design, query: ConditionQuery, precision: str) -> bytes:
    """Return a condition as a model in `double` or `float` precision."""
    about = {
        INPUT: ", ".join(axis.name for axis in query.axes),
        OUTPUT: f"{query.margins} margins of {query.name}: it holds where none is negative",
    }
    model = helper.make_model(
        graph(query.program, query.file, REALS[precision], about),
        opset_imports=[helper.make_opsetid("", OPERATOR_SET)],
        ir_version=IR_VERSION,
        producer_name="neuralgaits",
        producer_version=design.origin.version,
        doc_string=f"condition {query.name} of a walking gait, region {query.region}",
    )
    checker.check_model(model, full_check=True)
    return model.SerializeToString()


def _compared(design: Design, query: ConditionQuery, model: bytes, points: int) -> QueryModel:
    """Compare a model with Python in both precisions. Raises: InputError; MismatchError."""
    x = random_points(query, points)
    with np.errstate(all="ignore"):
        margins = evaluate(query.program, {INPUT: x}, POINT)[OUTPUT]
    if not np.isfinite(margins).all():
        raise InputError(
            f"condition {query.name}: expected finite margins in its region, found NaN or infinity:"
            " the run's weights are damaged; restore the run, or train again"
        )
    double = distance(query, margins, model_answers(model, x))
    if not double <= LIMIT:
        raise MismatchError(
            f"condition {query.name}: ONNX Runtime and Python disagree: expected margins within "
            f"{LIMIT:g}, found {double:.3g}: do not use this model"
        )
    single = condition_model(design, query, "float")
    return QueryModel(
        condition=query.name,
        file=model_name(query),
        queries=tuple(query_name(query, number) for number in range(len(query.boxes))),
        difference=double,
        float_difference=distance(query, margins, model_answers(single, x.astype(np.float32))),
        model_bytes=len(model),
    )


def random_points(query: ConditionQuery, points: int) -> Float[np.ndarray, "B 1 n"]:
    """Return random points of the query's boxes, as many of each as of any other but one."""
    low, high = (
        np.array([getattr(query.boxes[i % len(query.boxes)], end) for i in range(points)])
        for end in ("low", "high")
    )
    share = np.random.default_rng(0).random(low.shape)
    return (low + share * (high - low))[:, None, :]


def distance(
    query: ConditionQuery, expected: Float[np.ndarray, "B 1 m"], values: Float[np.ndarray, "B 1 m"]
) -> float:
    """Return the largest distance, in scales of the condition, or shares of larger margins."""
    size = np.maximum(np.abs(expected), query.scale)
    return float(np.max(np.abs(values - expected) / size))


def model_answers(model: bytes, x: np.ndarray) -> Float[np.ndarray, "B 1 m"]:
    """Return what ONNX Runtime makes of points, one call a point, in float64."""
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.log_severity_level = 3  # Errors only.
    # Beyond these, factors of a product are put into it as attributes, in single precision.
    options.graph_optimization_level = onnxruntime.GraphOptimizationLevel.ORT_ENABLE_BASIC
    session = onnxruntime.InferenceSession(model, options, providers=["CPUExecutionProvider"])
    return np.array([session.run([OUTPUT], {INPUT: row})[0] for row in x], dtype=np.float64)
