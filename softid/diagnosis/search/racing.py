"""Joint refits of all candidate causes as a race."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from functools import partial

from softid.diagnosis.refit.candidates import COARSE_STEPS, FINE_STEPS, Candidate
from softid.diagnosis.refit.equivalent_places import alternatives, exchanged
from softid.diagnosis.refit.rough_copy import over_samples_of, rough_copy
from softid.diagnosis.search.catching_up import (
    SMALLEST_GAIN,
    best_of_each,
    by_squares,
    gain,
    one_of_each_place,
)
from softid.diagnosis.search.effect_starts import (
    candidate_from,
    late_candidate,
    slow_candidate,
)
from softid.diagnosis.search.forms import (
    by_themselves,
    forms_that_gain,
    is_richer,
    simpler_forms,
)
from softid.diagnosis.search.order_of_action import in_better_order, other_order
from softid.diagnosis.search.rounds import (
    FAR_ROUND,
    SECOND_ROUND,
    one_round,
    run_in_reach,
    run_round,
    run_rounds,
    those_in_reach,
    variance_of,
)
from softid.diagnosis.search.screening import Signature, screen
from softid.effects import confusable_with
from softid.effects.base import Effect
from softid.effects.scale import Scale
from softid.parallel import in_parallel

SECOND_START = 0.3
"""A further start of an effect runs when it promises this share of the best one's drop."""

MAX_STARTS = 2
"""Starts of one effect that run at most."""

FIRST_ROUND = 4
"""Evaluations of the first round, which all starts run."""

LAST_ROUNDS = (5, 10, 25)
"""Evaluations of the last rounds, within which who cannot catch up any more drops out."""

SECOND_SURVIVORS = 7
"""Candidates that stay in the race for the second round."""

LAST_SURVIVORS = 4
"""Candidates that stay in the race for the last round. All of them also start with the times of
inertia and lag exchanged, for which of two poles is whose has nothing to do with who leads."""

FINAL_DISTANCE = 24.0
"""Distance from the leader, in n ln(S), up to which candidates stay for the last round beyond their
number: a parameter more costs 8, and 12 of BIC tell no cause from another, so that a tie is not
missed for the fifth of them."""

FORM_SURVIVORS = 2
"""Candidates of the last round that also start with the base's terms in another form."""

MULTISTART_ROUNDS = (8, 8, 16)
"""Evaluations of the rounds of candidates from a multistart."""

MULTISTART_SURVIVORS = 8
"""Candidates from a multistart that join the race."""

PROMISING_SIGNATURES = 5
"""Effects of the best signatures stay for the second round however far the first one brought them:
a motion that integrates its force answers violently to a start that is a little off."""

UNSETTLED_OFFSET = 5.0
"""Standard errors from its optimum beyond which a candidate stays for the second round in any
case."""

UNCONVERGED = 1.0
"""Candidates that are more standard errors away from their optimum after the second round run it
again before anyone drops out: some begin worse than the base."""

EXTRA_ROUNDS = 2
"""Most further rounds of candidates that are not settled."""

FAVOURITES = 2
"""The effects of so many best signatures that are still not settled run the last round too."""

CLEAR_LEAD = 0.2
"""A candidate whose sum of squares above the leader's is more than this share of the base's misfit
above the leader's drops out before the last round."""

UNCONVERGED_LEAD = 0.5
"""Share of the base's misfit above the leader's beyond which a candidate that is not settled drops
out before the last round."""


