"""The papers behind results, each declared once; ``cite`` chooses among them."""

from typing import NamedTuple


class Paper(NamedTuple):
    """A paper, book or contribution to a conference; what is not known for certain is empty."""

    key: str  # of BibTeX
    authors: tuple[str, ...]  # "others" at the end for more
    title: str
    venue: str  # journal or proceedings; publisher of a book
    year: int
    volume: str = ""
    pages: str = ""
    doi: str = ""
    kind: str = "article"  # entry of BibTeX: article, book or inproceedings


HESS = Paper(
    "Hess2012",
    ("M. Heß",),
    "On the reduction method of dimensionality: The exact mapping of axisymmetric contact problems with and without "
    "adhesion",
    "Physical Mesomechanics",
    2012,
    "15",
    "264-269",
    "10.1134/S1029959912030034",
)
POPOV_HESS = Paper(
    "PopovHess2015",
    ("V. L. Popov", "M. Heß"),
    "Method of Dimensionality Reduction in Contact Mechanics and Friction",
    "Springer",
    2015,
    doi="10.1007/978-3-642-53876-6",
    kind="book",
)
HERTZ = Paper(
    "Hertz1882",
    ("H. Hertz",),
    "Ueber die Berührung fester elastischer Körper",
    "Journal für die reine und angewandte Mathematik",
    1882,
    "92",
    "156-171",
    "10.1515/crll.1882.92.156",
)
SNEDDON = Paper(
    "Sneddon1965",
    ("I. N. Sneddon",),
    "The relation between load and penetration in the axisymmetric Boussinesq problem for a punch of arbitrary profile",
    "International Journal of Engineering Science",
    1965,
    "3",
    "47-57",
    "10.1016/0020-7225(65)90019-4",
)
JKR = Paper(
    "Johnson1971",
    ("K. L. Johnson", "K. Kendall", "A. D. Roberts"),
    "Surface energy and the contact of elastic solids",
    "Proceedings of the Royal Society of London A",
    1971,
    "324",
    "301-313",
    "10.1098/rspa.1971.0141",
)
KENDALL = Paper(
    "Kendall1971",
    ("K. Kendall",),
    "The adhesion and surface energy of elastic solids",
    "Journal of Physics D: Applied Physics",
    1971,
    "4",
    "1186-1195",
    "10.1088/0022-3727/4/8/320",
)
MAUGIS = Paper(
    "Maugis1992",
    ("D. Maugis",),
    "Adhesion of spheres: The JKR-DMT transition using a Dugdale model",
    "Journal of Colloid and Interface Science",
    1992,
    "150",
    "243-269",
    "10.1016/0021-9797(92)90285-T",
)
DUGDALE = Paper(
    "Dugdale1960",
    ("D. S. Dugdale",),
    "Yielding of steel sheets containing slits",
    "Journal of the Mechanics and Physics of Solids",
    1960,
    "8",
    "100-104",
    "10.1016/0022-5096(60)90013-2",
)
TABOR = Paper(
    "Tabor1977",
    ("D. Tabor",),
    "Surface forces and surface interactions",
    "Journal of Colloid and Interface Science",
    1977,
    "58",
    "2-13",
    "10.1016/0021-9797(77)90366-6",
)
GREENWOOD_WILLIAMSON = Paper(
    "Greenwood1966",
    ("J. A. Greenwood", "J. B. P. Williamson"),
    "Contact of nominally flat surfaces",
    "Proceedings of the Royal Society of London A",
    1966,
    "295",
    "300-319",
    "10.1098/rspa.1966.0242",
)
LONGUET_HIGGINS = Paper(
    "LonguetHiggins1957",
    ("M. S. Longuet-Higgins",),
    "The statistical analysis of a random, moving surface",
    "Philosophical Transactions of the Royal Society of London A",
    1957,
    "249",
    "321-387",
    "10.1098/rsta.1957.0002",
)
NAYAK = Paper(
    "Nayak1971",
    ("P. R. Nayak",),
    "Random process model of rough surfaces",
    "Journal of Lubrication Technology",
    1971,
    "93",
    "398-407",
    "10.1115/1.3451608",
)
GREENWOOD = Paper(
    "Greenwood2006",
    ("J. A. Greenwood",),
    "A simplified elliptic model of rough surface contact",
    "Wear",
    2006,
    "261",
    "191-200",
    "10.1016/j.wear.2005.09.031",
)
PERSSON = Paper(
    "Persson2005",
    ("B. N. J. Persson", "O. Albohr", "U. Tartaglino", "A. I. Volokitin", "E. Tosatti"),
    "On the nature of surface roughness with application to contact mechanics, sealing, rubber friction and adhesion",
    "Journal of Physics: Condensed Matter",
    2005,
    "17",
    "R1-R62",
    "10.1088/0953-8984/17/1/R01",
)
EWALD = Paper(
    "Ewald1921",
    ("P. P. Ewald",),
    "Die Berechnung optischer und elektrostatischer Gitterpotentiale",
    "Annalen der Physik",
    1921,
    "369",
    "253-287",
    "10.1002/andp.19213690304",
)
CIAVARELLA = Paper(
    "Ciavarella2008",
    ("M. Ciavarella", "J. A. Greenwood", "M. Paggi"),
    "Inclusion of “interaction” in the Greenwood and Williamson contact theory",
    "Wear",
    2008,
    "265",
    "729-734",
    "10.1016/j.wear.2008.01.019",
)
POLONSKY = Paper(
    "Polonsky1999",
    ("I. A. Polonsky", "L. M. Keer"),
    "A numerical method for solving rough contact problems based on the multi-level multi-summation and conjugate "
    "gradient techniques",
    "Wear",
    1999,
    "231",
    "206-219",
    "10.1016/S0043-1648(99)00113-1",
)
STANLEY_KATO = Paper(
    "Stanley1997",
    ("H. M. Stanley", "T. Kato"),
    "An FFT-based method for rough surface contact",
    "Journal of Tribology",
    1997,
    "119",
    "481-485",
    "10.1115/1.2833523",
)
LOVE = Paper(
    "Love1929",
    ("A. E. H. Love",),
    "The stress produced in a semi-infinite solid by pressure on part of the boundary",
    "Philosophical Transactions of the Royal Society of London A",
    1929,
    "228",
    "377-420",
    "10.1098/rsta.1929.0009",
)

