"""The architecture, held: a module imports from lines above its own, and what is heavy is loaded late."""

import ast
import statistics
import subprocess
import sys
from collections import Counter
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path
from typing import NamedTuple

import pytest
import tomli_w
from forms import large
from scenes import scene

import roughmdr as rm

PACKAGE = Path(__file__).parent.parent / "roughmdr"
LINES = (
    ("errors", "variables"),
    ("numerics",),
    ("schema",),
    ("storage",),
    ("spectrum",),
    ("shapes",),
    ("loading",),
    ("kernels",),
    ("springs",),
    ("asperity",),
    ("ensemble",),
    ("interaction",),
    ("elements",),
    ("model_error",),
    ("aggregate",),
    ("expected",),
    ("theory",),
    ("stages",),
    ("scene",),
    ("batch",),
    ("result",),
    ("runner",),
    ("pictures", "fitting"),
    ("report", "analysis"),
    ("cli",),
    ("__main__",),
)
LINE_OF = {part: number for number, line in enumerate(LINES) for part in line}
FILES = sorted(path for path in PACKAGE.rglob("*.py") if path != PACKAGE / "__init__.py")


class Facts(NamedTuple):
    """Every module that a file imports, anywhere in it; its constants, functions and classes; numbers of parameters."""

    imports: set[str]
    defined: Counter[str]
    parameters: dict[str, int]


@cache
def facts(path: Path) -> Facts:
    """Read a file once."""
    tree = ast.parse(path.read_text())
    found = Facts(set(), Counter(), {})
    for node in ast.walk(tree):
        match node:
            case ast.Import():
                found.imports.update(alias.name for alias in node.names)
            case ast.ImportFrom(module=str(module)):
                found.imports.update(f"{module}.{alias.name}" for alias in node.names)
            case ast.FunctionDef(args=listed):
                names = [each.arg for each in (*listed.posonlyargs, *listed.args, *listed.kwonlyargs)]
                names += [each.arg for each in (listed.vararg, listed.kwarg) if each is not None]
                many = len(names) - (names[:1] in (["self"], ["cls"]))
                found.parameters[node.name] = max(many, found.parameters.get(node.name, 0))
    for node in tree.body:
        match node:
            case ast.FunctionDef(name=name) | ast.ClassDef(name=name):
                found.defined[name] += 1
            case ast.Assign(targets=targets) | ast.AnnAssign(target=ast.Name() as targets):
                every = targets if isinstance(targets, list) else [targets]
                found.defined.update(
                    each.id for target in every for each in ast.walk(target) if isinstance(each, ast.Name)
                )
    return found


def test_a_file_defines_a_name_once() -> None:
    for path in FILES:
        twice = {name for name, times in facts(path).defined.items() if times > 1}
        assert not twice, f"{path} defines {twice} twice"


def part(path: Path) -> str:
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


def test_a_module_imports_only_from_its_own_line_or_above() -> None:
    for path in FILES:
        for name in facts(path).imports:
            if name.startswith("roughmdr."):
                assert LINE_OF[name.split(".")[1]] <= LINE_OF[part(path)], f"{path} imports {name}"


@pytest.mark.parametrize(
    ("package", "allowed"),
    [
        ("dask", ["runner/"]),
        ("distributed", ["runner/"]),
        ("numba", ["numerics/cache.py", "numerics/compiling.py", "numerics/jit.py", "numerics/numba_parts.py"]),
        ("matplotlib", ["pictures/"]),
        ("click", ["cli/"]),
        ("rich", ["runner/progress.py"]),
        (
            "xarray",
            [
                "storage/labelled.py",
                "storage/clocked.py",
                "asperity/",
                "ensemble/",
                "aggregate/",
                "runner/",
                "report/",
                "result/",
                "pictures/",
                "analysis/",
                "fitting/",
            ],
        ),
        ("netCDF4", ["storage/"]),
    ],
)
def test_a_package_is_known_only_where_it_belongs(package: str, allowed: list[str]) -> None:
    users = {path for path in FILES if any(name.split(".")[0] == package for name in facts(path).imports)}
    for path in users:
        assert str(path.relative_to(PACKAGE)).startswith(tuple(allowed)), f"{path.name} imports {package}"


def test_importing_the_package_loads_nothing_heavy() -> None:
    code = "import sys, roughmdr, roughmdr.cli; print([m for m in sys.modules])"
    loaded = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout
    for heavy in ("numpy", "numba", "scipy", "xarray", "dask", "matplotlib", "pydantic", "netCDF4"):
        assert f"'{heavy}'" not in loaded


