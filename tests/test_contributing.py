"""The examples of CONTRIBUTING.md, as they stand there: each is added, and works everywhere."""

import importlib.util
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from exports import of_csv
from forms import large
from scenes import ensemble, scene

import roughmdr as rm
from roughmdr.report.export import formats
from roughmdr.shapes import SHAPES

S, R, E, W = 0.05, 3e-5, 4e6, 0.02
ROOT = Path(__file__).parent.parent
GUIDE = (ROOT / "CONTRIBUTING.md").read_text()


@pytest.fixture
def conoid(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    file = tmp_path / "conoid.py"
    file.write_text(re.findall(r"```python\n(.*?)```", GUIDE, flags=re.DOTALL)[0])
    spec = importlib.util.spec_from_file_location("conoid", file)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "conoid", module)
    spec.loader.exec_module(module)
    monkeypatch.setitem(SHAPES, "conoid", module.Conoid)
    return module


@pytest.mark.large
def test_the_shape_of_the_guide_is_a_series(conoid: ModuleType) -> None:
    new, same = conoid.Conoid(S, R), rm.PowerSeries({1.0: S, 2.0: 1.0 / (2.0 * R)})
    for work in (0.0, W):
        for control, values in (("indentation", [1e-9, 1e-7, 3e-6]), ("force", [1e-8, 1e-6, 1e-4])):
            one, other = (
                rm.indent(shape, effective_modulus=E, work=work, **{control: values}) for shape in (new, same)
            )
            for name in one.data_vars:
                np.testing.assert_allclose(one[name], other[name], rtol=1e-12)
    for control in ("displacement", "force"):
        one, other = (rm.pull_off(shape, effective_modulus=E, work=W, control=control) for shape in (new, same))
        assert float(one.force) == pytest.approx(float(other.force), rel=1e-12)


def test_the_shape_of_the_guide_works(conoid: ModuleType) -> None:
    new, x = conoid.Conoid(S, R), np.geomspace(1e-9, 1e-4, 7)
    np.testing.assert_allclose(new.f(x), S * x + x**2 / (2.0 * R), rtol=1e-14)
    np.testing.assert_allclose(new.g(x), 0.5 * np.pi * S * x + x**2 / R, rtol=1e-14)
    np.testing.assert_allclose(new.G(x), 0.25 * np.pi * S * x**2 + x**3 / (3.0 * R), rtol=1e-14)
    for work in (0.0, W):
        for control, values in (("indentation", [1e-7, 3e-6]), ("force", [1e-6, 1e-4])):
            one = rm.indent(new, effective_modulus=E, work=work, **{control: values})
            a = one.contact_radius.to_numpy()
            stretch = np.sqrt(2.0 * np.pi * a * work / E)
            np.testing.assert_allclose(one.indentation, new.g(a) - stretch, rtol=1e-12, atol=1e-12 * stretch.max())
            force = 2.0 * E * (a * new.g(a) - new.G(a) - a * stretch)
            np.testing.assert_allclose(one.force, force, rtol=1e-12, atol=2e-12 * E * (a * stretch).max())
    off = rm.pull_off(new, effective_modulus=E, work=W, control="force")
    assert rm.equilibria(new, effective_modulus=E, work=W, indentation=float(off.indentation)).sizes["equilibrium"] > 0
    data = ensemble([0.0, -1e-7], shape="conoid", slope=[S, 2.0 * S], radius=R)
    law = rm.load_separation(data, separation=[1e-6, -1e-6, 1e-6], effective_modulus=E, work=W)
    alone = [
        rm.indent(conoid.Conoid(s, R), effective_modulus=E, work=W, indentation=d)
        for s, d in ((S, 1e-6), (2 * S, 0.9e-6))
    ]
    assert float(law.force[1]) == pytest.approx(sum(float(one.force) for one in alone), rel=1e-12)


