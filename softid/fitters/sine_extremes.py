"""Second stage of Ru's protocol: inertia from the extremes of a sine, where ẋ = 0."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from softid.channels import read_only
from softid.errors import IdentificationError, Issue
from softid.fitters.branches import turning_samples
from softid.fitters.local_derivatives import (
    local_derivatives,
    local_polynomial,
    samples_per_window,
    vertex_s,
)
from softid.fitters.settled_levels import contraction, require_unit
from softid.fitters.static_levels import LevelsFit
from softid.log import Log
from softid.models.geometry import ArcGeometry

Array = npt.NDArray[np.float64]

WINDOWS_PER_PERIOD = 10
"""A smoothing window is a tenth of the period of the motion."""

SEEKING_WINDOWS = 2.0
"""Extremes are looked for in windows longer by this factor than those they are read in."""

DISAGREEMENT = 0.5
"""Upper and lower extremes disagree when their medians differ by this share of M."""

PROMINENCE = 0.2
"""An extreme counts when the motion comes back by this share of its range."""


@dataclass(frozen=True, eq=False)
class ExtremesFit:
    """Inertia from the extremes of a sine, where ẋ = 0 and M·ẍ = P − Q·x.

    Attributes
    ----------
    mass
        Median of ``samples``, in s² per unit of x.
    quartiles
        Lower and upper quartile of ``samples``.
    straddles_zero
        Whether the quartiles lie on both sides of zero: then the log does not show the inertia,
        not even its sign.
    top, bottom
        Median over the upper and the lower extremes, or None without any.
    unit
        Unit of x.
    samples
        M of each extreme, shape (m,).
    time_s, pressure_kpa, contraction, acceleration, force_balance
        The extremes: when, p, x, ẍ and P − Q·x, each of shape (m,).
    window_s
        Length of the smoothing windows.
    issues
        What the user should know.
    """

    mass: float
    quartiles: tuple[float, float]
    straddles_zero: bool
    top: float | None
    bottom: float | None
    unit: str
    samples: Array
    time_s: Array
    pressure_kpa: Array
    contraction: Array
    acceleration: Array
    force_balance: Array
    window_s: float
    issues: tuple[Issue, ...] = ()


@dataclass(frozen=True, eq=False)
class Stretch:
    """Used samples of one segment: times, input and x, each of shape (n,)."""

    time_s: Array
    pressure_kpa: Array
    x: Array


def extremes(
    log: Log,
    static: LevelsFit,
    *,
    output: str | None = None,
    geometry: ArcGeometry | None = None,
    window_s: float | None = None,
) -> ExtremesFit:
    """Read the inertia off the extremes of a sine response, M = (P − Q·x)/ẍ where ẋ = 0.

    Weakness: M is the quotient of two small differences. At the top of a 0.5 Hz sine to 2.4 bar
    P − Q·x is about −0.8 while P is about 1300, so an error of 0.1 % in the static curve there is
    larger than the whole effect, and so is 0.3 mm of noise in x: over 40 s at 100 Hz the quartiles
    of M then lay on both sides of zero in 28 of 40 recordings, and upper and lower extremes
    disagreed in 36. A peak is also picked where the noise is high, which biases M. Prefer a
    simultaneous fit of all logs.

    Parameters
    ----------
    log
        A sine of the pressure, several periods.
    static
        The static curve from `levels`, taken as exact.
    output, geometry
        As in `levels`.
    window_s
        Length of the windows in which x and p are smoothed by a quartic; by default a tenth of
        the period of the motion, which without noise errs by about 5 %: longer windows hold the
        noise down and flatten the peak.

    Raises
    ------
    IdentificationError
        The motion has no extreme away from the ends of the log.
    UsageError
        The output is no motion, needs the geometry, or gives x in another unit than the curve's.

    Source: Ru et al. 2019, Eq 4 and the paragraph before Eq 6.
    """
    stretches = stretches_of(log, output, geometry, unit=static.unit)
    window = window_s or default_window_s(stretches, log.name)
    found = [row for s in stretches for row in _extremes_of(s, window)]
    if not found:
        raise IdentificationError(
            "the motion has no extreme away from the ends of the log",
            where=log.name,
            remedy="use a log of a sine with several periods",
        )
    time_s, pressure_kpa, x, acceleration, heading = np.array(found).T
    balance = static.force_balance(pressure_kpa, x)
    samples = balance / acceleration
    lower, middle, upper = np.quantile(samples, (0.25, 0.5, 0.75)).tolist()
    fit = ExtremesFit(
        mass=middle,
        quartiles=(lower, upper),
        straddles_zero=lower <= 0.0 <= upper,
        top=_median(samples[heading < 0]),
        bottom=_median(samples[heading > 0]),
        unit=static.unit,
        samples=read_only(samples),
        time_s=read_only(time_s),
        pressure_kpa=read_only(pressure_kpa),
        contraction=read_only(x),
        acceleration=read_only(acceleration),
        force_balance=read_only(balance),
        window_s=window,
    )
    return replace(fit, issues=_mass_issues(fit))


def stretches_of(
    log: Log, output: str | None, geometry: ArcGeometry | None, *, unit: str
) -> list[Stretch]:
    """The used samples of every segment that has at least two.

    Parameters
    ----------
    log, output, geometry
        As in `extremes`.
    unit
        That of the static curve with which x is to be taken.

    Raises
    ------
    UsageError
        The output is no motion, needs the geometry, or gives x in another unit.
    """
    found = []
    for segment in log.segments():
        x, own = contraction(segment, output, geometry)
        require_unit(own, unit, where=log.name, of="the static curve")
        used = np.isfinite(x)
        found.append(Stretch(segment.time_s[used], segment.input[used], x[used]))
    return [s for s in found if s.time_s.size >= 2]


def _median(values: Array) -> float | None:
    return float(np.median(values)) if values.size else None


def default_window_s(stretches: Sequence[Stretch], where: str) -> float:
    """A tenth of the period of the motion.

    Raises
    ------
    IdentificationError
        The motion does not go back and forth.
    """
    half_periods = []
    for s in stretches:
        turns = [k for k, _ in _turning_points(s.x)]
        if len(turns) > 1:
            half_periods.append(float(np.median(np.diff(s.time_s[turns]))))
    if not half_periods:
        raise IdentificationError(
            "the motion does not go back and forth",
            where=where,
            remedy="use a log of a sine with several periods, or give window_s",
        )
    return 2.0 * float(np.median(half_periods)) / WINDOWS_PER_PERIOD


def _turning_points(x: Array) -> list[tuple[int, int]]:
    """Extremes with a swing on both sides, and the direction after each."""
    return turning_samples(x, PROMINENCE * float(np.ptp(x)))[1:]


def _extremes_of(s: Stretch, window_s: float) -> list[tuple[float, float, float, float, float]]:
    """Time, p, x, ẍ and direction afterwards of the extremes away from the ends of a stretch.

    Where x is extreme is looked for in windows twice as long as those in which it is read: a
    peak found and read in the same samples is the peak of the noise as well.
    """
    seek_s = SEEKING_WINDOWS * window_s
    if s.time_s.size < samples_per_window(s.time_s, seek_s):
        return []
    smooth = local_derivatives(s.time_s, s.x, window_s=seek_s).value
    rows = []
    for k, heading in _turning_points(smooth):
        near_s = float(s.time_s[k])
        if not s.time_s[0] + seek_s <= near_s <= s.time_s[-1] - seek_s:
            continue
        sought = local_polynomial(s.time_s, s.x, near_s=near_s, window_s=seek_s)
        flat_s = vertex_s(sought, 0.5 * seek_s)
        if flat_s is None:
            continue
        at_s = near_s + flat_s
        motion = local_polynomial(s.time_s, s.x, near_s=at_s, window_s=window_s)
        pressure = local_polynomial(s.time_s, s.pressure_kpa, near_s=at_s, window_s=window_s)
        p, x, acceleration = (float(f(0.0)) for f in (pressure, motion, motion.deriv(2)))
        rows.append((at_s, p, x, acceleration, float(heading)))
    return rows


def _mass_issues(fit: ExtremesFit) -> tuple[Issue, ...]:
    remedy = "fit all logs together by output error, which does not differentiate the data"
    lower, upper = fit.quartiles
    spread = f"quartiles {lower:.3g} to {upper:.3g} s²/{fit.unit} from {fit.samples.size} extremes"
    found = []
    if fit.straddles_zero:
        message = f"the extremes do not show the inertia, not even its sign: {spread}"
        found.append(Issue("inertia-not-seen", "warning", message, remedy))
    elif fit.mass < 0.0:
        message = f"the extremes give a negative inertia, so the static curve is off: {spread}"
        found.append(Issue("inertia-negative", "warning", message, remedy))
    elif upper - lower > fit.mass:
        message = f"the extremes scatter by more than the inertia itself: {spread}"
        found.append(Issue("inertia-poorly-known", "warning", message, remedy))
    if fit.top is None or fit.bottom is None:
        return tuple(found)
    if abs(fit.top - fit.bottom) > DISAGREEMENT * abs(fit.mass):
        message = (
            f"the upper extremes give an inertia of {fit.top:.3g}, the lower ones of "
            f"{fit.bottom:.3g} s²/{fit.unit}"
        )
        found.append(Issue("extremes-disagree", "warning", message, remedy))
    return tuple(found)
