"""Of which kind a file is: nothing that exists is replaced by a file of another kind unasked."""

from pathlib import Path

from roughmdr.errors import RoughmdrError, StoreError
from roughmdr.storage.netcdf import load_dimensions

_BEGIN = {"png": b"\x89PNG\r\n\x1a\n", "pdf": b"%PDF-"}
_HEAD = 4096  # bytes, in which an SVG says that it is one


def check_kind(path: Path, kind: str) -> None:
    """StoreError where a file is at ``path`` that is no ``kind``: "png", "pdf", "svg" or "ensemble"."""
    if path.exists() and not (_is_ensemble(path) if kind == "ensemble" else _is_picture(path, kind)):
        raise StoreError(f"{path}: is there already, and is no {kind}: give another output, or --fresh to replace it")


def _is_picture(path: Path, kind: str) -> bool:
    try:
        with path.open("rb") as file:
            head = file.read(_HEAD)
    except OSError as error:
        raise StoreError(f"{path}: cannot be read: {error.strerror}") from None
    return b"<svg" in head if kind == "svg" else head.startswith(_BEGIN[kind])


def _is_ensemble(path: Path) -> bool:
    try:
        return load_dimensions(path).get("height") == ("asperity",)
    except RoughmdrError:
        return False
