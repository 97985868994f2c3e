"""A picture of a file or a dataset, written and returned."""

import warnings
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from roughmdr.errors import LimitWarning, level_outside
from roughmdr.pictures.kinds import draw_request
from roughmdr.pictures.request import Request, drawable
from roughmdr.pictures.style import format_of, save, styled
from roughmdr.schema.keywords import with_options
from roughmdr.storage.files import check_writable
from roughmdr.storage.result_file import check_same_kind

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure


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
        expected law of the scene, the theory curves that apply to it, and the law by boundary elements that the
        result holds. Of a sweep: ``x``, the swept key along the axis; ``per_area``; ``log``; ``at``, a dictionary such
        as ``{"force": "1 mN"}`` of where on the loading the variable is taken. Of both and others: ``select``, a
        dictionary such as ``{"adhesion.work": "50 mJ/m^2"}`` of the part of a sweep. Of a map and an asperity:
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
        check_picture(Path(out), [] if source.file is None else [source.file], fresh=fresh)
    with styled(style):
        figure, remarks = draw_request(source, request)
        for title, remark in remarks:
            if "not drawn" in remark:
                warnings.warn(f"{title}: {remark}", LimitWarning, stacklevel=level_outside())
        if out is not None:
            save(figure, Path(out))
    return figure


def check_picture(path: Path, inputs: Iterable[Path], *, fresh: bool) -> None:
    """Raise StoreError unless a picture can be written to ``path`` and replaces nothing but one of its own format.

    With ``fresh`` it may replace a file of any kind but one of the inputs.
    """
    check_writable(path, inputs)
    kind = format_of(path)
    if not fresh:
        check_same_kind(path, kind)
