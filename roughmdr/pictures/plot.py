"""A result drawn, with the expected law and theory curves over it where they are asked for."""

import warnings
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from roughmdr.errors import LimitWarning
from roughmdr.pictures.law import draw, format_of, save
from roughmdr.pictures.reference import overlay_reference
from roughmdr.report.given import given_result
from roughmdr.result.layout import asked_variables
from roughmdr.storage.files import check_writable
from roughmdr.storage.labelled import Labelled
from roughmdr.storage.result_file import check_same_kind

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure


class Picture(NamedTuple):
    """A figure, and remarks on the curves over it: which they are, and whether they are drawn, and if not why."""

    figure: "Figure"
    remarks: list[tuple[str, str]]


def plot(
    result: "str | Path | xr.Dataset",
    out: str | Path | None = None,
    *,
    variables: str | Iterable[str] = (),
    with_expected: bool = False,
    with_theory: bool = False,
    with_reference: bool = False,
    fresh: bool = False,
) -> "Figure":
    """Draw the load-separation law of a result, as ``roughmdr plot`` does.

    A LimitWarning says which curve was asked for and cannot be drawn, and why.

    Parameters
    ----------
    result : path or xarray.Dataset
        A result file, or what ``run`` returned.
    out : path, optional
        The picture to write: .png, .pdf or .svg. One of the same format that is there already is replaced.
    variables : str or iterable of str, optional
        Those to draw; all that the result holds unless given.
    with_expected, with_theory : bool, optional
        Whether to draw the expected law of the scene, and the theory curves that apply to it, as well.
    with_reference : bool, optional
        Whether to draw the law by boundary elements that the result holds beside its own.
    fresh : bool, optional
        Whether to replace a file of any kind at ``out``.

    Returns
    -------
    matplotlib.figure.Figure
        The picture, whether it was written or not; a notebook shows it.

    Raises
    ------
    StoreError
        Where there is no such result or variable, no run was computed, or ``out`` cannot be written or must not be
        replaced.
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
    data, file = given_result(result)
    if out is not None:
        check_picture(Path(out), [] if file is None else [file], fresh=fresh)
    names = [variables] if isinstance(variables, str) else list(variables)
    figure, remarks = draw_result(
        data, names, file, with_expected=with_expected, with_theory=with_theory, with_reference=with_reference
    )
    for title, remark in remarks:
        if "not drawn" in remark:
            warnings.warn(f"{title}: {remark}", LimitWarning, stacklevel=2)
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


def draw_result(
    result: Labelled,
    variables: Iterable[str],
    file: Path | None,
    *,
    with_expected: bool,
    with_theory: bool,
    with_reference: bool = False,
) -> Picture:
    """Return the picture of a result that was read, from ``file`` unless that is None; all variables if none is named.

    Errors as in ``plot``.
    """
    names = asked_variables(result, variables)
    overlays = [("reference", overlay_reference(result, names))] if with_reference else []
    if with_expected or with_theory:
        from roughmdr.pictures.overlay import overlay_expected, overlay_theory, plan_of_result

        plan = plan_of_result(file, result)
        overlays += [("expected", overlay_expected(plan, names))] if with_expected else []
        overlays += [("theory", overlay_theory(plan, names))] if with_theory else []
    lines = [line for _, overlay in overlays for line in overlay.lines]
    return Picture(draw(result, names, lines), [(title, text) for title, each in overlays for text in each.remarks])
