"""A map and its summits in words, and whether its size and its unit can be right."""

from collections.abc import Mapping

from roughmdr.ensemble.maps.height_map import MapWaves
from roughmdr.ensemble.maps.resolution import verdict
from roughmdr.schema.units import format_quantity


def describe_map(attrs: Mapping[str, float | int | str]) -> tuple[str, ...]:
    """Return lines on a map, its heights, its summits and their radii, from the attributes of its ensemble."""

    def length(name: str) -> str:
        return format_quantity(float(attrs[name]), "m")

    kept = "periodic" if attrs["periodic"] else "not periodic"
    heights = f"r.m.s. height {length('rms_height')}"
    if "rms_height_raw" in attrs:
        kept += f", detrended: {attrs['detrend']}"
        heights = f"r.m.s. height {length('rms_height_raw')} as measured, {length('rms_height')} of it kept"
    slopes = f"r.m.s. slope {attrs['rms_slope']:.3g}"
    if "cutoff" in attrs:
        kept += f", without waves below {length('cutoff')}"
        heights = (
            f"r.m.s. height {length('rms_height_raw')} as measured, {length('uncut_rms_height')} without the trend, "
            f"{length('rms_height')} after the cutoff"
        )
        slopes += f", uncut {attrs['uncut_rms_slope']:.3g}: pressures at a given contact area fall with it"
    hills = ""
    if attrs.get("asperity_model") == "hills":
        hills = f"hills on a wavelength of {length('wavelength')}, their contacts {attrs['area_share']:.2g} of the area"
        hills += f" of circles as stiff; r.m.s. slopes along and across differ by a factor of {attrs['anisotropy']:.3g}"
    rows = f", rows of the file along {attrs['rows_along']}" if "rows_along" in attrs else ""
    outliers = f", {attrs['outliers']} outliers among them" if "outliers" in attrs else ""
    if "blind_share" in attrs:
        outliers += f", and {attrs['blind_share']:.1%} of the others beside them, where no summits are found"
    remarks = (implausible(attrs), str(attrs.get("doubtful", "")))
    return (
        *filter(None, remarks),
        f"{length('patch_x')} x {length('patch_y')}{rows}, {attrs['undefined_share']:.2%} undefined{outliers}; {kept}",
        f"{heights}; {slopes}",
        f"{attrs['points_per_summit']:.3g} points a summit, misfit {attrs['misfit']:.2g}; "
        f"{attrs['saddles']} saddles left out",
        *filter(None, (hills, verdict(attrs))),
    )


def describe_moments(waves: MapWaves) -> str:
    """Return the moments of a map that a theory needs, with the shortest wave that determines them."""
    m0, m2, m4 = waves.moments
    return (
        f"moments of the map: m0 = {m0:.3g} m2, m2 = {m2:.3g}, m4 = {m4:.3g} m-2, by differences of neighbours; "
        f"m4, and so radii and number of summits, is that of its shortest waves, {_shortest(waves)}, and of noise"
    )


def describe_spectrum(waves: MapWaves) -> str:
    """Return the parameters of the spectrum of a map that a theory needs."""
    slope = "" if waves.spectrum is None else f", r.m.s. slope {waves.spectrum.rms_slope:.3g}"
    return f"spectrum of the map down to waves of {_shortest(waves)}{slope}"


def _shortest(waves: MapWaves) -> str:
    return format_quantity(waves.short_wave, "m")


IMPLAUSIBLE = "size or unit is implausible"

_SLOPES = 1e-6, 10.0
"""R.m.s. slopes: flatter is less than an atom from point to point of any scan, steeper no instrument sees."""
_SIDES = 1e-8, 1.0
"""Sides of maps [m]: from a few atoms to the size of a table."""
_HEIGHTS = 1e-11, 1e-2
"""R.m.s. heights [m]: from a tenth of an atom to more than any instrument's range."""


def implausible(attrs: Mapping[str, float | int | str]) -> str:
    """Return which numbers of a map, from its attributes, no correct size and unit have; empty for none."""
    slope, height = float(attrs["rms_slope"]), float(attrs["rms_height"])
    sides = [float(attrs[name]) for name in ("patch_x", "patch_y")]
    reasons = []
    if not _SLOPES[0] <= slope <= _SLOPES[1]:
        reasons.append(f"an r.m.s. slope of {slope:.2g}")
    if min(sides) < _SIDES[0] or max(sides) > _SIDES[1]:
        reasons.append(f"{' x '.join(format_quantity(side, 'm') for side in sides)}")
    if not _HEIGHTS[0] <= height <= _HEIGHTS[1]:
        reasons.append(f"an r.m.s. height of {format_quantity(height, 'm')}")
    return f"its {IMPLAUSIBLE}: {', '.join(reasons)}; give size, and unit of the heights, as measured" * bool(reasons)