def race(
    fitted: Candidate,
    effects: Sequence[Effect],
    scale: Scale,
    sigma: Mapping[str, float],
    *,
    signatures: Sequence[Signature] | None = None,
    known: Sequence[Candidate] = (),
    extra: Sequence[Candidate] = (),
    again: bool = False,
) -> list[Candidate]:
    """Refit the base with each effect, polishing the contenders only; best first.

    All rounds but the last ones run on a `rough_copy`, where they cost a fraction.

    A richer form of a law enters where the plain one has got to, when that is still in the race
    after its second round, and leaves again if it hardly gains on it; one that promises far more
    runs from the start. Where it led to a better place, the plain one follows it there at the end,
    and so does a simpler effect that the law is like.

    Parameters
    ----------
    fitted
        What is to be extended.
    effects
        Effects that it does not have.
    scale
        Sizes of the base fit.
    sigma
        Output channel → scale that its residual is divided by.
    signatures
        From `screen`, if it ran already.
    known
        Candidates near their optimum already, which join for the last round; their effects do not
        run the others.
    extra
        Candidates that began elsewhere and came far; their effects run as usual, too.
    again
        Whether the race was run already without those: who dropped out would do so again, and only
        what is known and what began elsewhere runs.
    """
    found = list(signatures) if signatures is not None else screen(fitted, effects, scale, sigma)
    richer = [effect for effect in effects if any(is_richer(effect, e, scale) for e in effects)]
    late_forms = {effect.key for effect in richer} - by_themselves(found, richer)
    left_out = {c.effects[-1].key for c in known} | late_forms
    running = [e for e in effects if e.key not in left_out] if not again else []
    rough, rough_sigma = rough_copy(fitted, scale, sigma)
    near, far = ([over_samples_of(c, rough, scale) for c in those] for those in (known, extra))
    first = _first_round(rough, found, running, scale, rough_sigma)
    promising = list(dict.fromkeys(s.effect.key for s in found))
    second = _second_round(rough, first, promising, running, scale, rough_sigma)
    far, near = run_rounds([(far, FAR_ROUND), (near, 1)], rough_sigma, COARSE_STEPS)
    second = best_of_each([*second, *near, *far])
    entering = [effect for effect in richer if effect.key in late_forms]
    second = by_squares([*second, *forms_that_gain(rough, second, entering, scale, rough_sigma)])
    if not second or gain(rough.squares, second[0]) < SMALLEST_GAIN:
        best = [over_samples_of(candidate, fitted, scale) for candidate in second[:1]]
        return run_round(best, sigma, 1, FINE_STEPS)
    kept = _contenders(rough, second, promising, late_forms, rough_sigma)
    last = _last_rounds([over_samples_of(c, fitted, scale) for c in kept], sigma)
    last += simpler_forms(fitted, best_of_each(last)[:FORM_SURVIVORS], effects, scale, sigma)
    return best_of_each(last)


def refined(
    starts: Sequence[Candidate], base: Candidate, sigma: Mapping[str, float]
) -> list[Candidate]:
    """Candidates from starts of their own near their optimum, the best of each effect.

    Parameters
    ----------
    starts
        Where they begin.
    base
        The base fit, to which any start leads back.
    sigma
        Output channel → scale that its residual is divided by.
    """
    running, out = list(starts), list[Candidate]()
    for evaluations in MULTISTART_ROUNDS:
        running, out_of_reach = run_in_reach(
            running, out, sigma, evaluations, COARSE_STEPS, known=base.squares
        )
        out += out_of_reach
    return best_of_each([*running, *out])[:MULTISTART_SURVIVORS]


def _first_round(
    fitted: Candidate,
    signatures: Sequence[Signature],
    running: Sequence[Effect],
    scale: Scale,
    sigma: Mapping[str, float],
) -> list[Candidate]:
    """A few evaluations from the best starts of every effect; the best of each."""
    variance = variance_of(fitted)
    keys = {effect.key for effect in running}
    begins: list[Callable[[], Candidate]] = [
        partial(candidate_from, fitted, s, scale, sigma, variance)
        for s in _starts(signatures)
        if s.effect.key in keys
    ]
    begins += [
        partial(late_candidate, fitted, effect, scale, sigma, variance)
        for effect in running
        if effect.takes_time(scale)
    ]
    return best_of_each(
        in_parallel(
            lambda begin: one_round(begin(), sigma, FIRST_ROUND, COARSE_STEPS, straight=True),
            begins,
        )
    )


def _second_round(
    fitted: Candidate,
    first: Sequence[Candidate],
    promising: Sequence[str],
    running: Sequence[Effect],
    scale: Scale,
    sigma: Mapping[str, float],
) -> list[Candidate]:
    """Those that stay after the first round, once more, and the unconverged among them again.

    Effects that take time also begin far off, whoever dropped out: a base that was fitted to a slow
    sensor has taken its time, and leaves a lag nothing to explain where a search begins. And limits
    of a reading with a drift are tried in front of that, too: behind it they cut what they do not.
    """
    favoured = promising[:PROMISING_SIGNATURES]
    field = [
        c
        for k, c in enumerate(first)
        if k < SECOND_SURVIVORS
        or c.effects[-1].key in favoured
        or c.minimum.offset > UNSETTLED_OFFSET
    ]
    far_off = [form for candidate in first for form in exchanged(candidate)]
    variance = variance_of(fitted)
    slow = [effect for effect in running if effect.takes_time(scale)]
    far_off += [slow_candidate(fitted, effect, scale, variance) for effect in slow]
    far_off += in_parallel(
        lambda one: in_better_order(one, sigma),
        [one for one in first if other_order(one.acting) != one.acting],
    )
    afar, near = run_rounds([(far_off, SECOND_ROUND), (field, SECOND_ROUND)], sigma, COARSE_STEPS)
    _, left_behind = those_in_reach(far_off, afar, near)
    return by_squares(_led_on([*afar, *near], left_behind, [], sigma))


