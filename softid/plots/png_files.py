"""The plots of a result as PNG files, drawn on all cores."""

from __future__ import annotations

from softid.diagnosis_results import Diagnosis
from softid.parallel import in_parallel
from softid.plots.canvas import png_bytes
from softid.plots.diagnosis_gallery import diagnosis_drawings
from softid.plots.drawings import Drawing
from softid.plots.gallery import drawings
from softid.results import FitResult, Validation


def png_files(result: FitResult | Validation | Diagnosis) -> dict[str, bytes]:
    """Draw and render all plots of a result: name with suffix → PNG file, in their order.

    Parameters
    ----------
    result
        A fit, scores of a fixed model, or a diagnosis.
    """
    asked = diagnosis_drawings(result) if isinstance(result, Diagnosis) else drawings(result)
    names = [f"{name}.png" for name, _ in asked]
    files = in_parallel(_rendered, [draw for _, draw in asked])
    return {name: file for name, file in zip(names, files, strict=True) if file is not None}


def _rendered(draw: Drawing) -> bytes | None:
    figure = draw()
    return None if figure is None else png_bytes(figure)
