"""The architecture, held: a module imports from lines above its own, and what is heavy is loaded late."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parent.parent / "roughmdr"
LINES = (
    ("errors", "arguments", "variables", "labelled", "units", "quantities", "faults", "_jit", "_extended"),
    ("shapes",),
    ("kernels",),
    ("asperity",),
    ("ensemble",),
    ("scene",),
    ("aggregate",),
    ("theory",),
    ("plan", "statistics", "store", "result", "progress", "runner", "estimate"),
    ("curves", "analysis", "describe", "plots", "cli"),
)
LINE_OF = {part: number for number, line in enumerate(LINES) for part in line}
FILES = sorted(path for path in PACKAGE.rglob("*.py") if path != PACKAGE / "__init__.py")


def imports(path: Path) -> set[str]:
    """Every module that a file imports, anywhere in it."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names |= {f"{node.module}.{alias.name}" for alias in node.names}
    return names


def part(path: Path) -> str:
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_a_module_imports_only_from_its_own_line_or_above(path: Path) -> None:
    for name in imports(path):
        if name.startswith("roughmdr."):
            assert LINE_OF[name.split(".")[1]] <= LINE_OF[part(path)], f"{path.name} imports {name}"


@pytest.mark.parametrize(
    ("package", "allowed"),
    [
        ("dask", {"runner"}),
        ("numba", {"_jit"}),
        ("matplotlib", {"plots"}),
        ("click", {"cli"}),
        ("rich", {"progress"}),
        ("xarray", {"labelled", "asperity", "ensemble", "aggregate", "runner", "analysis", "plots"}),
        ("netCDF4", {"store", "scene"}),
    ],
)
def test_a_package_is_known_only_where_it_belongs(package: str, allowed: set[str]) -> None:
    users = {part(path) for path in FILES if any(name.split(".")[0] == package for name in imports(path))}
    assert users <= allowed


def test_importing_the_package_loads_nothing_heavy() -> None:
    code = "import sys, roughmdr, roughmdr.cli; print([m for m in sys.modules])"
    loaded = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout
    for heavy in ("numpy", "numba", "scipy", "xarray", "dask", "matplotlib", "pydantic", "netCDF4"):
        assert f"'{heavy}'" not in loaded


def test_every_public_name_is_there() -> None:
    import roughmdr

    for name in roughmdr.__all__:
        assert getattr(roughmdr, name) is not None
    assert callable(roughmdr.indent)
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        roughmdr.nothing  # noqa: B018
