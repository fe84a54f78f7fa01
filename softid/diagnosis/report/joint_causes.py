"""What named causes are together, or with the model: more than the name of each of them says."""

from __future__ import annotations

from dataclasses import replace
from itertools import takewhile

from softid.diagnosis.report.ambiguity import is_linear, law_that_ties, own_places, own_times
from softid.diagnosis.report.parameter_doubts import less_sure
from softid.diagnosis.verdict.equivalence import TWO_LAGS, TWO_RESONANCES
from softid.diagnosis.verdict.laws_alike import OWN_DAMPING
from softid.diagnosis_results import Cause, Diagnosis
from softid.effects import belongs_to, effect_of
from softid.effects.base import Effect
from softid.errors import Issue
from softid.results import FitResult, ParameterEstimate

ONE_CAUSE = "one-cause-in-two"
"""Code of the remark that two causes may be one."""

SHARED_SCALE = "shared-scale"
"""Code of the remark that inertia, damping and stiffness are known up to a factor."""

OWN_LAG = "own-lag"
"""Code of the remark that an inertia may be a lag."""

TWO = 2
"""Real times of a motion that does not ring."""

DYNAMIC = ("M", "N")
"""Parameters of a linear model that make its time constants; its gain is no matter of places."""

CURVE = "static_curve"
GAIN, ZERO = "sensor_gain_drift", "sensor_drift"

COMMUTING = (*TWO_LAGS.effects, *TWO_RESONANCES.effects, "delay", ZERO, GAIN)
"""Keys of what a linear motion may as well come before as behind."""


def joint_cause_issues(found: Diagnosis) -> tuple[Issue, ...]:
    """That drifts of a sensor's gain and of its zero are one of the gain about the sensor's zero.

    y (1 + g t) + d t = y₀ + (y − y₀)(1 + g t) with y₀ = −d/g: the sensor's own zero need not lie
    where the model's position is zero.

    Parameters
    ----------
    found
        A diagnosis in numbers.
    """
    by_key = {cause.key: cause for cause in found.causes}
    if found.extended is None or not {GAIN, ZERO} <= set(by_key):
        return ()
    gain, rate = _value(by_key[GAIN], "g"), _value(by_key[ZERO], "rate")
    if gain == 0.0:
        return ()
    row = next(s for s in found.extended.statistics if s.channel == found.extended.outputs[0])
    first = found.extended.nuisances[0]
    reading = (first.zero.get(row.channel, 0.0) - rate / gain) * row.display_factor
    where = f" of {first.log}" if len(found.extended.nuisances) > 1 else ""
    return (
        Issue(
            ONE_CAUSE,
            "info",
            f"drift of the sensor and of its gain may be one cause: a gain that drifts about the "
            f"sensor's own zero, at a reading{where} of {reading:.3g} {row.display_unit}",
            "look up which reading belongs to no signal of the sensor",
        ),
    )


def with_shared_scale(found: Diagnosis, *, linear_in: str | None) -> Diagnosis:
    """The diagnosis with what a free curve at rest makes up for: a factor of all forces.

    M ẍ + N ẋ + Q (x − s(u)) = F(u) with all three k times as large and
    s(u) + (1 − 1/k) F(u)/Q in place of s(u) is the same motion: only how well a spline draws that
    tells k. Where F is linear nothing does.
    The intervals hold for just such a spline, which no actuator has: none is identified.

    Parameters
    ----------
    found
        A diagnosis in numbers.
    linear_in
        Unit of the input where the model without effects is linear: what is measured in it goes
        with the factor, and speeds and times do not. None where forces are in shares of one.
    """
    if found.extended is None or all(cause.effect != CURVE for cause in found.causes):
        return found
    outer = [e for e in (effect_of(c.key) for c in found.causes) if e.stage != "state"]

    def goes_with_it(p: ParameterEstimate) -> bool:
        is_outer = any(belongs_to(effect, p.name) for effect in outer)
        return not is_outer and (linear_in is None or linear_in in p.unit)

    weak = {p.name for p in found.extended.parameters if goes_with_it(p)}
    told = less_sure(
        found,
        weak,
        "it is known up to a factor, which the static curve can make up for",
        "fix a parameter that is known, or read off ratios and time constants only",
    )
    issue = Issue(
        SHARED_SCALE,
        "warning",
        "with another static curve, inertia, damping and stiffness are known up to a common "
        "factor, which that curve makes up for: their ratios, and with them the response, are "
        "as sure as their intervals say, they themselves and the curve's own values only if "
        "it is just such a spline",
        "read off ratios and time constants only, or fix what is known with the `parameters` "
        "of `softid.diagnose`",
    )
    return replace(told, issues=(*found.issues, issue))


