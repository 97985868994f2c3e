"""The header of an exported file as comments, and its mark, by which it is known again."""

import textwrap
from collections.abc import Iterator

from roughmdr.report.export.document import Document
from roughmdr.schema.wording import escape_controls
from roughmdr.storage.result_file import EXPORT_MARK

_WIDTH = 108  # of a line of the header; CalculiX and Abaqus read more


def comment_lines(document: Document, code: str, start: str) -> Iterator[str]:
    """Yield the header as ASCII lines that begin with ``start``, the mark first."""
    yield f"{start} {document.quantity} for {code}, {EXPORT_MARK}"
    for name, text in document.header.items():
        for line in textwrap.wrap(f"{name}: {_plain(text)}", _WIDTH, subsequent_indent="    "):
            yield f"{start} {line}"


def _plain(text: str) -> str:
    """Return a text on one line in ASCII."""
    spelled = escape_controls(text).replace("\n", "; ").replace("±", "+/-").replace("µ", "u")
    return spelled.encode("ascii", "backslashreplace").decode()
