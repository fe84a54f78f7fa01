"""The equilibrium model with its damping or mass compensation changed, and its phase portrait."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from softid.intersample import Intersample
from softid.models.base import Model
from softid.plots.trials import Trial
from softid.results import FitResult, LogNuisance, Simulation
from softid.segment import Segment, with_knots

Array = npt.NDArray[np.float64]

NAME = "equilibrium"
TOO_SMALL, OVERDAMPED = 0.25, 1.5
"""C_d as a share of the fitted one, and as a damping ratio."""

FINE_POINTS = 6000
SMOOTHED, DEGREE = 13, 4
"""Samples in the local polynomial that gives the measured rate, and its degree."""


@dataclass(frozen=True, eq=False)
class Subject:
    """One fitted log, with what it takes to simulate it again."""

    model: Model
    values: Mapping[str, float]
    segment: Segment
    output: str
    start: Array | None
    zero: float
    intersample: Intersample

    @property
    def rows(self) -> Segment:
        """The samples, and what the fit took the input to do between them."""
        return with_knots(self.segment, self.intersample)

    def simulated(self, changes: Mapping[str, float]) -> Array:
        """Response with some parameters changed, zero included, shape (n,)."""
        names = self.model.parameters().names
        theta = np.array([{**self.values, **changes}[name] for name in names])
        rows = self.rows
        with np.errstate(all="ignore"):
            found = self.model.response(
                theta, rows, (self.output,), start=self.start, derivatives=False
            )
        simulated: Array = rows.samples_of(found.outputs[self.output]) + self.zero
        return simulated

    @property
    def measured(self) -> Array:
        """The record, NaN where a sample does not count, shape (n,)."""
        values = self.segment.outputs[self.output]
        return np.where(self.segment.used[self.output], values, np.nan)


def subject_of(
    model: Model, result: FitResult, simulation: Simulation, output: str
) -> Subject | None:
    """The first segment of a log as a subject; None for a model of another kind."""
    if model.name != NAME:
        return None
    starts = (*simulation.segment_starts, simulation.time_s.size)
    span = slice(starts[0], starts[1])
    segment = Segment(
        simulation.log,
        0,
        starts[0],
        starts[1],
        simulation.time_s[span],
        simulation.input[span],
        {output: simulation.measured[output][span]},
        {output: simulation.used[output][span]},
    )
    nuisance = next((n for n in result.nuisances if n.log == simulation.log), None)
    zero = nuisance.zero.get(output, 0.0) if nuisance else 0.0
    intersample = result.intersample or "straight"
    return Subject(model, result.values, segment, output, _start(nuisance), zero, intersample)


def _start(nuisance: LogNuisance | None) -> Array | None:
    if nuisance is None or not nuisance.starts or nuisance.starts[0].at_rest:
        return None
    return np.array(nuisance.starts[0].state, dtype=np.float64)


def damping_trials(subject: Subject) -> tuple[Trial, ...]:
    """Without damping, with a quarter of the fitted, overdamped and fitted; DEE 2022, Figure 5."""
    fitted = subject.values["C_d"]
    level = float(subject.segment.input[np.argmax(np.abs(subject.segment.input))])
    ratio = subject.model.speeds(subject.values, level).damping_ratio
    large = fitted * max(OVERDAMPED / (1.0 if ratio is None else ratio), 4.0)
    changes = (
        ("no damping", 0.0),
        (f"C_d too small: {TOO_SMALL * fitted:.2g} N·m·s/rad", TOO_SMALL * fitted),
        (f"C_d too large: {large:.2g} N·m·s/rad", large),
        (f"C_d fitted: {fitted:.3g} N·m·s/rad", fitted),
    )
    return tuple(Trial(label, subject.simulated({"C_d": value})) for label, value in changes)


def mass_trials(subject: Subject) -> tuple[Trial, ...]:
    """Without and with the fitted mass compensation; DEE 2022, Figure 6."""
    a, b, c = (subject.values[name] for name in "abc")
    return (
        Trial("without compensation: C_m = 1", subject.simulated({"a": 0.0, "b": 0.0, "c": 1.0})),
        Trial(f"with C_m = {a:.2g} θ² {_signed(b)} |θ| {_signed(c)}", subject.simulated({})),
    )


def phase_curves(subject: Subject) -> tuple[Array, Array, Array, Array]:
    """Simulated angle and rate on a fine grid, measured angle and rate by local polynomials."""
    segment = subject.segment
    fine_s = np.linspace(segment.time_s[0], segment.time_s[-1], FINE_POINTS)
    held = {subject.output: np.zeros(FINE_POINTS)}
    used = {subject.output: np.ones(FINE_POINTS, bool)}
    finer = replace(
        segment,
        stop=segment.start + FINE_POINTS,
        time_s=fine_s,
        input=np.interp(fine_s, subject.rows.time_s, subject.rows.input),
        outputs=held,
        used=used,
    )
    angle = replace(subject, segment=finer, intersample="straight").simulated({})
    there = np.isfinite(subject.measured)
    measured, rate = _smoothed(segment.time_s[there], subject.measured[there])
    return angle, np.gradient(angle, fine_s), measured, rate


def _smoothed(time_s: Array, values: Array) -> tuple[Array, Array]:
    """Value and slope of a polynomial through the samples around each, shape (n,) each."""
    count = min(SMOOTHED, time_s.size)
    first = np.clip(np.arange(time_s.size) - count // 2, 0, time_s.size - count)
    window = first[:, None] + np.arange(count)
    since = time_s[window] - time_s[:, None]
    reach_s = np.abs(since).max(axis=1, keepdims=True)
    basis = (since / reach_s)[:, :, None] ** np.arange(min(DEGREE, count - 1) + 1)
    solved = np.linalg.pinv(basis) @ values[window][:, :, None]
    return solved[:, 0, 0], solved[:, 1, 0] / reach_s[:, 0]


def _signed(value: float) -> str:
    """A number with its sign set apart: ``− 0.28``."""
    return f"{'−' if value < 0 else '+'} {abs(value):.3g}"
