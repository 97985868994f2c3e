"""The result of a fit: parameters with intervals, their covariance, the measured and the fitted curve."""

import time

import numpy as np
from numpy.typing import ArrayLike

from roughmdr.fitting.doubts import doubts
from roughmdr.fitting.model import Model
from roughmdr.fitting.parameters import Parameter
from roughmdr.fitting.posterior import posterior_of
from roughmdr.fitting.search import Fitted, Found
from roughmdr.fitting.uncertainty import Uncertainty, correlation_of, uncertainty
from roughmdr.loading.path import labelled_branches
from roughmdr.result.trust import trust_lines
from roughmdr.schema.units import format_quantity, spelled_in_results
from roughmdr.storage.labelled import Array, Labelled
from roughmdr.storage.result_file import FIT, provenance

_POINT, _PARAMETER, _PAIR = ("point",), ("parameter",), ("parameter", "parameter_2")
_REFERENCES = (
    "Mueller and Stadtmueller (1987), Annals of Statistics 15, 610: uneven noise by the residuals of neighbours; Bell "
    "and McCaffrey (2002), Survey Methodology 28, 169: its degrees of freedom"
)
_CHAINS = "Foreman-Mackey et al. (2013), Publ. Astron. Soc. Pacific 125, 306: chains of the posterior (emcee)"
_COVARIED = (
    "of the natural logarithm of a parameter where parameter_scale is 0, else of the parameter over its parameter_scale"
)
_NAMES = {"force": "force", "pressure": "pressure, force over nominal area"}
_CONSTANT = "spring constant that the file of the curve tells"
_CONTROLS = {"separation": "separation", "remote": "position of the far end of the spring"}


def assembled(command: str, fit: Fitted, *, posterior: bool = False) -> Labelled:
    """Return the result of a search with its uncertainty, and draws from the posterior where they are asked for."""
    started, (model, found, compared, undecided) = time.perf_counter(), fit
    scene, law, curve = model.fitted(found.x), model.law(found.x), model.curve
    known = uncertainty(model, found, law)
    draws = posterior_of(model, found, known) if posterior else None
    seconds = model.seconds + time.perf_counter() - started
    variables: dict[str, Array] = {}
    for i, parameter in enumerate(model.parameters):
        variables |= _of_parameter(parameter, i, found, known)
        if draws is not None:
            values, unit = np.vectorize(parameter.value)(draws.x[:, :, i]), spelled_in_results(parameter.unit)
            drawn = f"draws of {parameter.key} from the posterior"
            variables[f"{parameter.name}_posterior"] = _array(values, unit, drawn, ("chain", "draw"))  # names of ArviZ
    for name, matrix in (("covariance", known.covariance), ("correlation", correlation_of(known.influence))):
        variables[name] = _array(matrix, "1", f"{name} of the numbers that were fitted", _PAIR)
    variables["covariance"].attrs["comment"] = _COVARIED
    keys, scales = ([getattr(each, name) for each in model.parameters] for name in ("key", "scale"))
    scaled = "scale of a fitted number in SI, 0 where its logarithm was fitted"
    rms, about = curve.relative_rms(found.deviations), "root mean square of the residual over the largest load"
    variables |= {
        "parameter_scale": _array(scales, "", scaled, _PARAMETER),
        **_of_curve(model, law.variables[curve.quantity] + model.baseline(found.x)),
        "residual_rms": _array(rms, "1", about),
        **({} if curve.stiffness is None else {"spring_constant": _array(curve.stiffness, "N m-1", _CONSTANT)}),
        "evaluation_count": _array(float(model.evaluations), "1", "number of evaluations of the expected law"),
        "run_time": _array(seconds, "s", "time spent on the fit"),
        **{name: each for name, each in compared.items() if "units" in each.attrs},
    }
    coordinates = {
        curve.control: _array(curve.values, "m", f"measured {_CONTROLS[curve.control]}", _POINT),
        "branch": labelled_branches(curve.values)._replace(dims=_POINT),
        "parameter_name": _array(keys, "", "key of the parameter in the scene", _PARAMETER),
        "parameter_2_name": _array(keys, "", "key of the parameter in the scene", _PAIR[1:]),
        **{name: each for name, each in compared.items() if "units" not in each.attrs},
    }
    warnings = [*undecided, *doubts(model, found, known), *law.warnings]
    if any(stage.replaces_contacts for stage in scene.stages) and law.yielding()["plastic_contact_fraction"] == 0.0:
        warnings.append("no contact of the fitted law yields: begin the search with a lower strength")
    if draws is not None and not draws.long_enough:
        warnings.append("the chains are too short to tell the posterior well: free less, or give priors")
    interaction = None if scene.interaction is None else scene.interaction.model
    attrs = {
        **provenance(scene.title, command),
        "kind": FIT,
        "references": _REFERENCES,
        "measured": f"{curve.origin}: {curve.about}" if curve.about else curve.origin,
        "scene": scene.toml,
        "intervals": _intervals(model, known),
        "trust": dict(trust_lines(law.model_error.named, interaction=interaction))["trust"],
    }
    if draws is not None:
        law_error = "without" if known.error_of_law is None else "with"
        attrs["posterior"] = f"about {draws.independent:.0f} independent draws, {law_error} the error of the law"
        attrs["references"] += f"; {_CHAINS}"
    if warnings:
        attrs["warnings"] = "\n".join(warnings)
    result = Labelled(variables, coordinates, attrs)
    return result._replace(attrs={**attrs, "checksum": result.checksum()})


