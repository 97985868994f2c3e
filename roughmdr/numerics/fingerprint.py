"""A fingerprint of the program itself: what was compiled or computed by other sources is not used again."""

import hashlib
from functools import cache
from pathlib import Path


@cache
def fingerprint() -> str:
    """A hash of all the sources of the package."""
    digest = hashlib.sha256()
    for source in sorted(Path(__file__).parent.parent.rglob("*.py")):
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]
