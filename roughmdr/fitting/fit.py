"""Fit parameters of a scene to a measured curve."""

import time
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from roughmdr.errors import StoreError, warn_limits
from roughmdr.fitting.measured import read_measured
from roughmdr.fitting.model import Model, scene_to_fit
from roughmdr.fitting.result import assemble
from roughmdr.fitting.search import search
from roughmdr.fitting.stored import read_fit
from roughmdr.fitting.uncertainty import uncertainty
from roughmdr.fitting.words import parameter_keys
from roughmdr.scene import Scene
from roughmdr.schema.keywords import named_keywords
from roughmdr.storage.files import NETCDF_ENDINGS, check_ending, check_writable
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.netcdf_writing import write_netcdf
from roughmdr.storage.result_file import FIT, check_same_kind

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr


@named_keywords
def fit(
    measured: "str | Path | pd.DataFrame | xr.Dataset",
    scene: str | Path | dict[str, Any] | Scene,
    free: str | Iterable[str],
    out: str | Path | None = None,
    *,
    set: dict[str, Any] | None = None,  # noqa: A002 - as --set
    fresh: bool = False,
) -> "xr.Dataset":
    """Fit parameters of a scene to a measured curve, by least squares with the expected law of the scene.

    A LimitWarning says which parameters the curve does not tell apart, and where the scene does not describe it.

    Parameters
    ----------
    measured : path, pandas.DataFrame or xarray.Dataset
        Columns ``separation``, ``remote`` of a machine's spring, or ``piezo`` that moves a cantilever to the surface
        (``remote`` is minus that), and ``force`` or ``pressure``, in the order of the measurement; ``force_error`` is
        the standard deviation of each force. Units stand in the names, as in "force [mN]"; without, they are SI. A
        Dataset has its own.
    scene : path, dict or Scene
        Gives all else; its values are where the search starts. The measured path takes the place of its own.
    free : str or iterable of str
        Keys of the scene to fit, such as "adhesion.work"; and "offset", the separation [m] (or position of the far end)
        in the scene where the measurement reads 0.
    out : path, optional
        The netCDF file to write.
    set : dict, optional
        Keys of the scene, dotted, with the values that they get.
    fresh : bool, optional
        Whether to replace a file of any kind at ``out``; otherwise only a fit of no other parameters.

    Returns
    -------
    xarray.Dataset
        Each parameter, dots as underscores, with ``_standard_error``, ``_low`` and ``_high`` (95 %), and
        ``_model_error``, its shift by the error of the law where that is known; ``covariance`` and ``correlation``; the
        fitted law and the residual over ``point``. The attribute ``scene`` is the fitted scene.

    Raises
    ------
    SceneError
        Where the scene is wrong, has no expected law, or a key cannot be fitted.
    StoreError
        Where the measurement cannot be read, or ``out`` cannot be written or must not be replaced.
    OutOfRange
        Where no start of the search has a law.

    References
    ----------
    Intervals without ``force_error``: H.-G. Mueller, U. Stadtmueller (1987), Annals of Statistics 15, 610 (uneven noise
    by the residuals of neighbours); R. M. Bell, D. F. McCaffrey (2002), Survey Methodology 28, 169 (degrees of freedom
    of Student's t).

    Examples
    --------
    >>> import numpy as np, pandas as pd, roughmdr as rm
    >>> separation = np.linspace(3e-6, 0.0, 20)
    >>> load = rm.theory.greenwood_williamson(
    ...     separation=separation, effective_modulus=2e9, radius=50e-6, std=1e-6, density=1e9
    ... )
    >>> measured = pd.DataFrame({"separation": separation, "pressure [kPa]": load / 1e3})
    >>> fitted = rm.fit(measured, {
    ...     "title": "A rough plate", "material": {"effective_modulus": "1 GPa"},
    ...     "asperities": {
    ...         "source": "random", "shape": "paraboloid", "count": 1000, "patch": "1 mm", "radius": "50 um",
    ...         "height": {"distribution": "normal", "std": "1 um"},
    ...     },
    ... }, free=["material.effective_modulus"])
    >>> print(f"{float(fitted.material_effective_modulus):.4g} {fitted.material_effective_modulus.units}")
    2e+09 Pa
    """
    target, keys = None if out is None else Path(out), [free] if isinstance(free, str) else list(free)
    result = fit_labelled(measured, scene, keys, target, changes=set or {}, fresh=fresh)
    warn_limits(result.attrs.get("warnings", "").splitlines())
    return result.to_xarray()


def fit_labelled(
    measured: Any,
    scene: Any,
    free: list[str],
    out: Path | None,
    *,
    changes: Any,
    fresh: bool,
    command: str = "roughmdr.fit",
) -> Labelled:
    """Return the result of a fit, written to ``out`` unless that is None; arguments and errors as ``fit``."""
    started = time.perf_counter()
    curve = read_measured(measured, len(free))
    validated = scene_to_fit(scene, changes, curve, free)
    if out is not None:
        check_writable(out, [*validated.inputs, *([] if curve.file is None else [curve.file])])
        check_ending(out, "fit", NETCDF_ENDINGS)
        if not fresh:
            check_same_kind(out, FIT)
            _check_nothing_lost(out, free)
    model = Model(validated, curve, free)
    found = search(model)
    result = assemble(model, found, uncertainty(model, found), time.perf_counter() - started, command)
    if out is not None:
        write_netcdf(result, out)
    return result


def _check_nothing_lost(out: Path, free: list[str]) -> None:
    """Raise StoreError where there is a fit of parameters that are not fitted now."""
    if not out.exists():
        return
    lost = [key for key in parameter_keys(read_fit(out)) if key not in free]
    if lost:
        raise StoreError(f"{out}: holds a fit of {', '.join(lost)} too: give another output, or --fresh to replace it")
