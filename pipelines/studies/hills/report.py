"""The report of the study of hills."""

import numpy as np
import xarray as xr

from studies.hills.errors import RANGES, WORDS, errors_of, groups, percent, rms, within
from studies.hills.measure import METHODS
from studies.hills.press import QUANTITIES
from studies.hills.report_convergence import report_convergence, report_reference
from studies.hills.report_files import report_files
from studies.hills.separations import POINTS
from studies.study import table


def report(result: xr.Dataset) -> str:
    """Return errors and run times of each method, which of them is best where, and what the errors hang on."""
    counts = ", ".join(f"{own.sizes['case']} {name}" for name, own in groups(result).items())
    return "\n\n".join(
        [
            f"{counts} maps, {result.sizes['fraction']} separations from 0.3 to 20 % contact each, against boundary "
            f"elements with {POINTS} points a shortest wave. The stiffness -dF/dh is held against theirs at "
            f"{_stiffnesses(result)} of the separations, and is no part of the run times. {report_reference(result)}",
            _table(result),
            "The force by contact fraction, r.m.s.:",
            _table_of_ranges(result),
            *(_best(name, own) for name, own in groups(result).items()),
            report_convergence(result),
            report_files(result),
        ]
    )


def _stiffnesses(result: xr.Dataset) -> int:
    return int(result["stiffness"].sel(solver="fine elements").notnull().any("case").sum())


def _table(result: xr.Dataset) -> str:
    rows = []
    for name, own in groups(result).items():
        errors = {quantity: errors_of(own, quantity) for quantity in QUANTITIES}
        for method in _methods_of(own):
            force = errors["force"].sel(solver=method).to_numpy()
            seconds = own["seconds"].sel(solver=method).to_numpy()
            of_true = np.median(seconds / own["seconds"].sel(solver="fine elements").to_numpy())
            rows.append(
                [
                    name,
                    method,
                    percent(rms(force)),
                    f"{100 * np.nanmean(force):+.1f} %",
                    percent(float(np.nanquantile(np.abs(force), 0.9))),
                    percent(rms(errors["contact_fraction"].sel(solver=method)), 0),
                    percent(rms(errors["stiffness"].sel(solver=method))),
                    percent(float(np.isnan(force).mean()), 0),
                    f"{1e3 * np.median(seconds):.0f} ms",
                    f"{of_true:.2f}",
                ]
            )
    head = ["maps", "method", "force, rms", "mean", "90 % within", "area, rms", "stiffness, rms", "no answer", "a path"]
    return table([*head, "of fine"], rows)


def _table_of_ranges(result: xr.Dataset) -> str:
    rows = [
        [name, method, *(percent(rms(within(errors_of(own).sel(solver=method), each))) for each in RANGES)]
        for name, own in groups(result).items()
        for method in _methods_of(own)
    ]
    return table(["maps", "method", *map(_in_words, RANGES)], rows)


def _in_words(share: tuple[float, float]) -> str:
    return f"{100 * share[0]:g} to {100 * share[1]:g} %"


def _methods_of(own: xr.Dataset) -> list[str]:
    """Return the methods that there are for maps of a kind."""
    return [method for method in METHODS if np.isfinite(own["force"].sel(solver=method)).any()]


def _best(name: str, own: xr.Dataset) -> str:
    """Return in words which method is best for maps of a kind, of all and of those without a grid."""
    methods = _methods_of(own)
    gridless = [method for method in methods if not method.startswith("elements")]

    def best(errors: xr.DataArray, among: list[str]) -> str:
        found = {method: rms(errors.sel(solver=method)) for method in among}
        least = min(found, key=found.__getitem__)
        return f"{least} ({percent(found[least])})"

    quantities = "; ".join(
        f"{words} by {best(errors_of(own, quantity), methods)}, and of methods without a grid by "
        f"{best(errors_of(own, quantity), gridless)}"
        for quantity, words in WORDS.items()
    )
    ranges = ", ".join(
        f"at {_in_words(share)} contact {best(within(errors_of(own), share), gridless)}" for share in RANGES
    )
    return f"Best on {name} maps, r.m.s.: {quantities}. Of methods without a grid the force is best {ranges}."
