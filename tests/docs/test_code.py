"""Every Python block on a page runs, in the page's order, in a folder with a trained run."""

import jax
import pytest

from neuralgaits.barriers import specs
from neuralgaits.cli.main import main
from neuralgaits.robots import load_robot
from support import pages

WITH_CODE = [page for page in pages.PAGES if pages.blocks(page, "python")]


def run(page, place) -> dict:
    """Save the page's files, then run its blocks in one namespace. Returns: its names."""
    for name, text in pages.files(page).items():
        (place / name).write_text(text, encoding="utf-8")
    names: dict = {"__name__": page.stem}
    code = pages.blocks(page, "python")
    if any("gymnasium" in block.text for block in code):
        pytest.importorskip("gymnasium", reason="needs the gym extra: gymnasium")
    for words in pages.commands(page):
        # What a command on the page writes is there when the code below reads it.
        out = words[words.index("--out") + 1] if "--out" in words else None
        if out is not None and any(out in block.text for block in code):
            assert main(words[1:]) == 0
    for block in code:
        # Blank lines before it, so that an error shows the line of the page.
        source = "\n" * (block.line - 1) + block.text
        exec(compile(source, pages.name(page), "exec"), names)
    return names


CONDITIONS = pages.ROOT / "docs" / "conditions.md"


README = pages.ROOT / "README.md"
"""Trains, walks, proves and draws."""


@pytest.mark.parametrize(
    "page",
    [
        pytest.param(page, marks=pytest.mark.slow if page == README else (), id=pages.name(page))
        for page in WITH_CODE
        if page != CONDITIONS
    ],
)
def test_code_of_a_page_runs(page, place):
    assert run(page, place)


def test_margins_of_the_conditions_page(place):
    """One margin an inequality: of the hip, of two bounds on four joints, of a tolerance."""
    margins = run(CONDITIONS, place)["margins"]
    assert margins["hip-height"].shape == (1,)
    assert margins["power-upper"].shape == (4,)
    assert margins["symmetric-step"].shape == (2, 1)


def test_the_spec_of_the_recipe_is_one(place):
    page = pages.ROOT / "CONTRIBUTING.md"
    run(page, place)
    robot = load_robot("amber3m")
    brisk = specs.load("mine.py:brisk", robot)
    more = {condition.name for condition in brisk.conditions} - {
        condition.name for condition in specs.walking(robot).conditions
    }
    assert more == {"brisk"}
    gait = brisk.new_gait(jax.random.key(0), "posture", None)
    assert gait.policy is not None
