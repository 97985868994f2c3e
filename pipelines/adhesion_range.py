"""Adhesion of finite range: how far JKR is right, by the Tabor number, and what each law costs.

    python pipelines/adhesion_range.py -o results/studies

Writes adhesion_range.nc and adhesion_range.png: one paraboloid at several Tabor numbers, its pull-off force from DMT to
JKR, and for rough surfaces how far the force of JKR is from Dugdale's, from which the choice of model "auto" comes.
"""

import math
import time
import warnings
from pathlib import Path
from typing import TYPE_CHECKING

import click
import numpy as np
import xarray as xr
from scipy.stats import norm

import roughmdr as rm
from roughmdr.aggregate.tabor import SHIFT
from roughmdr.storage.atomic import replace_atomically
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.netcdf_writing import write_netcdf
from roughmdr.storage.result_file import provenance

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MODULUS, WORK, RADIUS = 4e6, 0.05, 50e-6  # of a soft rubber against a rigid body [Pa], [J/m^2], [m]
TIP = rm.Paraboloid(radius=RADIUS)
SHOWN = (0.1, 0.5, 1.0, 5.0)  # Tabor numbers of the curves
NUMBERS = np.logspace(-3.0, 3.0, 61)
ROUGH_NUMBERS = np.array([1.0, 3.0, 10.0, 30.0, 100.0])
RATIOS = (0.1, 0.3, 1.0, 3.0, 10.0)  # std of the heights over the depth at which JKR lets go
STOPS = (2.0, 0.0, -1.0)  # of the flat, in std
STEPS = 200
TINY = 1e-300  # no force at all


def strength(tabor: float) -> float:
    """sigma0 [Pa] of a Tabor number."""
    return tabor / rm.tabor(TIP, effective_modulus=MODULUS, work=WORK, strength=1.0)


