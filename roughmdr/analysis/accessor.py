"""The accessor ``ds.roughmdr``: analysis of results, beside the methods of xarray."""

from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from roughmdr.schema.wording import html_listing, listing

if TYPE_CHECKING:
    import xarray as xr

    from roughmdr.analysis.power_law import Between


class Analysis:
    """Analysis of a result, or the description of an ensemble: ``ds.roughmdr`` of a Dataset.

    Every method returns a new Dataset with units and long_name on each variable, over the swept keys and, where it is
    not about all of them, ``realization``. A dataset that is opened in chunks stays lazy. StoreError where the dataset
    is no result as ``run`` or ``load_separation`` returns it.

    Examples
    --------
    >>> import roughmdr as rm
    >>> result = rm.run({
    ...     "title": "Four patches", "material": {"effective_modulus": "5 MPa"},
    ...     "adhesion": {"model": "jkr", "work": "50 mJ/m^2"},
    ...     "asperities": {
    ...         "source": "random", "shape": "paraboloid", "count": 500, "patch": "1 mm", "radius": "50 um",
    ...         "height": {"distribution": "normal", "std": "1 um"},
    ...     },
    ...     "path": {"separation": {"stop": "1.5 um", "steps": 50}, "unload": True}, "batch": {"realizations": 4},
    ... })
    >>> print(result.roughmdr)
    result       Four patches
    runs         4 realisations, 100 steps
    ...
    """

    def __init__(self, dataset: "xr.Dataset") -> None:
        self._dataset = dataset

    def __repr__(self) -> str:
        from roughmdr.analysis.description import describe

        return listing(describe(self._dataset))

    def _repr_html_(self) -> str:
        from roughmdr.analysis.description import describe
        from roughmdr.pictures.sketch import sketch

        return html_listing(describe(self._dataset)) + sketch(self._dataset)

    def pull_off(self) -> "xr.Dataset":
        """Return the pull-off over the swept keys: the largest tension of each unloading, averaged.

        Returns
        -------
        xarray.Dataset
            ``force``, ``force_sem`` (standard error), ``force_model_error`` [N], ``separation`` [m], ``contacts`` [1],
            ``pressure`` [Pa], ``contact_fraction`` [1], ``count`` [1] of pull-offs and ``force_of_mean`` [N] if held.

        Raises
        ------
        StoreError
            Where the path has no unloading.

        Examples
        --------
        >>> off = result.roughmdr.pull_off()
        >>> bool(off.force < 0.0), int(off["count"])
        (True, 4)
        """
        from roughmdr.analysis.pull_off import pull_off

        return pull_off(self._dataset)

    def hysteresis(self) -> "xr.Dataset":
        """Return the energy of the loop, per realisation, or of the mean loop of statistics.

        Returns
        -------
        xarray.Dataset
            ``work_of_loading``, ``work_of_unloading`` (regained) and ``energy_lost``, their difference [J], each with
            ``NAME_interpolation_error`` [J]: how far the trapezoid rule changes where every other step is left out,
            and by jumps, which may cancel in that. ``dissipated_energy`` [J] at the last step, where the result has it.
            Of a lateral path they are those of the tangential force, with ``friction_energy`` [J].

        Raises
        ------
        StoreError
            Where the path has no unloading, or neither force nor pressure is in the result.

        Examples
        --------
        >>> bool((result.roughmdr.hysteresis().energy_lost > 0.0).all())
        True
        """
        from roughmdr.analysis.hysteresis import hysteresis

        return hysteresis(self._dataset)

    def at_force(self, force: ArrayLike, *, branch: str = "loading", reference: bool = False) -> "xr.Dataset":
        """Return all curves, and the separation, where the force first reaches values on a branch.

        Parameters
        ----------
        force : number, text with a unit, or array of these
            [N]. An array makes a dimension ``force``.
        branch : {"loading", "unloading"}, optional
            The branch on which it is reached: on the first leg that reaches it.
        reference : bool, optional
            Whether the reference by boundary elements is to reach them; the new dimension is ``reference_force``.

        Returns
        -------
        xarray.Dataset
            Linear between the two steps around the value (also pressure and contact fraction where not held); NaN where
            it is never reached. Beside each ``NAME`` its ``NAME_interpolation_error``, which holds in 97 % of cases, by
            bends and jumps around; of contact_count and the like, or of fewer than four steps, the difference to the
            farther. Beside what is no count or energy ``NAME_model_error``, by the assumptions of the model there; of a
            reference ``reference_NAME_error``, by its grid: at the separation, or ``reference``'s value.

        Raises
        ------
        StoreError
            Where the result has no such curve, or the path no such branch.
        OutOfRange
            Where a value is no finite number with the right unit.

        Examples
        --------
        >>> there = result.roughmdr.at_force(["10 uN", "20 uN"])
        >>> dict(there.separation.sizes), there.separation_interpolation_error.attrs["units"]
        ({'realization': 4, 'force': 2}, 'm')
        """
        return self._at("force", force, branch, reference)

    def at_pressure(self, pressure: ArrayLike, *, branch: str = "loading", reference: bool = False) -> "xr.Dataset":
        """Return all curves where the pressure [Pa] first reaches values; else as ``at_force``.

        Examples
        --------
        >>> result.roughmdr.at_pressure("10 Pa").force.dims
        ('realization',)
        """
        return self._at("pressure", pressure, branch, reference)

    def at_contact_fraction(
        self, contact_fraction: ArrayLike, *, branch: str = "loading", reference: bool = False
    ) -> "xr.Dataset":
        """Return all curves where the contact fraction [1] first reaches values; else as ``at_force``.

        Examples
        --------
        >>> result.roughmdr.at_contact_fraction([1e-3, 2e-3], branch="unloading").force.dims
        ('realization', 'contact_fraction')
        """
        return self._at("contact_fraction", contact_fraction, branch, reference)

    def at_separation(self, separation: ArrayLike, *, branch: str = "loading") -> "xr.Dataset":
        """Return all curves where the flat first stands at separations [m]; else as ``at_force``.

        Examples
        --------
        >>> bool((result.roughmdr.at_separation("2 um").force_interpolation_error < 1e-4).all())
        True
        """
        return self._at("separation", separation, branch)

    def _at(self, name: str, values: ArrayLike, branch: str, reference: bool = False) -> "xr.Dataset":
        from roughmdr.result.interpolation import at_value

        return at_value(self._dataset, f"reference_{name}" if reference else name, values, branch)

    def normalise(self, theory: str) -> "xr.Dataset":
        """Return the result without dimensions, by the scales of a theory.

        Parameters
        ----------
        theory : {"gw"}
            Greenwood and Williamson's: without adhesion force, contact area, count and stiffness are F_n(h/sigma) =
            int_d^inf (s - d)^n phi(s) ds with n = 3/2, 1, 0, 1/2. N, E*, the mean radius R and sigma are those of the
            scene, in each cell of a sweep.

        Returns
        -------
        xarray.Dataset
            Curves, pull-offs and the separation [1], with the scale of each in its long_name; other variables are
            left out.

        Raises
        ------
        StoreError
            Where the asperities are no paraboloids, or their heights do not scatter.

        Examples
        --------
        >>> result.roughmdr.normalise("gw").force.attrs["units"]
        '1'
        """
        from roughmdr.analysis.normalise import normalise

        return normalise(self._dataset, theory)

    def fit_power_law(
        self, y: str, x: str, *, branch: str = "loading", between: "Between | None" = None
    ) -> "xr.Dataset":
        """Return the power law y = coefficient (x/x0)^exponent of two curves, fitted in logarithms.

        Parameters
        ----------
        y, x : str
            Names of curves, or "separation".
        branch : {"loading", "unloading"}, optional
            The branch whose steps are fitted.
        between : pair of numbers or texts with a unit, optional
            The range of x; all steps at which x and y are above 0 unless given.

        Returns
        -------
        xarray.Dataset
            Over the swept keys: ``exponent`` [1], ``coefficient`` [of y], both with ``_error``, ``x0`` [of x], the
            geometric mean of x, ``rms_residual`` [1] and ``points`` [1]. Mean and standard error over realisations, of
            one (or of mean curves) from the residuals; NaN where fewer than two steps are left.

        Raises
        ------
        StoreError
            Where the result has no such curve, or ``between`` is no range.

        Examples
        --------
        >>> law = result.roughmdr.fit_power_law("contact_area", "force", branch="loading")
        >>> bool(law.exponent > 0.0), law.coefficient.attrs["units"]
        (True, 'm2')
        """
        from roughmdr.analysis.power_law import fit_power_law

        return fit_power_law(self._dataset, y, x, branch, between)

    def statistics(self) -> "xr.Dataset":
        """Return the result that keep = "statistics" would have stored, of a result with curves.

        Returns
        -------
        xarray.Dataset
            ``NAME_mean``, ``NAME_sem`` (standard error of the mean), ``NAME_min`` and ``NAME_max`` over the
            realisations. NaN for the error of a single one, and for that of the stiffness where contacts detach.

        Raises
        ------
        StoreError
            Where the result has no realisations.

        Examples
        --------
        >>> bool(abs(result.roughmdr.statistics().force_mean - result.force.mean("realization")).max() < 1e-15)
        True
        """
        from roughmdr.analysis.statistics import statistics

        return statistics(self._dataset)

    def trust(self) -> "xr.Dataset":
        """Return how far the force can be trusted, over the swept keys: the worst of the realisations.

        Returns
        -------
        xarray.Dataset
            ``model_error`` with its parts, ``largest_contact_fraction``, both sampling errors (all [1]) and
            ``trusted_separation`` [m], NaN where the whole path can be trusted; the attribute ``trust`` has words.

        Raises
        ------
        StoreError
            Where the result was made by a version that did not estimate the error of its model.

        Examples
        --------
        >>> "force within about" in result.roughmdr.trust().attrs["trust"]
        True
        """
        from roughmdr.analysis.trust import trust

        return trust(self._dataset)

    def plot(self, *args: Any, **kwargs: Any) -> Any:
        """Draw the result: ``roughmdr.plot`` with it as first argument.

        Examples
        --------
        >>> [axes.get_ylabel() for axes in result.roughmdr.plot(variables="contact_count").axes]
        ['contact count']
        """
        from roughmdr.pictures.kinds import plot
        from roughmdr.result.curves import result_of

        result_of(self._dataset)
        return plot(self._dataset, *args, **kwargs)
