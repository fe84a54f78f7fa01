"""A plainer model in the place of the one that was chosen, where it is likelier with its causes.

A model is chosen while nothing is known of causes, so one with more parameters wins that bends to
what a cause does: a muscle with its curved spring predicts an actuator that meets a wall better
than an oscillator does, and what it leaves then has no name.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from softid.diagnosis.base.base_fit import BaseFit, Recordings, Request
from softid.diagnosis.search.bic_ranking import is_likelier, rank
from softid.diagnosis.search.contenders import INDISTINCT
from softid.diagnosis.search.forward_selection import FIRST, Chain, next_link
from softid.diagnosis.search.screening import screen
from softid.diagnosis.searches.cause_search import CauseSearch
from softid.effects.base import Effect
from softid.errors import IdentificationError, Issue
from softid.models.base import Model

HOPELESS_RATIO = 20.0
"""A plainer model with a first cause that leaves so many times the sum of squares that the chosen
one leaves with its own is not looked at further."""

PAIR_RATIO = 4.0
"""A plainer model with two causes that leaves more than so many times the sum of squares that all
causes of the chosen one leave is not searched further."""

TRIED_CAUSES = 3
"""Causes of the most promising signatures that show whether a plainer model comes near."""

FIRST_RATIO = 8.0
"""A plainer model that leaves, with the best of the causes tried, more than so many times what the
chosen one leaves with its first cause is not looked at further, where that cause alone leaves the
chosen one no more than noise."""

BENT = 0.02
"""A curve follows any law within its knots only, and explains as much as a law where its BIC is
less than this share of all that falls above it."""

PLAINER_MODEL = "plainer-model"
"""Code of the remark that another model than the one that predicts best is extended."""


@dataclass(frozen=True, eq=False)
class ModelSearch:
    """A search over one model, and what it asks for.

    Attributes
    ----------
    request
        What the user asked for, with the model.
    search
        The search over its fit.
    first
        The chain with its first cause.
    """

    request: Request
    search: CauseSearch
    first: Chain


@dataclass(frozen=True)
class OtherModel:
    """A model that explains the logs as well as the one that is extended.

    Attributes
    ----------
    label
        What it is called.
    effects
        Its own causes.
    behind
        Its BIC above that of the other one.
    """

    label: str
    effects: tuple[Effect, ...]
    behind: float


@dataclass(frozen=True, eq=False)
class PlainerModels:
    """Models that lost by prediction, extended by causes like the one that was chosen.

    There are none where the user named a model.

    Attributes
    ----------
    recordings
        The logs.
    request
        What the user asked for.
    search
        The search over the model that was chosen.
    """

    recordings: Recordings
    request: Request
    search: CauseSearch

    @cached_property
    def chosen(self) -> ModelSearch:
        """The chosen model with its first cause."""
        return ModelSearch(self.request, self.search, self.search.first_cause())

    @property
    def _lost(self) -> tuple[Model, ...]:
        choice = self.search.base.identified.choice
        return choice.plainer if choice is not None else ()

    @cached_property
    def _fitted(self) -> list[tuple[Request, CauseSearch]]:
        """The plainer ones with their fits."""
        return self._fits_of(self._lost)

    def _fits_of(self, models: Sequence[Model]) -> list[tuple[Request, CauseSearch]]:
        found = []
        for model in models:
            asked = replace(self.request, model=model)
            try:
                base = asked.fit_base(
                    self.recordings.logs, self.recordings.hold_out, thorough=False
                )
            except IdentificationError:  # it was drafted, but its fit came to no parameters
                continue
            found.append((asked, replace(self.search, base=base)))
        return found

    @cached_property
    def plainer(self) -> list[ModelSearch]:
        """The plainer ones that come near with their own first cause."""
        return self._that_come_near(self._fitted)

    @cached_property
    def _promising(self) -> list[ModelSearch]:
        """The same where a settled chain asks; only the likeliest causes are tried at first."""
        near = [pair for pair in self._fitted if _first_look(pair[1]) < self._most_left]
        return self._that_come_near(near)

    @property
    def _most_left(self) -> float:
        """What a plainer model may leave with one cause, where another one is settled.

        Of two causes either may be the first, and leave much more than the other would.
        """
        is_one = self._settled is not None and len(self._settled.links) == 1
        return (FIRST_RATIO if is_one else HOPELESS_RATIO) * self.chosen.first.final.squares

    def is_chosen(self, base: BaseFit) -> bool:
        """Whether a base is of the model that predicts best by itself.

        Parameters
        ----------
        base
            What was extended.
        """
        own, other = (b.candidate.problem.model.name for b in (self.search.base, base))
        return own == other

    def richer_than(self, base: BaseFit) -> list[ModelSearch]:
        """The chosen model where a plainer one is extended; else those with more parameters.

        They predicted too little better to be chosen while nothing was known of causes.

        Parameters
        ----------
        base
            What was extended.
        """
        if not self.is_chosen(base):
            return [self.chosen]
        choice = self.search.base.identified.choice
        fitted = self._fits_of(choice.richer if choice is not None else ())
        return [ModelSearch(asked, search, search.first_cause()) for asked, search in fitted]

    def _that_come_near(self, asked: Sequence[tuple[Request, CauseSearch]]) -> list[ModelSearch]:
        found = [ModelSearch(request, search, search.first_cause()) for request, search in asked]
        most = HOPELESS_RATIO * self.chosen.first.final.squares
        return [m for m in found if m.first.links and m.first.final.squares < most]

    def likeliest(self) -> ModelSearch:
        """The model that is the likeliest with its first cause, or with two, by BIC.

        Where one or two causes of the chosen one leave noise and are no curve, only a plainer one
        that is likelier than that takes its place.
        """
        if not self._lost:
            return self.chosen
        settled = self._settled
        if settled is not None:
            rivals = self._promising if settled.links else []
            return self._likelier(rivals, settled, self._against_settled) or self.chosen
        with_one = self._likelier(self.plainer, self.chosen.first, lambda rival: rival.first)
        return with_one or self._likelier(self.plainer, _two(self.chosen), _two) or self.chosen

    def explaining_as_well(self, extended: ModelSearch, found: Chain) -> OtherModel | None:
        """A plainer model that explains the logs as well with causes of its own; None for none.

        Parameters
        ----------
        extended, found
            As in `after_first_cause`; the causes are named.
        """
        is_asked = extended is self.chosen and self._lost and found.links
        if not is_asked or self._settled is None:
            return None
        before, after = self.search.base.candidate, found.final
        for rival in self._promising:
            other = self._against_settled(rival)
            ranked = rank([before, after, other.final], self.search.base.sigma)
            bic = {id(row.plain): row.bic for row in ranked}
            behind = bic[id(other.final)] - bic[id(after)]
            slack = BENT * (bic[id(before)] - bic[id(after)]) if other.bends else 0.0
            if behind < max(INDISTINCT, slack):
                effects = other.final.effects
                return OtherModel(rival.search.base.candidate.problem.model.label, effects, behind)
        return None

    @cached_property
    def _settled(self) -> Chain | None:
        """The fewest causes of the chosen model, of two at most, that leave no doubt."""
        first = self.chosen.first
        if not self._is_in_doubt(first):
            return first
        two = _two(self.chosen)
        return None if self._is_in_doubt(two) else two

    def _against_settled(self, rival: ModelSearch) -> Chain:
        """As many causes of a plainer model as it needs, two at most."""
        first = rival.first
        is_near = first.final.squares < self._most_left
        return _two(rival) if is_near and rival.search.leaves_structure(first) else first

    def _is_in_doubt(self, chain: Chain) -> bool:
        return chain.bends or self.search.leaves_structure(chain)

    def after_first_cause(self, extended: ModelSearch, found: Chain) -> ModelSearch | None:
        """A plainer model that is likelier with one cause than the chosen one is with all it has.

        Parameters
        ----------
        extended
            The model that was extended.
        found
            Its causes, which have no name.
        """
        if extended is not self.chosen:
            return None
        return self._likelier(self.plainer, found, lambda rival: rival.first)

    def after_all_causes(
        self,
        extended: ModelSearch,
        found: Chain,
        *,
        is_named: bool,
        is_doubted: bool,
        is_explained: bool,
    ) -> ModelSearch | None:
        """A plainer model that is likelier with its causes than the chosen one is with its own.

        It is looked for where those or the model are doubted, or one of several is a curve; with a
        first cause only where the misfit of the chosen one is explained otherwise. Where one or two
        causes are named, a model that needs a third is no plainer one.

        Parameters
        ----------
        extended
            The model that was extended.
        found
            Its causes.
        is_named, is_doubted, is_explained
            Whether they have a name, whether they have none or the logs know little of the model
            that carries them, and whether something else explains the misfit.
        """
        is_in_doubt = is_doubted or (len(found.links) > 1 and found.bends)
        if extended is not self.chosen or not is_in_doubt:
            return None
        if is_explained:
            return self._likelier(self.plainer, found, lambda rival: rival.first)

        def searched(rival: ModelSearch) -> Chain:
            two = _two(rival)
            if two.final.squares > PAIR_RATIO * found.final.squares:
                return two
            if is_named and len(found.links) <= 2 and rival.search.leaves_structure(two):
                return two
            return rival.search.search(rival.first).chain

        return self._likelier(self.plainer, found, searched)

    def _likelier(
        self,
        rivals: Sequence[ModelSearch],
        chain: Chain,
        extended: Callable[[ModelSearch], Chain],
    ) -> ModelSearch | None:
        """The plainer model that is the likeliest when extended, if it is likelier."""
        best, found = None, chain.final
        for rival in rivals:
            other = extended(rival).final
            if is_likelier(other, found, self.search.base.sigma):
                best, found = rival, other
        return best


def _first_look(search: CauseSearch) -> float:
    """Sum of squares with the best of the few causes that promise most."""
    base = search.base
    promising = screen(base.candidate, search.effects, base.scale, base.sigma)
    keys = list(dict.fromkeys(signature.effect.key for signature in promising))[:TRIED_CAUSES]
    few = [effect for effect in search.effects if effect.key in keys]
    link = next_link(base.candidate, few, base.scale, base.sigma, FIRST, screened=promising)
    return base.candidate.squares if link is None else link.chosen.plain.squares


def _two(model: ModelSearch) -> Chain:
    return model.search.grow(model.first, max_links=2)


def plainer_model_issues(chosen: BaseFit, extended: BaseFit) -> tuple[Issue, ...]:
    """That another model is extended than the one chosen; nothing where it is the same.

    Parameters
    ----------
    chosen
        The fit of the model that predicts best by itself.
    extended
        That of the model that is extended.
    """
    models = [fit.candidate.problem.model for fit in (chosen, extended)]
    before, after = (model.name for model in models)
    if before == after or chosen.identified.choice is None:
        return ()
    own, other = (len(model.parameters().free) for model in models)
    return (
        Issue(
            PLAINER_MODEL,
            "info",
            f"by itself the {before} model predicts blocks left out of the fit "
            + (
                f"better, but the {after} model, which has fewer parameters, is likelier with its "
                "causes than that one with its own (BIC), and is extended"
                if other < own
                else f"nearly as well with fewer parameters, but the {after} model explains the "
                "logs better with its causes, and is extended"
            ),
            f"name it with --model {before} to keep that",
        ),
    )