def pull_off(points: int) -> xr.Dataset:
    """Pull-off force [N] of the paraboloid over the Tabor number, under dead load and under fixed grips."""
    numbers = NUMBERS[:: max(1, (NUMBERS.size - 1) // (points - 1))]
    force = [
        [
            float(
                rm.pull_off(
                    TIP,
                    effective_modulus=MODULUS,
                    work=WORK,
                    adhesion="dugdale",
                    strength=strength(mu),
                    control=control,
                ).force
            )
            for control in ("force", "displacement")
        ]
        for mu in numbers
    ]
    return xr.Dataset(
        {"pull_off_force": (("tabor", "control"), force, {"units": "N", "long_name": "pull-off force"})},
        coords={"tabor": ("tabor", numbers, {"long_name": "Tabor number"}), "control": ["force", "displacement"]},
    )


def rough(count: int) -> xr.Dataset:
    """How far JKR is from Dugdale, over the largest force, and seconds an asperity and step in contact of each law."""
    depth = -float(rm.pull_off(TIP, effective_modulus=MODULUS, work=WORK).indentation)
    quantiles = norm.ppf((np.arange(count) + 0.5) / count)
    error = np.empty((len(RATIOS), len(STOPS), ROUGH_NUMBERS.size))
    cost = np.empty((2, *error.shape))
    for i, ratio in enumerate(RATIOS):
        ensemble = xr.Dataset(
            {"height": ("asperity", quantiles * ratio * depth), "radius": ("asperity", np.full(count, RADIUS))},
            attrs={"shape": "paraboloid"},
        )
        for j, stop in enumerate(STOPS):
            for k, mu in enumerate(ROUGH_NUMBERS):
                reach = WORK / strength(float(mu))
                path = np.linspace(5.0 * ratio * depth + reach, stop * ratio * depth, STEPS)
                force = []
                for law, asked in enumerate(("jkr", "dugdale")):
                    sigma0 = strength(float(mu)) if asked == "dugdale" else None
                    started = time.perf_counter()
                    curve = rm.load_separation(
                        ensemble,
                        separation=path,
                        effective_modulus=MODULUS,
                        work=WORK,
                        adhesion=asked,  # type: ignore[arg-type]
                        strength=sigma0,
                        unload=True,
                    )
                    visits = max(float(curve.contact_count.sum()), 1.0)
                    cost[law, i, j, k] = (time.perf_counter() - started) / visits
                    force.append(curve.force.to_numpy())
                error[i, j, k] = np.abs(force[0] - force[1]).max() / max(np.abs(force[1]).max(), TINY)
    dims = ("roughness", "stop", "rough_tabor")
    return xr.Dataset(
        {
            "jkr_error": (
                dims,
                error,
                {"units": "1", "long_name": "largest difference of the forces over the largest"},
            ),
            "seconds": (("law", *dims), cost, {"units": "s", "long_name": "time an asperity in contact and step"}),
        },
        coords={
            "roughness": ("roughness", list(RATIOS), {"long_name": "std of the heights over the depth at pull-off"}),
            "stop": ("stop", list(STOPS), {"long_name": "closest separation, in std of the heights"}),
            "rough_tabor": ("rough_tabor", ROUGH_NUMBERS, {"long_name": "Tabor number"}),
            "law": ["jkr", "dugdale"],
        },
    )


def draw(result: xr.Dataset) -> "Figure":
    """Curves, pull-off, and the error of JKR."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(15, 4.6), layout="constrained")
    curves, off, error = figure.subplots(1, 3)
    scale = math.pi * WORK * RADIUS
    jkr = rm.pull_off(TIP, effective_modulus=MODULUS, work=WORK)
    depth = -float(jkr.indentation)
    for i, mu in enumerate((*SHOWN, math.inf)):
        law = {} if math.isinf(mu) else {"adhesion": "dugdale", "strength": strength(mu)}
        lowest = float(rm.pull_off(TIP, effective_modulus=MODULUS, work=WORK, **law).indentation)  # type: ignore[arg-type]
        delta = np.concatenate([lowest + (2.0 * depth - lowest) * np.linspace(0.0, 1.0, 400) ** 2])
        curve = rm.indent(TIP, effective_modulus=MODULUS, work=WORK, indentation=delta, **law)  # type: ignore[arg-type]
        label = "JKR" if math.isinf(mu) else f"Tabor number {mu:g}"
        curves.plot(delta / depth, curve.force / scale, color=f"C{i}" if law else "k", label=label)
        curves.plot(delta[0] / depth, curve.force[0] / scale, "o", color=f"C{i}" if law else "k", ms=4)
    curves.set(xlabel="indentation / |δc| of JKR", ylabel="force / πwR", xlim=(-8, 2), ylim=(-2.1, 2.0))
    curves.set_title("retraction of one paraboloid; dots: it lets go")
    curves.legend(fontsize=8)
    for control, label in (("force", "dead load"), ("displacement", "fixed grips")):
        off.semilogx(result.tabor, -result.pull_off_force.sel(control=control) / scale, label=label)
    for value, name in ((2.0, "DMT, 2 πwR"), (1.5, "JKR, dead load"), (5.0 / 6.0, "JKR, fixed grips")):
        off.axhline(value, color="0.7", lw=0.8)
        off.text(1.2e-3 if value < 2.0 else 20.0, value + 0.02, name, fontsize=8, color="0.4")
    off.set(xlabel="Tabor number", ylabel="pull-off force / πwR", title="pull-off between DMT and JKR")
    off.legend(fontsize=8)
    for i, ratio in enumerate(result.roughness.to_numpy()):
        worst = result.jkr_error.sel(roughness=ratio).max("stop")
        error.loglog(result.rough_tabor, worst, "o-", color=f"C{i}", label=f"std = {ratio:g} |δc|")
        error.loglog(result.rough_tabor, SHIFT / ratio / result.rough_tabor, "--", color=f"C{i}", lw=0.8)
    error.set(xlabel="Tabor number", ylabel="largest |F(JKR) - F(Dugdale)| / largest |F|", ylim=(1e-5, 3.0))
    error.set_title("rough surfaces; dashed: the rule of model 'auto'")
    error.legend(fontsize=8)
    return figure


def adhesion_range(count: int = 5000, points: int = NUMBERS.size) -> xr.Dataset:
    """All the numbers of this study."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.LimitWarning)
        rough(10)  # compiled before it is timed
        result = xr.merge([pull_off(points), rough(count)])
    return result.assign_attrs(
        provenance("Adhesion of finite range", "adhesion_range.py"), effective_modulus=MODULUS, work=WORK, radius=RADIUS
    )


@click.command(help=(__doc__ or "").split("\n", maxsplit=1)[0])
@click.option("-o", "--output", type=click.Path(file_okay=False, path_type=Path), default=Path("results/studies"))
@click.option("--count", type=click.IntRange(min=10), default=5000, show_default=True, help="Asperities.")
@click.option("--points", type=click.IntRange(min=3), default=NUMBERS.size, show_default=True, help="Tabor numbers.")
def main(output: Path, count: int, points: int) -> None:
    """Compute, print, write adhesion_range.nc and adhesion_range.png."""
    output.mkdir(parents=True, exist_ok=True)
    result = adhesion_range(count, points)
    write_netcdf(Labelled.of(result), output / "adhesion_range.nc")
    with replace_atomically(output / "adhesion_range.png") as temporary:
        draw(result).savefig(temporary, dpi=160, format="png")
    rule = SHIFT / result.roughness / result.rough_tabor
    click.echo(
        f"the error of JKR is at most {float((result.jkr_error / rule).max()):.2f} of {SHIFT:g} |δc|/std/Tabor number"
    )
    for name in result.law.to_numpy():
        typical = 1e9 * float(result.seconds.sel(law=name).median())
        click.echo(f"{name:<8} {typical:.0f} ns an asperity in contact and step, median")


if __name__ == "__main__":
    main()