SOFTWARE = {
    "numpy": Paper(
        "Harris2020",
        ("C. R. Harris", "K. J. Millman", "S. J. van der Walt", "others"),
        "Array programming with NumPy",
        "Nature",
        2020,
        "585",
        "357-362",
        "10.1038/s41586-020-2649-2",
    ),
    "numba": Paper(
        "Lam2015",
        ("S. K. Lam", "A. Pitrou", "S. Seibert"),
        "Numba: A LLVM-based Python JIT compiler",
        "Proceedings of the Second Workshop on the LLVM Compiler Infrastructure in HPC",
        2015,
        doi="10.1145/2833157.2833162",
        kind="inproceedings",
    ),
    "scipy": Paper(
        "Virtanen2020",
        ("P. Virtanen", "R. Gommers", "T. E. Oliphant", "others"),
        "SciPy 1.0: Fundamental algorithms for scientific computing in Python",
        "Nature Methods",
        2020,
        "17",
        "261-272",
        "10.1038/s41592-019-0686-2",
    ),
    "xarray": Paper(
        "Hoyer2017",
        ("S. Hoyer", "J. Hamman"),
        "xarray: N-D labeled arrays and datasets in Python",
        "Journal of Open Research Software",
        2017,
        "5",
        doi="10.5334/jors.148",
    ),
    "dask": Paper(
        "Rocklin2015",
        ("M. Rocklin",),
        "Dask: Parallel computation with blocked algorithms and task scheduling",
        "Proceedings of the 14th Python in Science Conference",
        2015,
        doi="10.25080/Majora-7b98e3ed-013",
        kind="inproceedings",
    ),
}
"""By the name of the package."""
