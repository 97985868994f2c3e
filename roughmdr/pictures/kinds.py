"""The kinds of pictures, with the data that each needs and the options that it takes, drawn and written."""

import warnings
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from roughmdr.errors import LimitWarning, StoreError, level_outside
from roughmdr.pictures.panel import MAX_NAMED
from roughmdr.pictures.request import Content, Drawable, Picture, Place, Request, drawable
from roughmdr.pictures.style import PICTURE_ENDINGS, save, styled
from roughmdr.result.select import along_longest, cell_of, pull_off_step, select
from roughmdr.result.view import ResultView
from roughmdr.schema.keywords import with_options
from roughmdr.schema.wording import suggestion
from roughmdr.storage.result_file import check_output
from roughmdr.variables import CURVE_VARIABLES, LAW_VARIABLES

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

_PULL_OFF = "pull-off"
_WITH_ARTICLE: dict[Content, str] = {"result": "a result", "ensemble": "an ensemble", "fit": "a fit"}


class Kind(NamedTuple):
    """A kind of picture."""

    draw: Callable[[Drawable, Request], Picture]
    of: tuple[Content, ...]
    takes: frozenset[str]
    """Options of a request that it takes."""


def draw_request(source: Drawable, request: Request) -> Picture:
    """Return the picture that is asked for; StoreError where its kind has no such data or option."""
    name = _usual(source, request) if request.kind is None else request.kind
    if name not in KINDS:
        raise StoreError(f"kind is {name!r}, which is none{suggestion(name, [*KINDS])}")
    kind = KINDS[name]
    if source.content not in kind.of:
        needed = " or ".join(_WITH_ARTICLE[each] for each in kind.of)
        raise StoreError(f"kind {name!r} is drawn from {needed}, and this is {_WITH_ARTICLE[source.content]}")
    if unfit := sorted(request.given - kind.takes):
        raise StoreError(
            f"{unfit[0]} does not go with kind {name!r}, which takes {', '.join(sorted(kind.takes)) or 'none'}"
        )
    return kind.draw(source, request)


def _usual(source: Drawable, request: Request) -> str:
    """Return the kind of picture that the options imply, or else the usual one: a sweep for many cells, or the law."""
    if source.content != "result":
        return "map" if source.content == "ensemble" else "fit"
    curves = set(LAW_VARIABLES)
    if request.at or any(name not in curves for name in request.variables):
        return "sweep" if len(source.result.cells) > 1 else "law"
    if request.x is not None:
        return "law" if request.x in curves or not source.result.sweep else "sweep"
    return "sweep" if len(source.result.cells) > MAX_NAMED else "law"


def _law(source: Drawable, request: Request) -> Picture:
    from roughmdr.pictures.law import draw_law, overlay_reference

    result, note = select(source.result, request.select)
    if len(result.cells) > MAX_NAMED and len(result.sweep) > 1:
        result, others = along_longest(result)
        note = f"{note}, {others}" if note else f"{others}; select chooses other cells"
    names, x = result.asked(request.variables), request.x or "separation"
    over = [x] if x in CURVE_VARIABLES and x not in names else []
    overlays = [("reference", overlay_reference(result, names + over))] if request.with_reference else []
    if request.with_expected or request.with_theory:
        from roughmdr.pictures.overlay import overlay_expected, overlay_theory, plan_of_result

        if note:
            raise StoreError(
                "a part of a sweep does not go with its expected law and theories: they are drawn for whole results"
            )
        plan = plan_of_result(source.file, result)
        overlays += [("expected", overlay_expected(plan, names + over))] if request.with_expected else []
        overlays += [("theory", overlay_theory(plan, names, x))] if request.with_theory else []
    if overlays and x != "separation":
        if x not in CURVE_VARIABLES:
            raise StoreError(f"x = {x!r} does not go with curves over the result, which are over its variables")
        overlays = [(title, overlay.over(x)) for title, overlay in overlays]
    lines = [line for _, overlay in overlays for line in overlay.lines]
    figure = draw_law(result, names, lines, request, note)
    return Picture(figure, [(title, text) for title, each in overlays for text in each.remarks])


def _sweep(source: Drawable, request: Request) -> Picture:
    from roughmdr.pictures.sweep import draw_sweep

    return Picture(draw_sweep(*select(source.result, request.select), request), [])


def _map(source: Drawable, request: Request) -> Picture:
    from roughmdr.pictures.map import draw_ensemble, draw_map

    if source.content == "ensemble":
        from roughmdr.ensemble import Ensemble

        if unfit := sorted(request.given):
            raise StoreError(f"{unfit[0]} does not go with asperities, which have no path")
        ensemble = Ensemble.from_dataset(source.data.to_xarray())
        return Picture(draw_ensemble(ensemble, str(source.data.attrs.get("title", "asperities"))), [])
    return Picture(draw_map(source.result, source.file, **_place(source.result, request)), [])


def _asperity(source: Drawable, request: Request) -> Picture:
    from roughmdr.pictures.asperity import draw_asperity

    place = _place(source.result, request)
    return Picture(draw_asperity(source.result, source.file, asperity=request.asperity, **place), [])


