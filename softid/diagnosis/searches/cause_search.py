"""Searches for a chain of causes of what one base leaves, from several beginnings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np

from softid.diagnosis.base.base_fit import BaseFit, Progress
from softid.diagnosis.changes.held_out_difference import is_another_actuator
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.held_out import BETTER, NO_WORSE
from softid.diagnosis.residual.assessment import assess
from softid.diagnosis.residual.input_noise import takes_input_noise_at_most
from softid.diagnosis.search.alternative_first import alternative_first_links, that_promise_the_rest
from softid.diagnosis.search.backward_revision import revised
from softid.diagnosis.search.bic_ranking import is_likelier
from softid.diagnosis.search.forward_selection import MAX_LINKS, Chain, Link, select_forward
from softid.diagnosis.search.indistinct import (
    best_of_tie,
    with_rivals_held_out,
    with_rivals_in_misfit,
)
from softid.diagnosis.search.multistart import is_astray, multistart_candidates
from softid.diagnosis.search.order_of_size import largest_first
from softid.diagnosis.search.two_of_first_order import chain_of_first_order
from softid.diagnosis.searches.search_memory import SearchMemory
from softid.diagnosis.searches.search_result import SearchResult, is_same_model
from softid.diagnosis.verdict.doubts import is_within_samples
from softid.diagnosis.verdict.held_out_error import with_held_out
from softid.diagnosis.verdict.naming import EXPLAINED, LEAST_GAIN, may_be_chance, nameable
from softid.diagnosis_results import Cause, Remainder
from softid.effects.base import Effect

BETTER_START = 0.99
"""Candidates from a multistart join the race when one leaves less than this share of what the first
cause does."""

NEAR_CURVE = 1.02
"""`BETTER_START` where the first cause is a curve, which has more unknowns than the rivals."""

HALF = 0.5
"""A first cause that explains a smaller share of the misfit is raced with a multistart before a
second one is looked for, and beside two that explain less no third is."""


@dataclass(frozen=True, eq=False)
class CauseSearch:
    """Searches for the causes of what one base leaves.

    Attributes
    ----------
    base
        The base fit, and what it is judged by.
    effects
        The effects to consider.
    seed
        Of the shifts that say what chance would make of noise.
    report
        Called with a sentence and the fraction done.
    """

    base: BaseFit
    effects: tuple[Effect, ...]
    seed: int
    report: Progress
    _memory: SearchMemory = field(default_factory=SearchMemory, init=False, repr=False)

    @cached_property
    def multistart(self) -> list[Candidate]:
        """Candidates from other starts of the base, sought once."""
        base = self.base
        return multistart_candidates(base.candidate, self.effects, base.scale, base.sigma)

    def remainder_of(self, model: Candidate) -> Remainder:
        """What a model leaves; looked at once, for the moments of jumps ask for many simulations.

        Parameters
        ----------
        model
            The base with causes.
        """
        base, rng = self.base, np.random.default_rng(self.seed)
        return self._memory.remainder(
            model, lambda: assess(base.candidate, model, base.scale, rng=rng, gauges=base.gauges)
        )

    def first_cause(self) -> Chain:
        """The base with one cause, if what is held out does not speak against any.

        Candidates from a multistart take part where the base is no place to start from, and before
        a curve with free values is believed.
        """
        if self.base.is_negligible:
            return self.nothing
        if self._is_astray:
            return self.grow(self.nothing, max_links=1, extra=self.multistart)
        chain = self._first_where_base_stands
        return self._raced_with_multistart(chain, NEAR_CURVE) if chain.bends else chain

    @cached_property
    def _first_where_base_stands(self) -> Chain:
        return self.grow(self.nothing, max_links=1)

    def grow(
        self,
        chain: Chain,
        *,
        max_links: int = MAX_LINKS,
        extra: Sequence[Candidate] = (),
        raced: Link | None = None,
    ) -> Chain:
        """A chain with further causes that what is held out does not speak against.

        Parameters
        ----------
        chain
            What is known already.
        max_links, extra, raced
            As in `select_forward`.
        """
        if extra or raced is not None:
            return self._select(chain, max_links, extra, raced)
        return self._memory.grown(chain, max_links, lambda: self._select(chain, max_links))

    def _select(
        self,
        chain: Chain,
        max_links: int,
        extra: Sequence[Candidate] = (),
        raced: Link | None = None,
    ) -> Chain:
        return select_forward(
            chain.final,
            self.effects,
            self.base.scale,
            self.base.sigma,
            is_no_worse=self._is_borne_out,
            is_noise=self.leaves_noise,
            report=lambda message, fraction: self.report(message, 0.3 + 0.4 * fraction),
            known_links=chain.links,
            extra=extra,
            raced=raced,
            max_links=max_links,
        )

    def _is_borne_out(self, before: Candidate, after: Candidate) -> bool:
        """Whether a cause is no worse on what is held out, and more than noise of the input."""
        held_out, gauges = self.base.held_out, self.base.gauges
        limit = BETTER if before.effects else NO_WORSE
        if held_out.rms(after) > limit * held_out.rms(before):
            return False
        return not (self.leaves_noise(before) and takes_input_noise_at_most(before, after, gauges))

    def leaves_noise(self, model: Candidate) -> bool:
        """Whether what a model leaves looks like noise, also on what is held out."""
        left, held_out = self.remainder_of(model), self.base.held_out
        if left.structured:
            return False
        before = held_out.rms(self.base.candidate)
        return not with_held_out(left, before, model, held_out, self.base.sigma).misses_held_out

    def search(self, first: Chain | None = None) -> SearchResult:
        """The chain of causes, what it leaves, and what may be named.

        Parameters
        ----------
        first
            The chain with its first cause, where that is known.
        """
        if self.base.is_negligible:
            left = self.remainder_of(self.base.candidate)
            return SearchResult(self.nothing, replace(left, structured=False), ())
        known = chain = first or self.first_cause()
        if self._may_stand_for_another(known) and self._share_of(known) < HALF:
            chain = self._raced_with_multistart(known, BETTER_START)
        met_multistart = chain is not known
        chain = self.grow(chain, max_links=2) if chain.links else chain
        if not met_multistart and self._may_stand_for_another(chain):
            other = self._raced_with_multistart(chain, BETTER_START)
            met_multistart = other is not chain
            chain = self.grow(other, max_links=2) if met_multistart else chain
        chain = self._of_first_order(chain)
        first_model = chain.links[0].found if chain.links else None
        if len(chain.links) > 1:  # a wrong first cause would ask for a third that mends it
            chain = self._with_third(self._revise(chain))
        if len(chain.links) > 2:  # a lag may win with a third where it lost with a second
            chain = self._of_first_order(chain, max_links=MAX_LINKS)
        return replace(self.judged(chain, first_model), met_multistart=met_multistart)

    def search_from_multistart(self, known: SearchResult) -> SearchResult | None:
        """What a search with candidates from a multistart finds, if that is sure.

        Parameters
        ----------
        known
            What was found without them: where they lead to the same first cause, the rest is known.
        """
        if known.met_multistart or self._is_astray:
            return None
        chain = self._first_from_multistart
        if known.first is not None and is_same_model(chain.final, known.first):
            return None
        return self._found_from_multistart if self._found_from_multistart.is_sure else None

    @cached_property
    def _first_from_multistart(self) -> Chain:
        known = self._first_where_base_stands
        raced = known.links[0] if known.links else known.last
        return self.grow(self.nothing, max_links=1, extra=self.multistart, raced=raced)

    @cached_property
    def _found_from_multistart(self) -> SearchResult:
        return self.search(self._first_from_multistart)

    def search_from_other_causes(self, found: SearchResult) -> SearchResult:
        """What a search from another first cause finds, where that is sure; else what is known.

        Either tells what was `unsure` on the way. What leads to the known causes is no other.

        Parameters
        ----------
        found
            What is known, with the chain from the best first cause.
        """
        return self._memory.from_others(found, lambda: self._from_other_causes(found))

    def _from_other_causes(self, found: SearchResult) -> SearchResult:
        known, unsure = found.chain, list[SearchResult]()
        best = known.links[0].added if known.links else None
        refused = None if known.links or known.last is None else known.last.added
        base, given = self.base, (self.effects, self.base.scale, self.base.sigma)
        others = alternative_first_links(best, base.candidate, *given, refused=refused)
        for other in that_promise_the_rest(others, self.remainder_of, *given):
            longer = self.grow(other, max_links=2)
            if len(longer.links) == 1 and longer.final.squares >= known.final.squares:
                continue  # it was raced with its own forms only
            if is_same_model(longer.final, known.final):
                continue
            left = self.remainder_of(longer.final)
            if left.structured and not self._may_outdo(known, longer):
                continue
            if left.explained_share > EXPLAINED:
                longer = self._of_first_order(longer)
                longer = self._revise(longer) if len(longer.links) > 1 else longer
                longer = self._with_third(longer) if left.structured else longer
                judged = self.judged(longer, other.final)
                if judged.is_sure:
                    return judged.with_unsure(unsure)
                unsure.append(judged)
        return found.with_unsure(unsure)

    def _may_outdo(self, known: Chain, other: Chain) -> bool:
        """Whether two causes that leave something may lead to more than is known with a third."""
        is_another = not other.final.names <= known.final.names
        return is_another and self.remainder_of(known.final).structured

    @cached_property
    def _is_astray(self) -> bool:
        return is_astray(self.base.candidate)

    def leaves_structure(self, chain: Chain) -> bool:
        """Whether causes leave more than noise.

        Parameters
        ----------
        chain
            The causes.
        """
        return bool(chain.links) and self.remainder_of(chain.final).structured

    def without_causes(self) -> SearchResult | None:
        """The base alone, if its residual shows nothing but noise.

        What explains a part of that, and may not be named, is no more than chance then.
        """
        left = self.remainder_of(self.base.candidate)
        if left.structured or left.colour_s is not None:
            return None
        if left.open_jumps == 0:
            base, held_out = self.base, self.base.held_out
            before = held_out.rms(base.candidate)
            left = with_held_out(left, before, base.candidate, held_out, base.sigma)
        return None if left.misses_held_out else SearchResult(self.nothing, left, ())

    def alone_beside(self, described: Sequence[Cause], left: Remainder) -> SearchResult | None:
        """The base alone, if there may be nothing in the actuator behind descriptions.

        Where it leaves structure that the course of the input between its samples makes, what is
        left behind the descriptions is what counts as left by it.

        Parameters
        ----------
        described
            What may not be named.
        left
            What is left behind it.
        """
        alone = self.without_causes()
        if alone is not None:
            is_nothing = alone.remainder.open_jumps > 0 or may_be_chance(described)
            return alone if is_nothing else None
        if not is_within_samples(described, left):
            return None
        left = replace(left, rms=self.remainder_of(self.base.candidate).rms, explained_share=1.0)
        return SearchResult(self.nothing, left, ())

    def explained_by_moments(self) -> SearchResult | None:
        """The base alone, if nothing but the moments of jumps of the input is unknown.

        They have to lie as by chance; a cause would ask for others.
        """
        left = self.remainder_of(self.base.candidate)
        return self.without_causes() if left.open_jumps and left.open_jumps_scatter else None

    @property
    def nothing(self) -> Chain:
        """The base without causes."""
        return Chain((), None, self.base.candidate)

    def _raced_with_multistart(self, chain: Chain, share: float) -> Chain:
        """A chain of one link, or another where one from a multistart leaves less than a share."""
        least = min((c.squares for c in self.multistart), default=np.inf)
        if least > share * chain.final.squares:
            return chain
        return self.grow(self.nothing, max_links=1, extra=self.multistart, raced=chain.links[0])

    def _may_stand_for_another(self, chain: Chain) -> bool:
        """Whether a single cause leaves structure, and was not raced with a multistart."""
        alone = len(chain.links) == 1 and not chain.bends
        return alone and not self._is_astray and self.remainder_of(chain.final).structured

    def _share_of(self, chain: Chain) -> float:
        return self.remainder_of(chain.final).explained_share

    def _with_third(self, chain: Chain) -> Chain:
        """The chain with a third cause, unless the first two explain so little that it is none."""
        if self._share_of(chain) < HALF:
            return chain
        longer = self.grow(chain)
        if len(longer.links) > len(chain.links):
            return self._revise(longer)
        return replace(chain, last=longer.last)

    def _of_first_order(self, chain: Chain, max_links: int = 2) -> Chain:
        """The chain, or a lag and other causes in place of one of second order, if likelier."""
        base = self.base
        lag = chain_of_first_order(chain, base.candidate, self.effects, base.scale, base.sigma)
        if lag is None:
            return chain
        longer = self.grow(lag, max_links=max_links)
        if len(longer.links) < 2 or not is_likelier(longer.final, chain.final, base.sigma):
            return chain
        is_worse = base.held_out.rms(longer.final) > NO_WORSE * base.held_out.rms(chain.final)
        return chain if is_worse else longer

    def _revise(self, chain: Chain) -> Chain:
        """The chain with its earlier causes revised, unless that is worse on what is held out."""
        self.report("checking the first causes again", 0.75)
        base = self.base
        again = revised(chain, base.candidate, self.effects, base.scale, base.sigma)
        if base.held_out.rms(again.final) <= NO_WORSE * base.held_out.rms(chain.final):
            return again
        return chain

    def judged(self, chain: Chain, first: Candidate | None) -> SearchResult:
        """What a chain leaves, and which of its causes may be named, the largest first.

        Parameters
        ----------
        chain, first
            As in `SearchResult`.
        """
        base, held_out = self.base, self.base.held_out
        chain = largest_first(chain, base.candidate, base.scale, base.sigma)
        before, after = held_out.rms(base.candidate), held_out.rms(chain.final)
        if chain.links and after > (1.0 - LEAST_GAIN) * before:
            # A chain that gains nothing is chance.
            chain, after = Chain((), chain.links[0], base.candidate), before
        self.report("looking at what is left", 0.85)
        remainder = self.remainder_of(chain.final)
        links = tuple(with_rivals_held_out(link, chain.final, held_out.rms) for link in chain.links)
        if remainder.structured:
            links = tuple(with_rivals_in_misfit(link) for link in links)
        remainder = with_held_out(remainder, before, chain.final, held_out, base.sigma)
        best = best_of_tie(links, chain.final, held_out.rms)
        of_tie = None
        if best is not chain.final:
            of_tie = with_held_out(remainder, before, best, held_out, base.sigma)
        another = partial(is_another_actuator, chain.final, remainder, base)
        gain = 1.0 - after / before
        is_named = nameable(
            links, chain.final, remainder, gain=gain, of_tie=of_tie, is_another=another
        )
        return SearchResult(replace(chain, links=links), remainder, is_named, first)
