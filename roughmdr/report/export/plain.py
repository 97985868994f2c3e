"""Tables as CSV and as JSON, with all digits and all columns."""

import json
import math

from roughmdr.report.export.comments import comment_lines
from roughmdr.report.export.document import Document
from roughmdr.storage.result_file import EXPORT_MARK


def write_csv(document: Document) -> str:
    """Return the header as comments, a line of names with units, and a line for each point."""
    names = ",".join(f"{column.name} [{column.unit}]" for column in document.columns)
    rows = zip(*(column.values.tolist() for column in document.columns), strict=True)
    return "\n".join([*comment_lines(document, "csv", "#"), names, *(",".join(map(repr, row)) for row in rows), ""])


def write_json(document: Document) -> str:
    """Return one object: the header, the unit of each column, and the columns; null for what is not known."""
    table = {
        "format": f"{document.quantity} for json, {EXPORT_MARK}",
        "header": document.header,
        "units": {column.name: column.unit for column in document.columns},
        "columns": {
            column.name: [value if math.isfinite(value) else None for value in column.values.tolist()]
            for column in document.columns
        },
    }
    return json.dumps(table, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
