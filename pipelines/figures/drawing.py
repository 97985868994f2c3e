"""Drawing that figures share: colours, springs, arrows."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from roughmdr.numerics.arguments import Floats
from roughmdr.pictures.asperity import coils

BODY, LINE = "#e4e0d8", "#4a4a4a"
COMPRESSED, STRETCHED, FREE = "#1b6ca8", "#c8553d", "#9a9a9a"


def draw_springs(ax: Axes, positions: Floats, ends: Floats, bottom: float, *, width: float, attached: Any) -> None:
    """Draw springs as zigzags from their base to their ends, coloured by their sign where ``attached``."""
    colors = list(np.where(attached, np.where(ends > 0.0, STRETCHED, COMPRESSED), FREE))
    ax.add_collection(LineCollection(coils(positions, ends, bottom, width), colors=colors, linewidths=0.9))
    ax.scatter(positions, ends, s=9, c=colors, zorder=3)
    ax.axhline(bottom, color=LINE, lw=2.5)


def draw_body(ax: Axes, x: Floats, profile: Floats, top: float) -> None:
    """Draw the body above its profile, and the undeformed surface."""
    ax.fill_between(x, profile, top, where=list(profile <= top), color=BODY, lw=0)
    ax.plot(x, profile, color=LINE, lw=1.4)
    ax.axhline(0.0, color="0.45", lw=0.9, ls=(0, (6, 4)), zorder=0)


def draw_length(
    ax: Axes, start: tuple[float, float], end: tuple[float, float], text: str, at: tuple[float, float]
) -> None:
    """Draw a double arrow between two points and its name at a third."""
    ax.annotate("", end, start, arrowprops={"arrowstyle": "<->", "lw": 1.2, "shrinkA": 0, "shrinkB": 0})
    ax.text(*at, text, ha="center", va="center", fontsize=12)


def draw_jump(ax: Axes, x: float, start: float, end: float, color: str) -> None:
    """Draw a jump at a given indentation."""
    style = {"arrowstyle": "-|>", "color": color, "lw": 1.4, "ls": ":", "shrinkA": 0, "shrinkB": 0}
    ax.annotate("", (x, end), (x, start), arrowprops=style)


def draw_axes(ax: Axes) -> None:
    """Draw lines through the origin."""
    ax.axhline(0.0, color="0.7", lw=0.7, zorder=0)
    ax.axvline(0.0, color="0.7", lw=0.7, zorder=0)
