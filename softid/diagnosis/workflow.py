"""The verb `diagnose`: what the simulation gets wrong, the cause, the extended model, the gain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from softid.diagnosis.base.base_fit import BaseFit, Progress, Recordings, Request, require_enough
from softid.diagnosis.base.intersample_selection import (
    is_measured,
    is_open,
    reading_unless_held,
    recordings_read_as,
)
from softid.diagnosis.base.judged_intersample import read_as_judged
from softid.diagnosis.base.reduced_base import reduced_base_issues, reduced_if_better
from softid.diagnosis.cause_search import CauseSearch
from softid.diagnosis.logs.decimation import decimated, samples_to_average
from softid.diagnosis.logs.input_denoising import without_input_noise
from softid.diagnosis.logs.input_gaps import without_lost_input
from softid.diagnosis.logs.moving_start import without_moving_start
from softid.diagnosis.logs.permanent_set import permanent_set_issues
from softid.diagnosis.plainer_model import PlainerModels, plainer_model_issues
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.characteristic_scales import fastest_time
from softid.diagnosis.refit.optimum import optimum_of
from softid.diagnosis.report.changes import held_out_change_issues
from softid.diagnosis.report.coarse_sampling import with_coarse_sampling
from softid.diagnosis.report.issues import (
    averaging_issues,
    jump_issues,
    negligible_issues,
    refusal_issues,
    restriction_issues,
    unsure_issues,
)
from softid.diagnosis.report.joint_causes import joint_cause_issues
from softid.diagnosis.report.motion_shown import motion_shown_issues
from softid.diagnosis.report.other_explanations import (
    OtherExplanations,
    with_other_explanations,
)
from softid.diagnosis.report.rounding import with_rounding
from softid.diagnosis.report.summary import write_summary
from softid.diagnosis.residual.disturbances import disturbance_issues
from softid.diagnosis.residual.motion import residual_context
from softid.diagnosis.residual.parameter_constancy import variations
from softid.diagnosis.search.backward_revision import prefix_models, refit_without
from softid.diagnosis.search.forward_selection import Chain
from softid.diagnosis.search_result import SearchResult
from softid.diagnosis.strategy import search_causes, search_with_intersample
from softid.diagnosis.verdict.cause_results import (
    alternatives_of,
    causes_of,
    evidence_of,
    gains_of,
    told_as,
    whole_gain_of,
)
from softid.diagnosis.verdict.chain_consistency import consistent_names
from softid.diagnosis.verdict.doubts import with_doubts
from softid.diagnosis.verdict.gain_interval import gain_interval
from softid.diagnosis.verdict.law_rivals import with_rivals
from softid.diagnosis.verdict.naming import (
    gains_by,
    may_gain_nothing,
    verdict_of,
)
from softid.diagnosis.verdict.profile_intervals import with_intervals
from softid.diagnosis_results import Cause, Diagnosis, Remainder, Verdict
from softid.effects import effects_of
from softid.errors import Issue
from softid.identification.assembly import OptimisedProblem, assemble
from softid.identification.parameter_constraints import ParameterConstraints
from softid.identification.preparation import as_log_set, as_logs, without_dropouts
from softid.identification.repeated_input import without_repeats
from softid.identification.slow_outputs import at_readings
from softid.identification.workflow import Identification
from softid.log import Log
from softid.models.base import Model
from softid.parallel import matrices_on_one_thread
from softid.parameters import ParameterSet
from softid.results import FitResult

if TYPE_CHECKING:
    import lmfit

Array = npt.NDArray[np.float64]


@matrices_on_one_thread()
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
        Seed of restarts and of the bootstrap.
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
        samples to tell a cause from noise, or what is held out does not move.

    Examples
    --------
    >>> from softid.synthesis import hidden_pair
    >>> train, hold_out = hidden_pair(["sensor_drift"], seed=7).logs
    >>> found = diagnose(train, hold_out=[hold_out], model="muscle", effects=["sensor_drift"])
    >>> found.verdict.value, [cause.effect for cause in found.causes]
    ('named', ['sensor_drift'])
    """
    report = _rising(progress)
    recorded = as_log_set(logs)
    is_in_doubt = is_open(recorded)
    recordings = Recordings(recorded, as_logs(hold_out)).each(_cleaned)
    if is_measured(recorded):
        usual = reading_unless_held(recorded)
        recordings = recordings.each(lambda log: log.with_intersample(usual))
    require_enough(recordings.logs, recordings.hold_out)
    request = Request(
        model,
        parameters,
        seed,
        lambda m, fraction: report(m, 0.3 * fraction),
        preferred=preferred,
    )
    whole, (recordings, base, count) = recordings.logs, _prepared(recordings, request)
    if is_in_doubt:
        recordings, base = read_as_judged(recordings, request, base)
    request, base = reduced_if_better(recordings, request, base)
    search, chosen = CauseSearch(base, effects_of(effects), seed, report), base
    others = OtherExplanations()
    answer, base = _searched(recordings, request, search, others, is_in_doubt=is_in_doubt)
    answer = with_other_explanations(answer, base, others)
    if count == 1:  # the mean of several samples lies between the steps
        answer = with_rounding(answer, recorded, base.candidate)
        answer = with_coarse_sampling(answer, base.candidate)
    issues = (
        *negligible_issues(base),
        *plainer_model_issues(chosen, base),
        *restriction_issues(effects),
        *averaging_issues(count),
        *(permanent_set_issues(whole) if base.candidate.has_spring else ()),
        *motion_shown_issues(base, answer),
        *jump_issues(answer.remainder, base.candidate.problem),
        *joint_cause_issues(answer),
    )
    return write_summary(replace(answer, issues=(*answer.issues, *issues)))


