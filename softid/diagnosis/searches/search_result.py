"""What a search for causes found."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.search.forward_selection import Chain
from softid.diagnosis.verdict.naming import EXPLAINED
from softid.diagnosis_results import Remainder

SAME_OPTIMUM = 1e-3
"""Models of the same structure whose sums of squares differ by less are at the same optimum."""


@dataclass(frozen=True)
class SearchResult:
    """What a search found.

    Attributes
    ----------
    chain
        The causes.
    remainder
        What they leave.
    is_named
        Which of them may be named.
    first
        The model with the cause that was found first, as it was then; None without a cause.
    met_multistart
        Whether candidates from a multistart took part.
    unsure
        Results from other first causes that explained the fitted samples and were not sure.
    """

    chain: Chain
    remainder: Remainder
    is_named: tuple[bool, ...]
    first: Candidate | None = None
    met_multistart: bool = False
    unsure: tuple[SearchResult, ...] = ()

    def with_unsure(self, results: Sequence[SearchResult]) -> SearchResult:
        """The same with results that were met on the way and not sure.

        Parameters
        ----------
        results
            Them.
        """
        return replace(self, unsure=(*self.unsure, *results)) if results else self

    @property
    def promising(self) -> Candidate | None:
        """What left noise on the fitted samples from another first cause, and erred elsewhere."""
        models = (result.chain.final for result in self.unsure)
        return min(models, key=lambda model: model.squares, default=None)

    @property
    def without_names(self) -> SearchResult:
        """The same as no more than a description."""
        return replace(self, is_named=(False,) * len(self.is_named))

    @property
    def came_to_nothing(self) -> bool:
        """Whether structure is left, there or on what is held out, and no cause explains it."""
        missed = self.remainder.misses_held_out and bool(self.chain.links)
        return (self.remainder.structured or missed) and not any(self.is_named)

    @property
    def is_sure(self) -> bool:
        """Whether causes may be named that leave noise and next to nothing of the misfit.

        Many tries find something that explains most of any misfit, so no less will do.
        """
        whole = self.remainder.explained_share > EXPLAINED
        return any(self.is_named) and whole and not self.remainder.leaves_something


def is_same_model(one: Candidate, other: Candidate) -> bool:
    """Whether two models have the same causes, whichever was found first, and explain as much.

    Parameters
    ----------
    one, other
        The models.
    """
    explain_as_much = abs(one.squares / other.squares - 1.0) < SAME_OPTIMUM
    return set(one.keys) == set(other.keys) and explain_as_much
