"""The papers behind lateral forces: partial slip of contacts, and its memory."""

from roughmdr.report.citations import Paper

CATTANEO = Paper(
    "Cattaneo1938",
    ("C. Cattaneo",),
    "Sul contatto di due corpi elastici: distribuzione locale degli sforzi",
    "Rendiconti dell'Accademia Nazionale dei Lincei",
    1938,
    "27",
    "342-348",
)
MINDLIN = Paper(
    "Mindlin1949",
    ("R. D. Mindlin",),
    "Compliance of elastic bodies in contact",
    "Journal of Applied Mechanics",
    1949,
    "16",
    "259-268",
)
MINDLIN_DERESIEWICZ = Paper(
    "MindlinDeresiewicz1953",
    ("R. D. Mindlin", "H. Deresiewicz"),
    "Elastic spheres in contact under varying oblique forces",
    "Journal of Applied Mechanics",
    1953,
    "20",
    "327-344",
)
JAEGER = Paper(
    "Jaeger1995",
    ("J. Jäger",),
    "Axi-symmetric bodies of equal material in contact under torsion or shift",
    "Archive of Applied Mechanics",
    1995,
    "65",
    "478-487",
)
MASING = Paper(
    "Masing1926",
    ("G. Masing",),
    "Eigenspannungen und Verfestigung beim Messing",
    "Proceedings of the 2nd International Congress of Applied Mechanics",
    1926,
    pages="332-335",
    kind="inproceedings",
)
