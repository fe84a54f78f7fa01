"""How well parameters are known when the residuals have a memory."""

from softid.uncertainty.autoregression import (
    AutoRegression,
    autocovariance,
    fit_ar,
    log_likelihood,
    whiten,
)
from softid.uncertainty.averaged import known_better
from softid.uncertainty.bootstrap import (
    block_length,
    bootstrap_intervals,
    resample,
)
from softid.uncertainty.covariance import (
    CI_METHOD,
    Covariance,
    confidence_interval,
    sandwich_covariance,
    standard_error,
    to_linear,
)
from softid.uncertainty.factored_rows import FactoredRows
from softid.uncertainty.identifiability import (
    companions,
    condition_number,
    judge,
    relative_sd,
    strongest_partner,
)
from softid.uncertainty.linearisation import ResidualBlock
from softid.uncertainty.noise import effective_n, noise_model
from softid.uncertainty.profile import ProfileResult, profile
from softid.uncertainty.propagation import propagated_errors
from softid.uncertainty.rounding import Rounding
from softid.uncertainty.widening import larger_of, widened

__all__ = [
    "CI_METHOD",
    "AutoRegression",
    "Covariance",
    "FactoredRows",
    "ProfileResult",
    "ResidualBlock",
    "Rounding",
    "autocovariance",
    "block_length",
    "bootstrap_intervals",
    "companions",
    "condition_number",
    "confidence_interval",
    "effective_n",
    "fit_ar",
    "judge",
    "known_better",
    "larger_of",
    "log_likelihood",
    "noise_model",
    "profile",
    "propagated_errors",
    "relative_sd",
    "resample",
    "sandwich_covariance",
    "standard_error",
    "strongest_partner",
    "to_linear",
    "whiten",
    "widened",
]
