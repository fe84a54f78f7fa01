"""What the legend of a figure says."""

from __future__ import annotations

from matplotlib.figure import Figure


def labels(figure: Figure) -> list[str]:
    """The entries of the first legend."""
    return [text.get_text() for text in figure.legends[0].get_texts()]
