"""The error of the radii of the summits of a map, estimated from the map itself.

Measured on Gaussian maps whose summits are known (waves of one length, and self-affine ones of Hurst exponent 0.3 and
0.8 over a factor of 4 to 16), sampled at 2 to 40 points a shortest wave, with white noise of 0 to 0.1 of the r.m.s.
height: where the mean curvature is off by more than 5 %, the estimate is 0.84 to 1.9 times that in 90 % of 728 maps;
none that is off by more than 20 % is taken for resolved. Heights in steps are noise of that kind; noise that neighbours
share, as on a smoothed map, is not seen: for means over 2 x 2 points a misfit of 0.3 goes with 20 %, 0.6 with factors
of 2 and more.
"""

import math
from collections.abc import Mapping

from roughmdr.ensemble.maps.height_map import HeightMap
from roughmdr.schema.units import format_quantity

MAX_UNCERTAINTY = 0.15
"""Relative uncertainty of the radii above which there is a warning."""

FORCE_PER_RADIUS = 0.5
"""Relative error of a force over that of the radii: Hertz's force grows as their square root."""
MAX_SUMMITS_ERROR = FORCE_PER_RADIUS * MAX_UNCERTAINTY
"""Error of the force of summits by the resolution of their map above which there is a warning."""

# Without noise the mean curvature of the fits is too low by about the misfit: 2 % at 290 points a summit, 9 % at 74,
# 15 % at 42, 29 % at 19 where waves are equally long, misfit 6/points; 3 % at 260, 14 % at 68, 23 % at 42 where they
# are self-affine, misfit 9/points to 15/points. A misfit above that is due to noise.
_FEWEST_PER_MISFIT = 6.0
_USUAL_PER_MISFIT = 12.0
_MISFIT_OF_NOISE = 1.07  # misfit of maps that are white noise alone, which have 9.5 points a summit
_MAX_NOISE = 0.99  # largest share of noise in the squared curvature that is estimated

MAX_HILLS_ERROR = 0.05
"""Error of the force of hills by the resolution of their map above which there is a warning."""
_HILLS = 10.0
SUMMITS_BY_BORDER, HILLS_BY_BORDER = 0.1, 0.01
"""Error by the border over the share of a strip beside it: summits beyond are left out, hills counted if on the map."""

_MOST = 1.0 / math.sqrt(1.0 - _MAX_NOISE) - 1.0

_CAUSES = {
    "sampling": "the map does not resolve its summits",
    "noise": "noise, or the steps of its heights, sets them",
    "cutoff": "the cutoff sets them",
}


def noise_error(points_per_summit: float, misfit: float) -> float:
    """Return the relative deficit of the radii by white noise.

    The squares of the curvatures of surface and noise add up, and so do those of the fourth differences. So the misfit
    gives the share s of the noise in the squared curvature; without noise the radius is 1/sqrt(1 - s) times as large.
    """
    smooth = min(_FEWEST_PER_MISFIT / points_per_summit, 1.0)
    share = (misfit - smooth) * (misfit + smooth) / ((_MISFIT_OF_NOISE - smooth) * (_MISFIT_OF_NOISE + smooth))
    return 1.0 / math.sqrt(1.0 - min(max(share, 0.0), _MAX_NOISE)) - 1.0


def radius_errors(attrs: Mapping[str, float | int | str]) -> dict[str, float]:
    """Return the relative errors that the radii of a map may have, by cause, from the attributes of its ensemble.

    Too few points make them too large, and so does a cutoff, if all that it removes was real; noise makes them small.
    """

    def of(name: str) -> float:
        return float(attrs[name])

    points, misfit = of("points_per_summit"), of("misfit")
    errors = {"sampling": min(misfit, _USUAL_PER_MISFIT / points, 1.0), "noise": noise_error(points, misfit)}
    if "cutoff" in attrs:
        errors["cutoff"] = max(1.0 - of("uncut_mean_curvature_radius") / of("mean_curvature_radius"), 0.0)
    return errors


def radius_uncertainty(attrs: Mapping[str, float | int | str]) -> float:
    """Return the largest of these errors: the relative uncertainty of a radius of the ensemble."""
    return max(radius_errors(attrs).values())


def hills_error(points_per_wave: float) -> float:
    """Return the relative deficit of the force of hills by too few points.

    Measured on band-limited maps at 2 to 12 points a shortest wave, the force between 0.3 and 20 % contact, in the mean
    (``pipelines/study.py hills``): 10 to 13 % at 4.2 points a wavelength (``hills.find``), 4 to 5 % at 5.7, 2 % at 7.
    """
    return min(_HILLS / points_per_wave**3, 1.0)


def border_error(surface: HeightMap, length: float, share: float) -> float:
    """Return the error of the force by what the border of a map cuts: a ``share`` of that on a strip beside it, one
    wavelength or one mean distance of summits wide, ``length`` [m] (80 cut Gaussian maps, 3 to 20 wavelengths a side).
    """
    sides = (n * spacing for n, spacing in zip(surface.height.shape, (surface.dx, surface.dy), strict=True))
    return 0.0 if surface.periodic else share * min(2.0 * sum(length / side for side in sides), 1.0)


def verdict(attrs: Mapping[str, float | int | str]) -> str:
    """Return in words how well a map resolves its hills, or the uncertainty of radii, with its cause if it is large."""
    if attrs.get("asperity_model") == "hills":
        points, error = float(attrs["points_per_wave"]), float(attrs["resolution_error"])
        low = f"forces too low by about {100.0 * error:.0f} % for want of points"
        return f"{points:.3g} points a wavelength: {low if error > MAX_HILLS_ERROR else 'the map resolves its hills'}"
    errors = radius_errors(attrs)
    cause = max(errors, key=errors.__getitem__)
    error = errors[cause]
    if error <= MAX_UNCERTAINTY:
        return f"radii right to about {max(100.0 * error, 1.0):.0f} %: the map resolves its summits"
    if error < 1.0:
        return f"radii uncertain by about {100.0 * error:.0f} %: {_CAUSES[cause]}"
    return f"radii uncertain by a factor of about {1.0 + error:.2g}{' or more' * (error >= _MOST)}: {_CAUSES[cause]}"


def warning(name: str, attrs: Mapping[str, float | int | str]) -> str:
    """Return the warning of a map ``name`` that does not resolve its hills, or its summits' radii; empty for none."""
    if attrs.get("asperity_model") == "hills":
        noise = "or what it shows between neighbouring points is noise; a finer map would tell"
        return f"{name}: {verdict(attrs)}, {noise}" if float(attrs["resolution_error"]) > MAX_HILLS_ERROR else ""
    errors = radius_errors(attrs)
    if max(errors.values()) <= MAX_UNCERTAINTY:
        return ""
    text = f"{name}: {verdict(attrs)} ({attrs['points_per_summit']:.3g} points a summit, misfit {attrs['misfit']:.2g})"
    if errors.get("cutoff", 0.0) == max(errors.values()):
        radius, uncut = (
            format_quantity(float(attrs[key]), "m") for key in ("mean_curvature_radius", "uncut_mean_curvature_radius")
        )
        return (
            f"{text}; the radius of the mean curvature is {radius}, uncut {uncut}: right only if all that it takes "
            "away was measured to be noise"
        )
    return (
        f"{text}; a finer map would tell. A cutoff is for noise that was measured: it takes real roughness away as "
        "well, and generate --cutoffs tells what it costs"
    )
