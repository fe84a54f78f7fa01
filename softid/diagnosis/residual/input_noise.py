"""What the noise of the recorded input, and its unknown course, leave of a true model.

The actuator follows the input that was there, the simulation the one that was recorded. Noise of
the gauge is averaged away as far as the course of the input allows; what is slow of it stays, goes
through the motion, and is large where the static curve is steep and nothing at rest. It is neither
white nor steady, so that it looks like a misfit. So does the rounding of a coarse gauge, and what
the input did between its samples where it was quick beside them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from weakref import WeakKeyDictionary

import numpy as np
import numpy.typing as npt

from softid.diagnosis.refit.candidates import Candidate, prior_sd
from softid.diagnosis.refit.optimum import optimum_of
from softid.diagnosis.refit.whitening import Whitener
from softid.diagnosis.residual.input_course import moved_by_courses
from softid.diagnosis.residual.jump_timing import part_of_jumps
from softid.diagnosis.residual.motion import mean_square, residual_context, simulated
from softid.diagnosis.residual.noise_floor import NoiseFloor
from softid.diagnosis.residual.projection import basis_of, rows_of
from softid.identification.errors_in_variables import with_input_errors
from softid.identification.gauge_errors import NO_ERRORS, GaugeErrors
from softid.identification.input_denoising import without_input_noise
from softid.identification.input_errors import NO_INPUT_ERRORS, InputErrors
from softid.identification.parameter_covariance import errors_of
from softid.log import Log
from softid.parallel import in_parallel

Array = npt.NDArray[np.float64]

DRAWS = 12
"""Draws of a noise that nobody knows; the mean square of what they make varies by a tenth."""

LEAST_COURSE = 0.02
"""Share of the output's noise from which on the unknown course of the input is drawn `DRAWS` times:
where the input is sampled well the course makes less, and every draw is a simulation."""

SEED = 0
"""Seed of the draws of the input's noise, the same in every log."""

_LEFT: WeakKeyDictionary[Log, tuple[GaugeErrors, Array]] = WeakKeyDictionary()
"""Log → errors of its gauge and what `_left_of` found: all models are asked the same,
and to average a long log takes longer than to simulate it."""


@dataclass(frozen=True, eq=False)
class InputNoise:
    """Draws of what is not known of the input, as a true model leaves them in the first output.

    Attributes
    ----------
    draws
        One in each row, at the used samples of all segments, shape (D, m).
    of_course
        Share of their power that the course between the samples makes, and not noise.
    """

    draws: Array
    of_course: float = 0.0

    @property
    def variance(self) -> float:
        """Mean square of the draws."""
        return float(np.mean(self.draws**2))

    def beside(self, floor: NoiseFloor) -> NoiseFloor:
        """The noise of both sensors together.

        Parameters
        ----------
        floor
            The noise of the output.
        """
        whole = floor.variance + self.variance
        spread = float(np.std(np.mean(self.draws**2, axis=1)))
        sd = float(np.hypot(floor.relative_sd * floor.variance, spread)) / whole
        return replace(floor, variance=whole, relative_sd=sd)

    def with_white(self, variance: float, *, rng: np.random.Generator) -> Array:
        """The draws with white noise of the output, one in each column, shape (m, D).

        Parameters
        ----------
        variance
            That of the output's noise.
        rng
            Draws it.
        """
        white = variance**0.5 * rng.standard_normal(self.draws.shape)
        found: Array = (self.draws + white).T
        return found


def input_noise(
    model: Candidate, gauges: Mapping[str, GaugeErrors], variance: float, *, is_judged: bool = False
) -> InputNoise | None:
    """Simulate what is not known of the input; None where that leaves nothing.

    What the parameters make up for is taken away.

    Parameters
    ----------
    model
        A fit to logs whose input was averaged.
    gauges
        Log → errors of the input that was recorded.
    variance
        That of the output's noise, beside which a course that is sampled well is none.
    is_judged
        Whether the logs are held out: then the parameters make up for nothing.
    """
    found = _unknown(model, gauges, variance)
    if found is None:
        return None
    noise, course = found
    basis = basis_of(_slopes(model)[:, len(model.problem.free) if is_judged else 0 :])
    draws = noise + course
    power = np.mean(course**2) / (np.mean(course**2) + np.mean(noise**2))
    return InputNoise(draws - (draws @ basis) @ basis.T, float(power))


