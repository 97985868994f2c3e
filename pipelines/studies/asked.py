"""[accuracy] of: whether a quantity that is asked for is as right as was asked, and at what cost.

Requests are drawn at random. The truth is the mean of many realisations of independent asperities, corrected by the
ratio of boundary elements, or of pairs with JKR, to these on a few.
"""

import math
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

import roughmdr as rm
from roughmdr.batch.stopping_rule import FEWEST
from studies.comparison import of_rows
from studies.study import Study, in_two_processes, table, timed, without_limits

SEED = 11
REQUESTS = {False: tuple(range(40)), True: (12, 30, 32)}  # numbers of the requests in full and in reduced form
_MANY, _FEW = 1000, 6  # realisations of independent asperities, and of those by which they are corrected
_PATCH = 1e-4  # side of the patch [m]
_KINDS = ("random", "random", "random", "jkr", "spectrum")
_QUANTITIES = ("contact_area", "contact_area", "stiffness", "separation", "force")
_GRID, _AREA_GRID = 1e-2, 2e-3
"""Error of the force by the grid of boundary elements that are the truth, where no area is asked for, or one is."""
_COLUMNS = {
    "asked": "relative error that was asked for; none of a separation",
    "reached": "error that was stated over that asked for",
    "error": "true error over that asked for",
    "unknown": "error of the truth, by its scatter and its grid, over the error asked for",
    "independent": "true error of independent asperities over that asked for",
    "realizations": "number of realisations",
    "fewest": "number of realisations that would have been enough",
    "whole": "time of the run with the choice of the method in seconds",
}


def draw_surface(chance: np.random.Generator, kind: str) -> dict[str, Any]:
    """Return sections of a scene without a path."""
    scene: dict[str, Any] = {"title": kind, "material": {"effective_modulus": 1e9}, "seed": int(chance.integers(1000))}
    if kind == "spectrum":
        scene["asperities"] = {
            "source": "spectrum", "patch": _PATCH, "long_wave": _PATCH / chance.choice([3, 4, 6]),
            "short_wave": _PATCH / chance.choice([12, 16]), "hurst": float(chance.choice([0.5, 0.8])),
            "rms_slope": 0.05, "points": 6.0,
        }  # fmt: skip
        return scene
    count = round(math.exp(chance.uniform(math.log(30), math.log(45 if kind == "jkr" else 150))))
    spacing = _PATCH / math.sqrt(count)
    radius = spacing * chance.uniform(3.0, 10.0)
    std = 0.1 * spacing**2 / radius * math.exp(chance.uniform(-1.0, 1.0))
    scene["asperities"] = {
        "source": "random", "shape": "paraboloid", "count": count, "patch": _PATCH, "radius": radius,
        "height": {"distribution": "normal", "std": std},
    }  # fmt: skip
    if kind == "jkr":
        stretch = std * math.exp(chance.uniform(math.log(0.02), math.log(0.3)))
        scene["adhesion"] = {"model": "jkr", "work": 1e9 * stretch**1.5 / math.sqrt(radius) / 3.0}
    return scene


def law_of(scene: dict[str, Any], **sections: Any) -> xr.Dataset:
    """Return the result of a scene with more sections."""
    with without_limits():
        return rm.run({**scene, **sections}, workers=1)


def draw_request(number: int) -> tuple[dict[str, Any], str, str, float, float]:
    """Return a surface, a quantity, what is given with its value in SI, and the error asked for, of a length [m]."""
    chance = np.random.default_rng([SEED, number])
    scene = draw_surface(chance, _KINDS[number % len(_KINDS)])
    fraction = math.exp(chance.uniform(math.log(0.003), math.log(0.1)))
    path = {"separation": {"stop": {"contact_fraction": min(1.2 * fraction, 0.1)}, "steps": 60}}
    summits = {"asperities": {**scene["asperities"], **({"model": "summits"} if scene["title"] == "spectrum" else {})}}
    output = {"variables": ["force", "pressure", "contact_fraction", "stiffness"]}
    found = law_of(scene, **summits, path=path, batch={"realizations": 4}, output=output)
    place = found.roughmdr.at_contact_fraction(fraction).mean("realization")
    if not np.isfinite(place["force"]):  # no realisation reaches it: the end of the path
        place = found.isel(step=-1).mean("realization")
    given = str(chance.choice(["pressure", "pressure", "pressure", "force", "separation"]))
    allowed = [name for name in _QUANTITIES if name != given and {name, given} != {"force", "pressure"}]
    quantity = str(chance.choice(allowed))
    tolerance = math.exp(chance.uniform(math.log(0.03), math.log(0.3)))
    if quantity == "separation":
        tolerance *= 0.5 * float(place.force / place.stiffness)
    return scene, quantity, given, float(place[given]), tolerance