def _searched(
    recordings: Recordings,
    request: Request,
    search: CauseSearch,
    others: OtherExplanations,
    *,
    is_in_doubt: bool,
) -> tuple[Diagnosis, BaseFit]:
    """The diagnosis over the model that the logs call for, with the base that it extends."""
    alone = search.explained_by_moments()
    if alone is not None:
        return _answer(search.base, alone, search.seed), search.base
    models = PlainerModels(recordings, request, search)
    asked = models.likeliest()
    searched = search_with_intersample if is_in_doubt else search_causes
    found, last = searched(recordings, asked.request, asked.search, others, asked.first)
    answer = _surest_answer(last, found)
    unnamed = answer.verdict is Verdict.UNKNOWN
    plainer = models.after_all_causes(
        asked,
        found.chain,
        is_unnamed=unnamed,
        is_explained=unnamed and bool(others.all(last.base)),
    )
    if plainer is not None:
        found, last = searched(recordings, plainer.request, plainer.search, others, plainer.first)
        answer = _surest_answer(last, found)
    return answer, last.base


def _surest_answer(search: CauseSearch, found: SearchResult) -> Diagnosis:
    """The diagnosis of what was found; where that is unknown, of what is sure in its place.

    Numbers may refuse a name that a search gave, and no other beginning has been tried then.
    """
    search.report("computing errors", 0.9)
    answer = _answer(search.base, found, search.seed)
    is_unknown = answer.verdict is Verdict.UNKNOWN
    alone = search.alone_beside(answer.descriptive, answer.remainder) if is_unknown else None
    if alone is not None:
        refused = unsure_issues(answer.descriptive)
        answer = _answer(search.base, alone, search.seed)
        answer = replace(answer, issues=(*answer.issues, *refused))
    if answer.verdict is not Verdict.UNKNOWN or found.came_to_nothing:
        return answer
    for search_again in (
        partial(search.search_from_multistart, found),
        partial(search.search_from_other_causes, found.chain),
    ):
        other = search_again()
        again = _answer(search.base, other, search.seed) if other else answer
        if again.verdict is not Verdict.UNKNOWN:
            return again
    return answer


def _prepared(recordings: Recordings, request: Request) -> tuple[Recordings, BaseFit, int]:
    """The cleaned and averaged logs, their base fit, and how many samples were averaged.

    Cleaning and averaging need a fit that knows how long the actuator remembers.
    """
    base = request.fit_base(recordings.logs, recordings.hold_out, thorough=False)
    problem = base.candidate.problem
    kept = recordings.each(
        partial(without_lost_input, model=problem.model, values=base.candidate.parameters)
    )
    fastest_s = fastest_time(problem, base.candidate.minimum.point)
    count = samples_to_average(
        (*recordings.logs, *recordings.hold_out), min(base.scale.motion_s, fastest_s)
    )
    if count > 1:
        if kept.logs.logs[0].intersample is None:
            kept = recordings_read_as(kept, base.candidate.problem.logs[0].between_samples)
        kept = kept.each(partial(decimated, count=count, keeps_jumps=True))
    if base.candidate.has_spring:  # without one there is no rest, and no beginning is forgotten
        states = len(problem.model.start_states)
        kept = kept.each(partial(without_moving_start, motion_s=base.scale.motion_s, states=states))
    if kept is not recordings:
        base = request.fit_base(kept.logs, kept.hold_out, thorough=False)
    return kept, base, count


def _rising(progress: Progress | None) -> Progress:
    """The callback with fractions that never fall, though a second search begins anew."""
    most = 0.0

    def report(message: str, fraction: float) -> None:
        nonlocal most
        most = max(most, fraction)
        if progress is not None:
            progress(message, most)

    return report


