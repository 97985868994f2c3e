"""A picture that can be read: nothing is cut off, and no legend lies over a panel."""

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text


def assert_legible(figure: Figure) -> None:
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    renderer, page = canvas.get_renderer(), figure.bbox
    axes = figure.findobj(Axes)
    ticks = {label for ax in axes for label in (*ax.get_xticklabels(), *ax.get_yticklabels())}
    for text in figure.findobj(Text):
        if text.get_visible() and text.get_text().strip() and text.get_figure() is not None:
            box = text.get_window_extent(renderer)
            inside = box.x0 >= -1 and box.y0 >= -1 and box.x1 <= page.x1 + 1 and box.y1 <= page.y1 + 1
            assert inside or text in ticks, text.get_text()  # ticks outside their axis are not drawn
    for legend in figure.legends:
        box = legend.get_window_extent(renderer)
        for ax in figure.axes:
            if ax.get_visible():
                assert not ax.get_window_extent(renderer).overlaps(box)


_PREFIXES = {"p": 1e-12, "n": 1e-9, "µ": 1e-6, "m": 1e-3, "k": 1e3, "M": 1e6, "G": 1e9}


def unit_of(label: str) -> float:
    """The size in SI of the unit of an axis, by its label: "force [mN]"."""
    unit = label.partition("[")[2].rstrip("]")
    size = _PREFIXES.get(unit[:1], 1.0) if len(unit) > 1 else 1.0
    return size**2 if unit.endswith("m²") and "/" not in unit else size
