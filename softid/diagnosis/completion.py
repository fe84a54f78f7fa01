"""What is added to an answer when the search is over, step by step, up to its paragraph."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from softid.diagnosis.base.base_fit import BaseFit, Request
from softid.diagnosis.changes.zero_jumps import is_without_jumps
from softid.diagnosis.logs.permanent_set import permanent_set_issues
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.report.clipped_input import with_clipped_input
from softid.diagnosis.report.coarse_sampling import with_coarse_sampling
from softid.diagnosis.report.held_excitation import held_experiments, with_advice_lacking
from softid.diagnosis.report.issues import (
    averaging_issues,
    input_noise_issues,
    jump_issues,
    negligible_issues,
    refused_law_issues,
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
    differing_log_issues,
    with_differences,
    with_event_beside,
    with_law_beside,
    with_other_explanations,
)
from softid.diagnosis.report.parameter_doubts import with_unnamed_misfit, with_varying_sizes
from softid.diagnosis.report.readings import reading_issues
from softid.diagnosis.report.rounding import with_rounding
from softid.diagnosis.report.second_input import with_second_input
from softid.diagnosis.report.summary import write_summary
from softid.diagnosis.report.timing import timing_issues
from softid.diagnosis.residual.assessment import noise_variance
from softid.diagnosis.search.forward_selection import Chain
from softid.diagnosis.searches.over_plainer_models import plainer_model_issues
from softid.diagnosis.verdict.begun_anew import law_begun_anew
from softid.diagnosis.verdict.no_response import no_response
from softid.diagnosis.verdict.revision import (
    as_unknown,
    is_outweighed_by_events,
    with_described_part,
    with_names_withdrawn,
)
from softid.diagnosis.verdict.sample_errors import with_sample_remainder
from softid.diagnosis.verdict.second_input import second_inputs
from softid.diagnosis_results import Diagnosis, Verdict
from softid.effects.base import Effect
from softid.intersample import AVERAGED
from softid.log import LogSet
from softid.parallel import both
from softid.results import FitResult


@dataclass(frozen=True, eq=False)
class Circumstances:
    """What an answer came from.

    Attributes
    ----------
    recorded
        The logs as they came, with all of their channels.
    cleaned
        The same without what no fit takes, before any averaging.
    averaged
        How many samples were averaged; 1 where none were.
    request
        How the base was fitted.
    asked_for
        Keys of the effects that the user wants considered; empty for all.
    effects
        Those that were searched.
    chosen
        The base that the search began over.
    base
        The base that the answer extends.
    chain
        The chain with all that is named or described.
    others
        Explanations that are no causes.
    """

    recorded: LogSet
    cleaned: LogSet
    averaged: int
    request: Request
    asked_for: Sequence[str]
    effects: tuple[Effect, ...]
    chosen: BaseFit
    base: BaseFit
    chain: Chain
    others: OtherExplanations

    @property
    def final(self) -> Candidate:
        """The model with all that is named or described."""
        return self.chain.final

    @cached_property
    def begun_anew(self) -> tuple[Effect, Candidate] | None:
        """The law that explains all but what is held out, where that may go on from another log."""
        noise = noise_variance(self.base.candidate, self.base.scale)
        return law_begun_anew(self.chain, self.base, noise)


def completed(answer: Diagnosis, case: Circumstances) -> Diagnosis:
    """The answer after all `STEPS`.

    Parameters
    ----------
    answer
        A diagnosis in numbers.
    case
        What it came from.
    """
    for step in STEPS:
        answer = step(answer, case)
    return answer


def _what_else_it_is(answer: Diagnosis, case: Circumstances) -> Diagnosis:
    """The answer with what explains the misfit if no cause does, which may outweigh causes."""
    differing = differing_log_issues(case.base) if answer.verdict is Verdict.ADEQUATE else ()
    if differing:
        return with_differences(as_unknown(answer), differing)
    if case.begun_anew is not None:
        return _with_law_begun_anew(answer, *case.begun_anew, case.base)
    if is_outweighed_by_events(answer) and case.others.events(case.base):
        answer = with_names_withdrawn(answer)
    return with_other_explanations(answer, case.base, case.others)


def _with_law_begun_anew(
    answer: Diagnosis, law: Effect, model: Candidate, base: BaseFit
) -> Diagnosis:
    """The answer without names, and with a law that what is held out may speak against wrongly."""
    (told,) = refused_law_issues(law, model, base.candidate, base.held_out)
    others = tuple(issue for issue in answer.issues if issue.code != told.code)
    answer = with_names_withdrawn(answer) if answer.causes else answer
    return replace(answer, alternatives=(), issues=(*others, told), next_experiment=told.remedy)


def _second_input(answer: Diagnosis, case: Circumstances) -> Diagnosis:
    """The answer; that of another input alone where that may be all that is missing."""
    told = second_inputs(answer, case.base, case.recorded.logs, case.request.seed)
    if not told:
        return answer
    return with_second_input(with_names_withdrawn(answer), told, case.recorded.logs[0].input)


def _event_beside(answer: Diagnosis, case: Circumstances) -> Diagnosis:
    return answer if case.begun_anew else with_event_beside(answer, case.base, case.final)


def _law_beside(answer: Diagnosis, case: Circumstances) -> Diagnosis:
    if case.begun_anew:
        return answer
    return with_law_beside(answer, case.base, case.final, case.effects)


def _clipped_input(answer: Diagnosis, case: Circumstances) -> Diagnosis:
    return with_clipped_input(answer, case.recorded.logs)


def _rounding(answer: Diagnosis, case: Circumstances) -> Diagnosis:
    if case.averaged > 1:  # the mean of several samples lies between the steps
        return answer
    return with_rounding(answer, case.recorded, case.base.candidate, case.request.gauges)


def _coarse_sampling(answer: Diagnosis, case: Circumstances) -> Diagnosis:
    if case.averaged > 1:  # then it is sampled far faster than anything moves
        return answer
    return with_coarse_sampling(answer, case.base.candidate)


def _shared_scale(answer: Diagnosis, case: Circumstances) -> Diagnosis:
    is_linear = case.base.candidate.problem.model.is_linear
    return with_shared_scale(answer, linear_in=case.recorded.input_unit if is_linear else None)


def _open_places(answer: Diagnosis, case: Circumstances) -> Diagnosis:
    return with_open_places(answer)


def _varying_sizes(answer: Diagnosis, case: Circumstances) -> Diagnosis:
    return with_varying_sizes(answer)


def _unnamed_misfit(answer: Diagnosis, case: Circumstances) -> Diagnosis:
    return with_unnamed_misfit(answer)


def _no_response(answer: Diagnosis, case: Circumstances) -> Diagnosis:
    """The answer; unknown, with the reason, where the output does not answer to the input."""
    found = no_response(answer, case.final)
    return answer if found is None else with_no_response(as_unknown(answer), found, case.final)


def _described_part(answer: Diagnosis, case: Circumstances) -> Diagnosis:
    return with_described_part(answer)


def _remarks(answer: Diagnosis, case: Circumstances) -> Diagnosis:
    """The answer with what is to be known beside its verdict."""
    base, problem, left = case.base, case.base.candidate.problem, answer.remainder
    jumped = {log.name for log in base.whole_logs if is_without_jumps(log)}  # which leave a set
    resting = [log for log in case.cleaned if log.name not in jumped and base.candidate.has_spring]
    sets, motions = both(
        lambda: permanent_set_issues(resting, base.scale.motion_s),
        lambda: motion_shown_issues(base, answer),
    )
    issues = (
        *negligible_issues(base),
        *plainer_model_issues(case.chosen, base),
        *restriction_issues(case.asked_for),
        *averaging_issues(case.averaged),
        *sets,
        *motions,
        *jump_issues(left, problem),
        *input_noise_issues(left, problem, case.request.gauges),
        *joint_cause_issues(answer),
        *reading_issues(answer, problem.model.without_effects),
        *(timing_issues(answer, case.final) if case.averaged == 1 else ()),
    )
    return replace(answer, issues=(*answer.issues, *issues))


def _input_treatment(answer: Diagnosis, case: Circumstances) -> Diagnosis:
    """The answer whose fits say how their input was taken, for who takes a model elsewhere."""

    def told(fit: FitResult) -> FitResult:
        return replace(fit, input_noise=AVERAGED)

    return replace(
        answer, base=told(answer.base), extended=answer.extended and told(answer.extended)
    )


def _sample_remainder(answer: Diagnosis, case: Circumstances) -> Diagnosis:
    return with_sample_remainder(answer) if case.averaged > 1 else answer


def _paragraph(answer: Diagnosis, case: Circumstances) -> Diagnosis:
    """The answer in words, with advice that the logs lack."""
    held = held_experiments(case.recorded)
    return write_summary(replace(answer, issues=with_advice_lacking(answer.issues, held)), held)


Step = Callable[[Diagnosis, Circumstances], Diagnosis]

STEPS: tuple[Step, ...] = (
    # What the misfit is, if no cause. The first two may take the names of causes away, which all
    # that follows goes by; the third and the fourth look for something only where nothing of the
    # kind is told yet, and an event may pass for a law, but no law for an event.
    _what_else_it_is,
    _second_input,
    _event_beside,
    _law_beside,
    # Faults of the recording. Each puts its own advice before what is advised already, so that the
    # one that spoils most, an input known at too few samples, comes last.
    _clipped_input,
    _rounding,
    _coarse_sampling,
    # Which parameters are less sure than their intervals say, once it is known what is named. A
    # parameter keeps the first reason that it gets, so that the most general one comes last.
    _shared_scale,
    _open_places,
    _varying_sizes,
    _unnamed_misfit,
    # It makes an adequate answer unknown and has the first remark and advice. It does not say that
    # a misfit has no name, so that parameters keep the verdict that they had.
    _no_response,
    # It makes a named answer one in part.
    _described_part,
    # Remarks that go by the verdict and by names, and change neither.
    _remarks,
    _input_treatment,
    # The paragraph tells all that is above, of the samples as they were recorded.
    _sample_remainder,
    _paragraph,
)
"""What is added to an answer, in this order."""
