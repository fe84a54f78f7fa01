"""The verb `diagnose`: what the simulation gets wrong, the cause, the extended model, the gain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from softid.arguments import require_names, require_seed
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
from softid.diagnosis.cause_search import CauseSearch
from softid.diagnosis.logs.decimation import decimated, samples_to_average
from softid.diagnosis.logs.moving_start import without_moving_start
from softid.diagnosis.logs.permanent_set import permanent_set_issues
from softid.diagnosis.plainer_model import plainer_model_issues
from softid.diagnosis.refit.characteristic_scales import fastest_time
from softid.diagnosis.report.clipped_input import with_clipped_input
from softid.diagnosis.report.coarse_sampling import with_coarse_sampling
from softid.diagnosis.report.held_excitation import held_experiments, with_advice_lacking
from softid.diagnosis.report.issues import (
    averaging_issues,
    input_noise_issues,
    jump_issues,
    negligible_issues,
    restriction_issues,
)
from softid.diagnosis.report.joint_causes import (
    joint_cause_issues,
    with_open_places,
    with_shared_scale,
)
from softid.diagnosis.report.motion_shown import motion_shown_issues
from softid.diagnosis.report.no_response import with_no_response
from softid.diagnosis.report.other_explanations import (
    OtherExplanations,
    with_event_beside,
    with_law_beside,
    with_other_explanations,
)
from softid.diagnosis.report.parameter_doubts import with_unnamed_misfit, with_varying_sizes
from softid.diagnosis.report.readings import reading_issues
from softid.diagnosis.report.rounding import with_rounding
from softid.diagnosis.report.second_input import with_second_input
from softid.diagnosis.report.summary import write_summary
from softid.diagnosis.residual.motion import mean_square, residual_context
from softid.diagnosis.verdict.sample_errors import with_sample_remainder
from softid.diagnosis_results import Diagnosis
from softid.effects import effects_of
from softid.errors import InputError
from softid.identification.gauge_errors import gauge_errors
from softid.identification.input_denoising import without_input_noise
from softid.identification.intersample_choice import choice_unless_held
from softid.identification.lost_input import without_lost_input
from softid.identification.preparation import as_log_set, as_logs, without_dropouts
from softid.identification.repeated_input import without_repeats
from softid.identification.slow_outputs import at_readings
from softid.identification.stalls import across_stalls
from softid.identification.unit_slips import unit_slips
from softid.intersample import AVERAGED
from softid.log import Log, LogSet
from softid.models.base import Model
from softid.parallel import both, in_step, is_copy, matrices_on_one_thread
from softid.parameters import ParameterSet
from softid.results import FitResult

if TYPE_CHECKING:
    import lmfit


@matrices_on_one_thread()
@in_step()
def diagnose(
    logs: Log | Sequence[Log],
    *,
    hold_out: Log | Sequence[Log] = (),
    model: Model | str | None = None,
    parameters: ParameterSet | lmfit.Parameters | None = None,
    preferred: Sequence[Model] = (),
    effects: Sequence[str] = (),
    seed: int = 0,
    progress: Progress | None = None,
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

    Returns
    -------
    Diagnosis
        The verdict with its evidence.

    Raises
    ------
    InputError, UsageError, IdentificationError
        As `softid.fit`; besides, an effect is unknown, the model is static, the logs have too few
        samples to tell a cause from noise, their input does not move beyond its own, or what is
        held out does not move or is given in another unit than it was recorded in.

    Examples
    --------
    >>> from softid.synthesis import hidden_pair
    >>> train, hold_out = hidden_pair(["sensor_drift"], seed=7).logs
    >>> found = diagnose(train, hold_out=[hold_out], model="muscle", effects=["sensor_drift"])
    >>> found.verdict.value, [cause.effect for cause in found.causes]
    ('named', ['sensor_drift'])
    """
    report, seed = _rising(progress), require_seed(seed)
    considered = effects_of(require_names(effects, where="effects"))
    recorded = as_log_set(logs)
    is_in_doubt = is_open(recorded)
    recordings = _recordings(recorded, as_logs(hold_out))
    require_enough(recordings.logs, recordings.hold_out)
    require_moving(recordings.logs, recordings.hold_out)
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
    whole, (recordings, base, count) = recordings.logs, _prepared(recordings, request)
    if is_in_doubt:
        recordings, base = with_judged_intersample(recordings, request, base)
    request, base = reduced_if_better(recordings, request, base)
    search, chosen = CauseSearch(base, considered, seed, report), base
    others = OtherExplanations()
    answer, base, final = best_answer(recordings, request, search, others, is_in_doubt=is_in_doubt)
    answer = with_other_explanations(answer, base, others)
    answer = with_second_input(answer, base, recorded.logs, seed)
    answer = with_law_beside(with_event_beside(answer, base, final), base, final, search.effects)
    answer = with_clipped_input(answer, recorded.logs)
    if count == 1:  # the mean of several samples lies between the steps
        rounded = with_rounding(answer, recorded, base.candidate)
        answer = with_coarse_sampling(rounded, base.candidate)
    unit = recorded.input_unit if base.candidate.problem.model.is_linear else None
    answer = with_open_places(with_shared_scale(answer, linear_in=unit))
    answer = with_no_response(with_unnamed_misfit(with_varying_sizes(answer)), final)
    has_spring = base.candidate.has_spring
    sets, motions = both(
        lambda: permanent_set_issues(whole, base.scale.motion_s) if has_spring else (),
        lambda: motion_shown_issues(base, answer),
    )
    issues = (
        *negligible_issues(base),
        *plainer_model_issues(chosen, base),
        *restriction_issues(effects),
        *averaging_issues(count),
        *sets,
        *motions,
        *jump_issues(answer.remainder, base.candidate.problem),
        *input_noise_issues(answer.remainder, base.candidate.problem, request.gauges),
        *joint_cause_issues(answer),
        *reading_issues(answer),
    )
    answer = replace(
        answer,
        base=_with_input_treatment(answer.base),
        extended=answer.extended and _with_input_treatment(answer.extended),
        issues=(*answer.issues, *issues),
    )
    return _in_words(answer, recorded, count)


def _recordings(recorded: LogSet, held: tuple[Log, ...]) -> Recordings:
    """The cleaned logs, with what their input does between samples where it is measured."""
    recordings = Recordings(recorded, held).each(_cleaned)
    if not is_measured(recorded):
        return recordings
    usual = choice_unless_held(recorded)
    return recordings.each(lambda log: log.with_intersample(usual))


def _in_words(answer: Diagnosis, recorded: LogSet, count: int) -> Diagnosis:
    """The diagnosis with its paragraph, told per sample of the logs, and advice that they lack."""
    whole = with_sample_remainder(answer) if count > 1 else answer
    held = held_experiments(recorded)
    return write_summary(replace(whole, issues=with_advice_lacking(whole.issues, held)), held)


def _with_input_treatment(fit: FitResult) -> FitResult:
    """The fit whose record says how its input was taken, for those who take the model elsewhere."""
    return replace(fit, input_noise=AVERAGED)


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
        kept = kept.each(partial(decimated, count=count, keeps_jumps=True))
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


def _cleaned(log: Log) -> Log:
    """The log as it is fitted, averaged and judged by: a drop-out must be in none of the three."""
    return at_readings(without_dropouts(without_input_noise(without_repeats(log))))
