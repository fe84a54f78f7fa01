"""Plots of results as matplotlib figures: arrays and results in, a Figure out, nothing written."""

from softid.plots.branches import draw_branches
from softid.plots.canvas import Display, new_figure, png_bytes
from softid.plots.curves_and_points import Series, draw_series
from softid.plots.damping import draw_damping
from softid.plots.diagnosis_gallery import diagnosis_figures
from softid.plots.gallery import draw_all, figures
from softid.plots.loops import Loop, draw_loops
from softid.plots.parameter_correlation import draw_parameter_correlation
from softid.plots.picture import Picture
from softid.plots.png_files import png_files
from softid.plots.profile import draw_profile
from softid.plots.residual_correlation import draw_residual_correlation
from softid.plots.residual_scatter import ResidualPoints, draw_residual_scatter
from softid.plots.response import draw_response
from softid.plots.spread import draw_spread
from softid.plots.static_curve import Levels, draw_static_curve
from softid.plots.trials import Trial, draw_phase_portrait, draw_trials

__all__ = [
    "Display",
    "Levels",
    "Loop",
    "Picture",
    "ResidualPoints",
    "Series",
    "Trial",
    "diagnosis_figures",
    "draw_all",
    "draw_branches",
    "draw_damping",
    "draw_loops",
    "draw_parameter_correlation",
    "draw_phase_portrait",
    "draw_profile",
    "draw_residual_correlation",
    "draw_residual_scatter",
    "draw_response",
    "draw_series",
    "draw_spread",
    "draw_static_curve",
    "draw_trials",
    "figures",
    "new_figure",
    "png_bytes",
    "png_files",
]
