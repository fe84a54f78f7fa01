"""From a fit to the arrays that the plots draw: curves of the model, settled levels, bands."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
import numpy.typing as npt

from softid.excitation import settled_windows
from softid.models.base import Model
from softid.parameters import Parameter, ParameterSet
from softid.plots.static_curve import Levels
from softid.plots.traces import broken_trace, segment_spans
from softid.results import FitResult, ParameterEstimate, Simulation

Array = npt.NDArray[np.float64]

NORMAL_95 = 1.959963984540054
GRID = 241
BEYOND = 0.1
NEAR_ZERO, BELOW_ZERO = 0.5, 0.05
SETTLED_TAIL = 0.25
_STEP = 1e-5
_NEGLIGIBLE = 1e-6


@runtime_checkable
class HasDamping(Protocol):
    """A model whose damping depends on the pressure."""

    def parameters(self) -> ParameterSet:
        """Declared parameters, in the order of ``theta``."""
        ...

    def damping_curve(self, theta: Array, pressure_kpa: Array) -> Array:
        """N(p) at pressures of shape (m,)."""
        ...


@dataclass(frozen=True, eq=False)
class Curve:
    """A function of the input with an optional 95 % band, all of shape (g,).

    Attributes
    ----------
    input
        Where it was evaluated, rising.
    value
        The function.
    band
        Lower and upper limit, or None when the logs do not determine it.
    """

    input: Array
    value: Array
    band: tuple[Array, Array] | None = None


def input_grid(result: FitResult) -> Array:
    """Inputs over all logs and a little beyond, and down to zero where that is near, shape (g,)."""
    low, high = result.fitted_range[result.input]
    for simulation in result.simulations:
        low = min(low, float(simulation.input.min()))
        high = max(high, float(simulation.input.max()))
    span = (high - low) or 1.0
    starts_near_zero = -BELOW_ZERO * span <= low <= NEAR_ZERO * span
    start = min(low, 0.0) if starts_near_zero else low - BEYOND * span
    return np.linspace(start, high + BEYOND * span, GRID)


def static_curve(model: Model, result: FitResult, output: str) -> Curve:
    """The model at rest with the common sensor zero of `settled_levels` applied.

    There is no band: the level of the curve and the sensor zero are estimated together, and the
    covariance of the parameters alone would overstate the error of their sum.
    """
    grid = input_grid(result)
    theta = np.array([p.value for p in result.parameters])
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        value = model.static_output(theta, grid, output)
    return Curve(grid, value + common_zero(result, output))


def damping_curve(model: HasDamping, result: FitResult) -> Curve:
    """N(p) over the pressures of the logs, with a band by the delta method on log N.

    The fit may be that of an extended model; the parameters of its effects are then left out.

    var log N = gᵀ C g, g the derivative of log N by the free parameters (by their logarithm where
    they are positive), so that the band N exp(±1.96 sd) stays positive.
    """
    grid = input_grid(result)
    names = model.parameters().names

    def log_damping(values: Mapping[str, float]) -> Array:
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            return np.log(model.damping_curve(np.array([values[n] for n in names]), grid))

    value = np.exp(log_damping(result.values))
    sd = curve_sd(log_damping, result)
    if sd is None:
        return Curve(grid, value)
    with np.errstate(over="ignore"):
        factor = np.exp(NORMAL_95 * sd)
    return Curve(grid, value, (value / factor, value * factor))


def curve_sd(function: Callable[[Mapping[str, float]], Array], result: FitResult) -> Array | None:
    """Standard deviation of a function of the parameters by the delta method.

    Parameters
    ----------
    function
        Parameter name → value to an array, shape (g,). Tied parameters are kept tied.
    result
        Supplies estimates and covariance.

    Returns
    -------
    ndarray or None
        Shape (g,); None when the function depends on a free parameter without a standard error,
        unless that parameter lies on its bound, where it is taken as known.
    """
    if result.covariance is None:
        return None
    resolve = _tie_resolver(result)
    rows = {name: k for k, name in enumerate(result.free)}
    slopes: list[Array] = []
    scales: list[float] = []
    order: list[int] = []
    for estimate in result.parameters:
        if estimate.fixed or estimate.tie is not None or estimate.value == 0.0:
            continue
        slope = _slope(function, resolve, result.values, estimate)
        if estimate.name in rows:
            slopes.append(slope)
            scales.append(abs(estimate.value))
            order.append(rows[estimate.name])
        elif not estimate.at_bound and float(np.nanmax(np.abs(slope))) > _NEGLIGIBLE:
            return None
    if not slopes:
        return None
    relative = result.covariance[np.ix_(order, order)] / np.outer(scales, scales)
    jacobian = np.stack(slopes, axis=1)
    variance = np.einsum("gi,ij,gj->g", jacobian, relative, jacobian)
    sd: Array = np.sqrt(np.maximum(variance, 0.0))
    return sd


def _slope(
    function: Callable[[Mapping[str, float]], Array],
    resolve: Callable[[Mapping[str, float]], Mapping[str, float]],
    values: Mapping[str, float],
    estimate: ParameterEstimate,
) -> Array:
    """Derivative by the relative change of one parameter, central difference."""
    name = estimate.name
    up = function(resolve({**values, name: estimate.value * (1.0 + _STEP)}))
    down = function(resolve({**values, name: estimate.value * (1.0 - _STEP)}))
    return (up - down) / (2.0 * _STEP)


def _tie_resolver(result: FitResult) -> Callable[[Mapping[str, float]], Mapping[str, float]]:
    if all(p.tie is None for p in result.parameters):
        return lambda values: values
    tied = ParameterSet(
        tuple(Parameter(p.name, p.value, tie=p.tie) for p in result.parameters)
    ).to_lmfit()

    def resolve(values: Mapping[str, float]) -> Mapping[str, float]:
        for p in result.parameters:
            if p.tie is None:
                tied[p.name].value = values[p.name]
        found: dict[str, float] = tied.valuesdict()
        return found

    return resolve


def common_zero(result: FitResult, output: str) -> float:
    """Median sensor zero of the fitted logs, to which every log is moved for comparison."""
    fitted = {s.log for s in result.statistics if s.in_sample}
    zeros = [n.zero.get(output, 0.0) for n in result.nuisances if n.log in fitted]
    return float(np.median(zeros)) if zeros else 0.0


def zero_shift(result: FitResult, log: str, output: str) -> float:
    """What to add to a log's output to bring it to the common zero."""
    own = next((n.zero.get(output, 0.0) for n in result.nuisances if n.log == log), 0.0)
    return common_zero(result, output) - own