def _answer(base: BaseFit, found: SearchResult, seed: int) -> Diagnosis:
    """The diagnosis in numbers: errors of the parameters, gains, and which names stay."""
    chain, remainder, held_out = found.chain, found.remainder, base.held_out
    rng = np.random.default_rng(seed)
    asked_for = base.asked_for.identified
    before = assemble(
        asked_for.found, asked_for.logs, asked_for.hold_out, choice=asked_for.choice, seed=seed
    )
    extends = bool(chain.links) or base.instead_of is not None
    after = _fit_of(chain.final, base.identified, seed) if extends else None
    models = prefix_models(chain, base.candidate, base.scale, base.sigma)
    errors = [held_out.first_errors(model) for model in models]
    causes = causes_of(chain, errors, after, rng)
    causes = _with_errors_without(causes, chain, base, errors[-1], rng)
    causes = _with_variations(causes, chain, base, found.remainder)
    causes = with_doubts(causes, chain, after, remainder, base)
    sure = [may and c.doubt is None for may, c in zip(found.is_named, causes, strict=True)]
    is_named = consistent_names(chain.links, causes, sure, chain.final.squares)
    forms = {
        link.added.key: told_as(link.added, cause.parameters).key
        for link, cause in zip(chain.links, causes, strict=True)
    }
    after, causes = with_intervals(after, causes, is_named, chain, base.sigma)
    links = with_rivals(chain, causes, list(forms.values()), is_named, base)
    told = list(zip(causes, is_named, strict=True))
    named = [link for link, stays in zip(links, is_named, strict=True) if stays]
    if base.instead_of is not None:
        errors = [held_out.first_errors(base.instead_of.candidate), *errors]
    return Diagnosis(
        verdict=verdict_of(links, is_named, remainder),
        summary="",
        base=before,
        extended=after,
        causes=tuple(cause for cause, stays in told if stays),
        descriptive=tuple(cause for cause, stays in told if not stays),
        alternatives=alternatives_of(named or links, forms),
        remainder=remainder,
        gains=gains_of(base.asked_for.candidate, chain.final, held_out, before),
        evidence=evidence_of(chain),
        next_experiment=None,
        issues=(
            *(after if after is not None and named else before).issues,
            *_issues_of_rest(base, chain, before),
            *refusal_issues(chain, held_out),
            *held_out_change_issues(
                chain.final, remainder, held_out, base.scale, is_sure=all(is_named)
            ),
        ),
        gain_ci95=whole_gain_of(errors, rng),
    )


def _issues_of_rest(base: BaseFit, chain: Chain, fit: FitResult) -> tuple[Issue, ...]:
    """That a reduced base is extended, and disturbances in what is left."""
    row = next(r for r in fit.statistics if r.channel == fit.outputs[0])
    return (
        *reduced_base_issues(base, unit=row.display_unit, factor=row.display_factor),
        *disturbance_issues(
            residual_context(chain.final),
            base.scale.motion_s,
            channel=row.channel,
            unit=row.display_unit,
            factor=row.display_factor,
        ),
    )


def _with_errors_without(
    causes: Sequence[Cause], chain: Chain, base: BaseFit, whole: Array, rng: np.random.Generator
) -> tuple[Cause, ...]:
    """The causes; those that may gain nothing in their place with the error of leaving them out.

    It is only told where the other causes surely do worse without this one than the ``whole`` does.
    """
    found = []
    for position, cause in enumerate(causes):
        if len(causes) > 1 and (not gains_by(cause, np.inf) or may_gain_nothing(cause)):
            model = refit_without(chain, position, base.candidate, base.scale, base.sigma)
            gained = gain_interval(base.held_out.first_errors(model), whole, rng)
            if gained is None or gained[0] > 0.0:
                cause = replace(cause, holdout_rmse_without=base.held_out.rms(model))
        found.append(cause)
    return tuple(found)


def _with_variations(
    causes: Sequence[Cause], chain: Chain, base: BaseFit, remainder: Remainder
) -> tuple[Cause, ...]:
    """The causes with how their sizes vary throughout the logs."""
    if not causes:
        return ()
    added = [link.added for link in chain.links]
    varied = variations(chain.final, added, base.sigma, with_open_jumps=remainder.open_jumps > 0)
    return tuple(replace(c, variation=v) for c, v in zip(causes, varied, strict=True))


def _cleaned(log: Log) -> Log:
    """The log as it is fitted, averaged and judged by: a drop-out must be in none of the three."""
    return at_readings(without_dropouts(without_input_noise(without_repeats(log))))


def _fit_of(final: Candidate, identified: Identification, seed: int) -> FitResult:
    """The extended model as a fit with errors and scores."""
    problem = final.problem
    optimum = optimum_of(final, identified.found.optimum.sigma)
    constraints = ParameterConstraints.of(problem.model.parameters(), None)
    found = OptimisedProblem(problem, optimum, identified.found.unseen, constraints)
    return assemble(
        found, identified.logs, identified.hold_out, choice=identified.choice, seed=seed
    )