def _place(result: ResultView, request: Request) -> Place:
    """Return the cell, the realisation and the step that are asked for; a step of None is the closest approach."""
    cell, realization, step = cell_of(result, request.select), request.realization or 0, request.step
    if isinstance(step, str):
        if step != _PULL_OFF:
            raise StoreError(f"step is {step!r}; it must be a number from 0, or {_PULL_OFF!r}")
        step = pull_off_step(result, cell, realization)
    return {"cell": cell, "realization": realization, "step": step}


def _convergence(source: Drawable, request: Request) -> Picture:
    from roughmdr.pictures.convergence import draw_convergence

    return Picture(draw_convergence(select(source.result, request.select)[0]), [])


def _fit(source: Drawable, _: Request) -> Picture:
    from roughmdr.pictures.fit import draw_fit, draw_fits

    draw = draw_fits if "curve" in source.data.sizes else draw_fit
    return Picture(draw(source.data), [])


KINDS = {
    "law": Kind(
        _law,
        ("result",),
        frozenset({"variables", "x", "per_area", "select", "log", "with_expected", "with_theory", "with_reference"}),
    ),
    "sweep": Kind(_sweep, ("result",), frozenset({"variables", "x", "per_area", "at", "select", "log"})),
    "map": Kind(_map, ("result", "ensemble"), frozenset({"select", "step", "realization"})),
    "asperity": Kind(_asperity, ("result",), frozenset({"select", "step", "realization", "asperity"})),
    "convergence": Kind(_convergence, ("result",), frozenset({"select"})),
    "fit": Kind(_fit, ("fit",), frozenset()),
}


@with_options(Request)
def plot(
    result: "str | Path | xr.Dataset",
    out: str | Path | None = None,
    *,
    kind: str | None = None,
    variables: str | Iterable[str] = (),
    style: str | None = None,
    fresh: bool = False,
    **options: Any,
) -> "Figure":
    """Draw a result, an ensemble or a fit, as ``roughmdr plot`` does.

    A LimitWarning says which curve was asked for and cannot be drawn, and why.

    Parameters
    ----------
    result : path or xarray.Dataset
        A result file, or what ``run`` returned; of asperities, what ``generate`` did; of a fit, what ``fit`` did.
    out : path, optional
        The picture to write: .png, .pdf or .svg. One of the same format that is there already is replaced.
    kind : {"law", "sweep", "map", "asperity", "convergence", "fit"}, optional
        Which question it answers; unless given the law, of a sweep of many cells the sweep, of asperities the map.
    variables : str or iterable of str, optional
        Those to draw: of a law all that the result holds unless given, of a sweep one, the pull-off force.
    style : str, optional
        A style of matplotlib: its name or file.
    fresh : bool, optional
        Whether to replace a file of any kind at ``out``.
    **options
        Of a law: ``x``, the variable to draw over; ``per_area``, whether to divide by the nominal area; ``log``,
        whether the axis is logarithmic; ``with_expected``, ``with_theory`` and ``with_reference``, whether to draw the
        expected law of the scene (of asperities that feel each other, as if they did not), the theory curves that
        apply to it, and the law by boundary elements that the result holds. Of a sweep: ``x``, the swept key along the
        axis; ``per_area``; ``log``; ``at``, a dictionary such as ``{"force": "1 mN"}`` of where on the loading the
        variable is taken. Of both and others: ``select``, a dictionary such as ``{"adhesion.work": "50 mJ/m^2"}`` of
        the part of a sweep. Of a map and an asperity:
        ``step``, which may be "pull-off", and ``realization``, counted from 0; of an asperity its number, ``asperity``,
        from the highest down.

    Returns
    -------
    matplotlib.figure.Figure
        The picture, whether it was written or not; a notebook shows it.

    Raises
    ------
    StoreError
        Where there is no such result, variable or option, no run was computed, or ``out`` cannot be written or must
        not be replaced.
    SceneError
        Where a curve over the result is asked for and its scene cannot be read again.

    Examples
    --------
    >>> import roughmdr as rm
    >>> result = rm.run({
    ...     "title": "One patch", "material": {"effective_modulus": "1 GPa"}, "path": {"separation": ["3 um", "2 um"]},
    ...     "asperities": {
    ...         "source": "random", "shape": "paraboloid", "count": 500, "patch": "1 mm", "radius": "50 um",
    ...         "height": {"distribution": "normal", "std": "1 um"},
    ...     },
    ... })
    >>> [axes.get_ylabel() for axes in rm.plot(result, variables=["force", "contact_count"]).axes]
    ['force [mN]', 'contact count']
    """
    names = (variables,) if isinstance(variables, str) else tuple(variables)
    request = Request(kind, names, **options)
    source = drawable(result)
    if source.doubt:
        warnings.warn(f"{source.file}: {source.doubt}", UserWarning, stacklevel=level_outside())
    if out is not None:
        check_output(Path(out), "picture", PICTURE_ENDINGS, [source.file], fresh=fresh)
    with styled(style):
        figure, remarks = draw_request(source, request)
        for title, remark in remarks:
            if "not drawn" in remark:
                warnings.warn(f"{title}: {remark}", LimitWarning, stacklevel=level_outside())
        if out is not None:
            save(figure, Path(out))
    return figure
