"""Registers the accessor ``ds.roughmdr`` with xarray, without importing xarray: at once, or when that is imported."""

import sys
from collections.abc import Sequence
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import xarray as xr

    from roughmdr.analysis.accessor import Analysis

_NAME = "roughmdr"


def register() -> None:
    """Give every Dataset the attribute ``roughmdr``: now if xarray is loaded, else as soon as it is."""
    hook = _WhenImported()
    sys.meta_path.insert(0, hook)  # before the check whether it is loaded: another thread may import it meanwhile
    if "xarray" in sys.modules:
        hook.done()


class _WhenImported(MetaPathFinder):
    """Lets others find xarray, and registers the accessor once it is loaded."""

    def find_spec(
        self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Return the spec that the next finders have for xarray, with a loader that registers; None for the rest."""
        finders = sys.meta_path
        if name != "xarray" or self not in finders:
            return None
        following = finders[finders.index(self) + 1 :]
        spec = next(filter(None, (finder.find_spec(name, path, target) for finder in following)), None)
        if spec is None or spec.loader is None:
            return spec
        loader = spec.loader
        execute = loader.exec_module

        def exec_and_register(module: ModuleType) -> None:
            loader.exec_module = execute  # type: ignore[method-assign]
            execute(module)
            self.done()

        loader.exec_module = exec_and_register  # type: ignore[method-assign]
        return spec

    def done(self) -> None:
        """Register, and leave the list of finders; a new list, since other threads may be going through the old."""
        import xarray as xr

        if hasattr(xr, "register_dataset_accessor") and not hasattr(xr.Dataset, _NAME):
            xr.register_dataset_accessor(_NAME)(_analysis)  # type: ignore[no-untyped-call]
        sys.meta_path = [finder for finder in sys.meta_path if finder is not self]


def _analysis(dataset: "xr.Dataset") -> "Analysis":
    """Return ``ds.roughmdr``, the analysis of a dataset."""
    from roughmdr.analysis.accessor import Analysis

    return Analysis(dataset)