def test_the_export_format_of_the_guide_works(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (entry,) = re.findall(
        r"```python\n(.*?)```", GUIDE.split("## A new export format\n")[1].split("\n## ")[0], flags=re.DOTALL
    )
    monkeypatch.setitem(formats.FORMATS, "lsdyna", eval(entry, vars(formats)))
    path = {"separation": {"start": "clear", "stop": "0.5 sigma", "steps": 120}}
    law = rm.run(scene(adhesion=None, path=path, batch={"estimator": "expected"}))
    asked = {"error": 5e-3, "units": "mm,N,MPa"}
    rm.export(law, tmp_path / "law.k", to="lsdyna", **asked)
    rm.export(law, tmp_path / "law.csv", to="csv", **asked)
    lines = [line for line in (tmp_path / "law.k").read_text("ascii").splitlines() if line[0] != "$"]
    assert lines[:2] == ["*DEFINE_CURVE", "1"]
    numbers = [[float(line[:20]), float(line[20:])] for line in lines[2:]]
    np.testing.assert_allclose(numbers, of_csv(tmp_path / "law.csv").iloc[:, :2], rtol=1e-12)
    with pytest.raises(rm.StoreError, match="lsdyna has no table of quantity 'area'"):
        rm.export(law, tmp_path / "law.k", to="lsdyna", quantity="area")


_USE = """
import sys
sys.path.insert(0, {package!r})
import numpy as np
import roughmdr as rm
from scenes import ASPERITIES, ensemble, scene

{code}
"""
_DMT = """
E, w, R = 4e6, 0.05, np.array([5e-5, 1e-4])
data = ensemble([0.0, -1e-7], radius=R)
law = rm.load_separation(data, separation=[1e-6, -1e-6, 1e-6], effective_modulus=E, work=w, adhesion="dmt")
delta = np.array([1e-6, 0.9e-6])
exact = (4.0 / 3.0 * E * np.sqrt(R) * delta**1.5 - 2.0 * np.pi * w * R).sum()
assert abs(float(law.force[1]) - exact) <= float(law.numerical_error) * abs(exact)
assert float(law.force[0]) == float(law.force[2]) == 0.0
adhesion, asperities = {"model": "dmt", "work": w}, {**ASPERITIES, "radius": 5e-5, "count": 4000}
drawn = rm.run(scene(adhesion=adhesion, asperities=asperities, batch={"realizations": 4}), "out.nc").force
expected = rm.run(scene(adhesion=adhesion, asperities=asperities, batch={"estimator": "expected"})).force[0]
assert float(expected.min()) < 0.0 < float(expected.max())
assert float(abs(drawn.mean("realization") - expected).max()) < 0.1 * float(expected.max())
"""
_PERIMETER = """
names = ["contact_perimeter", "contact_radius_sum"]
for batch in ({"realizations": 2}, {"estimator": "expected"}):
    found = rm.run(scene(batch=batch, output={"variables": names}), f"{len(batch)}{list(batch)[0]}.nc")
    assert found.contact_perimeter.attrs["units"] == "m"
    np.testing.assert_allclose(found.contact_perimeter, 2.0 * np.pi * found.contact_radius_sum, rtol=1e-14)
    assert float(found.contact_perimeter.max()) > 0.0
"""


_STIFFENING = """
import json, subprocess, tomli_w, warnings
from pathlib import Path
from click.testing import CliRunner
from roughmdr.cli import main

def told(*arguments):
    return CliRunner().invoke(main, list(arguments)).output

plain = scene(adhesion=None, batch={"realizations": 2})
treated = plain | {"stiffening": {"factor": 1.5, "error": 0.1}}
treated["output"] = {"variables": ["force", "contact_area", "stiffness", "untreated_force"]}
before, after = rm.run(plain), rm.run(treated, "out.nc")
np.testing.assert_array_equal(after.force, 1.5 * before.force)
np.testing.assert_array_equal(after.untreated_force, before.force)
np.testing.assert_array_equal(after.contact_area, before.contact_area)
assert "stiffening.factor is known to 0.1 only" in after.attrs["warnings"]
assert "stiffer contacts: the scene has no [stiffening]" in before.attrs["left_out"]
assert "elastic contact of rough spheres" in rm.cite(after)
expected = [rm.run(table | {"batch": {"estimator": "expected"}}).force for table in (plain, treated)]
np.testing.assert_allclose(expected[1], 1.5 * expected[0], rtol=1e-15)
sweep = treated | {"sweep": {"stiffening.factor": [1.0, 1.5]}, "stiffening": {"error": 0.1}}
swept = rm.run(sweep, "swept.nc")
assert swept.cell_key[0] != swept.cell_key[1] == after.cell_key
np.testing.assert_array_equal(swept.force.sel(stiffening_factor=1.5), after.force)
more = rm.run(sweep | {"sweep": {"stiffening.factor": [1.0, 1.5, 3.0]}}, "swept.nc")
np.testing.assert_array_equal(more.run_time[:2], swept.run_time)  # they were not computed again
for wrong, says in (
    ({"stiffning": {"factor": 2}}, "unknown key; did you mean 'stiffening'?"),
    ({"stiffening": {}}, "is missing; for example: factor = 1.2"),
    ({"stiffening": {"factor": -1}}, "stiffening.factor = -1: must be above 0"),
    ({"adhesion": {"model": "jkr", "work": 0.05}, "stiffening": {"factor": 2}}, "does not go with adhesion"),
    ({"output": {"variables": ["untreated_force"]}}, "untreated_force needs [stiffening]"),
    ({"path": {"force": {"stop": "1 mN", "steps": 4}}, "stiffening": {"factor": 2}}, "not with path.force"),
    ({"nominal": {"radius": "1 mm"}, "stiffening": {"factor": 2}}, "each is of the elastic law under a flat"),
):
    Path("wrong.toml").write_text(tomli_w.dumps(plain | wrong))
    assert says in told("plan", "wrong.toml"), (says, told("plan", "wrong.toml"))
schema = json.loads(told("schema"))
assert schema["properties"]["stiffening"]["properties"]["factor"]["description"].startswith("Force over that without")
assert "stiffening.factor" in schema["properties"]["sweep"]["properties"]
assert "contacts that a treatment stiffens" in told("plot", "out.nc", "-o", "out.png", "--with-theory")
"""


@pytest.mark.large
@pytest.mark.parametrize(
    ("section", "code"),
    [large("adhesion model", _DMT), large("curve variable", _PERIMETER), ("section", _STIFFENING)],
)
def test_the_patches_of_the_guide_work(section: str, code: str, tmp_path: Path) -> None:
    shutil.copytree(ROOT / "roughmdr", tmp_path / "roughmdr", ignore=shutil.ignore_patterns("__pycache__"))
    (patch,) = re.findall(
        r"```diff\n(.*?)```", GUIDE.split(f"## A new {section}\n")[1].split("\n## ")[0], flags=re.DOTALL
    )
    (tmp_path / "example.diff").write_text(patch)
    subprocess.run(["git", "apply", "--unidiff-zero", "example.diff"], cwd=tmp_path, check=True)
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "tests"), "PYTHONWARNINGS": "ignore"}
    command = [sys.executable, "-c", _USE.format(package=str(tmp_path), code=code)]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
