"""What a misfit is that no cause of the catalogue accounts for: a change, or another law."""

from __future__ import annotations

from collections.abc import Iterator, Sequence, Set
from dataclasses import dataclass, field, replace

from softid.diagnosis.base.base_fit import BaseFit
from softid.diagnosis.changes.events import Event, events_in, is_parted
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.report.ambiguity import SEVERAL_STEPS
from softid.diagnosis.report.changes import (
    CHANGE_POINT,
    HELD_OUT_CHANGE,
    change_issues,
    difference_issues,
    own_parameter_issues,
    spell_issues,
)
from softid.diagnosis.report.difference_texts import LOG_DIFFERENCES
from softid.diagnosis.report.held_excitation import held_experiments
from softid.diagnosis.report.other_model import UNASKED_MODEL
from softid.diagnosis.report.second_input import FOLLOWS_SECOND_INPUT
from softid.diagnosis.report.unlisted_texts import (
    LAW_BESIDE,
    LIKE_UNLISTED_LAW,
    UNLISTED_LAW,
    unlisted_issue,
)
from softid.diagnosis.residual.assessment import excess_of, noise_variance
from softid.diagnosis.residual.disturbances import SHORT_EVENTS, SPECTRAL_LINE
from softid.diagnosis.residual.one_step import is_one_step
from softid.diagnosis.search.backward_revision import refit_with_fewer
from softid.diagnosis.verdict.beyond_catalogue import (
    OUTDONE_RATIO,
    BeyondCatalogue,
    beyond_and_cause,
    beyond_catalogue,
)
from softid.diagnosis.verdict.unlisted_laws import NEAR_ONE, UNLISTED_LAWS
from softid.diagnosis_results import Diagnosis, Doubt, Verdict
from softid.effects.base import Effect
from softid.errors import Issue
from softid.sentences import listed, lowered

ONE_STEP = "one-step"
"""Code of the remark that a single step leaves the parameters open that what is held out needs."""

FAR_MORE, LEAST_LEFT = 3.0, 0.01
"""A law in no catalogue is not told where it leaves so many times what descriptions leave of the
misfit above the noise; what these leave counts as a hundredth at least."""

EVENTS = (CHANGE_POINT, LOG_DIFFERENCES, FOLLOWS_SECOND_INPUT)
"""Codes of the remarks on what happened beside any law."""

EVENT_BESIDE = "event-beside"
"""Code of the remark that what causes leave begins at one moment."""

OF_A_DISTURBANCE = (SPECTRAL_LINE, SHORT_EVENTS)
"""Codes of the remarks on a steady line and on short events."""

OF_REST = (LAW_BESIDE, EVENT_BESIDE)
"""Codes of the remarks that say what it is that causes leave."""


