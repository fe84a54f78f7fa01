"""The paper's protocol for the bi-directional actuator by name: tune C_d, then C_m, by eye.

It is kept because the paper uses it and because it can be done with a ruler. It is not the default:
it reads two numbers off a record that holds thousands.

Source: DEE 2022, sections 2.3 and 4.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.errors import IdentificationError, Issue
from softid.excitation import second_difference_noise
from softid.fitters.rest import REST_FRACTION
from softid.fitters.swings import Swings, count_swings
from softid.log import Log
from softid.models.equilibrium import NAMES, Equilibrium
from softid.segment import Segment

__all__ = ["ByHand", "by_hand"]

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

DAMPING_RATIOS: Array = np.geomspace(0.01, 3.0, 121)
"""Values of C_d that are tried, in units of the critical damping at the last level and 5 % apart.
From a hundredth of it, where a swing loses 6 % from period to period, to where nothing swings."""

TRIED_MASSES: Array = np.geomspace(0.05, 20.0, 161)
"""Constant values of C_m that are tried, 4 % apart; the period is interpolated between them. That
of small swings goes nearly as √C_m, so that the grid spans a factor of 20 in it."""

LEAST_SWING, NOISES = 0.05, 5.0
"""Extremes nearer to the final level than this share of the way to it, or than this many standard
deviations of the record's noise, are not counted."""


@dataclass(frozen=True, eq=False)
class ByHand:
    """C_d and a constant C_m, tuned by the paper's protocol.

    Attributes
    ----------
    values
        All parameters of the model.
    damping_range
        Smallest and largest C_d that give the same number of swings, in N·m·s/rad.
    measured, damped, compensated
        Swings of the record, after C_d was tuned with C_m = 1, and after C_m was tuned too.
    rmse_rad
        Error of the final simulation.
    simulated_rad
        Final simulation with the record's zero, shape (n,).
    issues
        What the protocol could not do.
    """

    values: dict[str, float]
    damping_range: tuple[float, float]
    measured: Swings
    damped: Swings
    compensated: Swings
    rmse_rad: float
    simulated_rad: Array
    issues: tuple[Issue, ...] = ()


def by_hand(log: Log, *, model: Equilibrium | None = None, output: str = "angle") -> ByHand:
    """Tune C_d by the number of swings, then C_m by their frequency.

    1. With C_m = 1, C_d is moved until the simulation swings as often about its final level as the
       record does; of the range that gives the same count the geometric middle is taken.
    2. With that C_d, a constant C_m = c is moved until the mean period of the swings is that of
       the record.

    Weakness: a count leaves C_d open by a wide range, which is reported, and says nothing of a
    record that does not swing. c changes the number of swings again, since the damping ratio goes
    with 1/√c, and the protocol never looks back. a and b do not show in one period. The stiffness
    is taken as exact: the final level tests it and nothing else, so an error of the statics goes
    into c. A drift of the sensor or a lag of the pressure goes there too.

    Parameters
    ----------
    log
        One step from rest.
    model
        Geometry and options; softid's assumed actuator by default.
    output
        The angle.

    Raises
    ------
    UsageError
        The log has no such channel.
    IdentificationError
        The record does not swing, has no angle before the step, or no C_d or C_m gives its swings.

    Source: DEE 2022, Figures 5 and 6.
    """
    chosen = model or Equilibrium()
    log = log.with_roles(outputs=(output,))
    segment = max(log.segments(), key=lambda s: s.time_s.size)
    record = segment.outputs[output]
    shown = np.where(segment.used[output], record, np.nan)
    least = _least(shown)
    measured = count_swings(segment.time_s, shown, segment.input, least=least)
    if measured.count < 1 or measured.period_s is None:
        raise IdentificationError(
            "the record does not swing, so neither C_d nor C_m can be tuned by it",
            where=log.name,
            remedy="use a larger step, or fit by output error",
        )
    rest = _rest(segment, output)
    theta = chosen.parameters().with_fixed({"a": 0.0, "b": 0.0, "c": 1.0}).values_vector()
    critical = _critical_damping(chosen, theta, segment, where=log.name)

    def run(at: Array) -> Swings:
        simulated = _simulated(chosen, at, segment, output)
        return count_swings(segment.time_s, simulated, segment.input, least=least)

    fitting = [
        damping
        for damping in (critical * DAMPING_RATIOS).tolist()
        if run(_moved(theta, "C_d", damping)).count == measured.count
    ]
    if not fitting:
        raise IdentificationError(
            f"no C_d gives {measured.count} swings with C_m = 1",
            where=log.name,
            remedy="check the geometry, or fit by output error",
        )
    low, high = fitting[0], fitting[-1]
    damped = _moved(theta, "C_d", float(np.sqrt(low * high)))
    tuned = _moved(damped, "c", _best_mass(run, damped, measured.period_s, log.name))
    rivals = (measured, run(damped), run(tuned))
    return _told(chosen, segment, output, (low, high), rivals, tuned, rest)


