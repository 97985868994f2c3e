"""``ds.roughmdr`` is there whatever is imported first, and importing roughmdr does not import xarray."""

import subprocess
import sys

import pytest
from forms import large

_LATER = """
import sys, roughmdr
assert "xarray" not in sys.modules
import xarray
"""
_FIRST = "import xarray, roughmdr\n"
_AGAIN = """
import sys, roughmdr
for name in [name for name in sys.modules if name.startswith("roughmdr")]:
    del sys.modules[name]
import roughmdr, xarray, roughmdr
"""
_THREADS = """
import importlib, threading
threads = [threading.Thread(target=importlib.import_module, args=(name,)) for name in ("roughmdr", "xarray") * 4]
[thread.start() for thread in threads]
[thread.join() for thread in threads]
import xarray, roughmdr
"""
_LOOKED_FOR = """
import importlib.util, roughmdr, sys
assert importlib.util.find_spec("xarray").loader.get_filename("xarray").endswith("__init__.py")
assert "xarray" not in sys.modules
import xarray
"""
_FAILED = """
import builtins, sys, roughmdr
sys.modules["pandas"] = None
try:
    import xarray
except ImportError:
    del sys.modules["pandas"]
else:
    raise AssertionError
for name in [name for name in sys.modules if name.startswith("xarray")]:
    del sys.modules[name]
import xarray
"""
_CHECK = """
import sys
assert "neither" in repr(xarray.Dataset().roughmdr)
assert not [finder for finder in sys.meta_path if type(finder).__module__.startswith("roughmdr")]
assert xarray.__spec__.loader is xarray.__loader__
"""


@pytest.mark.large
@pytest.mark.parametrize(
    "order",
    [_LATER, _FIRST, *map(large, [_AGAIN, _THREADS, _LOOKED_FOR, _FAILED])],
    ids=lambda order: order.strip().split("\n")[0],
)
def test_it_is_registered_once_xarray_is_there(order: str) -> None:
    done = subprocess.run(
        [sys.executable, "-W", "error::RuntimeWarning", "-c", order + _CHECK],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
