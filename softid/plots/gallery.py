"""All plots of a result, by name."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure

from softid.effects import model_of
from softid.errors import InputError
from softid.models.base import Model
from softid.plots.branches import draw_branches, rising_samples
from softid.plots.canvas import Display, names_and_count
from softid.plots.curves import (
    HasDamping,
    common_zero,
    damping_curve,
    settled_levels,
    static_curve,
    zero_shift,
)
from softid.plots.cycles import find_cycles
from softid.plots.damping import draw_damping
from softid.plots.drawings import Drawing, applying, file_name
from softid.plots.equilibrium_trials import Subject as TrialSubject
from softid.plots.equilibrium_trials import (
    damping_trials,
    mass_trials,
    phase_curves,
    subject_of,
)
from softid.plots.loops import Loop, draw_loops
from softid.plots.parameter_correlation import draw_parameter_correlation
from softid.plots.residual_correlation import draw_residual_correlation, residual_correlation
from softid.plots.residual_scatter import draw_residual_scatter, residual_points
from softid.plots.response import draw_response
from softid.plots.static_curve import draw_static_curve
from softid.plots.trials import Trial, draw_phase_portrait, draw_trials
from softid.results import FitResult, FitStatistics, Simulation, Validation

Array = npt.NDArray[np.float64]

FEWEST_RESIDUALS = 8
STILL_SHARE = 0.05
"""An input that moves less than this share of the liveliest one stands still."""


@dataclass(frozen=True, eq=False)
class Subject:
    """One output of a fit, with what every plot of it needs.

    Attributes
    ----------
    result, model, output
        The fit, its model built again, and the output channel.
    scored
        Simulation and score of every log, fitted logs first.
    """

    result: FitResult
    model: Model
    output: str
    scored: tuple[tuple[Simulation, FitStatistics], ...]

    @property
    def fitted(self) -> tuple[Simulation, ...]:
        """Simulations of the fitted logs."""
        return tuple(sim for sim, score in self.scored if score.in_sample)

    @property
    def shown_input(self) -> Display:
        """How the input is shown."""
        return Display(self.result.input, self.scored[0][0].input_unit)

    @property
    def shown_output(self) -> Display:
        """How the output is shown: in the unit of the first log's file."""
        first = self.scored[0][1]
        return Display(self.output, first.display_unit, first.display_factor)

    def titled(self, what: str, *, fitted_only: bool = False) -> str:
        """Heading with the model and the logs that are shown."""
        shown = self.fitted if fitted_only else [sim for sim, _ in self.scored]
        return f"{what}, {self.model.name} model: {names_and_count([sim.log for sim in shown])}"


def static_figure(subject: Subject) -> Figure | None:
    """Static curve with levels; by branch for a model without dynamics."""
    if not subject.model.start_states:
        return branch_figure(subject)
    curve = static_curve(subject.model, subject.result, subject.output)
    if not np.isfinite(curve.value).any():
        return None
    levels = [
        settled_levels(
            simulation,
            subject.output,
            in_sample=score.in_sample,
            shift=zero_shift(subject.result, simulation.log, subject.output),
        )
        for simulation, score in subject.scored
    ]
    return draw_static_curve(
        curve.input,
        curve.value,
        levels,
        fitted_range=subject.result.fitted_range[subject.result.input],
        input=subject.shown_input,
        output=subject.shown_output,
        title=subject.titled("Static curve"),
    )


def branch_figure(subject: Subject) -> Figure:
    """Measured points by branch with the curve of a static model."""
    result, output = subject.result, subject.output
    shifts = [zero_shift(result, sim.log, output) for sim, _ in subject.scored]
    measured = [
        np.where(sim.used[output], sim.measured[output], np.nan) + shift
        for (sim, _), shift in zip(subject.scored, shifts, strict=True)
    ]
    simulated = [
        sim.outputs[output] + shift for (sim, _), shift in zip(subject.scored, shifts, strict=True)
    ]
    grid = np.linspace(*result.fitted_range[result.input], 241)
    theta = np.array([p.value for p in result.parameters])
    curve = subject.model.static_output(theta, grid, output) + common_zero(result, output)
    return draw_branches(
        np.concatenate([sim.input for sim, _ in subject.scored]),
        np.concatenate(measured),
        np.concatenate(simulated),
        np.concatenate([rising_samples(sim.input) for sim, _ in subject.scored]),
        grid,
        curve,
        input=subject.shown_input,
        output=subject.shown_output,
        held_out=np.concatenate(
            [np.full(sim.time_s.size, not score.in_sample) for sim, score in subject.scored]
        ),
        curve_label=f"{subject.model.name} model",
        title=subject.titled("Static curve"),
    )


