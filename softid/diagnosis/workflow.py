"""The verb `diagnose`: what the simulation gets wrong, the cause, the extended model, the gain."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from softid.diagnosis.base.base_fit import (
    BaseFit,
    Progress,
    Recordings,
    Request,
    require_driven,
    require_enough,
    require_moving,
)
from softid.diagnosis.base.intersample_selection import (
    is_measured,
    is_open,
    recordings_with_intersample,
)
from softid.diagnosis.base.judged_intersample import with_judged_intersample
from softid.diagnosis.base.reduced_base import reduced_if_better
from softid.diagnosis.base.spikes import without_spikes
from softid.diagnosis.best_answer import best_answer
from softid.diagnosis.completion import Circumstances, completed
from softid.diagnosis.logs.decimation import decimated, samples_to_average
from softid.diagnosis.logs.moving_start import without_moving_start
from softid.diagnosis.refit.characteristic_scales import fastest_time
from softid.diagnosis.report.other_explanations import OtherExplanations
from softid.diagnosis.residual.motion import mean_square, residual_context
from softid.diagnosis.resumption import resumable
from softid.diagnosis.searches.cause_search import CauseSearch
from softid.diagnosis_results import Diagnosis
from softid.effects import effects_of
from softid.errors import InputError
from softid.fitters.levenberg_marquardt import cautiously
from softid.given_values import require_names, require_whole
from softid.identification.gauge_errors import gauge_errors
from softid.identification.input_denoising import without_input_noise
from softid.identification.intersample_choice import choice_unless_held
from softid.identification.lost_input import without_lost_input
from softid.identification.preparation import as_log_set, as_logs, without_dropouts
from softid.identification.repeated_input import without_repeats
from softid.identification.slow_outputs import at_readings
from softid.identification.stalls import across_stalls
from softid.identification.unit_slips import unit_slips
from softid.log import Log, LogSet
from softid.models.base import Model
from softid.parallel import in_step, is_copy, matrices_on_one_thread
from softid.parameters import ParameterSet
from softid.records.checkpoint import GOES_ON

if TYPE_CHECKING:
    import lmfit


def diagnose(
    logs: Log | Sequence[Log],
    *,
    hold_out: Log | Sequence[Log] = (),
    model: Model | str | None = None,
    parameters: ParameterSet | lmfit.Parameters | None = None,
    preferred: Sequence[Model | str] = (),
    effects: Sequence[str] = (),
    seed: int = 0,
    progress: Progress | None = None,
    checkpoint: str | Path | None = None,
) -> Diagnosis:
    """Name the physical cause of what a model gets wrong, and measure what mending it gains.

    The base model is fitted. Every effect of the catalogue is then screened by its signature,
    refitted together with the base in a race, and compared by the BIC of residuals that one noise
    model has made white. Causes are added while that pays and the held-out error does not rise.
    What is left is compared with the noise and with chance, and decides the verdict.

    Parameters
    ----------
    logs
        Logs to explain.
    hold_out
        Logs that judge; without them contiguous blocks of the logs are held out.
    model
        Base model, its name, or None to choose.
    parameters
        Bounds, fixed values, ties and start values of the named model.
    preferred
        Without a model: as in `softid.fit`.
    effects
        Keys of the effects to consider; empty for the whole catalogue.
    seed
        Seed of restarts, and of the shifts that say what chance would make.
    progress
        Called with a sentence and the fraction done.
    checkpoint
        A file that keeps what is found after the first seconds. An interrupted diagnosis that is
        asked for again, with the same file and arguments, goes on from there; a file of others is
        begun anew. It is removed at the end, takes up to 4 GB, and is as trusted as a program, so
        it belongs where only you may write. Where it cannot be written, as on Windows, none is
        kept.

    Returns
    -------
    Diagnosis
        The verdict with its evidence.

    Raises
    ------
    InputError, UsageError, IdentificationError
        As `softid.fit`; besides, an effect is unknown, ``checkpoint`` is another file, the model is
        static, the logs have too few samples to tell a cause from noise, their input does not move
        beyond its own, or what is held out does not move or is given in another unit than it was
        recorded in.

    Examples
    --------
    >>> from softid.synthesis import hidden_pair
    >>> train, hold_out = hidden_pair(["sensor_drift"], seed=7).logs
    >>> found = diagnose(train, hold_out=[hold_out], model="muscle", effects=["sensor_drift"])
    >>> found.verdict.value, [cause.effect for cause in found.causes]
    ('named', ['sensor_drift'])
    """
    arguments: dict[str, Any] = {
        "logs": logs,
        "hold_out": hold_out,
        "model": model,
        "parameters": parameters,
        "preferred": preferred,
        "effects": effects,
        "seed": seed,
    }
    with resumable(checkpoint, arguments) as goes_on:
        if goes_on and progress is not None:
            progress(GOES_ON, 0.0)
        return _diagnosed(**arguments, progress=progress)


@matrices_on_one_thread()
@cautiously()
@in_step()
def _diagnosed(
    logs: Log | Sequence[Log],
    *,
    hold_out: Log | Sequence[Log],
    model: Model | str | None,
    parameters: ParameterSet | lmfit.Parameters | None,
    preferred: Sequence[Model | str],
    effects: Sequence[str],
    seed: int,
    progress: Progress | None,
) -> Diagnosis:
    """See `diagnose`."""
    report = _rising(progress)
    seed = require_whole(seed, least=0, where="seed")
    considered = effects_of(require_names(effects, where="effects"))
    recorded = as_log_set(logs)
    is_in_doubt = is_open(recorded)
    cleaned = _cleaned(recorded, as_logs(hold_out))
    require_enough(cleaned.logs, cleaned.hold_out)
    require_moving(cleaned.logs, cleaned.hold_out)
    require_driven(recorded)
    request = Request(
        model,
        parameters,
        seed,
        lambda m, fraction: report(m, 0.3 * fraction),
        preferred=preferred,
        gauges={log.name: gauge_errors(log) for log in (*as_logs(hold_out), *recorded)},
        is_intersample_open=is_in_doubt,
    )
    recordings, chosen, averaged = _prepared(cleaned, request)
    if is_in_doubt:
        recordings, chosen = with_judged_intersample(recordings, request, chosen)
    request, chosen = reduced_if_better(recordings, request, chosen)
    search = CauseSearch(chosen, considered, seed, report)
    others = OtherExplanations()
    answer, base, chain = best_answer(recordings, request, search, others, is_in_doubt=is_in_doubt)
    case = Circumstances(
        recorded=recorded,
        cleaned=cleaned.logs,
        averaged=averaged,
        request=request,
        asked_for=effects,
        effects=search.effects,
        chosen=chosen,
        base=base,
        chain=chain,
        others=others,
    )
    return completed(answer, case)


def _cleaned(recorded: LogSet, hold_out: tuple[Log, ...]) -> Recordings:
    """The logs as they are fitted, averaged and judged by: a drop-out must be in none of the three.

    A measured input is taken to do between its samples what it usually does.
    """
    cleaned = Recordings(recorded, hold_out).each(_without_faults)
    if not is_measured(recorded):
        return cleaned
    usual = choice_unless_held(recorded)
    return cleaned.each(lambda log: log.with_intersample(usual))


def _without_faults(log: Log) -> Log:
    return at_readings(without_dropouts(without_input_noise(without_repeats(log))))


def _prepared(recordings: Recordings, request: Request) -> tuple[Recordings, BaseFit, int]:
    """The cleaned and averaged logs, their base fit, and how many samples were averaged.

    Cleaning and averaging need a fit that knows how long the actuator remembers.

    Raises
    ------
    InputError
        What is held out is given in another unit than it was recorded in.
    """
    base = request.fit_base(recordings.logs, recordings.hold_out, thorough=False)
    _require_units(base, recordings.hold_out)
    steady = without_spikes(recordings, base)
    if steady is not recordings:
        recordings = steady
        base = request.fit_base(recordings.logs, recordings.hold_out, thorough=False)
    problem = base.candidate.problem
    values = base.candidate.parameters
    kept = recordings.each(partial(across_stalls, model=problem.model, values=values))
    kept = kept.each(partial(without_lost_input, model=problem.model, values=values))
    fastest_s = fastest_time(problem, base.candidate.minimum.point)
    count = samples_to_average(
        (*recordings.logs, *recordings.hold_out), min(base.scale.motion_s, fastest_s)
    )
    if count > 1:
        if kept.logs.logs[0].intersample is None:
            kept = recordings_with_intersample(
                kept, base.candidate.problem.logs[0].effective_intersample
            )
        kept = kept.each(partial(decimated, count=count))
    if base.candidate.has_spring:  # without one there is no rest, and no beginning is forgotten
        states = len(problem.model.start_states)
        kept = kept.each(partial(without_moving_start, motion_s=base.scale.motion_s, states=states))
    if kept is not recordings:
        base = request.fit_base(kept.logs, kept.hold_out, thorough=False)
    return kept, base, count


def _require_units(base: BaseFit, hold_out: Sequence[Log]) -> None:
    """Refuse logs to judge by that are given in another unit than they were recorded in.

    Raises
    ------
    InputError
        The base explains one of them in another unit, and not as it stands.
    """
    problem = base.candidate.problem
    first = problem.outputs[0]
    spread = np.std(np.concatenate([s.outputs[first][s.used[first]] for s in problem.segments]))
    left = mean_square(residual_context(base.candidate)) ** 0.5
    usual = left / max(float(spread), np.finfo(float).tiny)
    slips = unit_slips(problem.model, base.candidate.parameters, hold_out, usual=usual)
    if slips:
        raise InputError(slips[0].message, remedy=slips[0].remedy)


def _rising(progress: Progress | None) -> Progress:
    """The callback with fractions that never fall, though a second search begins anew."""
    most = 0.0

    def report(message: str, fraction: float) -> None:
        nonlocal most
        most = max(most, fraction)
        if progress is not None and not is_copy():
            progress(message, most)

    return report
