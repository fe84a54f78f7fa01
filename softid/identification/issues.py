"""What the user should know about a fit beyond its numbers."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
import numpy.typing as npt

from softid.errors import IdentificationError, Issue, Severity
from softid.identification.input_denoising import input_noise_sd
from softid.identification.parameter_covariance import Errors
from softid.log import Log, LogSet
from softid.results import FitResult, FitStatistics, ParameterEstimate
from softid.scores import are_too_few
from softid.sentences import listed
from softid.uncertainty import Covariance
from softid.uncertainty.incomplete_beta import r_squared_tail

Array = npt.NDArray[np.float64]

RANGE_MARGIN = 0.02
"""Share of the fitted range by which a log may pass it before that counts as extrapolation."""

A_FEW = 0.005
"""Share of the samples that would round to 0 %."""

POOR_FIT_PERCENT = 70.0
"""Fit below which the user is told: it leaves 30 % of the output's standard deviation, or 9 % of
its variance. A judgement of what is worth a look at the residual."""

ASTRAY = 3.0
"""A model that errs by so many times its usual error on an output that hardly moves moves there: it
is the output that stays still."""

NEXT_TO_NOTHING_PERCENT = 10.0
"""Fit of all fitted logs below which the output may have nothing to do with the input: a fifth of
its variance is explained, as slow noise and a few parameters can make by chance."""

LEAST_R2 = 0.02
"""Least share of an output's variance that a model explains, a fit of 1 %: less is nothing."""

BY_CHANCE = 1e-3
"""What a model linear in its unknowns explains of white noise with this probability, by an F test,
is nothing, too. Models that bend search for what they explain: of 280 logs of white noise, of 20
and 100 readings, oscillator and muscle pass with 4, all of 100 readings; noise that remembers
passes more often."""

CLEARLY_WIDER = 1.5
"""Factor by which noise of the input widens an interval before the user is told."""

SERIOUS_FIRST: tuple[Severity, ...] = ("error", "warning", "info")
"""In which order issues are told."""


def require_explained(found: FitResult, logs: LogSet, signs: Sequence[Issue]) -> None:
    """Refuse a fit that explains no more of any output than a constant would.

    An output is explained by R² = 1 − Σ(y − ŷ)²/Σ(y − ȳ)² over all its fitted samples, with a mean
    for each log. Outputs are judged one by one: squares of radians and of millimetres have no sum.
    All free parameters and initial states may have been spent on any of them.

    Parameters
    ----------
    found
        The fit.
    logs
        What was fitted.
    signs
        What was found of logs that go different ways.

    Raises
    ------
    IdentificationError
        R² of every output is below `LEAST_R2`, or the unknowns reach it by chance more often than
        `BY_CHANCE`.
    """
    rows = [row for row in found.statistics if row.in_sample and row.nrmse > 0.0]
    of_outputs = [[row for row in rows if row.channel == name] for name in found.outputs]
    fitted = {row.log for row in rows}
    starts = [s for own in found.nuisances if own.log in fitted for s in own.starts]
    unknowns = len(found.free) + sum(len(s.state) for s in starts if not s.at_rest)
    if not rows or any(_is_explained(own, unknowns) for own in of_outputs if own):
        return
    raise IdentificationError(
        f"the {found.model.name} model explains nothing of {', '.join(found.outputs)}",
        where=", ".join(log.name for log in logs),
        value=f"fit {max(row.fit_percent for row in rows):.1f} %",
        remedy="; ".join(issue.message for issue in signs)
        or "look at the channels with `softid inspect`, and at the bounds, if you set any",
    )


def _is_explained(rows: Sequence[FitStatistics], unknowns: int) -> bool:
    """Whether R² of one output, a row per log, is more than nothing."""
    left = sum(row.n * row.rmse**2 for row in rows)
    whole = sum(row.n * (row.rmse / row.nrmse) ** 2 for row in rows)
    if whole == 0.0:
        return True
    explained, freedom = 1.0 - left / whole, sum(row.n for row in rows) - len(rows) - unknowns
    is_chance = unknowns > 0 and r_squared_tail(explained, unknowns, freedom) > BY_CHANCE
    return explained >= LEAST_R2 and not is_chance


