"""The answer of a diagnosis in numbers: errors of the parameters, gains, and which names stay."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from softid.diagnosis.base.base_fit import BaseFit
from softid.diagnosis.base.intersample_selection import refitted_as
from softid.diagnosis.base.reduced_base import reduced_base_issues
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.held_out import HeldOut
from softid.diagnosis.refit.optimum import optimum_of
from softid.diagnosis.refit.whitening import Whitener
from softid.diagnosis.report.ambiguity import with_presliding
from softid.diagnosis.report.changes import held_out_change_issues
from softid.diagnosis.report.issues import refusal_issues, unsure_input_issues
from softid.diagnosis.report.open_intersample import with_open_intersample
from softid.diagnosis.report.other_forms import with_other_forms
from softid.diagnosis.report.several_elements import with_several_elements
from softid.diagnosis.report.tied_values import with_tied_values
from softid.diagnosis.residual.disturbances import Line, disturbance_issues, line_in, with_line
from softid.diagnosis.residual.input_noise import moved_parameters, unknown_input
from softid.diagnosis.residual.jump_timing import untimed_jumps
from softid.diagnosis.residual.motion import heard, residual_context
from softid.diagnosis.residual.noise_model import noise_with_moments, refined_under
from softid.diagnosis.residual.parameter_constancy import variations
from softid.diagnosis.search.backward_revision import refit_without
from softid.diagnosis.search.forward_selection import Chain
from softid.diagnosis.search.order_of_size import prefix_models
from softid.diagnosis.search_result import SearchResult
from softid.diagnosis.verdict.cause_results import (
    alternatives_of,
    causes_of,
    evidence_of,
    gains_of,
    told_as,
    whole_gain_of,
)
from softid.diagnosis.verdict.chain_consistency import named_together
from softid.diagnosis.verdict.doubts import NO_GAIN, with_doubts
from softid.diagnosis.verdict.gain_interval import gain_interval
from softid.diagnosis.verdict.held_out_runs import held_out_lengths
from softid.diagnosis.verdict.law_rivals import with_rivals
from softid.diagnosis.verdict.naming import asks_for_the_others, verdict_of
from softid.diagnosis.verdict.profile_intervals import with_intervals
from softid.diagnosis.verdict.sample_errors import held_out_at_samples, with_sample_statistics
from softid.diagnosis_results import Cause, Diagnosis, Remainder, Variation
from softid.errors import Issue
from softid.identification.assembly import OptimisedProblem, assemble
from softid.identification.intersample_choice import choice_unless_held
from softid.identification.parameter_constraints import ParameterConstraints
from softid.identification.workflow import Identification
from softid.parallel import both
from softid.results import FitResult

Array = npt.NDArray[np.float64]


def answer_of(base: BaseFit, found: SearchResult, seed: int) -> Diagnosis:
    """The diagnosis in numbers, without its summary.

    Parameters
    ----------
    base
        The base fit, and what it is judged by.
    found
        What a search found.
    seed
        Seed of the fits, which their records keep.
    """
    chain, noise = _with_open_moments(found.chain, base)
    recorded = held_out_at_samples(base.held_out)
    line = line_in(residual_context(chain.final))
    remainder = with_line(found.remainder, line, base.scale.motion_s)
    lengths = held_out_lengths(recorded, chain.final)
    unsure, least_sd = _unsure_of(chain.final, base, remainder, noise)
    extends = bool(chain.links) or base.instead_of is not None
    before, after = both(
        lambda: _fit_of_base(base, seed, {} if extends else least_sd),
        lambda: _fit_of(chain.final, base.identified, seed, least_sd) if extends else None,
    )
    errors, varied = both(
        lambda: _errors_by_link(chain, base, recorded),
        lambda: _variations(chain, base, remainder, unsure),
    )
    causes = causes_of(chain, errors, after, base.scale, lengths)
    causes = _with_errors_without(causes, chain, base, recorded, errors[-1], lengths)
    causes = tuple(replace(c, variation=v) for c, v in zip(causes, varied, strict=True))
    causes = with_doubts(causes, chain, after, remainder, base)
    sure = [may and c.doubt is None for may, c in zip(found.is_named, causes, strict=True)]
    is_named, causes = named_together(chain.links, causes, sure, chain.final.squares)
    forms = {
        link.added.key: told_as(link.added, cause.parameters).key
        for link, cause in zip(chain.links, causes, strict=True)
    }
    after, causes = with_intervals(after, causes, is_named, chain, base.sigma, least_sd, noise)
    links = with_rivals(chain, causes, list(forms.values()), is_named, base, remainder)
    told = list(zip(causes, is_named, strict=True))
    named = [link for link, stays in zip(links, is_named, strict=True) if stays]
    if base.instead_of is not None:
        errors = [recorded.first_errors(base.instead_of.candidate), *errors]
    alternatives = with_presliding(alternatives_of(named or links, forms), causes, base.scale)
    stands = (cause.doubt in (None, *NO_GAIN) for cause in causes)  # but for what is held out
    is_sure = all(stands) and not alternatives
    answer = Diagnosis(
        verdict=verdict_of(links, is_named, remainder, causes),
        summary="",
        base=before,
        extended=after,
        causes=tuple(cause for cause, stays in told if stays),
        descriptive=tuple(cause for cause, stays in told if not stays),
        alternatives=alternatives,
        remainder=remainder,
        gains=gains_of(base.asked_for.candidate, chain.final, recorded, before),
        evidence=evidence_of(chain),
        next_experiment=None,
        issues=(
            *(after if after is not None and named else before).issues,
            *unsure_input_issues(after or before, least_sd),
            *_issues_of_rest(base, chain, before, line),
            *_issues_of_held_out(base, chain, remainder, is_sure=is_sure),
        ),
        gain_ci95=whole_gain_of(errors, lengths),
    )
    answer = with_tied_values(answer, named, len(chain.final.effects))
    answer = with_other_forms(answer, named, chain.final, base)
    answer = with_several_elements(answer, named, chain.final, base)
    return with_open_intersample(answer, chain.final, base)


def _with_open_moments(chain: Chain, base: BaseFit) -> tuple[Chain, Whitener | None]:
    """The chain with its last model refined under the noise that moments of jumps make, and that.

    Drawn straight, a jump is early for a law that gives way at once, and other parameters make up
    for it.
    """
    noise = noise_with_moments(chain.final, base.sigma) if chain.links else None
    if noise is None:
        return chain, None
    return replace(chain, final=refined_under(chain.final, noise, base.sigma)), noise


def _unsure_of(
    final: Candidate, base: BaseFit, remainder: Remainder, noise: Whitener | None
) -> tuple[Array | None, dict[str, float]]:
    """Draws of what is not known of the input, and how far that moves each parameter."""
    is_open = noise is not None
    unsure = unknown_input(final, base.gauges, remainder.noise_power, moments_are_open=is_open)
    return unsure, moved_parameters(final, unsure, remainder.noise_power, noise)


def _issues_of_rest(
    base: BaseFit, chain: Chain, fit: FitResult, line: Line | None
) -> tuple[Issue, ...]:
    """That a reduced base is extended, and disturbances in what is left."""
    row = next(r for r in fit.statistics if r.channel == fit.outputs[0])
    return (
        *reduced_base_issues(base, unit=row.display_unit, factor=row.display_factor),
        *disturbance_issues(
            heard(chain.final, residual_context(chain.final)),
            base.scale.motion_s,
            line,
            channel=row.channel,
            unit=row.display_unit,
            factor=row.display_factor,
        ),
    )


def _issues_of_held_out(
    base: BaseFit, chain: Chain, remainder: Remainder, *, is_sure: bool
) -> tuple[Issue, ...]:
    """What the held-out samples refuse, and what is another in them."""
    final, held_out = chain.final, base.held_out
    return (
        *refusal_issues(chain, held_out),
        *held_out_change_issues(final, remainder, base, is_sure=is_sure),
    )


def _with_errors_without(
    causes: Sequence[Cause],
    chain: Chain,
    base: BaseFit,
    held_out: HeldOut,
    whole: Array,
    lengths: Sequence[int],
) -> tuple[Cause, ...]:
    """The causes; those that may gain nothing in their place with the error of leaving them out.

    It is only told where the other causes surely do worse without this one than the ``whole`` does.
    """
    found = []
    for position, cause in enumerate(causes):
        if len(causes) > 1 and asks_for_the_others(cause, chain.links[position].added):
            model = refit_without(chain, position, base.candidate, base.scale, base.sigma)
            gained = gain_interval(held_out.first_errors(model), whole, lengths)
            if gained is None or gained[0] >= 0.0:
                cause = replace(cause, holdout_rmse_without=held_out.rms(model))
        found.append(cause)
    return tuple(found)


def _errors_by_link(chain: Chain, base: BaseFit, held_out: HeldOut) -> list[Array]:
    """What is missed of the held-out samples without a cause, with the first one, and so on."""
    return [held_out.first_errors(model) for model in prefix_models(chain, base.candidate)]


def _variations(
    chain: Chain, base: BaseFit, remainder: Remainder, unsure: Array | None
) -> Sequence[Variation | None]:
    """How the sizes of the causes vary throughout the logs.

    Moments of jumps that need not be left open for the noise's sake are unknown all the same: from
    jump to jump a delay seems to vary by what is not known of them.
    """
    if not chain.links:
        return ()
    final, is_open = chain.final, remainder.open_jumps > 0
    timed = None if is_open else _with_unknown_moments(final, base)
    if timed is not None:
        noise = remainder.noise_power
        unsure = unknown_input(timed, base.gauges, noise, moments_are_open=True)
    added = [link.added for link in chain.links]
    return variations(final, added, base.sigma, with_open_jumps=is_open, unsure=unsure)


def _with_unknown_moments(final: Candidate, base: BaseFit) -> Candidate | None:
    """The model over an input that jumps when nobody knows; None where it does not jump.

    That jumps are held until the next sample may be no more than the best guess at their moments.
    """
    logs = final.problem.logs
    if base.is_intersample_open and logs[0].effective_intersample == "held":
        final = refitted_as(final, base.sigma, choice_unless_held(logs)) or final
    is_any = any(len(untimed_jumps(segment)) for segment in final.problem.segments)
    return final if is_any else None


def _fit_of_base(base: BaseFit, seed: int, least_sd: Mapping[str, float]) -> FitResult:
    """The base that was asked for as a fit with errors and scores."""
    asked_for = base.asked_for.identified
    return _assembled(asked_for.found, asked_for, seed, least_sd)


def _fit_of(
    final: Candidate, identified: Identification, seed: int, least_sd: Mapping[str, float]
) -> FitResult:
    """The extended model as a fit with errors and scores.

    A term that the base could not see is in it again, and its error says whether it is seen now.
    """
    problem = final.problem
    unseen = {n: why for n, why in identified.found.unseen.items() if n not in problem.free}
    optimum = optimum_of(final, identified.found.optimum.sigma)
    constraints = ParameterConstraints.of(problem.model.parameters(), None)
    found = OptimisedProblem(problem, optimum, unseen, constraints)
    return _assembled(found, identified, seed, least_sd)


def _assembled(
    found: OptimisedProblem, identified: Identification, seed: int, least_sd: Mapping[str, float]
) -> FitResult:
    """What was found over the logs of an identification, scored at their samples."""
    fit = assemble(
        found,
        identified.logs,
        identified.hold_out,
        choice=identified.choice,
        seed=seed,
        least_sd=least_sd,
    )
    return with_sample_statistics(fit, identified)
