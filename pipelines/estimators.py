"""Error against run time of the three estimators: sampled, stratified, expected.

    python pipelines/estimators.py -o results/studies

The expected law is held against a double integral with 25 digits, samples of many sizes against the expected law.
Writes estimators.nc and estimators.png.
"""

from pathlib import Path

import click
import numpy as np
import xarray as xr
from estimators_measured import ASKED, DRAWN, ORDERS, SCENES, SPREADS, by_draws, by_order, by_spread, expected
from estimators_pictures import draw

from roughmdr.labelled import Labelled
from roughmdr.store import provenance, replacing, write


def slope(x: np.ndarray, error: np.ndarray) -> float:
    """Of log error over log x."""
    return float(np.polyfit(np.log(x), np.log(error), 1)[0])


def decades_a_node(error: list[float], noise: float) -> float:
    """By how many decades each node of Gauss's rule takes the error down; 0 where one node is right already."""
    orders, values = np.array(ORDERS), np.array(error)
    clear = values > noise
    return -float(np.polyfit(orders[clear], np.log10(values[clear]), 1)[0]) if clear.sum() > 1 else 0.0


def study(quick: bool) -> xr.Dataset:
    """All figures; ``quick`` with small ensembles and few points of the reference."""
    counts = 2 ** np.arange(6, 12 if quick else 17)
    large = slice(-4, None)  # where the run time grows with the number
    each = []
    for rough in SCENES.values():
        force, errors, asked = expected(rough, *((2, 16) if quick else (5, 25)))
        error, seconds = by_draws(rough, force, counts)
        order_error, order_seconds = by_order(rough)
        rate = decades_a_node(order_error, errors["numerical_error"])
        over_count = [slope(counts, row) for row in error]
        over_time = [slope(row[large], off[large]) for row, off in zip(seconds, error, strict=True)]
        variables = {
            "error": (("estimator", "count"), error, one("r.m.s. error of the force over its largest")),
            "seconds": (("estimator", "count"), seconds, s("time of a realisation of 200 separations")),
            "slope_count": ("estimator", over_count, one("slope of log error over log number")),
            "slope_time": ("estimator", over_time, one("slope of log error over log time, four largest numbers")),
            "order_error": ("order", order_error, one("r.m.s. error of the expected force over its largest")),
            "order_seconds": ("order", order_seconds, s("time of the expected force with so many nodes")),
            "decades_a_node": ((), rate, one("decades of error for a node over the radii")),
            "expected_seconds": ("asked", asked, s("time of the expected law, 200 separations")),
            "reference_error": ((), errors["reference_error"], one("largest difference from the double integral")),
            "numerical_error": ((), errors["numerical_error"], one("error that the expected law states")),
        }
        each.append(xr.Dataset(variables))
    named = {"estimator": list(DRAWN), "count": counts, "order": list(ORDERS), "asked": list(ASKED)}
    result = xr.concat(each, xr.Variable("scene", list(SCENES))).assign_coords(named)
    result["spread_error"] = (
        ("spread", "order"),
        by_spread(),
        one("r.m.s. error of the expected force over its largest"),
    )
    result = result.assign_coords(spread=list(SPREADS))
    titles = {
        "count": "number of asperities",
        "order": "nodes over the radii",
        "spread": "std of the radii over their mean",
    }
    for name, title in titles.items():
        result[name].attrs.update(one(title))
    return result.assign_attrs(provenance("Error against run time of the estimators", "estimators.py"))


def one(name: str) -> dict[str, str]:
    """The attributes of a number without a unit."""
    return {"units": "1", "long_name": name}


def s(name: str) -> dict[str, str]:
    """The attributes of a time."""
    return {"units": "s", "long_name": name}


@click.command(help=(__doc__ or "").split("\n", maxsplit=1)[0])
@click.option("-o", "--output", type=click.Path(file_okay=False, path_type=Path), default=Path("results/studies"))
@click.option("--quick", is_flag=True, help="Small ensembles: seconds, and rough figures.")
def main(output: Path, quick: bool) -> None:
    """Measure, print, write estimators.nc and estimators.png."""
    output.mkdir(parents=True, exist_ok=True)
    result = study(quick)
    write(Labelled.of(result), output / "estimators.nc")
    with replacing(output / "estimators.png") as temporary:
        draw(result).savefig(temporary, dpi=160, format="png")
    for title in result.scene.to_numpy():
        own = result.sel(scene=title)
        click.echo(title)
        for method in DRAWN:
            last, slopes = own.sel(estimator=method).isel(count=-1), own.sel(estimator=method)
            click.echo(
                f"  {method:<10} error ~ N^{float(slopes.slope_count):.2f} ~ time^{float(slopes.slope_time):.2f}; "
                f"{int(last['count'])} asperities {float(last.error):.1e} in {1e3 * float(last.seconds):.1f} ms"
            )
        times = ", ".join(f"{name} {1e3 * float(own.expected_seconds.sel(asked=name)):.1f} ms" for name in ASKED)
        click.echo(
            f"  expected   {float(own.decades_a_node):.2f} decades a node; off by {float(own.reference_error):.1e}, "
            f"states {float(own.numerical_error):.1e}; {times}"
        )


if __name__ == "__main__":
    main()