def _led_on(
    candidates: Sequence[Candidate],
    left_behind: Sequence[Candidate],
    others: Sequence[Candidate],
    sigma: Mapping[str, float],
) -> list[Candidate]:
    """Candidates after further rounds of those that are unconverged and may catch up."""
    found, behind = list(candidates), list(left_behind)
    for _ in range(EXTRA_ROUNDS):
        moving = [c for c in found if _is_moving(c) and c not in behind]
        resting = [c for c in found if c not in moving]
        again, out_of_reach = run_in_reach(
            moving, [*resting, *others], sigma, SECOND_ROUND, COARSE_STEPS
        )
        found = resting + again + out_of_reach
        behind += out_of_reach
    return found


def _contenders(
    fitted: Candidate,
    second: Sequence[Candidate],
    promising: Sequence[str],
    late_forms: Collection[str],
    sigma: Mapping[str, float],
) -> list[Candidate]:
    """Those that stay for the last rounds, also with the base's terms or two times exchanged.

    A richer form that entered late bends to what a rough copy makes of the samples as well: it
    drives nobody out that is near the best of the others.
    """
    plain = [candidate for candidate in second if candidate.effects[-1].key not in late_forms]
    leader = (plain or second)[0].squares
    misfit = max(fitted.squares - leader, 0.0)
    limit = leader + CLEAR_LEAD * misfit
    kept = _last_survivors(second, promising, limit, leader + UNCONVERGED_LEAD * misfit)
    forms = [form for candidate in kept for form in exchanged(candidate)]
    forms += [form for candidate in kept[:FORM_SURVIVORS] for form in alternatives(candidate)]
    moved = run_round(forms, sigma, SECOND_ROUND, COARSE_STEPS)
    _, left_behind = those_in_reach(forms, moved, kept)
    forms = _led_on(moved, left_behind, kept, sigma)
    return one_of_each_place([*kept, *(form for form in forms if form.squares <= limit)])


def _last_survivors(
    second: Sequence[Candidate], promising: Sequence[str], limit: float, unconverged_limit: float
) -> list[Candidate]:
    """Those that stay after the second round: near the leader, or still on their way.

    Whoever is hardly behind stays, and so do the neighbours of their laws, in any of their forms,
    when they are near: it is them that these are taken for.
    """
    kept = []
    level = [-gain(second[0].squares, candidate) < FINAL_DISTANCE for candidate in second]
    leading = {c.effects[-1].name for c, is_level in zip(second, level, strict=True) if is_level}
    forms = [c.effects[-1] for c in second if c.effects[-1].name in leading]
    neighbours = {name for form in forms for name in confusable_with(form)}
    for k, candidate in enumerate(second):
        is_unconverged = _is_moving(candidate)
        asked = k < LAST_SURVIVORS or level[k] or candidate.effects[-1].name in neighbours
        near = asked and candidate.squares <= (unconverged_limit if is_unconverged else limit)
        if near or (is_unconverged and candidate.effects[-1].key in promising[:FAVOURITES]):
            kept.append(candidate)
    return kept


def _is_moving(candidate: Candidate) -> bool:
    """Whether it is far from its optimum, or held back from there."""
    return candidate.minimum.offset > UNCONVERGED or candidate.is_pulled


def _last_rounds(kept: Sequence[Candidate], sigma: Mapping[str, float]) -> list[Candidate]:
    """The contenders at their optimum, and those that cannot catch up as far as they got."""
    running, out = list(kept), list[Candidate]()
    for evaluations in LAST_ROUNDS:
        running, out_of_reach = run_in_reach(running, out, sigma, evaluations, FINE_STEPS)
        out += out_of_reach
    return running + out


def _starts(signatures: Sequence[Signature]) -> list[Signature]:
    """The best starts of every effect."""
    chosen: dict[str, list[Signature]] = {}
    for signature in signatures:
        mine = chosen.setdefault(signature.effect.key, [])
        if not mine or (len(mine) < MAX_STARTS and signature.drop >= SECOND_START * mine[0].drop):
            mine.append(signature)
    return [s for mine in chosen.values() for s in mine]