def damping_figure(subject: Subject) -> Figure | None:
    """N(p) with its band, for a model that has one and an order that uses it.

    Of an extended model it is the damping of the model itself, without what its effects add.
    """
    model, result = subject.model, subject.result
    if result.model.effects:  # a plain fit need not load the catalogue
        from softid.effects import ExtendedModel

        model = model.model if isinstance(model, ExtendedModel) else model
    if not isinstance(model, HasDamping) or not subject.model.start_states:
        return None
    curve = damping_curve(model, result)
    units = {p.name: p.unit for p in result.parameters}
    return draw_damping(
        curve.input,
        curve.value,
        curve.band,
        fitted_range_kpa=result.fitted_range[result.input],
        unit=units.get("c2", "1"),
        pressure=subject.shown_input,
        title=subject.titled("Damping N(p)"),
    )


def loop_figure(subject: Subject) -> Figure | None:
    """Loops by rate, when the input goes up and down again."""
    loops: list[Loop] = []
    still = STILL_SHARE * max(float(np.ptp(sim.input)) for sim, _ in subject.scored)
    for sim, _ in subject.scored:
        shift = zero_shift(subject.result, sim.log, subject.output)
        measured = np.where(sim.used[subject.output], sim.measured[subject.output], np.nan)
        for cycle in find_cycles(sim.time_s, sim.input, sim.segment_starts, smallest_span=still):
            span = slice(cycle.start, cycle.stop)
            loops.append(
                Loop(
                    cycle.rate_hz,
                    sim.input[span],
                    measured[span] + shift,
                    sim.outputs[subject.output][span] + shift,
                )
            )
    if not loops:
        return None
    return draw_loops(
        loops,
        input=subject.shown_input,
        output=subject.shown_output,
        title=subject.titled("Loops by rate"),
    )


def residual_correlation_figure(subject: Subject) -> Figure | None:
    """Correlation of the fitted logs' residuals with their past and with the input."""
    fitted = subject.fitted
    there = sum(int(np.isfinite(s.residual(subject.output)).sum()) for s in fitted)
    if there < FEWEST_RESIDUALS:
        return None
    try:
        auto, cross, period_s = residual_correlation(fitted, subject.output)
    except InputError:  # a perfect fit leaves nothing to correlate
        return None
    return draw_residual_correlation(
        period_s * auto.lags.astype(np.float64),
        auto.values,
        auto.bartlett_band,
        period_s * cross.lags.astype(np.float64),
        cross.values,
        cross.band,
        white_band=auto.white_band,
        input_name=subject.result.input,
        title=subject.titled("Residual correlation", fitted_only=True),
    )


def residual_scatter_figure(subject: Subject) -> Figure | None:
    """Residual of the fitted logs against output, speed, input and time."""
    points = residual_points(subject.fitted, subject.output)
    if points.residual.size < FEWEST_RESIDUALS:
        return None
    return draw_residual_scatter(
        points,
        input=subject.shown_input,
        output=subject.shown_output,
        title=subject.titled("Residual", fitted_only=True),
    )


def damping_trials_figure(subject: Subject) -> Figure | None:
    """The first fitted log with no, too little, too much and the fitted damping."""
    return _trials_figure(subject, damping_trials, "Damping compensation")


def mass_trials_figure(subject: Subject) -> Figure | None:
    """The first fitted log without and with the mass compensation."""
    return _trials_figure(subject, mass_trials, "Mass compensation")


