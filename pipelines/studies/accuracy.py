"""[accuracy]: how often a run meets the error asked for, and how many realisations it takes.

Many realisations of small scenes are computed once. Runs are drawn from them with replacement, so that the minimal
number of realisations for an error is known: (spread / (error * largest mean force))^2. A run stops by the rule of a
batch; the naive rule, which stops as soon as the estimated error is small enough, is for comparison.
"""

import math
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

import roughmdr as rm
from roughmdr.batch.moments import Moments, MomentTree, block_moments
from roughmdr.batch.stopping_rule import FIRST, next_count, relative_error
from roughmdr.numerics.arguments import Floats
from studies.study import Figure, Study, blank, named, table, without_limits


def scene_of(count: int, height: dict[str, Any], work: float = 0.0) -> dict[str, Any]:
    """Return a scene of ``count`` asperities, loaded and, with adhesion, unloaded."""
    return {
        "title": "A small scene",
        "material": {"effective_modulus": "4 MPa"},
        "adhesion": {"model": "jkr", "work": work},
        "asperities": {
            "source": "random", "shape": "paraboloid", "count": count, "patch": "0.5 mm", "height": height,
            "radius": "200 um",
        },
        "path": {"separation": {"start": "2 um", "stop": "-0.5 um", "steps": 20}, "unload": work > 0.0},
        "output": {"variables": ["force"]},
    }  # fmt: skip


NORMAL = {"distribution": "normal", "std": "1 um"}
SCENES = {
    "Hertz, 40 asperities": scene_of(40, NORMAL),
    "JKR, 40 asperities": scene_of(40, NORMAL, 0.05),
    "Hertz, 8 asperities, exponential heights": scene_of(8, {"distribution": "expon", "std": "1 um"}),
}
REALIZATIONS, RUNS = {False: 25_000, True: 4000}, {False: 200, True: 40}
MINIMAL_COUNTS = (50, 200, 500, 1000, 4000)  # realisations that the errors asked for need at least


class ForceSamples(NamedTuple):
    """The force of many realisations of a scene."""

    force: Floats  # [N], [realization, step]

    def kurtosis(self) -> float:
        """Return the kurtosis of the force at the step where it varies most; 3 for a normal distribution."""
        force = self.force[:, int(self.force.std(axis=0).argmax())]
        return float(np.mean((force - force.mean()) ** 4) / force.var() ** 2)

    def true_error(self, count: int) -> float:
        """Return the true standard error of the mean force of ``count`` realisations, over its largest value."""
        return float(self.force.std(axis=0).max() / np.abs(self.force.mean(axis=0)).max() / math.sqrt(count))

    def stop_as_a_batch(self, draws: np.ndarray, error: float) -> int:
        """Return how many of these draws a batch makes before it stops at ``error``."""
        moments, count, target = MomentTree[Moments](), 0, FIRST
        while count < target:
            for first, block in block_moments(count, self.force[draws[count:target]]):
                moments.add(first, block)
            total = moments.total(target)
            assert total is not None
            count, target = target, next_count(target, relative_error(total), error, len(draws))
        return count

    def stop_naively(self, draws: np.ndarray, error: float) -> int:
        """Return how many of these draws are made before the estimated error is below ``error``."""
        force = self.force[draws] - self.force.mean(axis=0)  # so that the squares keep their digits
        count = np.arange(1.0, len(draws) + 1.0)[:, None]
        mean = np.cumsum(force, axis=0) / count
        variance = np.cumsum(force**2, axis=0) / count - mean**2
        largest = np.abs(mean + self.force.mean(axis=0)).max(axis=1)
        estimate = np.sqrt(variance.max(axis=1) / np.maximum(count[:, 0] - 1.0, 1.0)) / largest
        reached = np.flatnonzero(estimate[FIRST - 1 :] <= error)
        return FIRST + int(reached[0]) if reached.size else len(draws)


RULES = {"as in a batch": ForceSamples.stop_as_a_batch, "estimate small enough": ForceSamples.stop_naively}


def force_samples(name: str, realizations: int) -> ForceSamples:
    """Compute realisations of one of ``SCENES``."""
    with without_limits():  # steep or not, the statistics are the same
        result = rm.run({**SCENES[name], "batch": {"realizations": realizations}})
    return ForceSamples(result.force.to_numpy())


def realizations_taken(samples: ForceSamples, error: float, seeds: int, rule: str = "as in a batch") -> np.ndarray:
    """Return how many realisations runs with other seeds take to meet ``error``: [seed]."""
    most = 2 * math.ceil((samples.true_error(1) / error) ** 2) + 200
    draws = (np.random.default_rng(seed).integers(0, len(samples.force), most) for seed in range(seeds))
    return np.array([RULES[rule](samples, each, error) for each in draws])


