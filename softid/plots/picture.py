"""A figure as the value of a notebook cell."""

from __future__ import annotations

from dataclasses import dataclass

from matplotlib.figure import Figure

from softid.plots.canvas import png_bytes


@dataclass(frozen=True, eq=False)
class Picture:
    """A figure that a notebook shows as PNG, without a matplotlib back end being set up.

    Attributes
    ----------
    figure
        The figure.
    """

    figure: Figure

    def _repr_png_(self) -> bytes:
        return png_bytes(self.figure)