def _intervals(model: Model, known: Uncertainty) -> str:
    """Return what the intervals are by, in words."""
    text = "95 %, residuals nearby, Student's t" if model.curve.error is None else "95 %, by the stated errors"
    if known.noise.rho:
        text += f"; wider, as residuals of neighbours are correlated by {known.noise.rho:.2g}"
    if keys := [each.key for each, is_so in zip(model.parameters, known.by_profile, strict=True) if is_so]:
        text += f"; by profile likelihood for {', '.join(keys)}"
    for each in model.parameters:
        if each.prior is not None:
            text += f"; with the prior {each.key} = {format_quantity(each.prior[0], each.unit, error=each.prior[1])}"
    return text


def _of_parameter(parameter: Parameter, i: int, found: Found, known: Uncertainty) -> dict[str, Array]:
    """Return a parameter with its standard error and its interval, limited to the bounds of the search."""
    x, error = float(found.x[i]), known.deviation_of(np.eye(found.x.size)[i])
    (lower, upper), per_x, key = known.reach[:, i], parameter.per_x(x), parameter.key
    unit = spelled_in_results(parameter.unit)
    numbers = {
        "": (parameter.value(x), f"fitted {key}"),
        "_standard_error": (per_x * error, f"standard error of the fitted {key}"),
        "_low": (parameter.value(x - float(lower)), f"lower end of the 95 % interval of {key}"),
        "_high": (parameter.value(x + float(upper)), f"upper end of the 95 % interval of {key}"),
    }
    if known.shift is not None:
        about = f"how far the model error of the law may shift the fitted {key}, not in its interval"
        numbers["_model_error"] = per_x * float(known.shift[i]), about
    return {f"{parameter.name}{end}": _array(value, unit, about) for end, (value, about) in numbers.items()}


def _of_curve(model: Model, fitted: np.ndarray) -> dict[str, Array]:
    """Return the measured and the fitted loads."""
    curve = model.curve
    name, unit = _NAMES[curve.quantity], curve.unit
    columns = {
        curve.quantity: (curve.load, f"measured {name}"),
        f"{curve.quantity}_fitted": (fitted, f"{name} of the fitted scene, with its baseline"),
        "residual": (curve.load - fitted, f"measured minus fitted {curve.quantity}"),
    }
    if curve.error is not None:
        columns[f"{curve.quantity}_error"] = curve.error, f"standard deviation of the measured {curve.quantity}"
    return {key: _array(values, unit, about, _POINT) for key, (values, about) in columns.items()}


def _array(values: ArrayLike, unit: str, long_name: str, dims: tuple[str, ...] = ()) -> Array:
    """Return an array with its attributes; no unit where that is empty."""
    return Array(dims, np.asarray(values), ({"units": unit} if unit else {}) | {"long_name": long_name})