def unknown_input(
    model: Candidate,
    gauges: Mapping[str, GaugeErrors],
    variance: float,
    *,
    moments_are_open: bool = False,
) -> Array | None:
    """Draws of what is not known of the input, in the first output; None where that is nothing.

    What parameters make up for is in them, too.

    Parameters
    ----------
    model, gauges, variance
        As in `input_noise`.
    moments_are_open
        Whether the moments at which the input jumped between two samples are not known.

    Returns
    -------
    ndarray or None
        One draw in each row, at the used samples of all segments, shape (D, m).
    """
    found = _unknown(model, gauges, variance)
    moments = _of_moments(model, variance) if moments_are_open else np.zeros((1, 1))
    if found is None:
        return moments if moments_are_open else None
    return found[0] + found[1] + moments


def moved_parameters(
    model: Candidate, draws: Array | None, variance: float, noise: Whitener | None = None
) -> dict[str, float]:
    """How far what is not known of the input moves each free parameter; nothing where it does not.

    The root mean square of what parameters, sensor zeros and initial states together make up for of
    the draws, in the internal coordinates of the problem; what these logs do not show is known by a
    prior, to a factor of 4.5, for no draw tells more of it. The residuals tell errors as noise that
    is alike throughout makes them. That of a course which is not known where it bends lies where
    inertia and damping act.

    Parameters
    ----------
    model, variance
        As in `input_noise`.
    draws
        From `unknown_input`.
    noise
        That under which the model is at its optimum; None for white noise.
    """
    if draws is None:
        return {}
    slopes, moved = _slopes(model), draws.T
    if not (np.isfinite(slopes).all() and np.isfinite(moved).all()):  # it runs away
        return {}
    if noise is not None:
        slopes, moved = (_shrunk(model, columns, noise) for columns in (slopes, moved))
    free = model.problem.free
    known = np.zeros((len(free), slopes.shape[1]))
    known[:, : len(free)] = np.diag([variance**0.5 / prior_sd(model, k) for k in range(len(free))])
    moved = np.linalg.lstsq(
        np.vstack((slopes, known)), np.pad(moved, ((0, len(free)), (0, 0))), rcond=None
    )[0]
    return dict(zip(free, np.sqrt(np.mean(moved**2, axis=1)).tolist(), strict=False))


def errors_in_fit(model: Candidate, gauges: Mapping[str, GaugeErrors]) -> InputErrors:
    """Those of the input that count in the errors of a model's parameters.

    A motion without a spring adds up what a force is off for the whole log: draws of its noise then
    leave far more than the recorded one, and say nothing of it.

    Parameters
    ----------
    model
        A fit.
    gauges
        As in `input_noise`.
    """
    return left_input_errors(model.problem.logs, gauges) if model.has_spring else NO_INPUT_ERRORS


def left_input_errors(logs: Iterable[Log], gauges: Mapping[str, GaugeErrors]) -> InputErrors:
    """What averaging leaves of the noise of each log's input, and what rounding hides of it.

    Parameters
    ----------
    logs
        Logs whose input was averaged.
    gauges
        As in `input_noise`.
    """
    recorded = [log.as_recorded for log in logs]
    shifts = [_left_of(log, gauges.get(log.name, NO_ERRORS)) for log in recorded]
    drawn = [shift.__getitem__ if shift.any() else None for shift in shifts]
    return InputErrors([log.time_s for log in recorded], drawn, is_averaged=True)


def unsure_parameters(
    model: Candidate, gauges: Mapping[str, GaugeErrors], sigma: Mapping[str, float]
) -> dict[str, float]:
    """Standard deviations of the free parameters that noise of the input makes larger.

    As `with_input_errors` has them, but none larger than the factor of 4.5 to which a prior knows
    it.

    Parameters
    ----------
    model, gauges
        As in `input_noise`.
    sigma
        Output channel → scale that its residual is divided by.
    """
    problem, optimum = model.problem, optimum_of(model, sigma)
    told = errors_of(problem, optimum).covariance
    if told is None:
        return {}
    errors = errors_in_fit(model, gauges)
    wider, found = with_input_errors(told, problem, optimum, errors), {}
    for k, name in enumerate(problem.free):
        row = told.names.index(name) if name in told.names else None
        sd, wide = (None, None) if row is None else (told.sd[row], wider.sd[row])
        if sd is not None and wide is not None and wide > sd:
            found[name] = min(wide, max(sd, prior_sd(model, k)))
    return found


def _shrunk(model: Candidate, columns: Array, noise: Whitener) -> Array:
    """Columns at the used samples of the first output, with what unknown numbers move shrunk."""
    own = [row for row in rows_of(model) if row.channel == model.problem.outputs[0]]
    each = np.split(columns, np.cumsum([row.residual.size for row in own])[:-1])
    return np.vstack([noise.shrunk(part, row.place) for part, row in zip(each, own, strict=True)])


