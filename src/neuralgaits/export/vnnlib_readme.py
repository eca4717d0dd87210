"""The page beside queries in VNN-LIB: axes, meaning of the answers, measured distances."""

from collections.abc import Sequence

from neuralgaits.export.condition_query import INPUT, OUTPUT, ConditionQuery
from neuralgaits.export.design import Design
from neuralgaits.records.exported import QueryModel

README = "README.md"


def readme(design: Design, models: Sequence[QueryModel]) -> str:
    """Return the text of the page. `models` are in the order of the design's queries."""
    queries, origin = design.queries, design.origin
    return "\n".join(
        (
            f"# Conditions of a walking gait of {design.controller.robot.name}",
            "",
            f"Written by neuralgaits {origin.version} from a run with the spec {origin.spec}: one "
            "ONNX model for each condition, one VNN-LIB query for each box of its region.",
            "`instances.csv` lists model, query and time limit in seconds.",
            "",
            f"- robot file: sha256 {origin.robot_sha256}",
            f"- policy: sha256 {origin.policy_sha256}",
            f"- its own proof: {origin.proof_verdict or 'none'}",
            "",
            *_input_section(queries[0]),
            *_answers_section(any(query.outputs > query.margins for query in queries)),
            *_conditions_section(queries, models),
            *_precision_section(models),
        )
    )


def _input_section(query: ConditionQuery) -> list[str]:
    rows = [
        f"| `{INPUT}_{i}` | {_cell(axis.name)} | {_cell(axis.meaning)} |"
        for i, axis in enumerate(query.axes)
    ]
    return [
        f"## Input {INPUT}",
        "",
        f"A point of the gait's chart, of shape (1, {len(rows)}):",
        "",
        "| element | axis | meaning |",
        "|---|---|---|",
        *rows,
        "",
    ]


def _answers_section(coupled: bool) -> list[str]:
    more = [
        "The last elements of Y, behind the margins, are negative where a command changes by more "
        "than the gait's largest change. Such X are left out: they answer no query.",
        "",
    ]
    return [
        f"## Output {OUTPUT} and answers",
        "",
        f"{OUTPUT} has the condition's margins, in its unit. The condition holds at {INPUT} if "
        "none of them is negative.",
        "",
        *(more if coupled else ()),
        "Each query asks for a point of the box with a margin of 0 or less:",
        "",
        "- `unsat`: the condition holds on the whole box, in the tool's arithmetic.",
        "- `sat`: the tool has found a point where the condition is broken, or its margin is 0. "
        "Evaluate the model there.",
        "",
        "These queries are about level 1: single states of the gait's zero dynamics. They say "
        "nothing about where a walk goes from there (levels 2 and 3), about joints off their "
        "desired angles (levels 4 and 5), or about a real robot. A tool that does not bound its "
        "own rounding shows nothing about margins near it.",
        "",
    ]


def _conditions_section(
    queries: Sequence[ConditionQuery], models: Sequence[QueryModel]
) -> list[str]:
    rows = [
        f"| {_cell(query.name)} | `{model.file}` | {_cell(query.region)} | {len(query.boxes)} | "
        f"{query.margins} | {query.scale:.6g} | {model.difference:.1e} | "
        f"{model.float_difference:.1e} |"
        for query, model in zip(queries, models, strict=True)
    ]
    return [
        "## Conditions",
        "",
        "| condition | model | region | boxes | margins | scale | double | single |",
        "|---|---|---|---|---|---|---|---|",
        *rows,
        "",
        "The last two columns are distances from Python at random points of the boxes, measured "
        "through ONNX Runtime, in scales of the condition or shares of larger margins: of the "
        "model in double precision, which is here, and of the same in single precision.",
        "",
    ]


def _precision_section(models: Sequence[QueryModel]) -> list[str]:
    worst = max(model.float_difference for model in models)
    return [
        "## Precision",
        "",
        "The models are in double precision, in operator set 17. A tool that computes in single "
        f"precision is about margins that are off by up to {worst:.1e} at the points measured; "
        "between these points nothing is known.",
        "",
        "Ask ONNX Runtime for basic graph optimisations (`ORT_ENABLE_BASIC`): its usual ones move "
        "factors of products into attributes in single precision, even in models in double "
        "precision.",
        "",
    ]


def _cell(text: str) -> str:
    return text.replace("|", "\\|")
