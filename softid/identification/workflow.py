"""The fit from logs to result."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from softid.errors import IdentificationError, Issue, UsageError
from softid.fitters.output_error import output_error
from softid.fitters.problem import Problem
from softid.given_values import require_whole
from softid.identification.assembly import OptimisedProblem, assemble
from softid.identification.dropped_terms import DroppedTerm, dropped_term
from softid.identification.input_errors import InputErrors
from softid.identification.input_treatment import taken_as_fitted
from softid.identification.intersample_choice import (
    BETTER_BY,
    Explained,
    as_held,
    as_smooth,
    explains_better,
    held_choices,
    with_bends_told,
)
from softid.identification.issues import fitted_range, most_serious_first, require_explained
from softid.identification.model_selection import ModelChoice, choose_model
from softid.identification.parameter_constraints import ParameterConstraints
from softid.identification.preparation import (
    adapted_model,
    as_log_set,
    as_logs,
    named_model,
    require_channels,
    require_excitation,
    require_outputs,
    require_same_units,
    same_stretch,
    with_faults_told,
    without_dropouts,
)
from softid.identification.repeated_input import without_repeats
from softid.identification.response_sign import falls_with_input, opposed
from softid.identification.slow_outputs import at_readings
from softid.identification.tied_parameters import require_room_of_ties, require_tied_starts
from softid.identification.unit_slips import unit_slips
from softid.intersample import HELD
from softid.log import Log, LogSet
from softid.models.base import Model
from softid.parallel import matrices_on_one_thread
from softid.parameters import ParameterSet
from softid.results import FitResult

if TYPE_CHECKING:
    import lmfit

Array = npt.NDArray[np.float64]
Progress = Callable[[str, float], None]


SEEN = 0.9
"""Where the simpler model leaves so much more that the one with a term leaves this share of it, the
samples do show the term: an input that changes between them shows a swing quicker than they are."""


@matrices_on_one_thread()
def fit(
    logs: Log | Sequence[Log],
    *,
    model: Model | str | None = None,
    preferred: Sequence[Model | str] = (),
    hold_out: Log | Sequence[Log] = (),
    parameters: ParameterSet | lmfit.Parameters | None = None,
    seed: int = 0,
    progress: Progress | None = None,
) -> FitResult:
    """Identify a model from one or several logs by simultaneous output error.

    Minimises Σ (y − ŷ)²/σ² over all logs and outputs at once, with the sensor zero of every log and
    the initial state of every segment that does not start at rest estimated alongside. Starts come
    from the data alone.

    Parameters
    ----------
    logs
        Logs to fit.
    model
        A model, its name, or None to let blocks that are left out of the fit decide.
    preferred
        Without a model: models or names to be compared first, such as one with the user's
        geometry; any other must predict 5 % better.
    hold_out
        One log or several that are scored and not fitted; only their zero and initial state are
        estimated.
    parameters
        Bounds, fixed values, ties and start values, as a `ParameterSet` or lmfit ``Parameters``
        (which may name only some) of the named model.
    seed
        Seed of the perturbed restarts.
    progress
        Called with a sentence and the fraction done.

    Returns
    -------
    FitResult
        Its ``success`` is False when the optimum was not reached; its issues come most serious
        first.

    Raises
    ------
    InputError
        The logs cannot identify anything: constant input, dead output.
    UsageError
        The model is unknown or does not link the channels, the logs' roles or units differ,
        parameters are given without a model, a tie leaves its bounds wherever the search begins, or
        an argument is not what it has to be.
    IdentificationError
        The samples are too few, the output does not follow the input, or the best fit lies beyond a
        bound of a tied parameter.

    Examples
    --------
    >>> t = np.arange(0.0, 8.0, 0.02)
    >>> u = np.where(t % 4 < 2, 0.0, 100.0)
    >>> y = np.zeros_like(t)
    >>> for k in range(1, t.size):
    ...     y[k] = y[k - 1] + 0.02 / 0.3 * (0.01 * u[k - 1] - y[k - 1])
    >>> log = Log.from_arrays(t, {"pressure": u, "angle": y})
    >>> fit(log, model="oscillator").success
    True
    """
    seed = require_whole(seed, least=0, where="seed")
    identified = identify(
        logs,
        model=model,
        hold_out=hold_out,
        parameters=parameters,
        preferred=preferred,
        seed=seed,
        progress=progress,
    )
    if progress is not None:
        progress("computing errors", 0.95)
    found = assemble(
        identified.found,
        identified.logs,
        identified.hold_out,
        choice=identified.choice,
        seed=seed,
        input_errors=InputErrors.as_recorded(identified.logs),
    )
    signs = opposed(identified.logs, identified.hold_out)
    require_explained(found, identified.logs, signs)
    told = (*signs, *_slips(identified, found), *found.issues)
    return replace(found, issues=most_serious_first(told))


def _slips(identified: Identification, found: FitResult) -> tuple[Issue, ...]:
    """Wrong units of what is held out."""
    rows = [row for row in found.statistics if row.in_sample and row.channel == found.outputs[0]]
    return unit_slips(
        identified.found.problem.model,
        found.values,
        identified.hold_out,
        usual=max(row.nrmse for row in rows),
    )


@dataclass(frozen=True, eq=False)
class Identification:
    """A finished optimisation with the logs it belongs to.

    Attributes
    ----------
    found
        Problem and optimum.
    logs, hold_out
        Fitted and held-out logs, drop-outs taken out.
    choice
        How the model was chosen, if softid chose it.
    """

    found: OptimisedProblem
    logs: LogSet
    hold_out: tuple[Log, ...]
    choice: ModelChoice | None


def identify(
    logs: Log | Sequence[Log],
    *,
    model: Model | str | None = None,
    hold_out: Log | Sequence[Log] = (),
    parameters: ParameterSet | lmfit.Parameters | None = None,
    preferred: Sequence[Model | str] = (),
    seed: int = 0,
    thorough: bool = True,
    moving: bool = False,
    progress: Progress | None = None,
) -> Identification:
    """Find the optimum of `fit`, without errors and scores.

    Parameters
    ----------
    logs, model, hold_out, parameters, preferred, seed, progress
        As in `fit`.
    thorough
        Whether a motion that rings is looked for where the residual has structure.
    moving
        Whether softid may choose among models with a motion only.

    Raises
    ------
    InputError, UsageError, IdentificationError
        As `fit`.
    """
    cleaned = tuple(with_faults_told(without_dropouts(log)) for log in as_log_set(logs))
    cleaned_held = tuple(without_dropouts(log) for log in as_logs(hold_out))
    recorded, recorded_held = _at_readings(cleaned), _at_readings(cleaned_held)
    whole = [without_repeats(log) for log in cleaned]
    bridged = tuple(
        read if log is own else at_readings(log)
        for log, own, read in zip(whole, cleaned, recorded, strict=True)
    )
    log_set = LogSet(as_smooth(bridged))
    held = _at_readings(without_repeats(log) for log in cleaned_held)
    require_outputs(held)
    _require_new(log_set, held)
    if model is None and parameters is not None:
        raise UsageError(
            "parameters have no meaning before the model is chosen",
            remedy="name the model with --model (model= in Python)",
        )
    require_same_units(LogSet((*log_set, *held)))
    require_excitation(log_set)
    report = progress or (lambda message, fraction: None)
    rng = np.random.default_rng(seed)
    choice = starts = None
    if model is None:
        report("choosing the model", 0.0)
        inverted = falls_with_input(log_set, rng=rng)
        choice = choose_model(log_set, inverted=inverted, preferred=preferred, moving=moving)
        adapted, starts = choice.model, choice.starts or None
        constraints = ParameterConstraints.of(adapted.parameters(), None)
    else:
        named = named_model(model)
        constraints = ParameterConstraints.of(named.parameters(), parameters)
        require_channels(named, log_set)
        adapted = adapted_model(named, log_set, inverted=falls_with_input(log_set, rng=rng))
    optimise = partial(
        _identify, adapted, rng=rng, report=report, chosen=model is None, thorough=thorough
    )
    found = optimise(log_set, constraints, starts)
    taken, own = log_set, None
    is_finite = np.isfinite(found.optimum.cost)
    for other in _with_other_intersamples(log_set, bridged, recorded) if is_finite else ():
        own = own or Explained(found.problem, found.optimum)
        if explains_better(own, other):
            taken, own = other, None
            found = optimise(taken, constraints, starts)
        elif _is_straight(other) and not explains_better(own, other, -BETTER_BY):
            taken = with_bends_told(taken)
    require_room_of_ties(found.problem, found.optimum)
    intersample = taken.logs[0].intersample
    if intersample is not None:
        problem, unknowns = found.problem, found.optimum.unknowns
        judges = recorded_held if intersample in HELD else held
        held = taken_as_fitted(judges, intersample, problem.model, problem.values(unknowns))
    return Identification(found, taken, held, choice)


def _at_readings(logs: Iterable[Log]) -> tuple[Log, ...]:
    return tuple(at_readings(log) for log in logs)


def _with_other_intersamples(
    taken: LogSet, bridged: Sequence[Log], recorded: Sequence[Log]
) -> Iterator[LogSet]:
    """The logs with other intersample behaviours; a held one is held as it was recorded."""
    if any(log.intersample != own.intersample for log, own in zip(taken, bridged, strict=True)):
        yield LogSet(tuple(log.with_intersample("straight") for log in bridged))
    for intersample in held_choices(recorded):
        yield LogSet(as_held(recorded, intersample))


def _is_straight(logs: LogSet) -> bool:
    return logs.logs[0].intersample == "straight"


def _require_new(logs: LogSet, held: Sequence[Log]) -> None:
    """Refuse what breaks the rules of a set over both, and samples that count twice."""
    LogSet((*logs, *held))
    fitted = logs.logs
    for k, log in enumerate((*fitted, *held)):
        for known in fitted[:k]:
            if same_stretch(log, known):
                raise UsageError(
                    f"this log holds the same samples as {known.name}, which is fitted",
                    where=log.place,
                    remedy="give each log once" if k < len(fitted) else "hold out one not fitted",
                )


def _identify(
    model: Model,
    logs: LogSet,
    constraints: ParameterConstraints,
    starts: Sequence[Mapping[str, float]] | None,
    *,
    rng: np.random.Generator,
    report: Progress,
    chosen: bool,
    thorough: bool,
) -> OptimisedProblem:
    """Fit, and continue with the model's limit while a term cannot be seen.

    Parameters
    ----------
    starts
        Start values if they are known already; None searches them in the data.
    chosen
        Whether softid chose the model, so that the user named none.
    """
    overlaid = constraints.over(model.parameters())
    problem = Problem(model, overlaid, logs.logs)
    _require_samples(problem, logs, chosen=chosen)
    if starts is None:
        guesses = model.guess(problem.plain_segments, logs.outputs[0])
        starts = [guess.values_dict() for guess in guesses]
    begins = constraints.starts(overlaid, starts)
    require_tied_starts(problem, begins)
    optimum = output_error(problem, begins, rng=rng, thorough=thorough, progress=report)
    period_s = float(np.median([log.period_s for log in logs]))
    input_range = fitted_range(logs)[logs.input]
    longest_s = max(float(np.ptp(log.time_s)) for log in logs)
    unseen: dict[str, str] = {}
    terms: list[DroppedTerm] = []
    while np.isfinite(optimum.cost):
        theta = problem.theta(optimum.unknowns)
        values = dict(zip(problem.parameters.names, theta.tolist(), strict=True))
        limit_at = partial(
            problem.model.limit,
            period_s=period_s,
            input_range=input_range,
            longest_s=longest_s,
        )
        simpler = limit_at(theta)
        if simpler is None:
            break
        limit, reason = simpler
        dropped = set(problem.free) - set(limit.parameters().free)
        if not dropped or constraints.keep(dropped):
            break
        overlaid = constraints.over(limit.parameters())
        values |= {n: p.value for n, p in overlaid.items() if p.fixed}
        without = Problem(limit, overlaid, logs.logs)
        found = output_error(without, [values], rng=rng, thorough=thorough, progress=report)
        if without.size < problem.size and optimum.cost < SEEN * found.cost:
            break
        unseen |= dict.fromkeys(dropped, reason)
        is_seen = partial(_is_seen, limit_at, limit)
        terms.append(dropped_term(problem, optimum, dropped, is_seen))
        problem, optimum = without, found
    return OptimisedProblem(problem, optimum, unseen, constraints, tuple(terms))


def _is_seen(
    limit_at: Callable[[Array], tuple[Model, str] | None], limit: Model, theta: Array
) -> bool:
    """Whether these parameters need more than a limit of the model."""
    found = limit_at(theta)
    return found is None or found[0] != limit


def _require_samples(problem: Problem, logs: LogSet, *, chosen: bool) -> None:
    if problem.n_samples <= problem.size:
        raise IdentificationError(
            f"{problem.n_samples} samples cannot tell the {problem.size} unknowns of the "
            f"{problem.model.name} model",
            where=", ".join(log.place for log in logs),
            remedy="record longer, or name a simpler model with --model (model= in Python)"
            if chosen
            else "record longer, fix parameters, or choose a simpler --model (model= in Python)",
        )
