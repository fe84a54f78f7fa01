"""What the numbers of a diagnosis say against the names of its causes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import count, pairwise, takewhile

from softid.diagnosis.base.base_fit import BaseFit
from softid.diagnosis.changes.held_out_difference import gain_beside_difference, held_out_difference
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.residual.motion import heard, residual_context, samples_alike
from softid.diagnosis.residual.noise_floor import fastest_part
from softid.diagnosis.residual.one_step import is_one_step
from softid.diagnosis.search.forward_selection import Chain
from softid.diagnosis.verdict.cancelling import cancelling
from softid.diagnosis.verdict.chain_consistency import mending, taken_by
from softid.diagnosis.verdict.displacement import behind, displacing
from softid.diagnosis.verdict.naming import doubt_of, most_variation
from softid.diagnosis.verdict.occurrence import occurs
from softid.diagnosis.verdict.two_memories import MEMORIES, are_two_laws
from softid.diagnosis_results import Cause, Doubt, Remainder
from softid.effects import extended_name
from softid.effects.base import Effect
from softid.effects.scale import Scale
from softid.results import FitResult
from softid.uncertainty.autoregression import contiguous_runs

NO_GAIN = (Doubt.GAINS_NOTHING, Doubt.MAY_GAIN_NOTHING)
"""What is held out refuses these, if it holds them at all."""

DWARFED = 0.05
"""Share of the misfit of the largest cause, as a root mean square, up to which another may as well
be what the law of that one leaves, for no material keeps to its law more closely."""

PIECE = 0.2
"""What takes less than this share of what a law does that is not quite that of the catalogue may be
what this one leaves."""

GAINS_BESIDE = 0.1
"""Share of the held-out error that a cause takes away at least beside a number in which what is
held out differs, where it gains nothing without that."""

OVER_RECORD = ("smoothing", "smoothing.mean")
"""Filters that run over a record when it is there, noise and all. A moving average of the past may
be that of a sensor, whose converter adds noise behind it."""

LEAST_ALIKE = 3
"""Samples whose noise is alike behind a filter, at least, where it can be told from white noise."""

FAST_SHARE, OF_MEAN = 0.3, 1.5
"""Share of the variance of second differences of samples far apart that those of neighbours have at
least where fast noise is left, and the same times the number of samples between: in white noise it
is 1. Behind a mean of k samples it is 2/3 over k; what a converter or rounding adds behind the
filter is allowed for."""

WORTH_A_NAME = 0.1
"""Share of the held-out error that a filter takes away at least which the noise bears out, where
the interval of that gain holds a loss."""

WITHIN_A_SAMPLE = 0.1
"""Share of a sampling interval up to which a lag or a delay may as well be what the input did in
it."""


def with_doubts(
    causes: Sequence[Cause],
    chain: Chain,
    extended: FitResult | None,
    remainder: Remainder,
    base: BaseFit,
    whole: float,
) -> tuple[Cause, ...]:
    """The causes with what their numbers say against their names.

    Parameters
    ----------
    causes
        The causes with their held-out errors and variations.
    chain
        The chain that they come from.
    extended
        The fit with all of them; None without any.
    remainder
        What it leaves.
    base
        The base fit.
    whole
        Held-out error of the model with all causes, at the samples at which theirs were found.
    """
    if extended is None:
        return tuple(causes)
    final, held_out, scale = chain.final, base.held_out, base.scale
    varies = most_variation(remainder)
    displaced_by = displacing(final, base.candidate)
    # what differs by direction or by level says more than the motion whose place it takes
    moves_alike = (e.key for e in final.effects if e.is_linear and e.key in displaced_by)
    against = {
        **dict.fromkeys(moves_alike, Doubt.DISPLACES),
        **dict.fromkeys(behind(final, displaced_by), Doubt.ACTS_BEHIND),
        **dict.fromkeys(cancelling(final, base.candidate, scale), Doubt.CANCELS),
    }
    told, small, in_one_step = [], dwarfed(chain), is_one_step(final.problem)
    is_noisy = None
    if not remainder.noise_from_rounding:
        is_noisy = has_fast_noise(final, in_misfit=remainder.structured)
    pieces, is_alone = _pieces(chain, remainder, base), len(causes) == 1
    for cause, link in zip(causes, chain.links, strict=True):
        doubt = doubt_of(cause, link.added, extended, whole, varies=varies)
        if doubt is None and cause.key in small:
            doubt = Doubt.DWARFED
        if doubt is None and is_within_a_sample(cause, link.added, scale):
            doubt = Doubt.TOO_QUICK
        doubt = _of_filter(doubt, cause, is_noisy=is_noisy)
        if doubt is None and in_one_step and not link.added.has_one_form:
            doubt = Doubt.ONE_STEP
        if doubt is None and cause.key in pieces:
            doubt = Doubt.MENDS
        if doubt in NO_GAIN and is_alone:
            differs = held_out_difference(final, remainder, held_out, scale)
            beside = gain_beside_difference(differs, final, base)
            doubt = doubt if beside is None or beside < GAINS_BESIDE else None
        if doubt in NO_GAIN and not occurs(link.added, final, base.candidate, held_out, scale):
            doubt = Doubt.DOES_NOT_OCCUR
        told.append(replace(cause, doubt=against.get(cause.key, doubt)))
    return tuple(told)


def _pieces(chain: Chain, remainder: Remainder, base: BaseFit) -> frozenset[str]:
    """Keys of causes that may be pieces of one law, without two that are shown to be two laws.

    One of those two is then not quite that of the catalogue, and what it leaves looks like others.
    """
    final, links = chain.final, chain.links
    found = mending(links, final.squares, remainder)
    memories = {effect.key for effect in final.effects if effect.name in MEMORIES}
    has_both = len(memories) == len(MEMORIES)
    if not (has_both and found & memories and are_two_laws(final, base, remainder)):
        return found
    taken = dict(
        zip((link.added.key for link in links), taken_by(links, final.squares), strict=True)
    )
    least = PIECE * min(taken[key] for key in memories)
    return (found - memories) | {key for key in taken.keys() - memories if taken[key] < least}


def has_fast_noise(final: Candidate, *, in_misfit: bool = False) -> bool | None:
    """Whether fast noise is left that a filter over the record would have taken away.

    Behind such a filter the noise of neighbouring samples is alike. A misfit that a filter follows,
    as that of a second mass, is not.

    Parameters
    ----------
    final
        The model with all causes.
    in_misfit
        Whether more than noise is left. Samples far apart then differ by the misfit; behind a
        filter those hardly apart do not differ by anything.

    Returns
    -------
    bool or None
        None without such a filter, or where it is too short to tell.
    """
    alike = samples_alike(final)
    if not any(effect.key in OVER_RECORD for effect in final.effects) or alike < LEAST_ALIKE:
        return None
    runs = [
        run
        for part in heard(final, residual_context(final))
        for run in contiguous_runs(part.residual)
    ]
    fast = fastest_part(runs).variance
    apart = (
        takewhile(lambda n: n < alike, (LEAST_ALIKE * 2**k for k in count())) if in_misfit else ()
    )
    return any(
        fast > max(FAST_SHARE, OF_MEAN / n) * fastest_part(runs, n).variance
        for n in (*apart, alike)
    )


def _of_filter(doubt: Doubt | None, cause: Cause, *, is_noisy: bool | None) -> Doubt | None:
    """What speaks against a filter over the record, which the noise refutes or bears out."""
    if cause.key not in OVER_RECORD or is_noisy is None:
        return doubt
    if is_noisy:
        return doubt or Doubt.FAST_NOISE
    gains = cause.holdout_rmse_after < (1.0 - WORTH_A_NAME) * cause.holdout_rmse_before
    return None if doubt is Doubt.MAY_GAIN_NOTHING and gains else doubt


def dwarfed(chain: Chain) -> set[str]:
    """Keys of the causes that take away next to nothing beside what another one does.

    Parameters
    ----------
    chain
        The chain.
    """
    squares = [*(link.left_before for link in chain.links), chain.final.squares]
    falls = [before - after for before, after in pairwise(squares)]
    least = DWARFED**2 * max(falls, default=0.0)
    return {link.added.key for link, f in zip(chain.links, falls, strict=True) if f < least}


def is_within_samples(descriptions: Sequence[Cause], left: Remainder) -> bool:
    """Whether all that was missing is what the input did between its samples.

    Parameters
    ----------
    descriptions
        What may not be named.
    left
        What is left behind it.
    """
    quick = [cause.doubt is Doubt.TOO_QUICK for cause in descriptions]
    return any(quick) and all(quick) and not left.leaves_something


def is_within_a_sample(cause: Cause, effect: Effect, scale: Scale) -> bool:
    """Whether a cause whose size is a time is over when a sampling interval has hardly begun.

    Parameters
    ----------
    cause
        The cause with its parameters.
    effect
        Its effect.
    scale
        Sizes of the logs.
    """
    if effect.amplitude is None or not effect.takes_time(scale):
        return False
    values = {p.name: p.value for p in cause.parameters}
    size = values[extended_name(effect, effect.amplitude)]
    ratio = values.get(extended_name(effect, "ratio"), 1.0)
    return size * max(ratio, 1.0) < WITHIN_A_SAMPLE * scale.period_s