@dataclass(frozen=True, eq=False)
class OtherExplanations:
    """Explanations of what a base leaves that are no causes; each base is looked at once.

    Laws that a single cause may do as well count against a cause only where they outdo it, and
    against descriptions where they leave less.
    """

    _events: dict[BaseFit, tuple[Issue, ...]] = field(default_factory=dict, repr=False)
    _laws: dict[BaseFit, BeyondCatalogue | None] = field(default_factory=dict, repr=False)
    _happened: dict[BaseFit, list[Event]] = field(default_factory=dict, repr=False)
    _parted: dict[BaseFit, bool] = field(default_factory=dict, repr=False)
    _from_starts: dict[BaseFit, BeyondCatalogue | None] = field(default_factory=dict, repr=False)
    _near_one: dict[BaseFit, BeyondCatalogue | None] = field(default_factory=dict, repr=False)

    def events(self, base: BaseFit) -> tuple[Issue, ...]:
        """What differs from log to log, or happened at a moment or for a while.

        What one law explains, or one number for each log, needs no event: a gain that is another
        one in a whole log would pass for one that changed near its beginning.

        Parameters
        ----------
        base
            The base fit.
        """
        if base not in self._events:
            self._events[base] = self._look_for_events(base)
        return self._events[base]

    def _look_for_events(self, base: BaseFit) -> tuple[Issue, ...]:
        candidate = base.candidate
        excess = excess_of(candidate, base.scale)
        found = difference_issues(base)
        found = found or change_issues(candidate, base.scale, excess, alone=True)
        if found or self._beyond(base) is not None:
            return found
        return spell_issues(base, self._events_in) or change_issues(candidate, base.scale, excess)

    def _events_in(self, base: BaseFit) -> list[Event]:
        if base not in self._happened:
            self._happened[base] = events_in(base)
        return self._happened[base]

    def laws(self, base: BaseFit, taken: float = 0.0) -> tuple[Issue, ...]:
        """A law in no catalogue; nothing where none accounts for the misfit.

        Parameters
        ----------
        base
            The base fit.
        taken
            Share of the misfit above the noise that descriptions take away: a law that leaves many
            times as much is not what is missing, nor is one that a single cause may do as well and
            that leaves hardly less.
        """
        found, most = self._beyond(base) or self._at_starts(base), FAR_MORE
        if found is None:
            found, most = self._beyond_one(base), OUTDONE_RATIO
        if found is None or 1.0 - found.share > most * max(1.0 - taken, LEAST_LEFT):
            return ()
        return (unlisted_issue(found, held=held_experiments(base.candidate.problem.logs)),)

    def outdo(self, base: BaseFit, cause: Candidate) -> bool:
        """Whether a law in no catalogue leaves nothing to look for beside a cause.

        One that a single cause may do as well is compared with the cause that does best; where it
        leaves less, it takes the place of the law that is told of the base.

        Parameters
        ----------
        base
            The base fit.
        cause
            The base with the best cause.
        """
        found = self._beyond(base)
        if found is not None and found.outdoes(cause):
            return True
        other = self._beyond_one(base)
        if other is None or not other.outdoes(cause):
            return False
        self._laws[base] = other
        return True

    def part(self, base: BaseFit) -> bool:
        """Whether one number that changed within a log leaves nothing else to look for.

        Parameters
        ----------
        base
            The base fit.
        """
        if base not in self._parted:
            self._parted[base] = is_parted(
                base, excess_of(base.candidate, base.scale), self._events_in
            )
        return self._parted[base]

    def all(self, base: BaseFit, taken: float = 0.0) -> tuple[Issue, ...]:
        """The events, or where there is none a law in no catalogue.

        Parameters
        ----------
        base, taken
            As in `laws`.
        """
        return self.events(base) or self.laws(base, taken)

    def _beyond(self, base: BaseFit) -> BeyondCatalogue | None:
        if base not in self._laws:
            noise = noise_variance(base.candidate, base.scale)
            self._laws[base] = beyond_catalogue(base, noise)
        return self._laws[base]

    def _at_starts(self, base: BaseFit) -> BeyondCatalogue | None:
        """One to which no way leads from where the base stands, but from its start values."""
        if base not in self._from_starts:
            noise = noise_variance(base.candidate, base.scale)
            self._from_starts[base] = beyond_catalogue(base, noise, at_starts=True)
        return self._from_starts[base]

    def _beyond_one(self, base: BaseFit) -> BeyondCatalogue | None:
        """One that a single cause may do as well."""
        if base not in self._near_one:
            noise = noise_variance(base.candidate, base.scale)
            self._near_one[base] = beyond_catalogue(base, noise, NEAR_ONE)
        return self._near_one[base]


def with_other_explanations(
    answer: Diagnosis, base: BaseFit, others: OtherExplanations
) -> Diagnosis:
    """The diagnosis with what explains a misfit that no cause does.

    Parameters
    ----------
    answer
        The diagnosis, in which no name stands that an event outweighs.
    base
        The base fit to the logs.
    others
        The explanations.
    """
    known = tuple(issue for issue in answer.issues if issue.code == HELD_OUT_CHANGE)
    is_unknown, leaves = answer.verdict is Verdict.UNKNOWN, answer.remainder.structured
    told: tuple[Issue, ...] = ()
    unasked = [issue.remedy for issue in answer.issues if issue.code == UNASKED_MODEL]
    if unasked:
        return replace(answer, alternatives=(), next_experiment=unasked[0])
    if any(cause.doubt is Doubt.ONE_STEP for cause in answer.descriptive):
        return answer  # what is slow behind a step would begin at a moment
    if is_unknown and not (leaves or answer.descriptive) and is_one_step(base.candidate.problem):
        return replace(
            answer,
            issues=(*answer.issues, one_step_issue()),
            next_experiment=SEVERAL_STEPS,
        )
    if is_unknown and (leaves or not known):
        left = answer.remainder
        told = others.all(base, min(left.explained_share, left.held_out_share))
    following = [issue.remedy for issue in (*told, *known)]
    return replace(
        answer,
        alternatives=() if told else answer.alternatives,  # a tie of descriptions says nothing
        issues=(*_not_of_a_law(answer.issues, told), *told),
        next_experiment=following[0] if following else answer.next_experiment,
    )


def _not_of_a_law(known: Sequence[Issue], told: Sequence[Issue]) -> tuple[Issue, ...]:
    """Remarks without marks of a disturbance, where one law takes away nearly all that holds them.

    What rings after every move would pass for a pump.
    """
    is_whole = any(issue.code == UNLISTED_LAW for issue in told)
    return tuple(issue for issue in known if not (is_whole and issue.code in OF_A_DISTURBANCE))


