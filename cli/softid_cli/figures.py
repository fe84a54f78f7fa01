"""Plots of a result as PNG files."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec

from softid.diagnoses import Diagnosis
from softid.results import FitResult, Validation

GALLERY = "softid.plots.diagnosis_gallery"


def drawn(result: FitResult | Validation) -> dict[str, str | bytes]:
    """Draw all plots of a result: file name → PNG."""
    from softid.plots import draw_all, png_bytes  # matplotlib, 0.4 s

    return {f"{name}.png": png_bytes(figure) for name, figure in draw_all(result)}


def drawn_diagnosis(diagnosis: Diagnosis) -> dict[str, str | bytes]:
    """Draw all plots of a diagnosis: file name → PNG."""
    from softid.plots import draw_all, png_bytes

    if find_spec(GALLERY) is None:  # nothing but the base fit can be drawn
        return {f"base_{name}.png": png_bytes(f) for name, f in draw_all(diagnosis.base)}
    figures = import_module(GALLERY).diagnosis_figures(diagnosis)
    return {f"{name}.png": png_bytes(figure) for name, figure in figures}
