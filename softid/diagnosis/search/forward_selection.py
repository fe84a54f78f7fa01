"""Forward selection of causes: add the best effect, and go on while the whitened BIC falls."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import dataclass, replace

import numpy as np

from softid.diagnosis.refit.bound_relaxation import released, with_own_bounds
from softid.diagnosis.refit.candidates import Candidate, advance, prior_about, standing_at
from softid.diagnosis.refit.initial_states import with_settled_starts
from softid.diagnosis.search.bic_ranking import Ranked, rank
from softid.diagnosis.search.contenders import added_to, choose_contender
from softid.diagnosis.search.order_of_action import in_better_order
from softid.diagnosis.search.racing import UNCONVERGED, race
from softid.diagnosis.search.screening import Signature, screen
from softid.effects.base import Effect
from softid.effects.scale import Scale
from softid.parallel import in_parallel


@dataclass(frozen=True)
class Acceptance:
    """What a cause must bring to count.

    Attributes
    ----------
    predicted_fall
        Fall of n ln(S) that some signature must predict before anything is refitted. It predicts
        for white noise and a guessed shape, and a fall that counts is many times larger.
    bic
        Fall of the whitened BIC.
    share
        Share of the sum of squares that must go.
    """

    predicted_fall: float
    bic: float
    share: float


FIRST = Acceptance(predicted_fall=6.0, bic=18.0, share=0.0)
"""What a first cause must gain to be accepted."""

FURTHER = Acceptance(predicted_fall=15.0, bic=30.0, share=0.01)
"""What a further cause must gain to be accepted: small errors of the first one's law would else be
taken for a cause."""

BEHIND_NOISE = Acceptance(predicted_fall=60.0, bic=60.0, share=0.02)
"""What a further cause must gain to be accepted where what is left already looks like noise."""

MAX_LINKS = 3
"""A fourth cause would be fitted to what three have left, which is their own errors as a rule."""

MOST_TRIED = 3
"""When what is held out refuses the best contender, so many are tried in all."""

LARGEST_PROMISE = 0.999
"""Largest share of the sum of squares that a signature is taken to promise: rounding may make it
all, of which there is no logarithm."""

CONVERGING = 40
"""Evaluations that bring a model to its optimum."""

CONVERGING_ROUNDS = 3
"""Rounds of `CONVERGING` evaluations that a model gets while it is more than a standard error away
from its optimum."""

STILL_FALLS = 0.999
"""Share of its sum of squares below which a model must fall in one round of `CONVERGING`
evaluations to get another."""


@dataclass(frozen=True, eq=False)
class Link:
    """One step of the selection.

    Attributes
    ----------
    before
        What was to be extended, under the step's noise model.
    ranked
        All contenders of the step and what they extend, best first.
    chosen
        The contender that is taken: the best one, a plainer one that explains about as much, or a
        later one where what was held out refused those before.
    rivals
        Names of the effects that explain the logs as well, the chosen one's first.
    signatures
        The best signature of every effect.
    squares_before
        Sum of squares of what was to be extended, for white noise: what the promises are shares of.
    found
        The model with this link and those before it, at its optimum when the link was added.
    squares_before_it
        Sum of squares, for white noise, of the model with the links before it alone, where that is
        known to be another one than when it was added.
    replaced
        Names of other laws, and the model with them in the place of this and perhaps other causes,
        which explains the logs as well.
    """

    before: Ranked
    ranked: tuple[Ranked, ...]
    chosen: Ranked
    rivals: tuple[str, ...]
    signatures: tuple[Signature, ...]
    squares_before: float
    found: Candidate | None = None
    squares_before_it: float | None = None
    replaced: tuple[tuple[str, Candidate], ...] = ()

    @property
    def left_before(self) -> float:
        """Sum of squares that the links before it leave, for white noise."""
        return self.squares_before if self.squares_before_it is None else self.squares_before_it

    @property
    def added(self) -> Effect:
        """The effect that the link adds."""
        return self.added_by(self.chosen)

    def among(self, names: Set[str]) -> Link:
        """The link as if the effects of these names alone had been raced."""
        return replace(
            self,
            ranked=tuple(
                row for row in self.ranked if row is self.before or self.added_by(row).name in names
            ),
            rivals=tuple(name for name in self.rivals if name in names),
            replaced=tuple((name, model) for name, model in self.replaced if model.names <= names),
        )

    def added_by(self, row: Ranked) -> Effect:
        """The effect that a contender of the round adds."""
        return added_to(self.before, row)

    @property
    def extending(self) -> tuple[Ranked, ...]:
        """The ranked models without the one that they extend."""
        return tuple(row for row in self.ranked if row is not self.before)

    @property
    def contenders(self) -> tuple[Candidate, ...]:
        """The ranked models without the one that they extend, at their optimum for white noise."""
        return tuple(row.plain for row in self.extending)

    @property
    def delta_bic(self) -> float:
        """Fall of the BIC."""
        return self.before.bic - self.chosen.bic


@dataclass(frozen=True, eq=False)
class Chain:
    """The links found, and the step that found no more.

    Attributes
    ----------
    links
        One for each cause.
    last
        The step that added no further link, or one that was taken back; None when no step followed
        the last link, because the limit was reached or no signature predicted enough.
    final
        The model with all causes.
    """

    links: tuple[Link, ...]
    last: Link | None
    final: Candidate

    @property
    def bends(self) -> bool:
        """Whether a cause is a curve with free values, which bends to much that it is not."""
        return any(len(link.added.amplitudes) > 1 for link in self.links)

    def among(self, names: Set[str]) -> Chain:
        """The chain as if the effects of these names alone had been raced, its own among them."""
        return replace(self, links=tuple(link.among(names) for link in self.links), last=None)


def select_forward(
    base: Candidate,
    effects: Sequence[Effect],
    scale: Scale,
    sigma: Mapping[str, float],
    *,
    is_no_worse: Callable[[Candidate, Candidate], bool],
    is_noise: Callable[[Candidate], bool],
    report: Callable[[str, float], None] = lambda message, fraction: None,
    known_links: Sequence[Link] = (),
    extra: Sequence[Candidate] = (),
    raced: Link | None = None,
    max_links: int = MAX_LINKS,
) -> Chain:
    """Extend the base by one effect after the other.

    Parameters
    ----------
    base
        The base fit, or the model with the causes that are known already.
    effects
        The catalogue.
    scale
        Sizes of the base fit.
    sigma
        Output channel → scale that its residual is divided by.
    is_no_worse
        Whether a candidate is no worse than another on what was held out.
    is_noise
        Whether what a candidate leaves looks like noise, so that more is asked of a further cause.
    report
        Called with a sentence and the fraction done.
    known_links
        The links to those causes.
    extra
        Candidates for the first cause that began elsewhere, as in `race`.
    raced
        The round for the first cause without those, if it ran already.
    max_links
        No more causes than this.
    """
    links = list(known_links)
    now, acceptance = base, FIRST
    if links:
        acceptance = BEHIND_NOISE if is_noise(now) else FURTHER
    last: Link | None = None
    while len(links) < max_links:
        number = len(links)
        report(f"looking for cause {number + 1}", number / max_links)
        others, earlier = ((), None) if links else (extra, raced)
        link = next_link(now, effects, scale, sigma, acceptance, extra=others, raced=earlier)
        if link is None:
            break
        last = link
        found = _first_no_worse(link, now, sigma, is_no_worse, acceptance)
        if found is None:
            break
        link, extended = found
        links.append(replace(link, found=extended))
        last = None
        now = extended
        acceptance = BEHIND_NOISE if is_noise(now) else FURTHER
    return Chain(tuple(links), last, now)


def _first_no_worse(
    link: Link,
    now: Candidate,
    sigma: Mapping[str, float],
    is_no_worse: Callable[[Candidate, Candidate], bool],
    acceptance: Acceptance,
) -> tuple[Link, Candidate] | None:
    """The best contender that is accepted and no worse on what was held out, with its model."""
    others = [
        row
        for row in link.ranked
        if row not in (link.before, link.chosen) and row.bic >= link.chosen.bic
    ]
    for row in (link.chosen, *others[: MOST_TRIED - 1]):
        rivals = link.rivals if row is link.chosen else (link.added_by(row).name,)
        tried = replace(link, chosen=row, rivals=rivals)
        if not is_accepted(tried, acceptance):
            return None
        extended = converged(row.plain, sigma)
        if is_no_worse(now, extended):
            return tried, extended
    return None


def next_link(
    now: Candidate,
    effects: Sequence[Effect],
    scale: Scale,
    sigma: Mapping[str, float],
    acceptance: Acceptance,
    *,
    screened: Sequence[Signature] | None = None,
    known: Sequence[Candidate] = (),
    extra: Sequence[Candidate] = (),
    raced: Link | None = None,
) -> Link | None:
    """One round; None when nothing in the catalogue promises enough.

    ``screened`` holds the signatures of these effects and perhaps others, if they are known,
    ``known`` candidates that are near their optimum already, ``extra`` some that began elsewhere,
    ``raced`` the same round of the same effects without those.
    """
    taken = {effect.name for effect in now.effects}
    left = [effect for effect in effects if effect.name not in taken]
    if not left:
        return None
    if raced is not None:
        screened, known = raced.signatures, raced.contenders
    if screened is None:
        screened = screen(now, left, scale, sigma)
    asked = {effect.key for effect in left}
    signatures = [signature for signature in screened if signature.effect.key in asked]
    promised = max((s.drop for s in signatures), default=0.0)
    share = min(promised / now.squares, LARGEST_PROMISE) if now.squares > 0.0 else 0.0
    predicted_fall = -now.problem.n_samples * np.log1p(-share)
    if predicted_fall < acceptance.predicted_fall and not extra:
        return None
    contenders = race(
        now,
        left,
        scale,
        sigma,
        signatures=signatures,
        known=known,
        extra=extra,
        again=raced is not None,
    )
    contenders = in_parallel(
        lambda one: in_better_order(released(one, now.effects, sigma), sigma), contenders
    )
    ranked = rank([*contenders, now], sigma)
    before = next(r for r in ranked if r.candidate.keys == now.keys)
    others = [r for r in ranked if r is not before]
    if not others:
        return None
    chosen, rivals = choose_contender(others, before, scale.period_s)
    return Link(before, tuple(ranked), chosen, rivals, _best_promises(signatures), now.squares)


def is_accepted(link: Link, acceptance: Acceptance) -> bool:
    """Whether a link brings enough to count.

    Parameters
    ----------
    link
        The link.
    acceptance
        What is asked of it.
    """
    before, after = link.before.candidate.squares, link.chosen.candidate.squares
    takes = acceptance.share == 0.0 or after < (1.0 - acceptance.share) * before
    return link.delta_bic > acceptance.bic and takes


def _best_promises(signatures: Sequence[Signature]) -> tuple[Signature, ...]:
    best: dict[str, Signature] = {}
    for signature in signatures:
        best.setdefault(signature.effect.key, signature)
    return tuple(best.values())


def converged(candidate: Candidate, sigma: Mapping[str, float]) -> Candidate:
    """The candidate brought to its optimum for white noise, from which the next round starts."""
    for _ in range(CONVERGING_ROUNDS):
        before = candidate.squares
        n = max(candidate.problem.n_samples - candidate.problem.size, 1)
        point, problem = candidate.minimum.point, candidate.problem
        prior = prior_about(problem, point, problem.free, before / n)
        begin = standing_at(point, candidate.minimum, prior, before)
        candidate = advance(replace(candidate, minimum=begin, prior=prior), sigma, CONVERGING)
        held, candidate = candidate, with_settled_starts(with_own_bounds(candidate), sigma)
        if candidate is not held:
            continue
        rests = candidate.minimum.offset <= UNCONVERGED and not candidate.is_pulled
        if rests or candidate.squares > STILL_FALLS * before:
            break
    return candidate
