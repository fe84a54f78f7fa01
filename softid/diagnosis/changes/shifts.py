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

ALIKE = 1e-6
"""Two poles whose ratio is as near to one, or to nothing, are taken to be that far from it."""

DECISIVE = 30.0
"""Sums of squares, in variances of white noise, by which one course explains a log better than
another where the log tells them apart: odds of exp(15)."""


@dataclass(frozen=True)
class Shift:
    """What shifts an output.

    Attributes
    ----------
    kind
        ``zero``, ``load``, or ``zero or load``.
    size
        What stays of it, in the unit of the output.
    """

    kind: str
    size: float


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
        A linear model without effects.
    time_s, left
        Samples of the log and what the model leaves of them, shape (n,).
    noise
        What is left of them at other times.

    Returns
    -------
    Shift or None
        None where nothing shifts, or the model is another one.
    """
    found = _settling(model)
    if found is None or not noise.sigma_innovation > 0.0:
        return None
    settling, settled_s = found
    courses: dict[str, Course] = {ZERO: _jump, LOAD: settling}
    wide_s = max(settled_s, LEAST_SAMPLES * float(np.median(np.diff(time_s))))
    nearest = np.argmin(np.abs(time_s[:, None] - np.array(moments_s)), axis=1)
    falls, sizes = dict.fromkeys(courses, 0.0), dict.fromkeys(courses, 0.0)
    for k, at in enumerate(moments_s):
        near = (nearest == k) & (np.abs(time_s - at) <= wide_s)
        window = _Window(time_s[near], left[near], noise)
        for kind, course in courses.items():
            fall, size = window.best(course, COARSE * settled_s / SETTLED)
            falls[kind] += fall
            sizes[kind] += size * (-1) ** k / len(moments_s)
    kind, other = (LOAD, ZERO) if falls[LOAD] > falls[ZERO] else (ZERO, LOAD)
    if not falls[kind] > DECISIVE:
        return None
    return Shift(kind if falls[kind] - falls[other] > DECISIVE else EITHER, sizes[kind])


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


def _jump(since_s: Array) -> Array:
    """A reading that jumps."""
    return np.where(since_s > 0.0, 1.0, 0.0)


def _settling(model: Candidate) -> tuple[Course, float] | None:
    """How a linear actuator goes to where a load moves it, and the time in which it has settled.

    1 − (exp(p t) − r exp(p t/r))/(1 − r) with the slower pole p of M·p² + N·p + Q = 0 and the ratio
    r of the poles; without inertia r is 0.
    """
    law, values = model.problem.model, model.parameters
    inertia, stiffness = (
        values.get(name or "", 0.0) for name in (law.inertia_parameter, law.stiffness_parameter)
    )
    damping = sum(values.get(name, 0.0) for name in law.damping_parameters)
    twice = damping + np.sqrt(complex(damping**2 - 4.0 * inertia * stiffness))
    if not law.is_linear or model.effects or not twice.real > 0.0 or not stiffness > 0.0:
        return None
    slow, ratio = -2.0 * stiffness / twice, 4.0 * inertia * stiffness / twice**2
    if abs(1.0 - ratio) < ALIKE:
        ratio = 1.0 - ALIKE

    def settling(since_s: Array) -> Array:
        after = np.maximum(since_s, 0.0)
        fast = ratio * np.exp(slow * after / ratio) if abs(ratio) > ALIKE else 0.0
        share: Array = 1.0 - ((np.exp(slow * after) - fast) / (1.0 - ratio)).real
        return np.where(since_s > 0.0, share, 0.0)

    return settling, SETTLED / float(-slow.real)
