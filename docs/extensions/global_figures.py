"""The pictures of a gallery example: every figure that a name of the example stands for, once.

``rm.plot`` makes figures without pyplot, which the scrapers of sphinx-gallery do not see.
"""

from collections.abc import Callable
from typing import Any

from matplotlib.figure import Figure
from sphinx_gallery.scrapers import figure_rst

_DRAWN: set[Figure] = set()


def scrape(block: Any, block_vars: dict[str, Any], gallery_conf: dict[str, Any]) -> str:
    """Save the figures that this block has made, and return how the page shows them."""
    figures = [value for value in block_vars["example_globals"].values() if isinstance(value, Figure)]
    new = [figure for figure in dict.fromkeys(figures) if figure not in _DRAWN]
    paths = []
    for figure in new:
        _DRAWN.add(figure)
        paths.append(next(block_vars["image_path_iterator"]))
        figure.savefig(paths[-1], dpi=150)
    return str(figure_rst(paths, gallery_conf["src_dir"]))


def _get_sg_image_scraper() -> Callable[..., str]:
    return scrape
