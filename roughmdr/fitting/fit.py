"""Fit parameters of a scene, which has the path of a measured curve, to that curve."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from roughmdr.errors import SceneError, StoreError, warn_limits
from roughmdr.fitting.compare import RANGES, best_model
from roughmdr.fitting.curves import first_of, fit_each, taken_apart
from roughmdr.fitting.measured import MeasuredCurve
from roughmdr.fitting.model import Model
from roughmdr.fitting.parameters import MACHINE, Known
from roughmdr.fitting.posterior import check_package
from roughmdr.fitting.result import assembled
from roughmdr.fitting.search import fitted
from roughmdr.fitting.stored import read_fit
from roughmdr.fitting.words import curve_names, parameter_names
from roughmdr.runner.backend import Backend
from roughmdr.scene import Scene, read
from roughmdr.scene.keys import entry_at, set_key
from roughmdr.schema.keywords import with_options
from roughmdr.schema.wording import short_repr
from roughmdr.stages import stages_in
from roughmdr.storage.files import NETCDF_ENDINGS
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.netcdf_store import write_netcdf
from roughmdr.storage.result_file import FIT, check_output

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

_NAMED = 5  # most parameters or curves that a message names


@dataclass(frozen=True)
class FitOptions:
    """Options of ``fit``, which describes them."""

    model: str | None = None
    bounds: Mapping[str, Any] = field(default_factory=dict)
    priors: Mapping[str, Any] = field(default_factory=dict)
    shared: str | Iterable[str] = ()
    posterior: bool = False
    workers: int = 1
    quiet: bool = True


@with_options(FitOptions)
def fit(
    measured: "str | Path | pd.DataFrame | xr.Dataset | Mapping[str, Any] | list[Any]",
    scene: str | Path | dict[str, Any] | Scene,
    free: str | Iterable[str],
    out: str | Path | None = None,
    *,
    set: dict[str, Any] | None = None,  # noqa: A002 - as --set
    fresh: bool = False,
    **options: Any,
) -> "xr.Dataset":
    """Fit parameters of a scene to a measured curve or to many, by least squares with the expected law of the scene.

    A LimitWarning says which parameters the curve does not tell apart, and where the scene does not describe it.

    Parameters
    ----------
    measured : path, pandas.DataFrame, xarray.Dataset, dict or list
        Columns ``separation``, ``remote`` of a machine's spring, or ``piezo`` that moves a cantilever to the surface
        (``remote`` is minus that), and ``force`` or ``pressure``, in the order of the measurement; ``force_error`` is
        the standard deviation of each force. Units stand in the names, as in "force [mN]"; without, they are SI. A
        Dataset has its own. Or a force curve as an AFM program exports it, whose spring constant is that of the machine
        where the scene has none. Many curves: a column ``curve`` with the name of each, a Dataset over ``curve`` with
        NaN after the last point of each, a dict of curves by their names, or a list of paths.
    scene : path, dict or Scene
        Gives all else; its values are where the search starts. The measured path takes the place of its own.
    free : str or iterable of str
        Keys of the scene to fit, such as "adhesion.work"; and "offset", the separation [m] (or position of the far end)
        in the scene where the measurement reads 0; "baseline", the load that it reads at its first row without contact,
        and "baseline_slope", the change of that per metre of the separation or the far end.
    out : path, optional
        The netCDF file to write.
    set : dict, optional
        Keys of the scene, dotted, with the values that they get.
    fresh : bool, optional
        Whether to replace a file of any kind at ``out``; otherwise only a fit of no other parameters and curves.
    **options
        ``model = "auto"`` has the curve choose the adhesion model: none, "jkr" or "dugdale", by the corrected Akaike
        criterion. ``bounds``, lowest and highest value, and ``priors``, mean and standard deviation of what is known
        otherwise, as if measured, are pairs by free keys, such as ``{"adhesion.work": ("50 mJ/m^2", "10 mJ/m^2")}``. Of
        many curves: ``shared``, the free keys that have one value for all, whose errors are those of the joint fit;
        ``workers``, the number of processes, 1 for this one alone unless given; the numbers are the same for any.
        ``posterior = True`` draws from the posterior of one curve, which takes some hundred times as long.
        ``quiet = False`` shows the progress.

    Returns
    -------
    xarray.Dataset
        Each parameter, dots as underscores, with ``_standard_error``, ``_low`` and ``_high`` (95 %), and
        ``_model_error``, its shift by the error of the law where that is known; ``covariance`` and ``correlation``; the
        fitted law and the residual over ``point``. With ``posterior`` draws of each, ``_posterior``, over ``chain`` and
        ``draw``. The attribute ``scene`` is the fitted scene. With ``model``, ``aicc``, ``akaike_weight``,
        ``tabor_parameter`` and ``model_residual_rms`` over the dimension ``model``. Of
        many curves all have the dimension ``curve``, and ``scene`` is that of the start; ``failure`` says why a curve
        could not be fitted, and ``remark`` has the doubts about each.

    Raises
    ------
    SceneError
        Where the scene is wrong, has no expected law, or a key cannot be fitted.
    StoreError
        Where the measurement cannot be read, or ``out`` cannot be written or must not be replaced.
    OutOfRange
        Where no start of the search has a law, of many curves for none of them.

    References
    ----------
    Intervals without ``force_error``: H.-G. Mueller, U. Stadtmueller (1987), Annals of Statistics 15, 610 (uneven noise
    by the residuals of neighbours); R. M. Bell, D. F. McCaffrey (2002), Survey Methodology 28, 169 (degrees of freedom
    of Student's t). Draws: D. Foreman-Mackey et al. (2013), Publ. Astron. Soc. Pacific 125, 306.

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
    target = None if out is None else Path(out)
    result = fit_labelled(measured, scene, free, target, FitOptions(**options), changes=set or {}, fresh=fresh)
    warn_limits(result.attrs.get("warnings", "").splitlines())
    return result.to_xarray()


def fit_labelled(
    measured: Any,
    scene: Any,
    free: str | Iterable[str],
    out: Path | None,
    options: FitOptions = FitOptions(),
    *,
    changes: Any,
    fresh: bool,
    command: str = "roughmdr.fit",
) -> Labelled:
    """Return the result of a fit, written to ``out`` unless that is None; arguments and errors as ``fit``."""
    free, shared = _keys("free", free), _keys("shared", options.shared)
    found = taken_apart(measured)
    curves = found if isinstance(found, dict) else {}
    curve = first_of(curves or {"": found}, len(free))
    validated, curve = scene_to_fit(scene, changes, curve, free)
    _check(options, free, shared, validated, several=bool(curves))
    auto, known = options.model == "auto", Known(options.bounds, options.priors)
    if out is not None:
        files = [Path(each) for each in (measured, *curves.values()) if isinstance(each, str | PathLike)]
        check_output(out, "fit", NETCDF_ENDINGS, [*validated.inputs, *files], kind=FIT, fresh=fresh)
        if not fresh:
            _check_nothing_lost(out, [*free, *curves, *(RANGES if auto else ())])
    if curves:
        model, workers, quiet = Model(validated, curve, free, known), options.workers, options.quiet
        result = fit_each(curves, model, command, shared=shared, workers=workers, quiet=quiet)
    else:
        best = best_model(validated, curve, free, known) if auto else fitted(Model(validated, curve, free, known))
        result = assembled(command, best, posterior=options.posterior)
    if out is not None:
        write_netcdf(result, out)
    return result


def _keys(name: str, given: Any) -> list[str]:
    """Return keys that are given as one or several; SceneError where they are none."""
    keys = [given] if isinstance(given, str) or not isinstance(given, Iterable) else list(given)
    if not all(isinstance(key, str) for key in keys):
        raise SceneError(f"{name} is {short_repr(given)}; it must be a key of the scene, or several")
    return keys


def _check(options: FitOptions, free: list[str], shared: list[str], scene: Scene, *, several: bool) -> None:
    """Raise RoughmdrError where options are not allowed, alone or beside each other."""
    if options.model not in (None, "auto"):
        raise SceneError(f"model is {options.model!r}; it must be 'auto' or None; set adhesion.model for another")
    if options.model and several:
        raise SceneError("model: 'auto' compares models of one curve; give one, or set adhesion.model")
    if options.posterior and several:
        raise SceneError("posterior: is of one curve; fit each alone, or take the intervals of all")
    if options.posterior:
        check_package()
    if not free:
        raise SceneError("free: names no key; expected some like adhesion.work, material.modulus")
    for name, given in (("bounds", options.bounds), ("priors", options.priors)):
        if not (isinstance(given, Mapping) and all(isinstance(key, str) for key in given)):
            raise SceneError(f"{name} is {short_repr(given)}; it must be a dict with two numbers for each key")
    wrong = [key for key in shared if key not in free or key in options.priors or not several]
    if wrong:
        raise SceneError(f"shared: {wrong[0]}: must be a free key, without a prior, of several curves")
    if shared and scene.asperities.equal_heights and scene.work > 0.0:
        told = "joint fits do not follow jumps, which asperities of one height make under adhesion"
        raise SceneError(f"shared: {told}: fit the curves on their own, and take the mean over them")
    Backend(workers=options.workers).check()


def _check_nothing_lost(out: Path, kept: list[str]) -> None:
    """Raise StoreError where there is a fit of parameters or curves that are not fitted now."""
    if not out.exists():
        return
    old = read_fit(out)
    lost = [name for name in [*parameter_names(old), *curve_names(old)] if name not in kept]
    if lost:
        named = ", ".join(lost[:_NAMED]) + f" and {len(lost) - _NAMED} more" * (len(lost) > _NAMED)
        raise StoreError(f"{out}: holds a fit of {named} too: give another output, or --fresh to replace it")


def scene_to_fit(source: Any, changes: Any, curve: MeasuredCurve, free: list[str]) -> tuple[Scene, MeasuredCurve]:
    """Return the scene of a curve: the path begins as measured, and nothing is swept; SceneError where it is wrong.

    A free key that is swept has its first value. The curve has a spring constant only where it is the machine's.
    """
    own: Any = None

    def amend(table: dict[str, Any]) -> None:
        nonlocal own
        path, sweep = table.get("path"), table.pop("sweep", {})
        steps: dict[str, Any] = {curve.control: [float(curve.values[0])]}
        own = path.get("machine_stiffness") if isinstance(path, dict) else None
        if curve.control == "remote" and (stiffness := curve.stiffness if own is None else own) is not None:
            steps["machine_stiffness"] = stiffness
        table["path"] = steps
        for section in ("batch", "accuracy"):
            table.pop(section, None)
        if "interaction" not in table and not all(stage.flat for stage in stages_in(table)):  # only the expected law
            table["batch"] = {"estimator": "expected"}
        for key, entries in sweep.items() if isinstance(sweep, dict) else ():
            if key in free:
                _set_first(table, key, entries)
            elif key != "mode" and (key == MACHINE or not key.startswith("path.")):
                raise SceneError(
                    f"sweep.{key}: a curve is of one scene; free the key, or fix it with --set {key}=VALUE"
                )

    scene = read(source, changes, amend)
    return scene, curve if own is None and curve.control == "remote" else curve._replace(stiffness=None)


def _set_first(table: dict[str, Any], key: str, entries: Any) -> None:
    """Set a swept key that the scene leaves out to the first of its entries."""
    if isinstance(entries, dict):
        entries = entries.get("linspace", entries.get("logspace"))
    if entry_at(key, table) is None and isinstance(entries, list) and entries:
        set_key(table, key, entries[0])