def _rest(segment: Segment, output: str) -> BoolArray:
    """Used samples before the pressure moves, which tell the zero of the angle, shape (n,)."""
    u = segment.input
    moves = np.abs(u - u[0]) > REST_FRACTION * float(np.ptp(u))
    still = np.arange(u.size) < max(1, int(np.argmax(moves)))
    rest: BoolArray = segment.used[output] & still
    if rest.any():
        return rest
    raise IdentificationError(
        "the angle is missing until the pressure moves, so its zero is not known",
        where=segment.log_name,
        remedy="record the rest before the step too, or fit by output error",
    )


def _told(
    model: Equilibrium,
    segment: Segment,
    output: str,
    span: tuple[float, float],
    swings: tuple[Swings, Swings, Swings],
    tuned: Array,
    rest: BoolArray,
) -> ByHand:
    measured, damped, compensated = swings
    simulated = _simulated(model, tuned, segment, output)
    used = segment.used[output]
    simulated = simulated + float(np.mean((segment.outputs[output] - simulated)[rest]))
    left = (segment.outputs[output] - simulated)[used]
    issues = []
    if compensated.count != measured.count:
        issues.append(
            Issue(
                "swings-changed",
                "warning",
                f"after C_m was tuned the simulation swings {compensated.count} times, the record "
                f"{measured.count} times",
                "fit by output error, which moves C_d and C_m together",
            )
        )
    return ByHand(
        values=dict(zip(NAMES, tuned.tolist(), strict=True)),
        damping_range=span,
        measured=measured,
        damped=damped,
        compensated=compensated,
        rmse_rad=float(np.sqrt(np.mean(left**2))),
        simulated_rad=simulated,
        issues=tuple(issues),
    )


def _best_mass(run: Callable[[Array], Swings], damped: Array, period_s: float, where: str) -> float:
    """The constant C_m at which the period is the record's, between two points of the grid."""
    masses, periods = [], []
    for mass in TRIED_MASSES.tolist():
        found = run(_moved(damped, "c", mass)).period_s
        if found is not None:
            masses.append(mass)
            periods.append(found)
    if not masses or not min(periods) <= period_s <= max(periods):
        raise IdentificationError(
            f"no C_m gives swings of {period_s:.3g} s",
            where=where,
            remedy="check the geometry, or fit by output error",
        )
    rising = np.maximum.accumulate(periods)
    return float(np.exp(np.interp(period_s, rising, np.log(masses))))


def _critical_damping(model: Equilibrium, theta: Array, segment: Segment, *, where: str) -> float:
    values = dict(zip(NAMES, _moved(theta, "C_d", 1.0).tolist(), strict=True))
    level = float(segment.input[-1])
    ratio = model.speeds(values, level).damping_ratio
    if ratio is None:
        raise IdentificationError(
            f"the model has no rest at {level:.4g} kPa",
            where=where,
            remedy="check the geometry, or fit by output error",
        )
    return 1.0 / ratio


def _simulated(model: Equilibrium, theta: Array, segment: Segment, output: str) -> Array:
    with np.errstate(all="ignore"):
        found = model.response(theta, segment, (output,), start=None, derivatives=False)
    return found.outputs[output]


def _least(shown: Array) -> float:
    """Smallest share of the step that stands out of the noise."""
    y = shown[np.isfinite(shown)]
    step = abs(float(np.median(y[-(y.size // 4) :])) - float(y[0]))
    return float(max(LEAST_SWING, NOISES * second_difference_noise(y) / max(step, 1e-12)))


def _moved(theta: Array, name: str, value: float) -> Array:
    moved = theta.copy()
    moved[NAMES.index(name)] = value
    return moved