def measure(quick: bool) -> xr.Dataset:
    """Return the realisations taken by every scene, rule and error, and the share of runs that met the error."""
    samples = [force_samples(name, REALIZATIONS[quick]) for name in SCENES]
    errors = [[each.true_error(count) for count in MINIMAL_COUNTS] for each in samples]
    taken = [
        [[realizations_taken(each, error, RUNS[quick], rule) for error in row] for rule in RULES]
        for each, row in zip(samples, errors, strict=True)
    ]
    reached = (np.array(taken) >= np.array(MINIMAL_COUNTS)[:, None]).mean(axis=-1)
    minimal = named("least number of realisations that meets the error")
    runs = ("scene", "rule", "minimal", "seed")
    return xr.Dataset(
        {
            "taken": (runs, taken, named("realisations that a run takes")),
            "asked": (("scene", "minimal"), errors, named("standard error of the mean force over its largest value")),
            "reached": (runs[:-1], reached, named("share of the runs that meet the error")),
            "kurtosis": ("scene", [each.kurtosis() for each in samples], named("kurtosis of the force")),
        },
        {"scene": list(SCENES), "rule": list(RULES), "minimal": ("minimal", list(MINIMAL_COUNTS), minimal)},
    )


def draw(result: xr.Dataset) -> Figure:
    """Draw how many runs meet the error, and how many realisations they take over the minimal number."""
    from matplotlib.lines import Line2D

    figure = blank(13, 5.6)
    left, right = figure.subplots(1, 2)
    quantiles = (result.taken / result.minimal).quantile([0.05, 0.25, 0.5, 0.75, 0.95], "seed")
    for shift, colour, scene in zip((-0.22, 0.0, 0.22), ("#1b6ca8", "#c8553d", "#2e8b57"), SCENES, strict=True):
        x, own = np.arange(result.minimal.size) + shift, result.sel(scene=scene)
        label = f"{scene} (kurtosis {float(own.kurtosis):.1f})"
        left.plot(x, 100.0 * own.reached[0], "o", color=colour, ms=8, label=label)
        left.plot(x, 100.0 * own.reached[1], "D", color=colour, ms=6, mfc="w")
        low, first, middle, last, high = quantiles.sel(scene=scene).to_numpy()
        right.vlines(x, low[0], high[0], color=colour, lw=1.5)
        right.vlines(x, first[0], last[0], color=colour, lw=5)
        right.plot(x, middle[0], "o", color=colour, ms=8, mec="w")
        right.vlines(x + 0.055, low[1], high[1], color=colour, lw=1.0, alpha=0.6)
        right.plot(x + 0.055, middle[1], "D", color=colour, ms=5, mfc="w")
    left.axhline(95.0, color="0.4", lw=1.0, ls="--")
    left.text(-0.45, 94.0, "95 of 100", color="0.4", va="top")
    left.set(
        ylim=(0.0, 103.0), ylabel="runs whose true standard error is what was asked for [%]", title="Is the error met?"
    )
    left.legend(loc="lower right", fontsize=9)
    right.axhline(1.0, color="k", lw=1.0)
    right.set(ylim=(0.0, 2.6), ylabel="realisations taken, over the fewest that meet the error", title="At what cost?")
    circle = Line2D([], [], color="0.3", marker="o", ms=8, lw=0, label="the rule of a batch")
    diamond = Line2D([], [], color="0.3", marker="D", ms=6, lw=0, mfc="w", label="stop once the estimate is low enough")
    right.legend(handles=[circle, diamond], title="median, 5 to 95 % of the runs", loc="upper right", fontsize=9)
    for panel in (left, right):
        panel.set_xticks(range(result.minimal.size), result.minimal.to_numpy().tolist())
        panel.set(xlim=(-0.5, result.minimal.size - 0.5), xlabel="fewest realisations that meet the error asked for")
        panel.grid(axis="y", color="0.92")
    return figure


def report(result: xr.Dataset) -> str:
    """Return a table of all scenes and errors."""
    rows = []
    for name in SCENES:
        for minimal in MINIMAL_COUNTS:
            rule, naive = (result.sel(scene=name, minimal=minimal, rule=rule) for rule in RULES)
            times = [f"{value:.2f}" for value in (rule.taken / minimal).quantile([0.5, 0.05, 0.95]).to_numpy()]
            met = [f"{100.0 * float(own.reached):.1f} %" for own in (rule, naive)]
            scene = f"{name} (kurtosis {float(rule.kurtosis):.1f})"
            rows.append([scene, f"{float(rule.asked):.2g}", f"{minimal}", *met, *times])
    head = ["scene", "error", "fewest", "met", "met by the estimate alone", "taken over fewest: median", "5 %", "95 %"]
    return table(head, rows)


STUDY = Study(
    "accuracy", "Errors asked for, and reached", measure, draw, report,
    f"{RUNS[True]} of {RUNS[False]} runs, drawn from {REALIZATIONS[True]} of {REALIZATIONS[False]} realisations",
)  # fmt: skip
