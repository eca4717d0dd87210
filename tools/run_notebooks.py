"""Run notebooks and write what their cells show into them: no Jupyter is needed.

    .venv/bin/python tools/run_notebooks.py [NOTEBOOK.ipynb ...]

Without a name, all of examples/notebooks. Each runs in its own folder, as Jupyter would run it;
what it makes there (`runs/`) stays. A cell that fails ends everything, and nothing is written.
"""

import ast
import base64
import contextlib
import io
import json
import sys
from pathlib import Path
from typing import Any

from PIL import Image

from neuralgaits.runs import write_text

FOLDER = Path(__file__).parents[1] / "examples" / "notebooks"


def run(notebook: dict[str, Any], name: str) -> dict[str, Any]:
    """The notebook with the outputs of its code cells, all run in one namespace.

    Args:
        notebook: in nbformat 4.
        name: said of a line that fails.
    """
    names: dict[str, Any] = {"__name__": "__main__"}
    count, cells = 0, []
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            count += 1
            outputs = _outputs("".join(cell["source"]), f"{name}, cell {count}", names, count)
            cell = cell | {"execution_count": count, "outputs": outputs}
        cells.append(cell)
    return notebook | {"cells": cells}


def _outputs(source: str, where: str, names: dict[str, Any], count: int) -> list[dict[str, Any]]:
    """What was printed, and what the last line is if it is an expression."""
    tree = ast.parse(source, where)
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    printed = io.StringIO()
    value = None
    with contextlib.redirect_stdout(printed):
        exec(compile(tree, where, "exec"), names)
        if isinstance(last, ast.Expr):
            value = eval(compile(ast.Expression(last.value), where, "eval"), names)
    outputs: list[dict[str, Any]] = []
    if text := printed.getvalue():
        outputs.append({"output_type": "stream", "name": "stdout", "text": _lines(text)})
    if value is not None:
        result = {"output_type": "execute_result", "execution_count": count, "metadata": {}}
        outputs.append(result | {"data": _data(value)})
    return outputs


def _data(value: Any) -> dict[str, Any]:
    data: dict[str, Any] = {"text/plain": _lines(repr(value))}
    # What an object may show itself as, the richest first.
    forms = (("_repr_png_", "image/png"), ("_repr_html_", "text/html"))
    for method, kind in forms:
        if hasattr(value, method):
            shown = getattr(value, method)()
            if isinstance(shown, bytes):
                return {kind: base64.b64encode(_smaller(shown)).decode()}
            return data | {kind: _lines(shown)}
    return data


def _smaller(png: bytes) -> bytes:
    """The picture with few colours: a third of the size."""
    out = io.BytesIO()
    picture = Image.open(io.BytesIO(png)).convert("RGB")
    picture.quantize(64, Image.Quantize.MEDIANCUT).save(out, "PNG", optimize=True)
    return out.getvalue()


def _lines(text: str) -> list[str]:
    return text.splitlines(keepends=True)


def main() -> None:
    """Run the notebooks that are named, or all."""
    for path in map(Path, sys.argv[1:] or sorted(map(str, FOLDER.glob("*.ipynb")))):
        done = run_file(path.resolve())
        print(f"{path.name}: {done} code cells, {path.stat().st_size // 1000} kB")


def run_file(path: Path) -> int:
    """Run a notebook where it lies and write it again, whole. Returns: code cells."""
    notebook = json.loads(path.read_text(encoding="utf-8"))
    with contextlib.chdir(path.parent):
        done = run(notebook, path.name)
    write_text(path, json.dumps(done, indent=1, ensure_ascii=False) + "\n")
    return sum(cell["cell_type"] == "code" for cell in done["cells"])


if __name__ == "__main__":
    main()