def _unknown(
    model: Candidate, gauges: Mapping[str, GaugeErrors], variance: float
) -> tuple[Array, Array] | None:
    """Draws of the noise's and of the course's part, each of shape (D, m) or (1, 1)."""
    course = np.zeros((1, 1))
    noise = _of_noise(model, gauges)
    first = _of_courses(model, (0,))
    if np.mean(first**2) > LEAST_COURSE * variance:
        course = np.vstack((first, _of_courses(model, range(1, DRAWS))))
    return (noise, course) if noise.any() or course.any() else None


def _slopes(model: Candidate) -> Array:
    """Derivatives of the first output at its used samples by all unknowns, shape (m, U)."""
    first = model.problem.outputs[0]
    return np.concatenate([row.jacobian for row in rows_of(model) if row.channel == first])


def takes_input_noise_at_most(
    before: Candidate, after: Candidate, gauges: Mapping[str, GaugeErrors]
) -> bool:
    """Whether a cause takes away no more than what is not known of the input leaves anyway.

    Friction that holds a motion still also holds it against the noise of a gauge, which no
    actuator feels.

    Parameters
    ----------
    before, after
        The models without and with the cause.
    gauges
        As in `input_noise`.
    """
    left, behind = (mean_square(residual_context(model)) for model in (before, after))
    driven = input_noise(before, gauges, behind)
    return driven is not None and left - behind <= driven.variance


def _of_courses(model: Candidate, draws: Sequence[int]) -> Array:
    """Changes of the first output at its used samples with other courses, shape (D, m)."""
    problem, first = model.problem, model.problem.outputs[0]
    used = np.concatenate([s.samples_of(s.used[first]) for s in problem.segments])
    moved = moved_by_courses(model, draws, without_jumps=True)
    return np.array([np.concatenate(parts)[used] for parts in moved])


def _of_moments(model: Candidate, variance: float) -> Array:
    """Changes of the first output at its used samples with draws of moments, shape (D, m)."""
    problem, first = model.problem, model.problem.outputs[0]
    rng, moved = np.random.default_rng(SEED), []
    for k, segment in enumerate(problem.segments):
        columns = part_of_jumps(model, k, noise=variance**0.5)
        columns = columns[segment.samples_of(segment.used[first])]
        moved.append(rng.standard_normal((DRAWS, columns.shape[1])) @ columns.T)
    return np.hstack(moved)


def _of_noise(model: Candidate, gauges: Mapping[str, GaugeErrors]) -> Array:
    """Changes of the first output at its used samples with draws of the noise, shape (D, m).

    Of shape (1, 1) without any.
    """
    problem, first = model.problem, model.problem.outputs[0]
    errors = left_input_errors(problem.logs, gauges)
    if not errors.are_there:
        return np.zeros((1, 1))
    still = [simulated(model, k, segment) for k, segment in enumerate(problem.segments)]

    def moved(draw: int) -> Array:
        moves, stirred = [], errors.added(problem, draw, 1.0)
        for k, (segment, before) in enumerate(zip(stirred, still, strict=True)):
            change = simulated(model, k, segment) - before
            moves.append(change[segment.samples_of(segment.used[first])])
        return np.concatenate(moves)

    return np.array(in_parallel(moved, range(DRAWS)))


def _left_of(log: Log, gauge: GaugeErrors) -> Array:
    """What is left of draws of a log's noise behind the averaging, and of its rounding.

    Shape (D, n), or (1, 1) without any.
    """
    known = _LEFT.get(log)
    if known is None or known[0] is not gauge:
        left = np.zeros((1, 1))
        if gauge.are_there:
            left = np.array(in_parallel(lambda draw: _left(log, gauge, draw), range(DRAWS)))
        _LEFT[log] = known = (gauge, left)
    return known[1]


def _left(log: Log, gauge: GaugeErrors, draw: int) -> Array:
    """What is left of one draw, shape (n,)."""
    channel, rng = log.channels[log.input], np.random.default_rng((SEED, draw))
    noise = gauge.sd * rng.standard_normal(len(log))
    channels = {**log.channels, log.input: replace(channel, values=channel.values + noise)}
    noisy = without_input_noise(replace(log, channels=channels))
    left: Array = noisy.channels[log.input].values - channel.values
    return left + gauge.rounding(log.time_s, rng) if gauge.step > 0.0 else left
