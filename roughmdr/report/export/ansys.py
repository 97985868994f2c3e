"""Tables as arrays of type TABLE in the parametric language of Ansys (APDL).

Real constants of contact elements take the name of such an array as %NAME%; its primary variable GAP is positive in
penetration, PRESSURE in compression (Mechanical APDL Basic Analysis Guide, tabular real constants).
"""

from roughmdr.report.export.comments import comment_lines
from roughmdr.report.export.document import Document

_NAMES = {"pressure": "PRES", "thermal_conductance": "TCC", "electrical_conductance": "ECC"}


def write_ansys(document: Document) -> str:
    """Return a table over GAP or PRESSURE: index values in column 0, values in column 1."""
    name = f"ROUGH_{_NAMES['pressure' if document.quantity == 'pressure' else document.variable]}"
    primary = "GAP" if document.argument.name == "overclosure" else "PRESSURE"
    lines = [*comment_lines(document, "ansys", "!"), f"*DIM,{name},TABLE,{document.value.values.size},1,1,{primary}"]
    pairs = zip(document.argument.values.tolist(), document.value.values.tolist(), strict=True)
    for row, (argument, value) in enumerate(pairs, start=1):
        lines += [f"*SET,{name}({row},0),{argument:.15g}", f"*SET,{name}({row},1),{value:.15g}"]
    return "\n".join([*lines, ""])
