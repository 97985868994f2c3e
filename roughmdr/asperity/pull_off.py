"""Public function of one asperity: its pull-off."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, Unpack

import numpy as np

from roughmdr.asperity.contact import Contact, Results
from roughmdr.asperity.dataset import dataset_of
from roughmdr.asperity.on_machine import OnMachine, check_machine_stiffness
from roughmdr.asperity.tabor import resolved, warnings_of
from roughmdr.errors import OutOfRange, RoughmdrError, warn_limits
from roughmdr.kernels.adhesion import Adhesion, AdhesiveMaterial
from roughmdr.schema.keywords import named_keywords
from roughmdr.schema.material import effective_modulus_of
from roughmdr.shapes import Shape

if TYPE_CHECKING:
    import xarray as xr

_PULL_OFFS = {
    "force": "at the largest tension",
    "displacement": "at the point of detachment under fixed grips",
    "remote": "at the point of detachment on the spring",
}
"""The ends of a slow retraction, by its control."""


@named_keywords
def pull_off(
    shape: Shape,
    *,
    work: float | str,
    control: Literal["force", "displacement", "remote"] = "force",
    machine_stiffness: float | str | None = None,
    **material: Unpack[AdhesiveMaterial],
) -> xr.Dataset:
    """Find the pull-off of one asperity: the largest tension that its contact bears.

    With ``control="displacement"`` find the point of detachment under fixed grips, which is something else: the least
    indentation at which there is a contact. The tension there is mostly less, since it has passed its largest. With
    ``control="remote"`` find where a tip detaches that a spring in series, such as a cantilever, withdraws; a dead load
    is the limit of a soft spring, and fixed grips of a stiff one.

    Parameters
    ----------
    shape, work, **material
        Profile, work of adhesion [J/m^2], and E*, adhesion, strength, range and error as in ``indent``.
    control : {"force", "displacement", "remote"}, optional
        Slow retraction under dead load, which ends at the pull-off force, under fixed grips, or by the far end of a
        spring.
    machine_stiffness : float or str, optional
        Of that spring [N/m]; it goes with control="remote".

    Returns
    -------
    xarray.Dataset
        Scalars: force [N], indentation [m], contact_radius [m] and, with "dugdale", cohesive_radius [m]; with "remote"
        also remote [m], as in ``indent``. All are 0 without adhesion. Their long_name and the attribute ``control`` say
        which of the points it is.

    Raises
    ------
    OutOfRange, ShapeError, RoughmdrError
        As ``indent``.

    References
    ----------
    .. [1] K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. A 324 (1971) 301.
    .. [2] D. Maugis, J. Colloid Interface Sci. 150 (1992) 243.

    Examples
    --------
    >>> import roughmdr as rm
    >>> tip = rm.Paraboloid(radius=1e-6)
    >>> off = rm.pull_off(tip, effective_modulus="1 GPa", work="50 mJ/m^2")
    >>> f"{float(off.force):.4g}"  # -3/2 pi w R
    '-2.356e-07'
    >>> grips = rm.pull_off(tip, effective_modulus="1 GPa", work="50 mJ/m^2", control="displacement")
    >>> f"{float(grips.force / off.force):.4g}"  # 5/9
    '0.5556'
    >>> lever = rm.pull_off(
    ...     tip, effective_modulus="1 GPa", work="50 mJ/m^2", control="remote", machine_stiffness="40 N/m"
    ... )
    >>> f"{float(lever.force / off.force):.4g}"
    '0.9622'
    """
    if control not in _PULL_OFFS:
        raise RoughmdrError(f"control is {control!r}; it must be 'force', 'displacement' or 'remote'")
    stiffness = check_machine_stiffness(machine_stiffness, wanted=control == "remote")
    wanted = Adhesion.from_arguments(work, material)
    effective_modulus = effective_modulus_of(pull_off, material)
    asked = resolved(shape, effective_modulus, wanted)
    contact = Contact.of(shape, effective_modulus, asked)
    names = ["force", "indentation", "contact_radius"]
    names += ["cohesive_radius"] * (asked.model == "dugdale") + ["remote"] * (control == "remote")
    if not contact.kernels.adhesive:
        return _at_pull_off({name: np.zeros(()) for name in names}, control, {})
    with np.errstate(all="ignore"):
        held = OnMachine.on_spring(contact, stiffness) if control == "remote" else None
        results = contact.pull_off(control) if held is None else held.pull_off()
    radius = results["contact_radius"]
    for name in names:
        if not np.isfinite(results[name]).all() or (asked.model == "jkr" and (radius == 0.0).any()):
            given = f"effective modulus {contact.effective_modulus:g} Pa, work {asked.work:g} J/m^2, {shape}"
            raise OutOfRange(f"{name} at pull-off is not representable: {given}")
    attrs = warn_limits(warnings_of(shape, radius, contact.effective_modulus, asked))
    attrs |= {"adhesion": asked.model} if wanted.model == "auto" else {}
    return _at_pull_off({name: results[name].reshape(()) for name in names}, control, attrs)


def _at_pull_off(results: Results, control: str, attrs: dict[str, str]) -> xr.Dataset:
    """Return scalars as a dataset that says which point they are of."""
    dataset = dataset_of(results, None, {"control": control, **attrs})
    for array in dataset.values():
        array.attrs["long_name"] += f", {_PULL_OFFS[control]}"
    return dataset
