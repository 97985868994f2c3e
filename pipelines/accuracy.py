"""[accuracy]: how often a run comes to the error that it was asked for, and how many realisations it spends on it.

    python pipelines/accuracy.py -o results/studies

Many realisations of small scenes are computed once. They are the law that runs are drawn from, so that the fewest
realisations that come to an error are known: (spread / (error * largest mean force))^2. Runs are decided by the rule
that a batch follows; beside it stands the plain one, to stop as soon as the estimated error is small enough.
Writes accuracy.nc and accuracy.png.
"""

import math
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import click
import numpy as np
import xarray as xr
from accuracy_picture import draw

import roughmdr as rm
from roughmdr.batch.moments import MomentTree
from roughmdr.batch.stopping_rule import FIRST, next_count, relative_error
from roughmdr.numerics.arguments import Floats
from roughmdr.scene.sections import Accuracy
from roughmdr.storage.atomic import replace_atomically
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.netcdf_writing import write_netcdf
from roughmdr.storage.result_file import provenance


def scene_of(count: int, height: dict[str, Any], work: float = 0.0) -> dict[str, Any]:
    """A few asperities, pressed and with adhesion pulled off again."""
    return {
        "title": "A small scene",
        "material": {"effective_modulus": "4 MPa"},
        "adhesion": {"model": "jkr", "work": work},
        "asperities": {
            "source": "random",
            "shape": "paraboloid",
            "count": count,
            "patch": "0.5 mm",
            "height": height,
            "radius": "200 um",
        },
        "path": {"separation": {"start": "2 um", "stop": "-0.5 um", "steps": 20}, "unload": work > 0.0},
        "output": {"variables": ["force"]},
    }


NORMAL = {"distribution": "normal", "std": "1 um"}
SCENES = {
    "Hertz, 40 asperities": scene_of(40, NORMAL),
    "JKR, 40 asperities": scene_of(40, NORMAL, 0.05),
    "Hertz, 8 asperities, exponential heights": scene_of(8, {"distribution": "expon", "std": "1 um"}),
}
FEWEST = (50, 200, 500, 1000, 4000)
"""Realisations that the errors asked for take at least."""
RULES = ("as in a batch", "estimate small enough")
ENOUGH = 1.3  # times the fewest: what a run should not spend more than


class Law(NamedTuple):
    """What the force of a scene is drawn from."""

    force: Floats
    """[N], [realization, step]."""

    @property
    def steepest(self) -> int:
        """The step at which the force varies most."""
        return int(self.force.std(axis=0).argmax())

    @property
    def kurtosis(self) -> float:
        """Of the force there: 3 of a normal distribution; the larger, the worse a spread is known from a sample."""
        force = self.force[:, self.steepest]
        return float(np.mean((force - force.mean()) ** 4) / force.var() ** 2)

    def error_of(self, count: int) -> float:
        """The true standard error of the mean force of so many realisations, over its largest value."""
        return float(self.force.std(axis=0).max() / np.abs(self.force.mean(axis=0)).max() / math.sqrt(count))

    def taken(self, draws: np.ndarray, error: float) -> int:
        """How many of these draws a batch makes until it has come to an error."""
        asked, tallies, count, now = Accuracy(relative=error, max_realizations=len(draws)), MomentTree(), 0, FIRST
        while count < now:
            tallies.add_all(count, self.force[draws[count:now]])
            whole = tallies.total(now)
            if whole is None:
                raise AssertionError("none is missing")
            count, now = now, next_count(now, relative_error(whole), asked)
        return count

    def taken_plainly(self, draws: np.ndarray, error: float) -> int:
        """How many it would make if it stopped as soon as its estimate of the error is small enough."""
        force = self.force[draws] - self.force.mean(axis=0)  # so that the squares keep their digits
        count = np.arange(1.0, len(draws) + 1.0)[:, None]
        mean = np.cumsum(force, axis=0) / count
        variance = np.cumsum(force**2, axis=0) / count - mean**2
        largest = np.abs(mean + self.force.mean(axis=0)).max(axis=1)
        estimate = np.sqrt(variance.max(axis=1) / np.maximum(count[:, 0] - 1.0, 1.0)) / largest
        enough = np.flatnonzero(estimate[FIRST - 1 :] <= error)
        return FIRST + int(enough[0]) if enough.size else len(draws)


