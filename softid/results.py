"""What the workflows return: frozen records of plain values, safe to keep, compare and write."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Literal

import numpy as np
import numpy.typing as npt

from softid.errors import Issue
from softid.intersample import InputNoise, Intersample

Array = npt.NDArray[np.float64]
ParameterVerdict = Literal["identified", "weakly identified", "not identified", "fixed", "tied"]


class FitStatus(Enum):
    """How an optimisation ended; the value is the sentence shown to the user."""

    CONVERGED = "the optimum was reached"
    NOT_MOVED = "the optimiser stopped without leaving its start although the gradient is not zero"
    NOT_OPTIMAL = "the optimiser stopped short of the optimum"
    STILL_IMPROVING = "restarts kept finding a better optimum"
    MAX_EVALUATIONS = "the limit of evaluations was reached before the optimum"
    NON_FINITE = "the model gave no finite response at any start"

    @property
    def success(self) -> bool:
        """Whether the parameters may be used."""
        return self is FitStatus.CONVERGED


@dataclass(frozen=True)
class ModelSpec:
    """A model and its options, enough to build it again.

    Attributes
    ----------
    name
        Key in the table of models.
    options
        Option name → plain value (text, number or None).
    effects
        Names of the effects that extend it, in the order in which they act.
    scale
        Sizes that those effects' bounds and knots go by; empty without effects.
    """

    name: str
    options: Mapping[str, str | float | None] = field(default_factory=dict)
    effects: tuple[str, ...] = ()
    scale: Mapping[str, str | float] = field(default_factory=dict)


@dataclass(frozen=True)
class ParameterEstimate:
    """One parameter after a fit.

    Attributes
    ----------
    name, unit, value
        What and how much.
    stderr
        Standard error in ``unit``, or None where it cannot be given.
    ci95, ci_method
        95 % confidence interval, or None, and how errors were computed: ``"ar-sandwich"``,
        ``"profile"``, ``"block-bootstrap"``.
    lower, upper
        Bounds of the search; None when infinite.
    fixed, tie
        Held value, or the expression that gave it.
    at_bound
        Whether the optimum lies on a bound.
    verdict
        What the logs say about this parameter.
    reason, remedy
        Why, and the log that would show it; empty when identified.
    scale
        ``"linear"`` or ``"log"``: the scale on which the interval is symmetric.
    meaning
        One sentence for people.
    """

    name: str
    unit: str
    value: float
    stderr: float | None
    ci95: tuple[float, float] | None
    ci_method: str | None
    lower: float | None
    upper: float | None
    fixed: bool
    tie: str | None
    at_bound: bool
    verdict: ParameterVerdict
    reason: str = ""
    remedy: str = ""
    scale: Literal["linear", "log"] = "linear"
    meaning: str = ""


@dataclass(frozen=True)
class FitStatistics:
    """How well a simulated output follows a measured one, on one log and channel.

    Attributes
    ----------
    log, channel, unit
        What was compared, in which canonical unit.
    in_sample
        Whether the parameters were fitted to this log.
    kind
        ``"simulated"``: free-run response, never one-step prediction.
    n
        Samples compared.
    rmse
        Root mean square error, in ``unit``.
    nrmse
        ‖y − ŷ‖/‖y − mean y‖.
    fit_percent
        100 (1 − nrmse), as MATLAB's ``compare``; NaN of a constant and of very few samples.
    r2
        1 − nrmse².
    vaf
        100 (1 − var(y − ŷ)/var y), per cent.
    display_unit, display_factor
        Unit of the file and factor from ``unit`` to it.
    """

    log: str
    channel: str
    unit: str
    in_sample: bool
    kind: Literal["simulated"]
    n: int
    rmse: float
    nrmse: float
    fit_percent: float
    r2: float
    vaf: float
    display_unit: str
    display_factor: float = 1.0


@dataclass(frozen=True)
class SegmentStart:
    """Initial state of one segment.

    Attributes
    ----------
    start_s
        Time of the segment's first sample.
    at_rest
        True when the state is the equilibrium at the first input rather than estimated.
    state
        State at that time, in the order of the model's states, behind which stands how far an
        effect's own state lies off the position; empty for a static model.
    """

    start_s: float
    at_rest: bool
    state: tuple[float, ...]


@dataclass(frozen=True)
class LogNuisance:
    """What was estimated for one log alone.

    Attributes
    ----------
    log
        Its name.
    zero
        Output channel → sensor zero in the canonical unit: y = output(x) + zero.
    zero_stderr
        Output channel → standard error, or None.
    starts
        One initial state per segment.
    """

    log: str
    zero: Mapping[str, float]
    zero_stderr: Mapping[str, float | None]
    starts: tuple[SegmentStart, ...]


@dataclass(frozen=True, eq=False)
class Simulation:
    """A simulated response on a log's own times.

    Attributes
    ----------
    log
        Name of the log whose input was used.
    time_s, input
        Times, and samples of the input in ``input_unit``, shape (n,).
    outputs, measured
        Output channel → samples, shape (n,), canonical unit: simulated with the sensor zero, and
        measured, empty when there are none.
    used
        Output channel → which samples counted in the residual.
    units
        Output channel → canonical unit.
    segment_starts
        Index of each segment's first sample.
    issues
        What to know of a prediction by a fit, such as that it extrapolates.
    """

    log: str
    time_s: Array = field(repr=False)
    input_name: str
    input: Array = field(repr=False)
    input_unit: str
    outputs: Mapping[str, Array] = field(repr=False)
    measured: Mapping[str, Array] = field(repr=False)
    used: Mapping[str, npt.NDArray[np.bool_]] = field(repr=False)
    units: Mapping[str, str]
    segment_starts: tuple[int, ...] = (0,)
    issues: tuple[Issue, ...] = ()

    def residual(self, channel: str) -> Array:
        """Measured minus simulated, shape (n,); NaN where the sample was not used."""
        difference = self.measured[channel] - self.outputs[channel]
        return np.where(self.used[channel], difference, np.nan)


@dataclass(frozen=True)
class NoiseModel:
    """What the residual of one output channel looks like.

    Attributes
    ----------
    channel
        Output channel.
    sigma
        Standard deviation of the residual, in the canonical unit.
    innovation_sigma
        Standard deviation of the autoregressive innovations.
    ar
        Coefficients φ of r_k = Σ φ_j r_{k−j} + e_k; empty for white noise.
    white
        Whether the Ljung–Box test keeps whiteness at 1 %.
    ljung_box_p
        Its p-value.
    effective_n
        Number of independent samples with the same variance of the mean, at most those there are.
    """

    channel: str
    sigma: float
    innovation_sigma: float
    ar: tuple[float, ...]
    white: bool
    ljung_box_p: float
    effective_n: float


@dataclass(frozen=True, eq=False)
class FitResult:
    """Everything a fit found.

    Attributes
    ----------
    model
        The model and its options.
    input, outputs
        Channels that the fitted logs have in these roles.
    status, message
        How the optimisation ended, in a word and in a sentence.
    parameters
        Estimates in the model's order.
    derived
        Quantities computed from the parameters, name → (value, unit).
    derived_stderr
        Their standard errors; None where the logs do not determine one, no entry where none was
        computed.
    nuisances
        Per-log zeros and initial states, fitted logs first.
    statistics
        One row per log and channel, fitted and held out.
    noise
        One residual model per output channel, over the fitted logs.
    correlation
        Correlation of the free parameters, shape (K, K); None when singular.
    free
        Names of the free parameters, in the order of ``correlation`` and ``covariance``.
    covariance
        Covariance of the free parameters (linear scale), shape (K, K), or None.
    condition_number
        Of the column-scaled Jacobian of the free parameters.
    aic, bic
        Information criteria from the whitened residual, or None.
    fitted_range
        Channel → (smallest, largest) value that the fitted logs reached, canonical unit.
    simulations
        Simulated and measured responses, fitted logs first.
    evaluations
        Number of simulations of the whole data set.
    issues
        What the user should know.
    choice
        Why this model, when softid chose it.
    fingerprints
        Log name → sha256 of its file ("" for arrays).
    seed
        Of its random draws.
    intersample, input_noise
        What the input was taken to do between its samples (None: straight), and about its noise.
    """

    model: ModelSpec
    input: str
    outputs: tuple[str, ...]
    status: FitStatus
    message: str
    parameters: tuple[ParameterEstimate, ...]
    derived: Mapping[str, tuple[float, str]]
    nuisances: tuple[LogNuisance, ...]
    statistics: tuple[FitStatistics, ...]
    noise: tuple[NoiseModel, ...]
    correlation: Array | None = field(repr=False)
    covariance: Array | None = field(repr=False)
    free: tuple[str, ...]
    condition_number: float | None
    aic: float | None
    bic: float | None
    fitted_range: Mapping[str, tuple[float, float]]
    simulations: tuple[Simulation, ...]
    evaluations: int
    issues: tuple[Issue, ...] = ()
    choice: str | None = None
    fingerprints: Mapping[str, str] = field(default_factory=dict)
    seed: int | None = None
    intersample: Intersample | None = None
    input_noise: InputNoise | None = None
    derived_stderr: Mapping[str, float | None] = field(default_factory=dict)

    @property
    def success(self) -> bool:
        """Whether the optimum was reached."""
        return self.status.success

    @property
    def values(self) -> dict[str, float]:
        """Parameter name → value."""
        return {p.name: p.value for p in self.parameters}

    def parameter(self, name: str) -> ParameterEstimate:
        """The estimate of one parameter.

        Raises
        ------
        KeyError
            There is no parameter of that name.
        """
        for estimate in self.parameters:
            if estimate.name == name:
                return estimate
        raise KeyError(name)


@dataclass(frozen=True, eq=False)
class Validation:
    """Scores of a fixed model on logs that it may not have seen.

    Attributes
    ----------
    model
        The model and its options.
    threshold_percent
        The bar: the lowest fit in per cent that passes, or None.
    passed
        Whether every channel of every log reached the bar; True without a bar.
    statistics, nuisances, simulations
        As in `FitResult`, one entry per log.
    input, outputs
        Channels that the scored logs have in these roles.
    issues
        Extrapolation, logs that were in the fit, and the like.
    fingerprints
        Log name → sha256 of its file ("" for arrays), of the scored logs.
    fitted_range
        As in `FitResult`; empty where the model does not state it.
    """

    model: ModelSpec
    input: str
    outputs: tuple[str, ...]
    threshold_percent: float | None
    passed: bool
    statistics: tuple[FitStatistics, ...]
    nuisances: tuple[LogNuisance, ...]
    simulations: tuple[Simulation, ...]
    issues: tuple[Issue, ...] = ()
    fingerprints: Mapping[str, str] = field(default_factory=dict)
    fitted_range: Mapping[str, tuple[float, float]] = field(default_factory=dict)
