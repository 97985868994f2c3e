"""The expected law of a result as quadrature nodes, for codes that sum the contacts themselves."""

from collections.abc import Iterator, Mapping
from pathlib import Path

from roughmdr.errors import StoreError
from roughmdr.expected.few_asperities import FewAsperities, few_asperities
from roughmdr.pictures.overlay import plan_of_result
from roughmdr.report.export.header import model_lines, origin_lines
from roughmdr.report.export.text import Column, Document
from roughmdr.report.export.units import UnitSystem
from roughmdr.result.select import cell_of, select
from roughmdr.result.view import ResultView
from roughmdr.scene import Scene
from roughmdr.shapes import SHAPES


def nodes_document(
    result: ResultView, file: Path | None, chosen: Mapping[str, object], error: float, units: UnitSystem
) -> Document:
    """Return the nodes whose sum is the expected law of a cell within ``error``, as few as are found.

    StoreError where the scene has no expected law of independent asperities over the separation, OutOfRange where nodes
    do not have it to that error.
    """
    cell, words = select(result, chosen)
    if (count := len(cell.cells)) > 1:
        raise StoreError(f"the result has {count} cells: select one")
    planned = plan_of_result(file, result).cells[result.cells.index(cell_of(result, chosen))]
    scene = planned.scene
    if reason := scene.reason_against("expected"):
        raise StoreError(f"quantity 'nodes' is of the expected law, which there is none of: {reason}")
    others = ["interaction"] * (scene.interaction is not None) + [each.key for each in scene.stages if each.unlike]
    if others:
        raise StoreError(f"quantity 'nodes' is of independent elastic asperities under a flat; scene has [{others[0]}]")
    found = few_asperities(
        scene.asperities,
        planned.path,
        effective_modulus=scene.effective_modulus,
        adhesion=scene.adhesion_model,
        error=error,
    )
    area = scene.asperities.nominal_area
    if area is None:
        raise StoreError("quantity 'nodes' is per nominal area, and the asperities have none")
    if "coefficient" in found.parameters and units.length.size != 1.0:
        raise StoreError("units: the coefficients of a power law depend on its exponent; give nodes in SI")
    length, density = units.length, units.of("1/m2")
    columns = [
        Column("height", length.name, found.height / length.size),
        Column("weight", density.name, found.weight / area / density.size),
    ]
    for name, values in found.parameters.items():
        unit = units.of(SHAPES[scene.asperities.shape_name].units[name])
        columns.append(Column(name, unit.name, values / unit.size))
    header = dict(origin_lines(cell, words)) | dict(_lines(scene, found, units)) | dict(model_lines(cell))
    return Document("nodes", header, tuple(columns))


def _lines(scene: Scene, found: FewAsperities, units: UnitSystem) -> Iterator[tuple[str, str]]:
    """Yield what the nodes are, how they are summed, and their errors."""
    adhesion, stress, tension = found.adhesion, units.stress, units.of("N/m")
    yield "law", "expected law of independent asperities"
    yield "units", units.names
    profile = scene.asperities.shared_profile
    yield "shape", scene.asperities.shape_name if profile is None else repr(profile)
    yield "effective modulus", f"{scene.effective_modulus / stress.size!r} {stress.name}"
    rule = "a node is in contact where its height is above the separation"
    if adhesion.work > 0.0:
        yield "adhesion", f"{adhesion.model}, work {adhesion.work / tension.size!r} {tension.name}"
        begin = "its height minus the separation reaches 0"
        if adhesion.cohesive:
            yield "strength", f"{adhesion.strength / stress.size!r} {stress.name}"
            begin = (
                f"its height minus the separation reaches {-adhesion.range / units.length.size!r} {units.length.name}"
            )
        rule = (
            f"a node is attracted or in contact once {begin} as the flat comes, and until the flat rises past its own "
            "detachment under fixed grips"
        )
    yield (
        "sum",
        "force per nominal area is the sum of weight P(height - separation) over the nodes, contact area likewise",
    )
    yield "contact of a node", f"P as rm.indent gives it for the shape, effective modulus and adhesion, in SI; {rule}"
    yield "points", f"{found.height.size} nodes"
    force, contact_area, count = found.errors
    yield (
        "error",
        f"force within {force:.2g}, contact area within {contact_area:.2g}, number in contact, which jumps at each "
        f"node, within {count:.2g} of the largest, at {found.separations} separations along the path",
    )