def settled_levels(
    simulation: Simulation, output: str, *, in_sample: bool, shift: float = 0.0
) -> Levels:
    """Levels at which a log settled, and its path.

    Parameters
    ----------
    simulation
        Supplies the measured samples.
    output
        Output channel.
    in_sample
        Whether the log was fitted.
    shift
        Added to the output, see `zero_shift`.
    """
    measured = np.where(simulation.used[output], simulation.measured[output], np.nan) + shift
    driving = simulation.input
    levels: list[tuple[float, float, int]] = []
    left = 0
    for span in segment_spans(simulation.segment_starts, driving.size):
        for window in settled_windows(simulation.time_s[span], driving[span]):
            first, end = span.start + window.start, span.start + window.stop
            tail = _tail(first, end)
            level = float(driving[tail].mean())
            way = _approach(driving[left:first], level)
            left = end - 1
            values = measured[tail][np.isfinite(measured[tail])]
            if values.size:
                levels.append((level, float(values.mean()), way))
    columns = np.array(levels, dtype=np.float64).reshape(-1, 3)
    # The path as a line needs its breaks in time, its points in the input.
    time_s, path_output = broken_trace(simulation.time_s, measured, simulation.segment_starts)
    path_input = np.interp(time_s, simulation.time_s, simulation.input)
    return Levels(
        simulation.log,
        in_sample,
        columns[:, 0],
        columns[:, 1],
        columns[:, 2].astype(np.int8),
        path_input,
        path_output,
    )


def _tail(start: int, stop: int) -> slice:
    """The end of a settled window, where the output has settled too."""
    return slice(stop - max(round(SETTLED_TAIL * (stop - start)), 1), stop)


def _approach(driving: Array, level: float) -> int:
    """1 when the input came to a level from below, −1 from above, 0 when nothing came before."""
    if driving.size == 0:
        return 0
    furthest = driving[np.abs(driving - level).argmax()]
    return int(np.sign(level - furthest))
