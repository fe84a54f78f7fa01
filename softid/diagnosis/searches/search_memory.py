"""What a search for causes has worked out already, so that nothing of it is done twice."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.search.forward_selection import Chain
from softid.diagnosis.searches.search_result import SearchResult
from softid.diagnosis_results import Remainder


@dataclass(frozen=True, eq=False)
class SearchMemory:
    """Remainders, grown chains and what other first causes lead to, which are asked for repeatedly.

    It lives as long as the one search that it belongs to, over one base with one seed, for all that
    is in it depends on these; a search over another base begins with an empty one. What is asked
    for first and what comes later changes no answer, only how long it takes.
    """

    _remainders: dict[Candidate, Remainder] = field(default_factory=dict)
    _grown: dict[tuple[Chain, int], Chain] = field(default_factory=dict)
    _from_others: dict[Chain, SearchResult] = field(default_factory=dict)

    def remainder(self, model: Candidate, assessed: Callable[[], Remainder]) -> Remainder:
        """What a model leaves.

        Parameters
        ----------
        model
            The base with causes.
        assessed
            Tells it, if it is not known.
        """
        if model not in self._remainders:
            self._remainders[model] = assessed()
        return self._remainders[model]

    def grown(self, chain: Chain, max_links: int, selected: Callable[[], Chain]) -> Chain:
        """A chain with further causes.

        Parameters
        ----------
        chain
            What is known already.
        max_links
            How many causes it may have then.
        selected
            Grows it, if that was not done yet.
        """
        if (chain, max_links) not in self._grown:
            self._grown[chain, max_links] = selected()
        return self._grown[chain, max_links]

    def from_others(
        self, known: SearchResult, searched: Callable[[], SearchResult]
    ) -> SearchResult:
        """What other first causes than those of a known chain lead to.

        Parameters
        ----------
        known
            What is known.
        searched
            Looks for it, if that was not done yet; where nothing is sure it gives what is known,
            with what was met on the way.
        """
        if known.chain not in self._from_others:
            self._from_others[known.chain] = searched()
        found = self._from_others[known.chain]
        if found.chain is not known.chain:
            return found
        return replace(known, unsure=found.unsure) if found.unsure else known
