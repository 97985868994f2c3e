"""The papers behind what is made of a law of contacts: conductance, partial slip, relaxation, a curved body."""

from roughmdr.report.citations import Paper

HOLM = Paper(
    "Holm1967",
    ("R. Holm",),
    "Electric Contacts: Theory and Application",
    "Springer",
    1967,
    doi="10.1007/978-3-662-06688-1",
    kind="book",
)
BARBER = Paper(
    "Barber2003",
    ("J. R. Barber",),
    "Bounds on the electrical resistance between contacting elastic rough bodies",
    "Proceedings of the Royal Society of London A",
    2003,
    "459",
    "53-66",
)
GREENWOOD_TRIPP = Paper(
    "Greenwood1967",
    ("J. A. Greenwood", "J. H. Tripp"),
    "The elastic contact of rough spheres",
    "Journal of Applied Mechanics",
    1967,
    "34",
    "153-159",
    "10.1115/1.3607616",
)
LEE_RADOK = Paper(
    "Lee1960",
    ("E. H. Lee", "J. R. M. Radok"),
    "The contact problem for viscoelastic bodies",
    "Journal of Applied Mechanics",
    1960,
    "27",
    "438-444",
    "10.1115/1.3644020",
)
TING = Paper(
    "Ting1966",
    ("T. C. T. Ting",),
    "The contact stresses between a rigid indenter and a viscoelastic half-space",
    "Journal of Applied Mechanics",
    1966,
    "33",
    "845-854",
    "10.1115/1.3625192",
)
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
