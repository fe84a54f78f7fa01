"""Plots of a result as PNG files."""

from __future__ import annotations

from softid.diagnosis_results import Diagnosis
from softid.results import FitResult, Validation


def drawn(result: FitResult | Validation) -> dict[str, str | bytes]:
    """Draw all plots of a result: file name → PNG."""
    from softid.plots import draw_all, png_bytes  # matplotlib, 0.4 s

    return {f"{name}.png": png_bytes(figure) for name, figure in draw_all(result)}


def drawn_diagnosis(diagnosis: Diagnosis) -> dict[str, str | bytes]:
    """Draw all plots of a diagnosis: file name → PNG."""
    from softid.plots import png_bytes
    from softid.plots.diagnosis_gallery import diagnosis_figures

    return {f"{name}.png": png_bytes(figure) for name, figure in diagnosis_figures(diagnosis)}
