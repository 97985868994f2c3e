"""The notebook among the examples runs cell by cell, and every object at the end of a cell can be shown."""

import ast
import json
from pathlib import Path
from typing import Any

import pytest

NOTEBOOK = Path(__file__).parent.parent.parent / "docs" / "examples" / "first_steps.ipynb"


@pytest.mark.large
def test_the_notebook_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run cells as a notebook does, which shows the last expression of each."""
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    shown = []
    for cell in json.loads(NOTEBOOK.read_text())["cells"]:
        if cell["cell_type"] == "code":
            *begin, last = ast.parse("".join(cell["source"])).body
            exec(compile(ast.Module(begin, []), NOTEBOOK.name, "exec"), names)
            assert isinstance(last, ast.Expr)
            shown.append(eval(compile(ast.Expression(last.value), NOTEBOOK.name, "eval"), names))
    scene, law, at, figure, fit = shown
    assert all("<table" in each._repr_html_() for each in (scene, law, fit))
    assert all("<svg" in each._repr_html_() for each in (law, fit))
    assert "force_mean" in at
    assert figure._repr_png_().startswith(b"\x89PNG")
    assert [axes.get_xgridlines()[0].get_visible() for axes in figure.axes] == [True, True]
    assert float(names["fit"].material_modulus) == pytest.approx(3e6, rel=0.1)


def test_the_notebook_holds_no_output() -> None:
    notebook = json.loads(NOTEBOOK.read_text())
    assert notebook["nbformat"] == 4
    codes = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert all(cell["outputs"] == [] and cell["execution_count"] is None for cell in codes)
    assert len({cell["id"] for cell in notebook["cells"]}) == len(notebook["cells"])