def truth_of(scene: dict[str, Any], quantity: str, given: str, at: float) -> tuple[float, float, float]:
    """Return the true quantity, its error, and the quantity of independent asperities."""
    own = {**scene["asperities"], **({"model": "summits"} if scene["title"] == "spectrum" else {})}
    path = {given: {"stop": at, "steps": 20} if given == "separation" else [at]}
    output = {"variables": ["force", "stiffness", "contact_area"]}

    def last(count: int, **sections: Any) -> xr.Dataset:
        law = law_of(scene, asperities=own, path=path, output=output, batch={"realizations": count}, **sections)
        return law.isel(step=-1)

    alone, of_grid = last(_MANY)[quantity].to_numpy(), 0.0
    if scene["title"] == "jkr":
        right = last(_FEW, interaction={"model": "pairwise"})[quantity].to_numpy()
    else:
        error = _AREA_GRID if quantity == "contact_area" else _GRID
        law = last(_FEW, reference={"model": "boundary_elements", "error": error})
        right = law[f"reference_{quantity}"].to_numpy()
        of_force, of_area = float(law["reference_error"].mean()), float(law["reference_area_error"].mean())
        slope = float((law["reference_force"] / law["reference_stiffness"]).mean())
        errors = {"contact_area": of_area, "stiffness": 0.5 * of_area, "force": of_force}
        of_grid = of_force * slope if quantity == "separation" else errors[quantity] * float(right.mean())
    off = right - alone[:_FEW] if quantity == "separation" else (right / alone[:_FEW] - 1.0) * alone.mean()
    unknown = math.hypot(float(off.std(ddof=1)) / math.sqrt(_FEW), of_grid)
    return float(alone.mean() + off.mean()), unknown, float(alone.mean())


def carry_out(number: int) -> dict[str, Any]:
    """Return what a request asked for, got and cost; errors are over that asked for."""
    scene, quantity, given, at, tolerance = draw_request(number)
    true, unknown, independent = truth_of(scene, quantity, given, at)
    accuracy = {"of": {quantity: tolerance, f"at_{given}": at}, "max_realizations": 400}
    found, whole = timed(partial(law_of, scene, accuracy=accuracy))
    method = found.attrs["accuracy"].splitlines()[0].rpartition(": ")[2].partition(",")[0]
    values = found[f"reference_{quantity}" if method == "boundary elements" else quantity].isel(step=-1).to_numpy()
    scale = tolerance * (1.0 if quantity == "separation" else abs(true))
    count, reached = values.size, float(found.accuracy_reached) / tolerance
    spread = float(values.std(ddof=1)) / scale if count > 1 else 0.0
    left = 1.0 - (reached - 2.0 * spread / math.sqrt(count))
    return {
        "kind": scene["title"], "quantity": f"{quantity} at {given}", "method": method,
        "asked": tolerance if quantity != "separation" else math.nan, "reached": reached,
        "error": (float(values.mean()) - true) / scale, "unknown": unknown / scale,
        "independent": (independent - true) / scale, "realizations": count,
        "fewest": max(float(FEWEST if count > 1 else 1), (2.0 * spread / left) ** 2 if left > 0.0 else math.nan),
        "whole": whole,
    }  # fmt: skip


def measure(quick: bool) -> xr.Dataset:
    """Carry out all requests, or a few of them."""
    words = {name: (about, "1") for name, about in _COLUMNS.items()}
    return of_rows(words, in_two_processes(carry_out, REQUESTS[quick]), "request")


def report(result: xr.Dataset) -> str:
    """Return how many requests were met, and at what cost."""
    stated = result.isel(request=np.flatnonzero(result["reached"].to_numpy() <= 1.0))
    off = np.maximum(np.abs(stated["error"].to_numpy()) - stated["unknown"].to_numpy(), 0.0)
    bounded, over = np.mean(off <= stated["reached"].to_numpy()), (stated["realizations"] / stated["fewest"]).to_numpy()
    cheaper = (np.abs(stated["independent"]) <= 1.0) & (stated["method"] != "independent asperities")
    rows = []
    for number in range(result.sizes["request"]):
        row = {str(name): values.values.item() for name, values in result.isel(request=number).variables.items()}
        asked = [row["kind"], row["quantity"].replace("_", " "), f"{100.0 * row['asked']:.2g} %", row["method"]]
        errors = [f"{row[name]:.2f}" for name in ("reached", "error", "unknown")]
        cost = f"{row['realizations']:.0f}", f"{row['realizations'] / row['fewest']:.2g}", f"{row['whole']:.1f}"
        rows.append([*asked, *errors, *cost])
    head = ["surface", "asked", "error", "method", "stated", "true", "of the truth", "realisations", "over fewest", "s"]
    return f"""{result.sizes["request"]} requests; {stated.sizes["request"]} stated that they were met. Of these
{100.0 * np.mean(off <= 1.0):.0f} % were, and {100.0 * bounded:.0f} % of the stated errors bound the true one, as far as
the truth is known. {np.sum(over <= 2.0)} took at most twice the fewest realisations, the median {np.median(over):.2g}.
In {int(cheaper.sum())} independent asperities would have been right enough, which their stated error does not promise.

{table(head, rows)}

Errors are over that asked for.
"""


STUDY = Study(
    "asked", "Quantities asked for with their error: met, and at what cost", measure, {}, report,
    f"{len(REQUESTS[True])} of {len(REQUESTS[False])} requests",
)  # fmt: skip
