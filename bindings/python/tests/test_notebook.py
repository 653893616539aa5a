# SPDX-License-Identifier: MIT
"""The notebook ten_minutes.ipynb runs from top to bottom, and what is stored below its cells is what they show.

python3 test_notebook.py     stores what they show now
"""
import ast
import contextlib
import io
import json
import pathlib

NOTEBOOK = pathlib.Path(__file__).resolve().parents[1] / "ten_minutes.ipynb"


def lines(text):
    return text.splitlines(keepends=True)


def outputs_of(cell, names, count):
    """Runs a cell as a notebook does: what it prints, and its last line's value."""
    tree = ast.parse("".join(cell["source"]))
    last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
    printed, value = io.StringIO(), None
    with contextlib.redirect_stdout(printed):
        exec(compile(tree, NOTEBOOK.name, "exec"), names)
        if last:
            value = eval(compile(ast.Expression(last.value), NOTEBOOK.name, "eval"), names)
    shown = []
    if printed.getvalue():
        shown.append({"name": "stdout", "output_type": "stream", "text": lines(printed.getvalue())})
    if value is not None:
        data = {"text/plain": lines(repr(value))}
        if hasattr(value, "_repr_svg_"):
            data = {"image/svg+xml": lines(value._repr_svg_()), **data}
        shown.append({"data": data, "execution_count": count, "metadata": {}, "output_type": "execute_result"})
    return shown


def run():
    """(the cell, what it shows) of each cell with code."""
    names = {"__name__": "__main__"}
    cells = [cell for cell in json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"] if cell["cell_type"] == "code"]
    return [(cell, outputs_of(cell, names, i)) for i, cell in enumerate(cells, 1)]


def test_the_notebook_runs_and_shows_what_it_says():
    for cell, shown in run():
        assert cell["outputs"] == shown, "".join(cell["source"])


def store():
    notebook = json.loads(NOTEBOOK.read_text(encoding="utf-8"))
    code = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    for i, (cell, (_, shown)) in enumerate(zip(code, run()), 1):
        cell["outputs"], cell["execution_count"] = shown, i
    NOTEBOOK.write_text(json.dumps(notebook, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


if __name__ == "__main__":
    store()
