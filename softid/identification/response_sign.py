"""Whether an output falls as its input rises."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from softid.errors import Issue
from softid.fitters.objective import Objective
from softid.fitters.output_error import draft_fit, output_error
from softid.fitters.problem import Problem
from softid.identification.log_beginning import beginning
from softid.identification.preparation import units_of
from softid.kernels.filters import lag
from softid.log import Log, LogSet
from softid.long_series import joint_powers
from softid.models import MODELS
from softid.models.base import Model
from softid.segment import Segment

Array = npt.NDArray[np.float64]

CLEAR_CORRELATION = 0.5
"""Correlation from which on an output goes one way with the input, where logs are compared."""

UNDOUBTED = 0.9
"""Correlation from which on an output rises with the input: past its natural frequency an actuator
moves less and less. So it does where it goes so with the input behind a lag, with which one that
falls goes the less."""

TRIED_LAGS = 9
"""Lags behind which an output is looked at for rising with the input, from one sample to
`LONGEST_LAG` of the longest segment."""

LONGEST_LAG = 0.25
"""Longest lag behind which an output is looked at for rising with the input, as a share of the
longest segment: a step is then nearly done at its end."""

NO_RIVAL = 3.0
"""Where an output goes with the input so clearly, and the start values of a falling model leave so
many times the squares of those of a rising one, none of the two is fitted: under steps, ramps and
slow sines they leave 7 to 90 times as many, past the natural frequency of one that falls 0.1 to
1.2."""

TRIED_SAMPLES = 20_000
"""Samples at the beginning of a log that show in which direction its output goes."""

CLEARLY_LESS = 0.5
"""Share of the squares of the other model that one leaves which is clearly better: else both are
fitted further than to a draft. The falling one has to be where the correlation is positive, for
such an output lags by more than a quarter turn, and is not merely noisy."""

BASELINE = "oscillator"
"""The model with which both directions are tried: linear, quick, and it takes any channels."""


def falls_with_input(logs: LogSet, *, rng: np.random.Generator) -> bool:
    """Whether the first output falls as the input rises.

    The sign of the correlation is not enough: past its natural frequency any actuator moves against
    its input, and one that falls may then move with it. Unless nothing speaks for that, the
    oscillator is tried in both directions and the one that explains the logs better counts.

    Parameters
    ----------
    logs
        What is to be fitted.
    rng
        Draws the restarts where drafts do not decide.

    Examples
    --------
    >>> from softid.log import Log
    >>> t = np.arange(0.0, 8.0, 0.05)
    >>> u = np.where(t % 4 < 2, 0.0, 100.0)
    >>> log = Log.from_arrays(t, {"pressure": u, "length": 150.0 - 0.3 * u})
    >>> falls_with_input(LogSet((log,)), rng=np.random.default_rng(0))
    True
    """
    found = correlation(logs)
    if found == 0.0 or found >= UNDOUBTED:
        return False
    if found >= CLEAR_CORRELATION and _rises_behind_a_lag(logs):
        return False
    first = LogSet(tuple(log.with_roles(outputs=log.outputs[:1]) for log in logs))
    baseline: Model = MODELS[BASELINE]()
    rising, falling = (
        baseline.adapted(units_of(first), inverted=inverted) for inverted in (False, True)
    )
    if found >= CLEAR_CORRELATION:
        part = LogSet(tuple(beginning(log, TRIED_SAMPLES) for log in first))
        if _cost_of_start(falling, part) > NO_RIVAL * _cost_of_start(rising, part):
            return False
    costs = [_draft_cost(model, first) for model in (rising, falling)]
    if min(costs) > CLEARLY_LESS * max(costs):
        costs = [_fit_cost(model, first, rng) for model in (rising, falling)]
    share = 1.0 if found < 0.0 else CLEARLY_LESS
    return costs[1] <= share * costs[0]


def opposed(logs: LogSet, held: Sequence[Log]) -> tuple[Issue, ...]:
    """Logs whose first output goes the other way with the input than in the first clear one.

    Parameters
    ----------
    logs, held
        Fitted and held-out logs.
    """
    if len(logs) + len(held) < 2:
        return ()
    ways = [(log, correlation(LogSet((log,)))) for log in (*logs, *held)]
    clear = [(log, way) for log, way in ways if abs(way) >= CLEAR_CORRELATION]
    if not clear:
        return ()
    first, usual = clear[0]
    name = logs.outputs[0]
    goes = "rises" if usual < 0.0 else "falls"
    return tuple(
        Issue(
            "opposed-signs",
            "warning",
            f"{log.name}: {name} {goes} as {logs.input} rises, unlike in {first.name}",
            f"turn the sign of {name} in one of them",
        )
        for log, way in clear
        if way * usual < 0.0
    )


def correlation(logs: LogSet, *, lag_s: float = 0.0) -> float:
    """Correlation of the first output with the input, means taken per segment; 0 if still.

    Parameters
    ----------
    logs
        The logs.
    lag_s
        Time constant of a lag of first order behind the input, in s.
    """
    cross = inputs = outputs = 0.0
    for segment in (s for log in logs for s in log.segments()):
        used = segment.used[logs.outputs[0]]
        if used.sum() < 2:
            continue
        rows = slice(None) if used.all() else used
        u, y = _behind_lag(segment, lag_s), segment.outputs[logs.outputs[0]]
        products = joint_powers(u[rows], y[rows])
        cross, inputs, outputs = cross + products[0], inputs + products[1], outputs + products[2]
    if inputs == 0 or outputs == 0:
        return 0.0
    return cross / float(np.sqrt(inputs * outputs))


def _behind_lag(segment: Segment, lag_s: float) -> Array:
    if lag_s <= 0.0:
        return segment.input
    late = np.array(segment.input, np.float64)
    lag(np.diff(segment.time_s), late, lag_s, lag_s)
    return late


def _rises_behind_a_lag(logs: LogSet) -> bool:
    part = LogSet(tuple(beginning(log, TRIED_SAMPLES) for log in logs))
    segments = [segment for log in part for segment in log.segments()]
    shortest_s = min(log.period_s for log in part)
    longest_s = LONGEST_LAG * max(float(s.time_s[-1] - s.time_s[0]) for s in segments)
    tried_s = np.geomspace(shortest_s, max(longest_s, shortest_s), TRIED_LAGS).tolist()
    middle_first = sorted(range(TRIED_LAGS), key=lambda k: abs(k - TRIED_LAGS // 2))
    return any(correlation(part, lag_s=tried_s[k]) >= UNDOUBTED for k in middle_first)


def _cost_of_start(model: Model, logs: LogSet) -> float:
    """Sum of squares that the best start values of a model leave over."""
    problem = Problem(model, model.parameters(), logs.logs)
    starts = model.guess(problem.plain_segments, logs.outputs[0]) or (model.parameters(),)
    objective = Objective(problem, dict.fromkeys(problem.outputs, 1.0))
    return objective(problem.unknowns(starts[0].values_dict())).cost


def _draft_cost(model: Model, logs: LogSet) -> float:
    """Sum of squares that a draft of a fit leaves over."""
    return draft_fit(*_task(model, logs)).cost


def _fit_cost(model: Model, logs: LogSet, rng: np.random.Generator) -> float:
    """Sum of squares that a fit of the model leaves over."""
    return output_error(*_task(model, logs), rng=rng, rounds=1, thorough=False).cost


def _task(model: Model, logs: LogSet) -> tuple[Problem, Sequence[dict[str, float]]]:
    """What is to be fitted, and where to start."""
    problem = Problem(model, model.parameters(), logs.logs)
    guesses = model.guess(problem.plain_segments, logs.outputs[0]) or (model.parameters(),)
    return problem, [guess.values_dict() for guess in guesses]
