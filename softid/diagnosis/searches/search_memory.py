"""What a search for causes has worked out already, so that nothing of it is done twice."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.search.forward_selection import Chain
from softid.diagnosis_results import Remainder


@dataclass(frozen=True, eq=False)
class SearchMemory:
    """Remainders of models and grown chains, which many beginnings of a search ask for.

    It lives as long as the one search that it belongs to, over one base with one seed, for all that
    is in it depends on these; a search over another base begins with an empty one. What is asked
    for first and what comes later changes no answer, only how long it takes.
    """

    _remainders: dict[Candidate, Remainder] = field(default_factory=dict)
    _grown: dict[tuple[Chain, int], Chain] = field(default_factory=dict)

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
