"""Plots of a fit as PNG files."""

from __future__ import annotations

from softid.results import FitResult


def fit_figures(result: FitResult) -> dict[str, str | bytes]:
    """Draw a fit: file name → PNG."""
    del result
    return {}
