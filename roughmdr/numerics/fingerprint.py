"""Hashes of the sources that decide what numba compiles, and of those that decide the numbers of a result."""

import hashlib
from functools import cache
from pathlib import Path

_PACKAGE = Path(__file__).parent.parent
COMPILED = (
    "aggregate",
    "asperity/fields",
    "ensemble/maps/hills",
    "ensemble/placement.py",
    "expected",
    "interaction",
    "kernels",
    "stages/curved",
    "stages/plastic",
    "loading",
    "numerics",
    "shapes",
)
"""Parts of the package that contain jitted functions, or code that they use."""
NUMBERS = (*COMPILED, "asperity", "batch", "elements", "ensemble", "scene", "schema", "spectrum.py", "stages")
"""Parts of the package that decide the numbers of a realisation, given its scene."""


@cache
def fingerprint(parts: tuple[str, ...]) -> str:
    """Return a hash of the sources in ``parts`` of the package, files or folders."""
    sources = {path for part in parts for path in (_PACKAGE / part, *(_PACKAGE / part).rglob("*.py"))}
    digest = hashlib.sha256()
    for source in sorted(path for path in sources if path.is_file()):
        digest.update(str(source.relative_to(_PACKAGE)).encode() + b"\0" + source.read_bytes())
    return digest.hexdigest()[:16]
