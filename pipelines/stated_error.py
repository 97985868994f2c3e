"""numerical_error: whether it is the bound on the error of the force that it is said to be, and how near.

    python pipelines/stated_error.py -o results/studies

Random scenes go through ``roughmdr.run``, and their forces are computed again at least ten times finer: of draws with
40 digits from the slopes of the profiles, of the expected law by dense quadrature.
Writes stated_error.nc and stated_error.png.
"""

import warnings
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import NamedTuple

import numpy as np
import xarray as xr
from stated_error_picture import draw
from stated_error_references import expected_force, force_of_draws
from stated_error_scenes import ESTIMATORS, Drawn, scene
from studies.study import Study, named, table

import roughmdr as rm
from roughmdr.numerics.arguments import Floats
from roughmdr.scene import read

SCENES, QUICK = 200, 60
HONEST = 0.99
"""The share of scenes whose true error is to be below the stated one."""
_WORKERS = 2


class Judged(NamedTuple):
    """The errors of the force of one scene along its path, over its largest magnitude."""

    true: float
    stated: float
    refused: str = ""
    """Why the scene was not computed: that is no number that could be wrong."""

    @property
    def honest(self) -> bool:
        """Whether the one is within the other."""
        return bool(self.true <= self.stated)


def judge(drawn: Drawn, disturbance: float = 0.0) -> Judged:
    """Run a scene and compute it again; all forces of the run are off by ``disturbance`` times its stated error."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.LimitWarning)  # steep or not, the numbers are the same
        result = rm.run(drawn.table)
    if (result.status != 0).any():
        return Judged(np.nan, np.nan, str(result.remark.values.ravel()[0]))
    stated = float(result.numerical_error.max())
    force = reference(drawn, result.separation.to_numpy(), stated)
    found = result.force_mean if "force_mean" in result else result.force.isel(realization=0)
    largest = max(abs(each) for each in force)
    found = found.to_numpy() + disturbance * stated * float(largest)
    off = max(abs(each - own) for each, own in zip(force, found.tolist(), strict=True))
    return Judged(float(off / largest) if largest else float(off), stated)


def reference(drawn: Drawn, separation: Floats, stated: float) -> list[float]:
    """The force [N] at each step, of whatever precision; the mean over all realisations."""
    asked = read(drawn.table)
    if drawn.estimator == "expected":
        return list(expected_force(asked, separation, stated))
    count = asked.batch.realizations
    each = [force_of_draws(asked, realization, separation) for realization in range(count)]
    return [sum(parts) / count for parts in zip(*each, strict=True)]


def measure(quick: bool) -> xr.Dataset:
    """All scenes, on two processes."""
    drawn = [scene(number) for number in range(QUICK if quick else SCENES)]
    with ProcessPoolExecutor(_WORKERS, get_context("spawn")) as pool:
        return judgement(drawn, list(pool.map(judge, drawn, chunksize=4)))


def judgement(drawn: list[Drawn], judged: list[Judged]) -> xr.Dataset:
    """What was found of each scene that was not refused."""
    kept = [(one, errors) for one, errors in zip(drawn, judged, strict=True) if not errors.refused]
    over, within = "scene", [errors.honest for _, errors in kept]
    return xr.Dataset(
        {
            "true_error": (over, [errors.true for _, errors in kept], named("true error over the largest force")),
            "stated_error": (over, [errors.stated for _, errors in kept], named("numerical_error")),
            "honest": (over, np.array(within, dtype=np.int8), named("1 where the true error is within")),
        },
        {
            "scene": (over, [one.number for one, _ in kept], named("number of the scene")),
            "estimator": (over, [one.estimator for one, _ in kept]),
            "adhesion": (over, [one.adhesion for one, _ in kept]),
            "shape": (over, [one.shape for one, _ in kept]),
        },
        {"refused": len(drawn) - len(kept)},
    )


def tell(result: xr.Dataset) -> str:
    """The share of honest scenes, those that are not, and how pessimistic the bound is."""
    rows = []
    for name in sorted(set(result.estimator.to_numpy()), key=ESTIMATORS.index):
        own = result.isel(scene=np.flatnonzero(result.estimator == name))
        true, stated = own.true_error.to_numpy(), own.stated_error.to_numpy()
        most = float(np.max(true[stated > 0.0] / stated[stated > 0.0], initial=0.0))
        cells = [name, f"{own.sizes['scene']}", f"{int(own.honest.sum())}"]
        for values in (stated, stated[true > 0.0] / true[true > 0.0]):
            cells += [f"{q:.1g}" for q in np.quantile(values, [0.5, 0.95])] if values.size else ["", ""]
        rows.append([*cells, f"{most:.2g}"])
    head = [
        "estimator",
        "scenes",
        "honest",
        "stated: median",
        "95 %",
        "stated/true: median",
        "95 %",
        "true/stated: most",
    ]
    false = [f"- {_described(int(number))}" for number in result.scene[result.honest == 0]]
    share = 100.0 * float(result.honest.mean())
    return "\n\n".join(
        [
            f"The true error is within the stated one in {share:.1f} % of {result.sizes['scene']} random scenes "
            f"(at least {100 * HONEST:.0f} % are asked for; {result.attrs['refused']} more were refused).",
            table(head, rows),
            *(["Not within it:\n\n" + "\n".join(false)] if false else []),
        ]
    )


def _described(number: int) -> str:
    """A scene on one line, as it can be given to ``roughmdr.run``."""
    return f"scene {number}: `{scene(number).table}`"


STUDY = Study("stated_error", "Is the stated error honest?", measure, draw, tell)

if __name__ == "__main__":
    STUDY.command()