def _trials_figure(
    subject: Subject, make: Callable[[TrialSubject], tuple[Trial, ...]], what: str
) -> Figure | None:
    simulation = subject.fitted[0]
    one = subject_of(subject.model, subject.result, simulation, subject.output)
    if one is None:
        return None
    return draw_trials(
        one.segment.time_s,
        one.measured,
        make(one),
        output=subject.shown_output,
        title=f"{what}, {subject.model.name} model: {simulation.log}",
    )


def phase_portrait_figure(subject: Subject) -> Figure | None:
    """Velocity against angle of the first fitted log."""
    simulation = subject.fitted[0]
    one = subject_of(subject.model, subject.result, simulation, subject.output)
    if one is None:
        return None
    return draw_phase_portrait(
        *phase_curves(one),
        output=subject.shown_output,
        title=f"Phase portrait, {subject.model.name} model: {simulation.log}",
    )


PER_OUTPUT: dict[str, Callable[[Subject], Figure | None]] = {
    "static_curve": static_figure,
    "damping": damping_figure,
    "loops": loop_figure,
    "residual_correlation": residual_correlation_figure,
    "residual_scatter": residual_scatter_figure,
    "damping_trials": damping_trials_figure,
    "mass_trials": mass_trials_figure,
    "phase_portrait": phase_portrait_figure,
}
"""Plots of one output over all logs; None when a plot does not apply."""


def parameter_correlation_figure(result: FitResult) -> Figure | None:
    """Correlation of the free parameters, when there are two or more."""
    if result.correlation is None or len(result.free) < 2:
        return None
    errors = [
        abs(p.stderr / p.value) if p.stderr is not None and p.value else None
        for p in (result.parameter(name) for name in result.free)
    ]
    return draw_parameter_correlation(
        result.correlation,
        result.free,
        relative_errors=errors,
        title=f"Correlation of the parameters, {result.model.name} model",
    )


def drawings(result: FitResult | Validation) -> list[tuple[str, Drawing]]:
    """What draws the plots of a result, each by itself.

    Parameters
    ----------
    result
        A fit, or scores of a fixed model; the latter has only the plots per log.

    Returns
    -------
    list of tuple of str and callable
        File name without suffix, and what draws the plot: ``response_LOG`` for every log, then
        ``static_curve``, ``damping``, ``loops``, ``residual_correlation``,
        ``residual_scatter``, ``damping_trials``, ``mass_trials``, ``phase_portrait`` and
        ``parameter_correlation``, as far as they apply. With several outputs the channel
        follows the name.
    """
    fit = result if isinstance(result, FitResult) else None
    ranges = result.fitted_range.get(result.input)
    taken: set[str] = set()
    several = len(result.outputs) > 1
    found: list[tuple[str, Drawing]] = []
    for simulation, score in scored(result):
        name = f"response_{simulation.log}" + (f"_{score.channel}" if several else "")
        response = partial(draw_response, simulation, score, fitted_range=ranges)
        found.append((file_name(name, taken), response))
    if fit is None or not fit.simulations:
        return found
    model = model_of(fit.model)
    for output in fit.outputs:
        pairs = tuple(pair for pair in scored(fit) if pair[1].channel == output)
        for kind, draw in PER_OUTPUT.items():
            name = file_name(kind + (f"_{output}" if several else ""), taken)
            found.append((name, partial(draw, Subject(fit, model, output, pairs))))
    table = partial(parameter_correlation_figure, fit)
    found.append((file_name("parameter_correlation", taken), table))
    return found


def draw_all(result: FitResult | Validation) -> Iterator[tuple[str, Figure]]:
    """Draw the plots of a result one after the other, so that only one needs to be in memory.

    Parameters
    ----------
    result
        As in `drawings`.

    Yields
    ------
    tuple of str and Figure
        File name without suffix, and the plot, of those that apply.
    """
    yield from applying(drawings(result))


def figures(result: FitResult | Validation) -> dict[str, Figure]:
    """All plots of a result: file name without suffix → figure; see `draw_all`."""
    return dict(draw_all(result))


def scored(
    result: FitResult | Validation,
) -> tuple[tuple[Simulation, FitStatistics], ...]:
    """Every simulation with each of its scores, in the order of the simulations."""
    return tuple(
        (simulation, score)
        for simulation in result.simulations
        for score in result.statistics
        if score.log == simulation.log and score.channel in simulation.measured
    )
