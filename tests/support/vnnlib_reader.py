"""A reader of VNN-LIB 1, as another tool's would be: nested lists, boxes and disjunctions."""

import re
from fractions import Fraction
from typing import Any

Bounds = dict[str, list[Fraction]]


def expressions(text: str) -> list[Any]:
    """Read a file as nested lists of words."""
    stack: list[list[Any]] = [[]]
    for word in re.findall(r"[()]|[^\s()]+", re.sub(r";.*", "", text)):
        if word == "(":
            stack.append([])
        elif word == ")":
            done = stack.pop()
            stack[-1].append(done)
        else:
            stack[-1].append(word)
    (found,) = stack
    return found


def read_query(text: str) -> tuple[Bounds, list[list[tuple[str, str, Fraction]]]]:
    """Return exact (low, high) of each input, and the cases of the output, any of which is sat.

    Each case is a list of (`<=` or `>=`, name of an output, number), all of which must hold.
    """
    bounds: Bounds = {}
    cases: list[list[tuple[str, str, Fraction]]] = []
    declared = set()
    for head, *rest in expressions(text):
        if head == "declare-const":
            assert rest[1] == "Real"
            declared.add(rest[0])
            continue
        assert head == "assert"
        ((kind, *operands),) = rest
        if kind == "or":
            cases = [[_comparison(c, declared) for c in case[1:]] for case in operands]
            assert all(case[0] == "and" for case in operands)
            continue
        order, name, number = _comparison([kind, *operands], declared)
        bounds.setdefault(name, [Fraction(-(10**9)), Fraction(10**9)])[order == "<="] = number
    return bounds, cases


def _comparison(words: list[str], declared: set[str]) -> tuple[str, str, Fraction]:
    order, name, number = words
    assert order in ("<=", ">=") and name in declared
    assert re.fullmatch(r"-?\d+\.\d+", number), number
    return order, name, Fraction(number)


def answers(text: str, x: Any, y: Any) -> bool:
    """Return whether a point, with the model's output there, satisfies a query."""
    bounds, cases = read_query(text)
    inside = all(
        low <= Fraction(float(x[int(name[2:])])) <= high for name, (low, high) in bounds.items()
    )

    def holds(order: str, name: str, number: Fraction) -> bool:
        value = float(y[int(name[2:])])
        return value <= number if order == "<=" else value >= number

    return inside and any(all(holds(*one) for one in case) for case in cases)