def differing_log_issues(base: BaseFit) -> tuple[Issue, ...]:
    """That the logs differ, and in what, though one model leaves no more than noise of them.

    Parameters
    ----------
    base
        The base fit to the logs, of which nothing else is told.
    """
    own = own_parameter_issues(base)
    return difference_issues(base) or own if own else ()


def with_differences(answer: Diagnosis, differing: Sequence[Issue]) -> Diagnosis:
    """A diagnosis of which nothing else is told, with what differs between the logs.

    Parameters
    ----------
    answer
        The diagnosis.
    differing
        The remarks on that, one at least.
    """
    issues, following = (*answer.issues, *differing), differing[0].remedy
    return replace(answer, issues=issues, next_experiment=following)


def with_law_beside(
    answer: Diagnosis, base: BaseFit, final: Candidate, effects: Sequence[Effect]
) -> Diagnosis:
    """The diagnosis with a law in no catalogue that explains what causes leave.

    Where no cause is named, it may stand beside another cause than those that are described: the
    best one alone is not always one of two. It is not told where these leave less, also on what is
    held out.

    Parameters
    ----------
    answer
        The diagnosis.
    base
        The base fit to the logs.
    final
        The model with all that is named or described.
    effects
        The catalogue.
    """
    if not answer.remainder.structured or _is_told(answer):
        return answer
    noise = noise_variance(base.candidate, base.scale)
    is_unknown = answer.verdict is Verdict.UNKNOWN
    found = beyond_and_cause(base, noise, effects) if is_unknown else None
    if found is not None and (
        final.squares < found.squares and answer.remainder.held_out_share > found.held_out_share
    ):
        found = None
    of_rest = found is None
    if of_rest and final.effects:
        found = beyond_catalogue(base, noise, UNLISTED_LAWS, beside=final)
    if found is None:
        return answer
    tied = {name for tie in answer.alternatives for name in tie.effects}
    issue = unlisted_issue(
        found,
        of_rest=of_rest,
        is_tied=found.laws[0].name in tied,
        held=held_experiments(base.candidate.problem.logs),
    )
    return replace(
        answer,
        alternatives=() if issue.code == UNLISTED_LAW else answer.alternatives,
        issues=(*answer.issues, issue),
        next_experiment=answer.next_experiment or issue.remedy,
    )


def with_event_beside(answer: Diagnosis, base: BaseFit, final: Candidate) -> Diagnosis:
    """The diagnosis with what happened beside causes: a difference between logs, or at a moment.

    A payload or a slip of the sensor asks for causes that stand for it, so those without a name are
    left out first, and each once.

    Parameters
    ----------
    answer
        The diagnosis.
    base
        The base fit to the logs.
    final
        The model with all that is named or described.
    """
    if not (final.effects and answer.remainder.structured) or _is_told(answer):
        return answer
    named = {cause.key for cause in answer.causes}
    for model in _with_fewer_causes(base, final, named):
        excess = excess_of(model, base.scale)
        differences = difference_issues(base, model)
        for issue in differences or change_issues(model, base.scale, excess, alone=True):
            beside = listed([lowered(effect.title) for effect in model.effects])
            told = replace(issue, code=EVENT_BESIDE, message=f"beside {beside} {issue.message}")
            return replace(answer, issues=(*answer.issues, told), next_experiment=issue.remedy)
    return answer


def _with_fewer_causes(base: BaseFit, final: Candidate, named: Set[str]) -> Iterator[Candidate]:
    """The model with the causes that have names, with all that it has, and without each once."""
    own = [effect for effect in final.effects if effect.key in named]
    if 0 < len(own) < len(final.effects):
        yield refit_with_fewer(final, base.candidate, own, base.scale, base.sigma)
    yield final
    for left_out in final.effects if len(final.effects) > 1 else ():
        others = [effect for effect in final.effects if effect is not left_out]
        if others != own:
            yield refit_with_fewer(final, base.candidate, others, base.scale, base.sigma)


def _is_told(answer: Diagnosis) -> bool:
    """Whether what the misfit is has been told already, or that something happened."""
    told = {issue.code for issue in answer.issues}
    return bool(told & {UNLISTED_LAW, UNASKED_MODEL, LIKE_UNLISTED_LAW, *OF_REST, *EVENTS})


def one_step_issue() -> Issue:
    """That what is missed elsewhere may be parameters which one step does not tell."""
    return Issue(
        ONE_STEP,
        "info",
        "the fitted logs hold one step only, and the model follows it: what it misses on what is "
        "held out may be its parameters, which one step hardly tells, or something that is missing",
        SEVERAL_STEPS,
    )
