"""Figures of matplotlib that a notebook shows as they are; only drawing imports this."""

import io

import matplotlib.figure


class Figure(matplotlib.figure.Figure):
    """A figure that shows itself, since notebooks know only figures of pyplot, which keeps each until it is closed."""

    def _repr_png_(self) -> bytes:
        content = io.BytesIO()
        self.savefig(content, format="png")
        return content.getvalue()
