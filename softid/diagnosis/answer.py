"""The answer of a diagnosis in numbers: errors of the parameters, gains, and which names stay."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

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
from softid.diagnosis.residual.disturbances import disturbance_issues
from softid.diagnosis.residual.input_noise import moved_parameters, unknown_input, unsure_parameters
from softid.diagnosis.residual.jump_timing import untimed_jumps
from softid.diagnosis.residual.motion import heard, residual_context
from softid.diagnosis.residual.noise_model import noise_with_moments, refined_under
from softid.diagnosis.residual.parameter_constancy import variations
from softid.diagnosis.residual.spectral_line import Line, line_in, with_line
from softid.diagnosis.search.backward_revision import refit_without
from softid.diagnosis.search.forward_selection import Chain, Link
from softid.diagnosis.search.order_of_size import prefix_models
from softid.diagnosis.searches.search_result import SearchResult
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
from softid.diagnosis_results import Alternative, Cause, Diagnosis, Remainder, Variation
from softid.errors import Issue
from softid.identification.assembly import OptimisedProblem, assemble
from softid.identification.intersample_choice import choice_unless_held
from softid.identification.workflow import Identification
from softid.parallel import both
from softid.results import FitResult
from softid.uncertainty import larger_of

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class _Case:
    """What the numbers of an answer are computed from.

    Attributes
    ----------
    base
        The base fit, and what it is judged by.
    chain
        What a search found, its last model refined where moments of jumps are open.
    noise
        The noise that these make; None where none are open.
    recorded
        What is held out, at the samples as they were recorded.
    line
        A steady line in what is left.
    remainder
        What is left.
    unsure, least_sd
        Draws of what is not known of the input, and how far that moves each parameter.
    lengths
        Of the runs of what is held out.
    """

    base: BaseFit
    chain: Chain
    noise: Whitener | None
    recorded: HeldOut
    line: Line | None
    remainder: Remainder
    unsure: Array | None
    least_sd: Mapping[str, float]
    lengths: Sequence[int]

    @classmethod
    def of(cls, base: BaseFit, found: SearchResult) -> _Case:
        """What a search found over a base."""
        chain, noise = _with_open_moments(found.chain, base)
        recorded = held_out_at_samples(base.held_out)
        line = line_in(residual_context(chain.final))
        remainder = with_line(found.remainder, line, base.scale.motion_s)
        unsure, least_sd = _unsure_of(chain.final, base, remainder, noise)
        lengths = held_out_lengths(recorded, chain.final)
        return cls(base, chain, noise, recorded, line, remainder, unsure, least_sd, lengths=lengths)

    @property
    def final(self) -> Candidate:
        """The model with all causes."""
        return self.chain.final


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
    case = _Case.of(base, found)
    before, extended = _fits_of(case, seed)
    errors, varied = both(
        lambda: _errors_by_link(case.chain, base, case.recorded),
        lambda: _variations(case.chain, base, case.remainder, case.unsure),
    )
    causes = _doubted_causes(case, extended, errors, varied)
    sure = [may and c.doubt is None for may, c in zip(found.is_named, causes, strict=True)]
    is_named, causes = named_together(case.chain.links, causes, sure, case.final.squares)
    forms = {
        link.added.key: told_as(link.added, cause.parameters).key
        for link, cause in zip(case.chain.links, causes, strict=True)
    }
    after, causes = with_intervals(
        extended, causes, is_named, case.chain, base.sigma, case.least_sd, case.noise
    )
    links = with_rivals(case.chain, causes, [*forms.values()], is_named, base, case.remainder)
    named = [link for link, stays in zip(links, is_named, strict=True) if stays]
    ties = with_presliding(alternatives_of(named or links, forms), causes, base.scale)
    told = list(zip(causes, is_named, strict=True))
    answer = Diagnosis(
        verdict=verdict_of(links, is_named, case.remainder, causes),
        summary="",
        base=before,
        extended=after,
        causes=tuple(cause for cause, stays in told if stays),
        descriptive=tuple(cause for cause, stays in told if not stays),
        alternatives=ties,
        remainder=case.remainder,
        gains=gains_of(base.asked_for.candidate, case.final, case.recorded, before),
        evidence=evidence_of(case.chain),
        next_experiment=None,
        issues=_issues_of(
            case, before, after, is_named=any(is_named), is_sure=_is_sure(causes, ties)
        ),
        gain_ci95=_whole_gain(case, errors),
    )
    for step in STEPS:
        answer = step(answer, named, case)
    return answer


def _fits_of(case: _Case, seed: int) -> tuple[FitResult, FitResult | None]:
    """The base that was asked for, and the model that extends it; None where nothing does."""
    base, final, least_sd = case.base, case.final, case.least_sd
    extends = bool(case.chain.links) or base.instead_of is not None
    return both(
        lambda: _fit_of_base(base, seed, {} if extends else least_sd),
        lambda: _fit_of(final, base.identified, seed, least_sd) if extends else None,
    )


def _doubted_causes(
    case: _Case,
    extended: FitResult | None,
    errors: Sequence[Array],
    varied: Sequence[Variation | None],
) -> tuple[Cause, ...]:
    """The causes in numbers, with what these say against their names.

    Doubts come last, for they go by all other numbers. All errors are those of the recorded
    samples: shares of them are what the user can check in the log, and a mean of several samples
    has less noise, so that a share of its error would be a gain that nobody finds.
    """
    measured = causes_of(case.chain, errors, extended, case.base.scale, case.lengths)
    beside = _with_errors_without(
        measured, case.chain, case.base, case.recorded, errors[-1], case.lengths
    )
    varying = [replace(c, variation=v) for c, v in zip(beside, varied, strict=True)]
    whole = case.recorded.rms(case.final)
    return with_doubts(varying, case.chain, extended, case.remainder, case.base, whole)


def _is_sure(causes: Sequence[Cause], ties: Sequence[Alternative]) -> bool:
    """Whether nothing speaks against the causes, but for what is held out."""
    return not ties and all(cause.doubt in (None, *NO_GAIN) for cause in causes)


def _issues_of(
    case: _Case, before: FitResult, after: FitResult | None, *, is_named: bool, is_sure: bool
) -> tuple[Issue, ...]:
    """Remarks on the fit that is believed, on what is left, and on what is held out."""
    believed = after if after is not None and is_named else before
    return (
        *believed.issues,
        *unsure_input_issues(after or before, case.least_sd),
        *_issues_of_rest(case, before),
        *_issues_of_held_out(case, is_sure=is_sure),
    )


def _whole_gain(case: _Case, errors: Sequence[Array]) -> tuple[float, float] | None:
    """What is gained over the model that was asked for."""
    replaced = case.base.instead_of
    first = [] if replaced is None else [case.recorded.first_errors(replaced.candidate)]
    return whole_gain_of([*first, *errors], case.lengths)


def _tied_values(answer: Diagnosis, named: Sequence[Link], case: _Case) -> Diagnosis:
    return with_tied_values(answer, named, len(case.final.effects))


def _other_forms(answer: Diagnosis, named: Sequence[Link], case: _Case) -> Diagnosis:
    return with_other_forms(answer, named, case.final, case.base)


def _several_elements(answer: Diagnosis, named: Sequence[Link], case: _Case) -> Diagnosis:
    return with_several_elements(answer, named, case.final, case.base)


def _open_intersample(answer: Diagnosis, named: Sequence[Link], case: _Case) -> Diagnosis:
    return with_open_intersample(answer, case.final, case.base)


STEPS = (_tied_values, _other_forms, _several_elements, _open_intersample)
"""What is added to the numbers, in this order: a parameter keeps the first reason why it is less
sure than its interval says, and that is another cause, then another form of one, and last what the
input does between its samples. A second element is told behind the forms of the first."""


def _with_open_moments(chain: Chain, base: BaseFit) -> tuple[Chain, Whitener | None]:
    """The chain with its last model refined under the noise that moments of jumps make, and that.

    Drawn straight, a jump is early for a law that gives way at once, and other parameters make up
    for it.
    """
    noise = noise_with_moments(chain.final, base.sigma) if chain.links else None
    if noise is None:
        return chain, None
    final = refined_under(chain.final, noise, base.sigma)
    *before, last = chain.links
    return replace(chain, links=(*before, replace(last, found=final)), final=final), noise


def _unsure_of(
    final: Candidate, base: BaseFit, remainder: Remainder, noise: Whitener | None
) -> tuple[Array | None, dict[str, float]]:
    """Draws of what is not known of the input, and how far that moves each parameter."""
    is_open = noise is not None
    unsure = unknown_input(final, base.gauges, remainder.noise_power, moments_are_open=is_open)
    moved = moved_parameters(final, unsure, remainder.noise_power, noise)
    return unsure, larger_of(moved, unsure_parameters(final, base.gauges, base.sigma))


def _issues_of_rest(case: _Case, fit: FitResult) -> tuple[Issue, ...]:
    """That a reduced base is extended, and disturbances in what is left."""
    base, final = case.base, case.final
    row = next(r for r in fit.statistics if r.channel == fit.outputs[0])
    return (
        *reduced_base_issues(base, unit=row.display_unit, factor=row.display_factor),
        *disturbance_issues(
            heard(final, residual_context(final)),
            base.scale.motion_s,
            case.line,
            channel=row.channel,
            unit=row.display_unit,
            factor=row.display_factor,
        ),
    )


def _issues_of_held_out(case: _Case, *, is_sure: bool) -> tuple[Issue, ...]:
    """What the held-out samples refuse, and what is another in them."""
    return (
        *refusal_issues(case.chain, case.base.held_out),
        *held_out_change_issues(case.final, case.remainder, case.base, is_sure=is_sure),
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
    constraints = identified.found.constraints.among(problem.model.parameters())
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
