"""The shape that CONTRIBUTING.md adds, as it stands there: one file and one line, and it works everywhere."""

import importlib.util
import re
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from scenes import ensemble

import roughmdr as rm
from roughmdr.shapes import SHAPES

S, R, E, W = 0.05, 3e-5, 4e6, 0.02


@pytest.fixture
def conoid(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    guide = (Path(__file__).parent.parent / "CONTRIBUTING.md").read_text()
    file = tmp_path / "conoid.py"
    file.write_text(re.findall(r"```python\n(.*?)```", guide, flags=re.DOTALL)[0])
    spec = importlib.util.spec_from_file_location("conoid", file)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "conoid", module)
    spec.loader.exec_module(module)
    monkeypatch.setitem(SHAPES, "conoid", module.Conoid)
    return module


def test_the_shape_of_the_guide_works(conoid: ModuleType) -> None:
    new, same = conoid.Conoid(S, R), rm.PowerSeries({1.0: S, 2.0: 1.0 / (2.0 * R)})
    x = np.geomspace(1e-9, 1e-4, 7)
    for name in ("f", "g", "G"):
        np.testing.assert_allclose(getattr(new, name)(x), getattr(same, name)(x), rtol=1e-14)
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
    assert rm.equilibria(new, effective_modulus=E, work=W, indentation=float(one.indentation)).sizes["equilibrium"] > 0
    data = ensemble([0.0, -1e-7], shape="conoid", slope=[S, 2.0 * S], radius=R)
    law = rm.load_separation(data, separation=[1e-6, -1e-6, 1e-6], effective_modulus=E, work=W)
    alone = [
        rm.indent(conoid.Conoid(s, R), effective_modulus=E, work=W, indentation=d)
        for s, d in ((S, 1e-6), (2 * S, 0.9e-6))
    ]
    assert float(law.force[1]) == pytest.approx(sum(float(one.force) for one in alone), rel=1e-12)
