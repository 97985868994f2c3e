"""Ensembles of asperities, and the sources that [asperities] in a scene chooses among.

Sources: ``random`` (distributions), ``gaussian`` (summits of a Gaussian surface), ``spectral`` (maps of one, and the
hills or summits of these), ``maps`` (those of a height map) and ``from_file`` (a saved ensemble). ``source`` declares
the interface of all.
"""

import operator
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any, SupportsIndex

from pydantic import Field

from roughmdr.ensemble.ensemble import Ensemble
from roughmdr.ensemble.from_file import FileAsperities
from roughmdr.ensemble.gaussian.section import NayakAsperities
from roughmdr.ensemble.maps.section import SurfaceAsperities
from roughmdr.ensemble.random.section import RandomAsperities
from roughmdr.ensemble.random.sections_of_shapes import AnyRandomAsperities
from roughmdr.ensemble.source import Source
from roughmdr.ensemble.spectral.section import SpectrumAsperities
from roughmdr.errors import SceneError, warn_limits
from roughmdr.schema.faults import validated
from roughmdr.schema.keywords import named_keywords

if TYPE_CHECKING:
    import xarray as xr

_AnySource = AnyRandomAsperities | NayakAsperities | SpectrumAsperities | SurfaceAsperities | FileAsperities
Asperities = Annotated[_AnySource, Field(discriminator="source")]
SOURCES: dict[str, type[Source]] = {
    "random": RandomAsperities,
    "nayak": NayakAsperities,
    "spectrum": SpectrumAsperities,
    "surface": SurfaceAsperities,
    "file": FileAsperities,
}
"""The sources by their names."""

__all__ = [
    "SOURCES",
    "Asperities",
    "Ensemble",
    "NayakAsperities",
    "RandomAsperities",
    "Source",
    "SpectrumAsperities",
    "SurfaceAsperities",
    "generate",
    "make",
]


@named_keywords
def generate(asperities: dict[str, Any] | Source, *, seed: int, realization: int = 0) -> "xr.Dataset":
    """Draw or read an ensemble of asperities, the same that a run with this seed loads.

    A LimitWarning says where the asperities are doubtful, such as those of a height map with few points per summit.

    Parameters
    ----------
    asperities : dict or section of a scene
        The table ``[asperities]`` of a scene, as a dictionary with its keys or as ``scene.asperities``. Quantities are
        numbers in SI or strings with a unit, such as ``"50 um"``.
    seed : int
        Seed of the random numbers, at least 0; ``seed`` of a scene.
    realization : int, optional
        Number of the realisation, from 0.

    Returns
    -------
    xarray.Dataset
        Over the dimension ``asperity``, from the highest summit to the lowest:

        - ``height`` [m], above the datum plane z = 0;
        - each parameter of the shape under its own name and in its own unit, such as ``radius`` [m]; the parameters of
          a profile that all asperities share (power_series, tabulated) lie over a dimension of their own;
        - ``x`` and ``y`` [m], where ``placement`` is given or the asperities come with positions.

        Attributes: ``shape``, ``seed``, ``nominal_area`` [m2] where it is known, ``patch`` (the side of the square
        nominal area) or ``patch_x`` and ``patch_y`` [m], ``warnings`` if there are any, and statistics of the source.

    Raises
    ------
    SceneError
        Where the section is wrong, with all faults at once; where seed or realization is not a whole number of at least
        0; where a file cannot be read.
    OutOfRange
        Where the asperities do not fit on the patch at the distance asked for.

    References
    ----------
    .. [1] P. R. Nayak, J. Lubr. Technol. 93 (1971) 398: summits of Gaussian surfaces, source "nayak".
    .. [2] J. A. Greenwood, Wear 261 (2006) 191: the radius 1/sqrt(k1 k2) of a summit, sources "nayak" and "surface".

    Examples
    --------
    >>> import roughmdr as rm
    >>> ensemble = rm.generate(
    ...     {
    ...         "source": "random",
    ...         "shape": "paraboloid",
    ...         "count": 2000,
    ...         "patch": "1 mm",
    ...         "height": {"distribution": "normal", "std": "1 um"},
    ...         "radius": {"distribution": "lognormal", "mean": "50 um", "std": "5 um"},
    ...     },
    ...     seed=1,
    ... )
    >>> dict(ensemble.sizes), list(ensemble.data_vars)
    ({'asperity': 2000}, ['height', 'radius'])
    >>> bool(ensemble.height[0] == ensemble.height.max())
    True
    >>> ensemble.attrs["shape"], float(ensemble.attrs["nominal_area"])
    ('paraboloid', 1e-06)
    """
    if not isinstance(asperities, dict | Source):
        raise SceneError(f"asperities is {asperities!r}; it must be a table, or the section of a scene")
    section: Source = validated(Asperities, asperities, "asperities") if isinstance(asperities, dict) else asperities
    ensemble = make(section, _whole_number("seed", seed), _whole_number("realization", realization))
    warn_limits(ensemble.warnings)
    return ensemble.labelled().to_xarray()


def make(section: Source, seed: int, realization: int) -> Ensemble:
    """Return an ensemble for a user to keep: with positions where the section says how to place the asperities."""
    placed = not section.model_fields_set.isdisjoint({"placement", "min_distance"})
    ensemble = section.ensemble(seed, realization, with_positions=placed)
    return replace(ensemble, warnings=(*section.warnings, *ensemble.warnings))


def _whole_number(name: str, value: object) -> int:
    if isinstance(value, bool) or not isinstance(value, SupportsIndex) or operator.index(value) < 0:
        raise SceneError(f"{name} is {value!r}; it must be a whole number of at least 0")
    return operator.index(value)
