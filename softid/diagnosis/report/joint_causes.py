"""What named causes are together, or with the model: more than the name of each of them says."""

from __future__ import annotations

from dataclasses import replace

from softid.diagnosis_results import Cause, Diagnosis
from softid.effects import belongs_to, effect_of
from softid.errors import Issue
from softid.results import ParameterEstimate

ONE_CAUSE = "one-cause-in-two"
"""Code of the remark that two causes may be one."""

SHARED_SCALE = "shared-scale"
"""Code of the remark that inertia, damping and stiffness are known up to a factor."""

CURVE = "static_curve"
GAIN, ZERO = "sensor_gain_drift", "sensor_drift"


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


def with_shared_scale(found: Diagnosis, *, is_linear: bool) -> Diagnosis:
    """The diagnosis with what a free curve at rest makes up for: a factor of all forces.

    M ẍ + N ẋ + Q (x − s(u)) = F(u) with all three k times as large and
    s(u) + (1 − 1/k) F(u)/Q in place of s(u) is the same motion: only how well a spline draws that
    tells k. Where F is a straight line nothing does, and the parameters themselves are told so.
    Their intervals hold for just such a spline, which no actuator has: none is identified.

    Parameters
    ----------
    found
        A diagnosis in numbers.
    is_linear
        Whether the model without effects is linear.
    """
    if is_linear or found.extended is None or all(cause.effect != CURVE for cause in found.causes):
        return found
    outer = [e for e in (effect_of(c.key) for c in found.causes) if e.stage != "state"]
    parameters = tuple(
        p if any(belongs_to(effect, p.name) for effect in outer) else _up_to_a_factor(p)
        for p in found.extended.parameters
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
    told = {p.name: p for p in parameters}
    causes = (
        replace(c, parameters=tuple(told.get(p.name, p) for p in c.parameters))
        for c in found.causes
    )
    return replace(
        found,
        causes=tuple(causes),
        extended=replace(found.extended, parameters=parameters),
        issues=(*found.issues, issue),
    )


def _up_to_a_factor(parameter: ParameterEstimate) -> ParameterEstimate:
    """A parameter that is known together with others only."""
    if parameter.verdict != "identified":
        return parameter
    return replace(
        parameter,
        verdict="weakly identified",
        reason="it is known up to a factor, which the static curve can make up for",
        remedy="fix a parameter that is known, or read off ratios and time constants only",
    )


def _value(cause: Cause, parameter: str) -> float:
    return next(p.value for p in cause.parameters if p.name == f"{cause.effect}_{parameter}")
