"""Queries in VNN-LIB: a box of the input, and the negation of a condition on the output."""

from decimal import Decimal

from neuralgaits.export.condition_query import INPUT, OUTPUT, ConditionQuery, QueryBox


def model_name(query: ConditionQuery) -> str:
    """Return the file name of the model of a condition."""
    return f"{query.file}.onnx"


def query_name(query: ConditionQuery, number: int) -> str:
    """Return the file name of the query about one box of a condition, numbered from 0."""
    return f"{query.file}-{number}.vnnlib"


def query_texts(queries: tuple[ConditionQuery, ...]) -> dict[str, str]:
    """Return the text of every query and of the list of instances, by file name."""
    texts, rows = {}, []
    timeout = 300  # Seconds that `instances.csv` gives a tool for each query; anybody may edit it.
    for query in queries:
        for number, box in enumerate(query.boxes):
            name = query_name(query, number)
            texts[name] = query_text(query, box)
            rows.append(f"{model_name(query)},{name},{timeout}\n")
    return texts | {"instances.csv": "".join(rows)}


def query_text(query: ConditionQuery, box: QueryBox) -> str:
    """Return the query whether a condition is broken in a box.

    VNN-LIB has no strict order, so a margin of exactly 0 answers it, too: `unsat` says that all
    margins are positive, which is a little more than the condition. A tolerance would say less.
    """
    margins, outputs = query.margins, range(query.outputs)
    lines = [
        f"; condition {query.name}, region {query.region}: sat at X where it is broken",
        *(f"; {INPUT}_{i}: {axis.name}" for i, axis in enumerate(query.axes)),
        *(f"(declare-const {INPUT}_{i} Real)" for i in range(len(query.axes))),
        *(f"(declare-const {OUTPUT}_{i} Real)" for i in outputs),
    ]
    for i, (low, high) in enumerate(zip(box.low, box.high, strict=True)):
        lines.append(f"(assert (>= {INPUT}_{i} {decimal(low)}))")
        lines.append(f"(assert (<= {INPUT}_{i} {decimal(high)}))")
    allowed = "".join(f" (>= {OUTPUT}_{i} 0.0)" for i in outputs[margins:])
    broken = [f"(and (<= {OUTPUT}_{i} 0.0){allowed})" for i in outputs[:margins]]
    lines += ["(assert (or", *(f"    {one}" for one in broken), "))"]
    return "\n".join(lines) + "\n"


def decimal(number: float) -> str:
    """Return a number in decimals without an exponent, every one of its digits.

    Fewer would be another box for a tool that computes with reals.
    """
    text = f"{Decimal(number):f}"
    return text if "." in text else f"{text}.0"
