"""Docstrings begin with a verb or their subject; comments on constants name the quantity."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
_DOCSTRING = re.compile(r"(?:As|Of|Those|This|Likewise|What|The same)\b", re.IGNORECASE)
_COMMENT = re.compile(r"\s*_?[A-Z][A-Z0-9_]*\b[^#]*=[^#]*#\s*(?:of|over|times)\b")


def docstrings(tree: ast.AST) -> Iterator[str]:
    """Yield the docstrings of the module, of its classes and functions, and of attributes and constants."""
    for node in ast.walk(tree):
        match node:
            case ast.Expr(value=ast.Constant(value=str(text))):
                yield text.strip()


def faults(source: str) -> list[str]:
    """Return the first lines of docstrings, and the lines with comments, that begin as they should not."""
    found = [text.splitlines()[0] for text in docstrings(ast.parse(source)) if _DOCSTRING.match(text)]
    return found + [line for line in source.splitlines() if _COMMENT.match(line)]


def test_docstrings_and_comments_name_their_subject() -> None:
    for folder in ("roughmdr", "pipelines", "data_gen", "tests"):
        for file in sorted((ROOT / folder).rglob("*.py")):
            assert not faults(file.read_text()), file


def test_faults_are_found() -> None:
    assert faults('"""As the other."""\n_A, _B = 1, 2  # of a step\nclass C:\n    x: int\n    """Likewise."""\n') == [
        "As the other.",
        "Likewise.",
        "_A, _B = 1, 2  # of a step",
    ]
    assert not faults('"""Assume it."""\nA = 1  # overlap of two\nLONG: int = 3  # steps of a path\n')