_LISTED = """
import sys
from roughmdr.cli import main
try:
    main({arguments!r})
except SystemExit as end:
    assert end.code in (0, 2), end.code
print("loaded:", *sorted(name for name in sys.modules if "." not in name))
"""
_ALWAYS_HEAVY = {"dask", "matplotlib", "xarray", "pandas", "scipy", "numba"}


@pytest.mark.few(2)
@pytest.mark.parametrize(
    ("arguments", "may_load"),
    [
        (["--help"], set()),
        (["--version"], set()),
        (["new", "new.toml"], {"scipy"}),  # whose distributions the schema beside it lists
        large(["schema"], {"scipy"}),
        large(["warm", "small.toml", "--workers", "1"], {"scipy", "numba"}),
        (["cite", "out.nc"], set()),
        (["info", "out.nc"], set()),
        large(["info", "out.nc", "--json"], set()),
        large(["plan", "small.toml", "--json"], {"scipy", "numba"}),
        large(["run", "small.toml", "-o", "x.nc", "--json"], {"scipy", "numba"}),
        large(["run", "wrong.toml", "-o", "x.nc"], {"scipy"}),
        large(["generate", "small.toml", "-o", "x.nc"], {"scipy"}),
        large(["plan", "small.toml"], {"scipy", "numba"}),
        (["run", "small.toml", "-o", "x.nc"], {"scipy", "numba"}),
        (["run", "small.toml", "-o", "x.nc", "--set", "asperities.count=20000"], {"scipy", "numba", "dask"}),
        large(["fit", "curve.csv", "small.toml", "-o", "x.nc", "--free", "adhesion.work"], {"scipy", "numba"}),
        (["plot", "out.nc", "-o", "x.png"], {"matplotlib"}),
        large(["plot", "out.nc", "-o", "x.png", "--kind", "map"], {"matplotlib", "scipy", "numba"}),
        large(["report", "out.nc", "-o", "x.html"], {"matplotlib"}),
        large(["export", "out.nc", "-o", "x.inp", "--to", "abaqus"], {"scipy"}),  # refused, it reads the scene
        large(
            ["export", "out.nc", "-o", "x.csv", "--to", "csv", "--quantity", "nodes", "--error", "0.1"],
            {"scipy", "numba"},
        ),
        (["plot", "out.nc", "-o", "x.png", "--with-expected"], {"matplotlib", "scipy", "numba"}),
        large(["plot", "out.nc", "-o", "x.png", "--with-theory"], {"matplotlib", "scipy", "numba"}),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_a_command_loads_only_what_it_uses(tmp_path: Path, arguments: list[str], may_load: set[str]) -> None:
    (tmp_path / "small.toml").write_text(tomli_w.dumps(scene()))
    (tmp_path / "wrong.toml").write_text(tomli_w.dumps(scene(title=3)))
    (tmp_path / "curve.csv").write_text("separation [um], force [mN]\n3, 0\n2, 0.1\n1, 2\n0.5, 4\n")
    rm.run(scene(batch=None), tmp_path / "out.nc")
    code = _LISTED.format(arguments=arguments)
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    loaded = set(done.stdout.splitlines()[-1].split()[1:])
    assert loaded & _ALWAYS_HEAVY <= may_load


def test_every_public_name_is_there() -> None:
    import roughmdr

    for name in dir(roughmdr):
        assert getattr(roughmdr, name) is not None
    assert callable(roughmdr.indent)
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        roughmdr.nothing  # noqa: B018


def module_of(path: Path) -> str:
    parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def test_the_top_level_holds_few_rooms() -> None:
    rooms = [path for path in PACKAGE.iterdir() if path.suffix == ".py" or (path.is_dir() and any(path.glob("*.py")))]
    assert len(rooms) <= 30


def test_no_module_imports_itself_by_way_of_others() -> None:
    modules = {module_of(path): path for path in FILES}

    def targets(path: Path) -> set[str]:
        named = {name.rpartition(".")[0] if name not in modules else name for name in facts(path).imports}
        return (named & set(modules)) - {module_of(path)}

    graph = {module: targets(path) for module, path in modules.items()}
    TopologicalSorter(graph).prepare()  # CycleError names the modules of a circle


def test_files_are_short() -> None:
    lengths = [len(path.read_text().splitlines()) for path in FILES if path.name != "__init__.py"]
    assert max(lengths) <= 300
    assert 60 <= statistics.median(lengths) <= 150


def test_no_function_has_many_parameters() -> None:
    for path in FILES:
        many = {name for name, count in facts(path).parameters.items() if count > 8}
        assert not many, f"{path.name}: {many}"
