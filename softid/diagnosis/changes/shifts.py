"""Whether it is a sensor that shifts an output, or a load: a reading jumps, an actuator moves.

In a linear model both are the same once the motion has settled, so that only the moments tell at
which they come and go.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.diagnosis.refit.candidates import Candidate
from softid.effects import ExtendedModel
from softid.segment import Segment
from softid.uncertainty.autoregression import AutoRegression, whiten

Array = npt.NDArray[np.float64]
Course = Callable[[Array], Array]
"""What is shifted of an output a time after the moment, as a share of what stays."""

ZERO, LOAD, EITHER = "zero", "load", "zero or load"
"""Kinds of a shift; the last where its moments do not tell."""

SETTLED = 6.0
"""Times the slowest time constant after which a motion has settled."""

COARSE = 0.1
"""Steps of the moments that are tried first, in time constants: a course hardly changes by less."""

FINER = 41
"""Moments that are tried about the best of these."""

LEAST_SAMPLES = 10
"""Least samples on either side of a moment of which a course is seen."""

POINTS = 1000
"""Points of the course of a load until it has settled, and as many behind that."""

DECISIVE = 30.0
"""Sums of squares, in variances of white noise, by which one course explains a log better than
another where the log tells them apart, or a shift than none: odds of exp(15)."""


@dataclass(frozen=True, eq=False)
class LoadCourse:
    """How an actuator goes to where a load moves it.

    Attributes
    ----------
    time_s, share
        Times after the moment, and share of what is reached after the longest log, shape (n,).
    settled_s
        The time after which its inertia and damping hold nothing back; the material may go on.
    """

    time_s: Array
    share: Array
    settled_s: float

    def __call__(self, since_s: Array) -> Array:
        """Share of what stays, times after the moment."""
        return np.interp(since_s, self.time_s, self.share, left=0.0)


def reading_jumps(since_s: Array) -> Array:
    """The course of a reading that jumps.

    Parameters
    ----------
    since_s
        Times after the moment.
    """
    return np.where(since_s > 0.0, 1.0, 0.0)


@dataclass(frozen=True)
class Shift:
    """What shifts an output.

    Attributes
    ----------
    kind
        ``zero``, ``load``, or ``zero or load``.
    size
        What stays of it after the first moment, in the unit of the output.
    course
        The course that explains more.
    """

    kind: str
    size: float
    course: Course


def shift_at(
    moments_s: Sequence[float], model: Candidate, time_s: Array, left: Array, noise: AutoRegression
) -> Shift | None:
    """What shifts the first output of a log at given moments, by the course about each of them.

    A load F moves a linear actuator as its input does: by −F/Q, along its step response.

    Parameters
    ----------
    moments_s
        About when it comes and goes, in turn.
    model
        A model. What is not linear in its motion hardly counts about a moment.
    time_s, left
        Samples of the log and what the model leaves of them, shape (n,).
    noise
        What is left of them at other times.

    Returns
    -------
    Shift or None
        None where nothing shifts, the model without effects is not linear, or there are effects on
        its output.
    """
    load = _load_course(model)
    if load is None or not (moments_s and noise.sigma_innovation > 0.0):
        return None
    courses: dict[str, Course] = {ZERO: reading_jumps, LOAD: load}
    wide_s = max(load.settled_s, LEAST_SAMPLES * float(np.median(np.diff(time_s))))
    nearest = np.argmin(np.abs(time_s[:, None] - np.array(moments_s)), axis=1)
    falls, sizes = dict.fromkeys(courses, 0.0), dict.fromkeys(courses, 0.0)
    for k, at in enumerate(moments_s):
        near = (nearest == k) & (np.abs(time_s - at) <= wide_s)
        window = _Window(time_s[near], left[near], noise)
        for kind, course in courses.items():
            fall, size = window.best(course, COARSE * load.settled_s / SETTLED)
            falls[kind] += fall
            sizes[kind] += size * (-1) ** k / len(moments_s)
    kind, other = (LOAD, ZERO) if falls[LOAD] > falls[ZERO] else (ZERO, LOAD)
    if not falls[kind] > DECISIVE:
        return None
    is_told = falls[kind] - falls[other] > DECISIVE
    return Shift(kind if is_told else EITHER, sizes[kind], courses[kind])


def _load_course(model: Candidate) -> LoadCourse | None:
    """The course of a load; None where no base is linear, or the sensor has a course, too."""
    whole = model.problem.model
    law = whole.motion_law(model.problem.theta(model.minimum.point))
    is_bare = all(effect.stage != "output" for effect in model.effects)
    if law is None or not (whole.without_effects.is_linear and is_bare):
        return None
    damping, stiffness, _ = (float(c[0]) for c in law.coefficients(np.zeros(1)))
    twice = damping + np.sqrt(complex(damping**2 - 4.0 * law.mass * stiffness))
    if not (twice.real > 0.0 and stiffness > 0.0):
        return None
    settled_s = SETTLED / float((2.0 * stiffness / twice).real)
    lasts_s = max(float(np.ptp(log.time_s)) for log in model.problem.logs)
    near_s = np.linspace(0.0, 2.0 * settled_s, POINTS)
    far_s = np.geomspace(near_s[-1], max(lasts_s, 2.0 * near_s[-1]), POINTS)
    time_s = np.concatenate((near_s, far_s[1:]))
    response = _response_to_level(model, time_s)
    if not (np.isfinite(response).all() and response[-1]):
        return None
    return LoadCourse(time_s, response / response[-1], settled_s)


def _response_to_level(model: Candidate, time_s: Array) -> Array:
    """Response to a level of the input from rest at zero, with what is linear in the motion."""
    whole = model.problem.model
    inner = whole.without_effects
    effects = tuple(e for e in model.effects if e.stage == "state" and e.is_linear)
    if isinstance(whole, ExtendedModel) and effects:
        inner = ExtendedModel(whole.without_effects, effects, whole.scale)
    values, name = model.parameters, model.problem.outputs[0]
    theta = np.array([values[parameter] for parameter in inner.parameters()])
    input_level = 1.0 + values.get(inner.rest_parameter or "", 0.0)
    segment = Segment(
        log_name=model.problem.logs[0].name,
        index=0,
        start=0,
        stop=time_s.size,
        time_s=time_s,
        input=np.full(time_s.size, input_level),
        outputs={name: np.zeros(time_s.size)},
        used={name: np.zeros(time_s.size, bool)},
    )
    found = inner.response(
        theta, segment, [name], start=np.zeros(len(inner.start_states)), derivatives=False
    )
    return found.outputs[name]


class _Window:
    """The samples about one moment, in which an output goes from one level to another."""

    def __init__(self, time_s: Array, left: Array, noise: AutoRegression) -> None:
        self._time_s, self._noise = time_s, noise
        level = whiten(noise, np.ones(time_s.size))
        self._level = level / max(float(np.linalg.norm(level)), np.finfo(float).tiny)
        self._left = self._white(left)

    def best(self, course: Course, step_s: float) -> tuple[float, float]:
        """Largest fall of the sum of squares, in variances, over all moments, and the size then."""
        if self._time_s.size <= LEAST_SAMPLES:
            return 0.0, 0.0
        step_s = max(step_s, float(np.median(np.diff(self._time_s))))
        rough = np.arange(self._time_s[0], self._time_s[-1], step_s)
        at = rough[np.argmax(self._falls(course, rough)[0])]
        fine = np.linspace(at - step_s, at + step_s, FINER)
        falls, sizes = self._falls(course, fine)
        best = int(np.argmax(falls))
        return float(falls[best]), float(sizes[best])

    def _falls(self, course: Course, moments_s: Array) -> tuple[Array, Array]:
        """Falls and sizes of a shift at each of some moments."""
        columns = self._white(course(self._time_s[:, None] - moments_s))
        power = np.maximum(np.sum(columns**2, axis=0), np.finfo(float).tiny)
        along = self._left @ columns
        return (along / self._noise.sigma_innovation) ** 2 / power, along / power

    def _white(self, values: Array) -> Array:
        """What is white of values, without a level."""
        white = whiten(self._noise, values)
        rest: Array = white - np.multiply.outer(self._level, self._level @ white)
        return rest