def law_of_force(name: str, realizations: int) -> Law:
    """Of one of ``SCENES``."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.LimitWarning)  # steep or not, the statistics are the same
        result = rm.run({**SCENES[name], "batch": {"realizations": realizations}})
    return Law(result.force.to_numpy())


def realizations_taken(law: Law, error: float, seeds: int, rule: Callable[..., int] = Law.taken) -> np.ndarray:
    """What runs with other seeds take to come to an error."""
    most = 2 * math.ceil((law.error_of(1) / error) ** 2) + 200
    return np.array(
        [rule(law, np.random.default_rng(seed).integers(0, len(law.force), most), error) for seed in range(seeds)]
    )


def study(realizations: int, seeds: int) -> xr.Dataset:
    """All figures."""
    taken = np.empty((len(SCENES), len(RULES), len(FEWEST), seeds))
    asked, kurtosis = np.empty((len(SCENES), len(FEWEST))), []
    for number, name in enumerate(SCENES):
        law = law_of_force(name, realizations)
        kurtosis.append(law.kurtosis)
        for place, fewest in enumerate(FEWEST):
            asked[number, place] = law.error_of(fewest)
            for row, rule in enumerate((Law.taken, Law.taken_plainly)):
                taken[number, row, place] = realizations_taken(law, asked[number, place], seeds, rule)
    least = np.array(FEWEST)[:, None]
    over = ("scene", "rule", "fewest")
    variables = {
        "taken": ((*over, "seed"), taken, one("realisations that a run takes")),
        "asked": (("scene", "fewest"), asked, one("standard error of the mean force over its largest value")),
        "reached": (over, (taken >= least).mean(axis=-1), one("share of the runs that reach the error asked for")),
        "thrifty": (
            over,
            (taken <= ENOUGH * least).mean(axis=-1),
            one(f"share that takes up to {ENOUGH} times the fewest"),
        ),
        "kurtosis": ("scene", kurtosis, one("kurtosis of the force where it varies most")),
    }
    named = {"scene": list(SCENES), "rule": list(RULES), "fewest": ("fewest", list(FEWEST), one("fewest realisations"))}
    result = xr.Dataset(variables, named)
    return result.assign_attrs(provenance("Errors asked for, and reached", "accuracy.py"))


def one(name: str) -> dict[str, str]:
    """The attributes of a number without a unit."""
    return {"units": "1", "long_name": name}


@click.command(help=(__doc__ or "").split("\n", maxsplit=1)[0])
@click.option("-o", "--output", type=click.Path(file_okay=False, path_type=Path), default=Path("results/studies"))
@click.option("--quick", is_flag=True, help="Fewer realisations and seeds: seconds, and rough figures.")
def main(output: Path, quick: bool) -> None:
    """Measure, print, write accuracy.nc and accuracy.png."""
    output.mkdir(parents=True, exist_ok=True)
    result = study(*((4000, 40) if quick else (25_000, 200)))
    write_netcdf(Labelled.of(result), output / "accuracy.nc")
    with replace_atomically(output / "accuracy.png") as temporary:
        draw(result).savefig(temporary, dpi=160, format="png")
    for name in result.scene.to_numpy():
        own = result.sel(scene=name)
        click.echo(f"{name} (kurtosis {float(own.kurtosis):.1f})")
        for fewest in FEWEST:
            rule, plain = (own.sel(fewest=fewest, rule=rule) for rule in RULES)
            spent = rule.taken / fewest
            click.echo(
                f"  error {float(rule.asked):.2g}, fewest {fewest}: reached by {100 * float(rule.reached):.1f} % with "
                f"{float(spent.median()):.2f} times as many ({float(spent.quantile(0.05)):.2f} to "
                f"{float(spent.quantile(0.95)):.2f}), by {100 * float(plain.reached):.1f} % where the estimate decides"
            )


if __name__ == "__main__":
    main()