def fitted_range(logs: LogSet) -> dict[str, tuple[float, float]]:
    """Smallest and largest recorded value of the input and of each output over the logs."""
    ranges = {}
    for name in (logs.input, *logs.outputs):
        every = [_finite(_recorded(log, name)) for log in logs]
        known = [values for values in every if values.size]
        low, high = min(values.min() for values in known), max(values.max() for values in known)
        ranges[name] = float(low), float(high)
    return ranges


def _recorded(log: Log, channel: str) -> Array:
    """A channel as it was recorded: an input between its readings passes these by nothing."""
    values = log.as_recorded.channels[channel].values
    if channel != log.input or log.input_read_range is None:
        return values
    return np.clip(values, *log.input_read_range)


def _finite(values: Array) -> Array:
    finite = np.isfinite(values)
    return values if finite.all() else values[finite]


def extrapolation(
    log: Log, channel: str, ranges: Mapping[str, tuple[float, float]]
) -> Issue | None:
    """A warning when a log drives the model outside the range that was fitted."""
    if channel not in ranges:
        return None
    low, high = ranges[channel]
    margin = RANGE_MARGIN * (high - low)
    values = _recorded(log, channel)
    outside = (values < low - margin) | (values > high + margin)
    if not outside.any():
        return None
    unit = log.channels[channel].unit
    share = f"{100 * outside.mean():.0f} %" if outside.mean() >= A_FEW else "a few"
    ends = float(values.min()), float(values.max())
    beyond = ends[0] < low - margin, ends[1] > high + margin
    reached = [f"{end:.4g}" for end, is_beyond in zip(ends, beyond, strict=True) if is_beyond]
    return Issue(
        "extrapolation",
        "warning",
        f"{log.name}: {channel} reaches {listed(reached)} {unit}, and {share} of the "
        f"samples lie outside the fitted {low:.4g} to {high:.4g} {unit}: this is extrapolation",
        f"fit a log that covers {' to '.join(reached)} {unit}",
    )


def issues_of(
    estimates: Sequence[ParameterEstimate],
    errors: Errors,
    unseen: Mapping[str, str],
    ranges: Mapping[str, tuple[float, float]],
    held: Sequence[Log],
    statistics: Sequence[FitStatistics],
) -> list[Issue]:
    """Everything worth saying about a fit, subject by subject.

    Parameters
    ----------
    estimates
        Of all parameters.
    errors
        What is known of their errors and of the noise.
    unseen
        Parameters dropped on the way because the logs cannot see them → the reason.
    ranges
        Channel → smallest and largest value in the fitted logs.
    held
        Logs held out.
    statistics
        Scores of every log and output.
    """
    found: list[Issue] = []
    for log in held:
        issue = extrapolation(log, log.input, ranges)
        if issue is not None:
            found.append(issue)
    for e in estimates:
        if e.name in unseen:
            message = (
                f"{e.name} cannot be seen: {e.reason}; the fit continues without it, and the "
                "errors of the others allow for it"
            )
            found.append(Issue("not-seen", "warning", message, e.remedy or None, e.name))
        elif (unknown := estimate_issue(e)) is not None:
            found.append(unknown)
    found += [
        _poor_fit(row, statistics) for row in statistics if row.fit_percent < POOR_FIT_PERCENT
    ]
    found += [
        Issue(
            "coloured-residual",
            "info",
            f"the residual of {noise.channel} is coloured: about {noise.effective_n:.0f} "
            "independent samples; standard errors allow for it",
        )
        for noise in errors.noise
        if not noise.white
    ]
    return found


