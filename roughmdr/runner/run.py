"""Runs a scene: all that is missing of its result."""

import warnings
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from roughmdr.batch.choose import plan_scene
from roughmdr.batch.plan import Plan
from roughmdr.errors import FailedRuns, level_outside, warn_limits
from roughmdr.runner.backend import Backend
from roughmdr.runner.batch import at_work, begun
from roughmdr.scene import Scene, read
from roughmdr.schema.keywords import named_keywords
from roughmdr.storage.labelled import Labelled
from roughmdr.variables import FAILED

if TYPE_CHECKING:
    import xarray as xr
    from distributed import Client


@named_keywords
def run(
    scene: str | Path | dict[str, Any] | Scene,
    out: str | Path | None = None,
    workers: int = 2,
    scheduler: "str | Client" = "threads",
    resume: bool = True,
    *,
    set: dict[str, Any] | None = None,  # noqa: A002 - as --set
    derivatives: str | Iterable[str] = (),
    quiet: bool = True,
) -> "xr.Dataset":
    """Compute a scene; with ``out``, write the result there as netCDF when all of it is done.

    Parameters
    ----------
    scene : path, dict or Scene
        A TOML file, a dictionary of the same form, or a Scene that was read.
    out : path, optional
        The result file. While the batch runs, what is finished is kept in ``OUT.parts``.
    workers : int
        Number of threads or processes.
    scheduler : str or distributed.Client
        "threads", "processes", or a dask cluster: its address, ``tcp://HOST:PORT`` or ``tls://HOST:PORT``, or a Client.
        Asperities in pairs, which threads compute one run at a time, are done sooner by processes.
    resume : bool
        Whether what ``out`` holds, or an earlier run kept beside it, is reused; else it is replaced.
    set : dict, optional
        Keys of the scene, dotted, with the values that they get, as in ``{"adhesion.work": "10 mJ/m^2"}``. A key that
        is set is no longer swept; names of files are relative to the current folder.
    derivatives : iterable of str, optional
        Keys of numbers of the scene, as ``output.derivatives`` has them: of an expected law the result then holds
        ``force_derivative`` and so on, with ``force_derivative_error``, over ``parameter``.
    quiet : bool
        Leave out the progress display.

    Returns
    -------
    xarray.Dataset
        Over the swept keys, ``realization`` and ``step``; the same to the last bit for any workers and scheduler.

    Raises
    ------
    SceneError, OutOfRange, StoreError
        Before anything is written, where the scene or ``out`` is wrong; where no run can be computed, the error of the
        first. Single runs that cannot be computed are marked, and a FailedRuns warning tells of them.
    Unfinished, KeyboardInterrupt
        The batch could not go on; what is done is kept beside ``out``.

    Examples
    --------
    >>> import roughmdr as rm
    >>> result = rm.run({
    ...     "title": "Sixteen surfaces", "seed": 1,
    ...     "material": {"effective_modulus": "1 GPa"},
    ...     "asperities": {
    ...         "source": "random", "shape": "paraboloid", "count": 50, "patch": "1 mm", "radius": "50 um",
    ...         "height": {"distribution": "normal", "std": "1 um"},
    ...     },
    ...     "path": {"separation": ["3 um", "1 um", "0 um"]},
    ...     "batch": {"realizations": 16},
    ... })
    >>> dict(result.force.sizes)
    {'realization': 16, 'step': 3}

    A scene file with another work of adhesion: ``rm.run("scene.toml", set={"adhesion.work": "10 mJ/m^2"})``.
    """
    target = None if out is None else Path(out)
    keys = [derivatives] if isinstance(derivatives, str) else list(derivatives)
    plan = plan_scene(read(scene, {**(set or {}), **({"output.derivatives": keys} if keys else {})}))
    result = execute(plan, target, Backend(scheduler, workers), resume=resume, quiet=quiet)
    warn_limits(result.attrs.get("warnings", "").splitlines())
    status = result.variables["status"].values
    if (status == FAILED).any():
        warnings.warn(
            f"{int((status == FAILED).sum())} of {status.size} failed, see remark",
            FailedRuns,
            stacklevel=level_outside(),
        )
    return result.to_xarray()


def execute(
    plan: Plan,
    target: Path | None,
    backend: Backend = Backend(),
    *,
    resume: bool = True,
    quiet: bool = True,
    command: str = "roughmdr.run",
) -> Labelled:
    """Carry out a plan; ``command`` goes into the file's history.

    StoreError, before computing, for a bad target or too little memory.
    """
    backend.check()
    with begun(plan, target, resume=resume) as beginning:
        if beginning.finished and beginning.old is not None:
            return beginning.old
        with at_work(beginning, backend, command, resume=resume, quiet=quiet) as batch:
            return batch.run(quiet=quiet)