def with_open_places(found: Diagnosis) -> Diagnosis:
    """The diagnosis with what may as well be the actuator's as a filter's before or behind it.

    In a linear model operations commute: a lag or a resonance, and the actuator's own, are in the
    order in which the search found them.

    Parameters
    ----------
    found
        A diagnosis in numbers.
    """
    if not is_linear(found.base):
        return found
    if found.extended is None:
        return _with_own_lag(found, found.base)
    filters = _beside_the_motion(found.extended)
    for tie in found.alternatives:
        if law_that_ties(tie, linear=True) is OWN_DAMPING or own_places(tie, found.extended):
            filters += [effect_of(c.key) for c in found.causes if c.effect in tie.effects]
    if not filters:
        return _with_own_lag(found, found.extended)
    names = (p.name for p in found.extended.parameters)
    weak = {*DYNAMIC, *(name for name in names if any(belongs_to(f, name) for f in filters))}
    return less_sure(
        found,
        weak,
        "the actuator's own time or resonance and that of a cause may change places",
        "record the sensor beside a faster one, or the pressure at the actuator itself",
    )


def _with_own_lag(found: Diagnosis, fit: FitResult) -> Diagnosis:
    """The diagnosis with inertia and damping that may be a lag before a motion without inertia.

    M ẍ + N ẋ + Q x = Q (τ₁ d/dt + 1) (τ₂ d/dt + 1) x where the motion does not ring, unless a law
    of the motion itself tells its own time from that of a gauge, a valve or a tube.
    """
    times = own_times(TWO_LAGS, fit)
    of_motion = any(effect_of(key).stage == "state" for key in fit.model.effects)
    if len(times) < TWO or of_motion:
        return found
    slow, fast = times
    same = (
        f"a lag of {slow} or of {fast}, before or behind a motion without inertia that has the "
        "other time, is the same law"
    )
    remedy = (
        "record the pressure at the actuator itself and the sensor beside a faster one, or weigh "
        "what moves"
    )
    issue = Issue(OWN_LAG, "info", f"M and N are known for a motion with inertia: {same}", remedy)
    return replace(less_sure(found, DYNAMIC, same, remedy), issues=(*found.issues, issue))


def _beside_the_motion(extended: FitResult) -> list[Effect]:
    """Lags and resonances between which and a linear motion all is linear, and which it may have.

    Their times and the motion's own in each other's place give the same response.
    """
    effects = [effect_of(key) for key in extended.model.effects]
    if any(effect.stage == "state" for effect in effects):
        return []
    before = [effect for effect in reversed(effects) if effect.stage == "input"]
    behind = [effect for effect in effects if effect.stage == "output"]
    return [
        effect
        for side in (before, behind)
        for effect in takewhile(lambda one: one.key in COMMUTING, side)
        for known in (TWO_LAGS, TWO_RESONANCES)
        if effect.name in known.effects and own_times(known, extended)
    ]


def _value(cause: Cause, parameter: str) -> float:
    return next(p.value for p in cause.parameters if p.name == f"{cause.effect}_{parameter}")
