"""Pictures of one asperity: the numbers behind them, for shapes of every kind, and what is refused."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from forms import large
from scenes import scene

import roughmdr as rm
from roughmdr.errors import StoreError
from roughmdr.kernels.adhesion import Adhesion
from roughmdr.pictures.asperity import draw_asperity, draw_contact
from roughmdr.pictures.one_contact import OneContact
from roughmdr.pictures.style import save
from roughmdr.result.view import ResultView
from roughmdr.shapes import Shape

MODULUS = 4e6
TABLE = np.linspace(0.0, 40e-6, 21)
JKR, DUGDALE, NONE = Adhesion(0.05), Adhesion(0.05, "dugdale", 5e5), Adhesion()
PARABOLOID, PUNCH, CONE = rm.Paraboloid(radius=50e-6), rm.FlatPunch(radius=7e-6), rm.Cone(slope=0.17)
CASES: dict[str, tuple[Shape, Adhesion, float]] = {
    "paraboloid": (PARABOLOID, NONE, 1e-6),
    "paraboloid, JKR": (PARABOLOID, JKR, 0.5e-6),
    "paraboloid, JKR, pulled": (PARABOLOID, JKR, -0.3e-6),
    "paraboloid, range": (PARABOLOID, DUGDALE, -0.1e-6),
    "cone, JKR": (CONE, JKR, 1e-6),
    "cone, range": (CONE, DUGDALE, 1e-6),
    "punch": (PUNCH, NONE, 1e-6),
    "punch, JKR": (PUNCH, JKR, -0.4e-6),
    "sphere": (rm.Sphere(radius=20e-6), JKR, 2e-6),
    "truncated cone": (rm.TruncatedCone(slope=0.17, flat_radius=6e-6), Adhesion(0.01), 1e-6),
    "table": (rm.Tabulated(TABLE, 0.07 * TABLE + TABLE**2 / 90e-6), JKR, 2e-6),
}
NAMES = [large(case) if case.startswith(("cone", "truncated cone", "table")) else case for case in CASES]
"""Names of all cases; long forms are those of shapes that nothing else here compiles."""


def contact_of(shape: Shape, adhesion: Adhesion, indentation: float) -> tuple[OneContact, float]:
    """The contact at an indentation, and its force."""
    how: Any = {"adhesion": "dugdale", "strength": adhesion.strength} if adhesion.cohesive else {}
    state = rm.indent(shape, effective_modulus=MODULUS, work=adhesion.work, indentation=indentation, **how)
    radius, force = float(state.contact_radius), float(state.force)
    contact = OneContact.of(shape, MODULUS, adhesion, radius=radius, force=force, indentation=indentation)
    return contact, force


@pytest.mark.few(3)
@pytest.mark.parametrize("case", NAMES)
def test_the_drawn_contact_has_the_indentation_and_the_force(case: str) -> None:
    contact, force = contact_of(*CASES[case])
    indentation = CASES[case][2]
    assert contact.state.indentation == pytest.approx(indentation, rel=1e-9)
    r, p, _ = contact.pressure()
    assert np.isfinite(p).all()
    inside = r < contact.state.radius
    angle = 0.5 * math.pi / np.count_nonzero(inside)  # points are even in asin(r/a)
    a = contact.state.radius
    total = 2.0 * math.pi * np.sum(p[inside] * r[inside] * np.sqrt(a * a - r[inside] ** 2)) * angle
    if contact.adhesion.cohesive:
        total -= math.pi * contact.adhesion.strength * (contact.state.reach**2 - a * a)
    assert total == pytest.approx(force, rel=2e-3)


@pytest.mark.parametrize("case", NAMES)
def test_the_springs_bear_the_force(case: str) -> None:
    contact, force = contact_of(*CASES[case])
    x, end = contact.springs()
    assert -MODULUS * (x[1] - x[0]) * end.sum() == pytest.approx(force, rel=0.12, abs=2e-6)  # of 26 springs


@pytest.mark.parametrize("case", NAMES)
def test_surface_and_body_touch_within_the_contact_alone(case: str) -> None:
    contact, _ = contact_of(*CASES[case])
    r, surface = contact.surface()
    body, a = contact.body(r), contact.state.radius
    size = np.ptp(surface)
    np.testing.assert_allclose(surface[r < a], body[r < a], atol=1e-9 * size)
    assert (body[(r > 1.001 * a) & ~np.isnan(body)] > surface[(r > 1.001 * a) & ~np.isnan(body)]).all()


def test_the_edge_is_lifted_by_dl_under_jkr() -> None:
    contact, _ = contact_of(*CASES["paraboloid, JKR"])
    dl = math.sqrt(2.0 * math.pi * contact.state.radius * 0.05 / MODULUS)
    assert contact.stretch == pytest.approx(dl, rel=1e-12)
    assert float(contact.mdr_profile(np.array([contact.state.radius]))[0]) == pytest.approx(dl, rel=1e-9)


@pytest.mark.few(1)
@pytest.mark.parametrize("case", NAMES)
def test_infinite_pressures_are_marked(case: str) -> None:
    contact, force = contact_of(*CASES[case])
    figure = draw_contact(contact, force, "A contact", [])
    marks = [each.get_text() for each in figure.axes[2].texts]
    infinite = contact.pressure().infinite
    assert len(marks) == sum(1 if radius == 0.0 else 2 for radius in infinite)
    edge = {mark for radius in infinite if radius == contact.state.radius for mark in marks[-2:]}
    assert edge <= ({"∞"} if case == "punch" else {"−∞"})


@pytest.mark.large
def test_the_asperity_of_a_result_is_the_one_with_the_largest_force() -> None:
    result = ResultView(rm.run(scene(batch=None)))
    figure = draw_asperity(result)
    title = figure.get_suptitle()
    assert "asperity 0 of 1000 (paraboloid), that with the largest force" in title
    assert "step 39 of 80 (loading)" in title
    ensemble = rm.generate(scene()["asperities"], seed=7)
    modulus = rm.effective_modulus("3 MPa", 0.49)
    tip = rm.Paraboloid(radius=float(ensemble.radius[3]))
    depth = float(ensemble.height[3]) + 0.5 * 1e-6
    alone = rm.indent(tip, effective_modulus=modulus, work=0.05, indentation=depth)
    assert (
        f"contact radius {1e6 * float(alone.contact_radius):.4g} µm" in draw_asperity(result, asperity=3).get_suptitle()
    )


def test_asperities_out_of_contact_are_refused() -> None:
    result = ResultView(rm.run(scene(batch=None)))
    with pytest.raises(StoreError, match="asperity is 999, which is not in contact at realisation 0, step 39"):
        draw_asperity(result, asperity=999)
    with pytest.raises(StoreError, match="asperity is 1000; the realisation has asperities 0 to 999"):
        draw_asperity(result, asperity=1000)
    with pytest.raises(StoreError, match="no asperity is in contact at realisation 0, step 79"):
        draw_asperity(
            ResultView(rm.run(scene(batch=None, adhesion=None, path={"separation": ["0 m", "9 um"] * 40}))), step=79
        )


@pytest.mark.large
def test_one_of_a_pair_is_drawn_with_its_radius_among_others() -> None:
    table = scene()["asperities"] | {"count": 20, "patch": "0.1 mm"}
    path = {"separation": ["2 um", "0.5 um"]}
    coupled = scene(batch=None, asperities=table, adhesion=None, interaction={"model": "pairwise"}, path=path)
    assert "among its neighbours" in draw_asperity(ResultView(rm.run(coupled))).get_suptitle()


@pytest.mark.large
@pytest.mark.parametrize("kind", [large("png"), "svg", large("pdf")])
def test_an_asperity_is_written_alike_each_time(tmp_path: Path, kind: str) -> None:
    contact, force = contact_of(*CASES["paraboloid, JKR"])
    written = []
    for name in ("one", "two"):
        save(draw_contact(contact, force, "A contact", []), tmp_path / f"{name}.{kind}")
        written.append((tmp_path / f"{name}.{kind}").read_bytes())
    assert written[0] == written[1]