def noisy_input_issues(
    logs: LogSet, told: Covariance, allowing: Covariance, names: Sequence[str]
) -> list[Issue]:
    """That noise of the input widens intervals, as far as it clearly does.

    Parameters
    ----------
    logs
        The fitted logs.
    told, allowing
        What the residuals tell of the errors, and what allows for the noise, of the same unknowns.
    names
        The parameters of the model.
    """
    sds = zip(told.names, told.sd, allowing.sd, strict=True)
    wider = [n for n, sd, wide in sds if n in names and sd and wide and wide > CLEARLY_WIDER * sd]
    if not wider:
        return []
    log = max(logs, key=lambda log: input_noise_sd(log.as_recorded))
    channel, sd = log.channels[log.input], input_noise_sd(log.as_recorded)
    whose = ", ".join(wider)
    return [
        Issue(
            "noisy-input",
            "info",
            f"the noise of {log.input}, {sd * channel.display_factor:.2g} {channel.display_unit}, "
            f"moves the simulation but not the actuator, which tells on {whose}; "
            f"{'their intervals allow' if len(wider) > 1 else 'its interval allows'} for that",
            f"record {log.input} with less noise, or move the actuator faster and farther",
        )
    ]


def too_few_to_score(rows: Sequence[FitStatistics], unknowns: Mapping[str, int]) -> list[Issue]:
    """That outputs have no fit, since what is estimated on their own log may follow all samples.

    Parameters
    ----------
    rows
        Scores of logs and outputs.
    unknowns
        Name of a log that was not fitted → zeros and initial states estimated on it alone.
    """
    few = [
        row
        for row in rows
        if row.log in unknowns and row.n > 1 and are_too_few(row.n, unknowns[row.log])
    ]
    return [
        Issue(
            "fit-undefined",
            "warning",
            f"{row.log}: {row.n} samples of {row.channel} cannot judge a model of which "
            f"{unknowns[row.log]} unknowns (zero and initial state) are estimated on them, so its "
            "fit in per cent is not defined",
            "score a longer log",
        )
        for row in few
    ]


def most_serious_first(issues: Iterable[Issue]) -> tuple[Issue, ...]:
    """Errors before warnings before remarks, each in the order in which they came.

    Parameters
    ----------
    issues
        In any order.
    """
    return tuple(sorted(issues, key=lambda issue: SERIOUS_FIRST.index(issue.severity)))


def estimate_issue(e: ParameterEstimate) -> Issue | None:
    """That a parameter is not well known, and why; None where it is.

    Parameters
    ----------
    e
        The estimate.
    """
    if e.verdict not in ("not identified", "weakly identified"):
        return None
    severity: Severity = "warning" if e.verdict == "not identified" else "info"
    message = f"{e.name} is {e.verdict}: {e.reason}"
    return Issue(e.verdict.replace(" ", "-"), severity, message, e.remedy or None, e.name)


def _poor_fit(row: FitStatistics, statistics: Sequence[FitStatistics]) -> Issue:
    """What is left on a log that the model follows badly, or that has next to nothing to follow."""
    where = "fitted" if row.in_sample else "held out"
    unit, factor = row.display_unit, row.display_factor
    spread = row.rmse / row.nrmse if row.nrmse > 0.0 else np.inf
    elsewhere = [r.rmse for r in statistics if r.in_sample and r.channel == row.channel]
    usual = float(np.median(elsewhere)) if elsewhere else 0.0
    explains = any(
        r.fit_percent > NEXT_TO_NOTHING_PERCENT
        for r in statistics
        if r.in_sample and r.channel == row.channel
    )
    check = f"check that the sensor of {row.channel} works, and that the right columns are read"
    if not row.in_sample and spread < usual and explains:
        is_still = row.rmse > ASTRAY * usual
        return Issue(
            "nothing-to-score",
            "warning",
            f"{row.log} ({where}): {row.channel} moves by only {spread * factor:.3g} {unit} rms, "
            f"less than the {usual * factor:.3g} {unit} that the model leaves on the usual fitted "
            f"log, so its fit % says nothing; {row.rmse * factor:.3g} {unit} rms are left",
            check if is_still else "hold out a log in which the actuator moves",
        )
    return Issue(
        "poor-fit",
        "warning",
        f"{row.log} ({where}): the model explains {row.channel} only to "
        f"{row.fit_percent:z.0f} %, leaving {row.rmse * factor:.3g} {unit} rms",
        "look at the residual plots for what is missing" if explains else check,
    )
