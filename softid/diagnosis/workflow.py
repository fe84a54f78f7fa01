"""The verb `diagnose`: what the simulation gets wrong, the cause, the extended model, the gain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from softid.diagnoses import Cause, Diagnosis, Remainder
from softid.diagnosis.assessment import (
    LEAST_GAIN,
    assess,
    gains_by,
    has_spring,
    held_out_share,
    nameable,
    stands,
    surroundings,
    verdict_of,
)
from softid.diagnosis.beginning import Asked, Beginning, Progress, require_enough
from softid.diagnosis.candidates import Candidate, catalogue
from softid.diagnosis.chain import MAX_LINKS, Chain, find_chain
from softid.diagnosis.credibility import credible, with_presliding
from softid.diagnosis.findings import (
    alternatives_of,
    causes_of,
    evidence_of,
    gains_of,
    whole_gain_of,
)
from softid.diagnosis.held_out import BETTER, NO_WORSE
from softid.diagnosis.indistinct import with_rivals_in_misfit
from softid.diagnosis.input_noise import without_input_noise
from softid.diagnosis.marks import marks_in
from softid.diagnosis.other_first import other_beginnings
from softid.diagnosis.other_reading import better_reading, is_open, read_as
from softid.diagnosis.remarks import averaged_over, restriction
from softid.diagnosis.residual_set import sets_left
from softid.diagnosis.revision import prefixes, revised, without_link
from softid.diagnosis.scale import fastest_time
from softid.diagnosis.thinning import samples_to_average, thinned
from softid.diagnosis.words import worded
from softid.effects.base import Effect
from softid.fitters.output_error import Optimum
from softid.identification.assembly import Identified, assemble
from softid.identification.preparation import as_log_set, without_dropouts
from softid.identification.wishes import Wishes
from softid.identification.workflow import Work
from softid.log import Log, LogSet
from softid.models.base import Model
from softid.parameters import ParameterSet
from softid.results import FitResult, FitStatus

if TYPE_CHECKING:
    import lmfit

BETTER_BASE = 0.98
"""Another optimum of the base counts when it leaves so much less than the first."""


def diagnose(
    logs: Log | Sequence[Log],
    *,
    hold_out: Sequence[Log] = (),
    model: Model | str | None = None,
    parameters: ParameterSet | lmfit.Parameters | None = None,
    effects: Sequence[str] = (),
    seed: int = 0,
    progress: Progress | None = None,
) -> Diagnosis:
    """Name the physical cause of what a model gets wrong, and measure what mending it gains.

    The base model is fitted. Every effect of the catalogue is then screened by its signature,
    refitted together with the base in a race, and compared by the BIC of residuals that one noise
    model has made white. Causes are added while that pays and the held-out error does not rise.
    What is left is compared with the noise and with chance, and decides the verdict.

    Parameters
    ----------
    logs
        Logs to explain.
    hold_out
        Logs that judge; without them contiguous blocks of the logs are held out.
    model
        Base model, its name, or None to choose.
    parameters
        Bounds, fixed values, ties and start values of the named model.
    effects
        Keys of the effects to consider; empty for the whole catalogue.
    seed
        Seed of restarts and of the bootstrap.
    progress
        Called with a sentence and the fraction done.

    Returns
    -------
    Diagnosis
        The verdict with its evidence.

    Raises
    ------
    InputError, UsageError, IdentificationError
        As `softid.fit`.
    """
    report = _rising(progress)
    log_set = LogSet(tuple(_cleaned(log) for log in as_log_set(logs)))
    hold_out = tuple(_cleaned(log) for log in hold_out)
    require_enough(log_set)
    asked = Asked(model, parameters, seed, lambda m, fraction: report(m, 0.3 * fraction))
    start = asked.begin(log_set, hold_out, thorough=False)
    fastest_s = fastest_time(start.base.problem, start.base.minimum.point)
    motion_s = min(start.scale.motion_s, fastest_s)
    count = samples_to_average((*log_set, *hold_out), motion_s)
    if count > 1:
        log_set = LogSet(tuple(thinned(log, count) for log in log_set))
        hold_out = tuple(thinned(log, count) for log in hold_out)
        start = asked.begin(log_set, hold_out, thorough=False)
    first = None
    if is_open(log_set):
        first = _extended(start, catalogue(effects), report, seed, max_links=1)
        reading = better_reading(first.final, dict(start.work.found.optimum.sigma))
        if reading is not None:
            log_set, hold_out = LogSet(read_as(log_set.logs, reading)), read_as(hold_out, reading)
            first = None
            start = asked.begin(log_set, hold_out, thorough=False)
    chain, remainder, is_named = _searched(start, effects, report, seed, first)
    if remainder.structured and not any(is_named):  # perhaps the base itself is a false optimum
        again = asked.begin(log_set, hold_out, thorough=True)
        if again.base.squares < BETTER_BASE * start.base.squares:
            start = again
            chain, remainder, is_named = _searched(start, effects, report, seed, None)
    if remainder.structured and not any(is_named):  # or the first cause stands for two others
        other = _from_other_causes(start, chain, effects, report, seed)
        chain, remainder, is_named = other or (chain, remainder, is_named)
    report("computing errors", 0.9)
    found = _answer(start, chain, remainder, is_named, seed)
    remarks = (*restriction(effects), *averaged_over(count))
    if has_spring(start.base):
        remarks = (*remarks, *sets_left(log_set))
    return worded(replace(found, issues=(*found.issues, *remarks)))


def _rising(progress: Progress | None) -> Progress:
    """The callback with fractions that never fall: what is searched twice begins at its start."""
    most = 0.0

    def report(message: str, fraction: float) -> None:
        nonlocal most
        most = max(most, fraction)
        if progress is not None:
            progress(message, most)

    return report


def _answer(
    start: Beginning,
    chain: Chain,
    remainder: Remainder,
    is_named: tuple[bool, ...],
    seed: int,
) -> Diagnosis:
    """The diagnosis in numbers: errors of the parameters, gains, and which names stay."""
    work, held, base = start.work, start.held, start.base
    rng = np.random.default_rng(seed)
    before = assemble(work.found, work.logs, work.hold_out, choice=work.choice, seed=seed)
    after = _fit_of(chain.final, work, seed) if chain.links else None
    models = prefixes(chain, base, start.scale, dict(work.found.optimum.sigma))
    errors = [held.first_errors(model) for model in models]
    causes = _with_errors_without(causes_of(chain, errors, after, rng), chain, start)
    whole = held.rms(chain.final)
    is_named = tuple(
        sure and after is not None and stands(cause, link.added, after, whole)
        for sure, cause, link in zip(is_named, causes, chain.links, strict=True)
    )
    is_named = credible(chain.links, causes, is_named, chain.final.squares)
    links = [
        with_presliding(link, cause, start.scale)
        for link, cause in zip(chain.links, causes, strict=True)
    ]
    told = list(zip(causes, is_named, strict=True))
    named = [link for link, sure in zip(links, is_named, strict=True) if sure]
    row = next(r for r in before.statistics if r.channel == before.outputs[0])
    marks = marks_in(
        surroundings(chain.final),
        start.scale.motion_s,
        channel=row.channel,
        unit=row.display_unit,
        factor=row.display_factor,
    )
    return Diagnosis(
        verdict=verdict_of(links, is_named, remainder),
        summary="",
        base=before,
        extended=after,
        causes=tuple(cause for cause, sure in told if sure),
        descriptive=tuple(cause for cause, sure in told if not sure),
        alternatives=alternatives_of(named or links),
        remainder=remainder,
        gains=gains_of(base, chain.final, held, before),
        evidence=evidence_of(chain),
        next_experiment=None,
        issues=(*(after if after is not None and named else before).issues, *marks),
        gain_ci95=whole_gain_of(errors, rng),
    )


def _with_errors_without(
    causes: Sequence[Cause], chain: Chain, start: Beginning
) -> tuple[Cause, ...]:
    """The causes; those that gain nothing in their place with the error of leaving them out."""
    sigma = dict(start.work.found.optimum.sigma)
    found = []
    for position, cause in enumerate(causes):
        if len(causes) > 1 and not gains_by(cause, np.inf):
            model = without_link(chain, position, start.base, start.scale, sigma)
            cause = replace(cause, holdout_rmse_without=start.held.rms(model))
        found.append(cause)
    return tuple(found)


def _cleaned(log: Log) -> Log:
    """The log as it is fitted, averaged and judged by: a drop-out must be in none of the three."""
    return without_dropouts(without_input_noise(log))


def _extended(
    start: Beginning,
    considered: Sequence[Effect],
    report: Progress,
    seed: int,
    *,
    begun: Chain | None = None,
    max_links: int = MAX_LINKS,
) -> Chain:
    """The base extended by causes that what is held out does not speak against."""

    def holds(before: Candidate, after: Candidate) -> bool:
        limit = BETTER if before.effects else NO_WORSE
        return start.held.rms(after) <= limit * start.held.rms(before)

    def is_noise(now: Candidate) -> bool:
        return not _left(start, now, seed).structured

    return find_chain(
        start.base if begun is None else begun.final,
        considered,
        start.scale,
        dict(start.work.found.optimum.sigma),
        holds=holds,
        is_noise=is_noise,
        report=lambda message, fraction: report(message, 0.3 + 0.4 * fraction),
        begun=() if begun is None else begun.links,
        max_links=max_links,
    )


def _left(start: Beginning, now: Candidate, seed: int) -> Remainder:
    return assess(start.base, now, start.scale, rng=np.random.default_rng(seed))


def _searched(
    start: Beginning,
    effects: Sequence[str],
    report: Progress,
    seed: int,
    begun: Chain | None = None,
) -> tuple[Chain, Remainder, tuple[bool, ...]]:
    """The chain of causes, each judged by what is held out; what it leaves; what may be named."""
    considered = catalogue(effects)
    if begun is not None and not begun.links:
        chain = begun
    else:
        chain = _extended(start, considered, report, seed, begun=begun, max_links=2)
    if len(chain.links) > 1:  # a wrong first cause would ask for a third that mends it
        chain = _asked_again(start, considered, chain, report)
        longer = _extended(start, considered, report, seed, begun=chain)
        if len(longer.links) > len(chain.links):
            chain = _asked_again(start, considered, longer, report)
        else:
            chain = replace(chain, last=longer.last)
    before, after = start.held.rms(start.base), start.held.rms(chain.final)
    if chain.links and after > (1.0 - LEAST_GAIN) * before:
        chain = Chain((), chain.links[0], start.base)  # a chain that gains nothing is chance
        after = before
    report("looking at what is left", 0.85)
    remainder = _left(start, chain.final, seed)
    if remainder.structured:
        chain = replace(chain, links=tuple(with_rivals_in_misfit(link) for link in chain.links))
    remainder = replace(remainder, held_out_share=held_out_share(before, after, remainder))
    is_named = nameable(chain.links, chain.final, remainder, gain=1.0 - after / before)
    largest_first = sorted(
        zip(chain.links, is_named, strict=True), key=lambda pair: -pair[0].squares_before
    )
    links = tuple(link for link, _ in largest_first)
    return replace(chain, links=links), remainder, tuple(sure for _, sure in largest_first)


def _from_other_causes(
    start: Beginning, chain: Chain, effects: Sequence[str], report: Progress, seed: int
) -> tuple[Chain, Remainder, tuple[bool, ...]] | None:
    """What a search finds from another first cause, if that leaves noise and may be named.

    So many more tries find something that explains most of any misfit.
    """
    sigma, considered = dict(start.work.found.optimum.sigma), catalogue(effects)
    known = chain.links[0].added.name if chain.links else None
    for begun in other_beginnings(known, start.base, considered, start.scale, sigma):
        longer = _extended(start, considered, report, seed, begun=begun, max_links=2)
        if not _left(start, longer.final, seed).structured:
            found = _searched(start, effects, report, seed, longer)
            if any(found[2]):
                return found
    return None


def _asked_again(
    start: Beginning, considered: Sequence[Effect], chain: Chain, report: Progress
) -> Chain:
    """The chain with its earlier causes revised, unless that is worse on what is held out."""
    report("checking the first causes again", 0.75)
    sigma = dict(start.work.found.optimum.sigma)
    again = revised(chain, start.base, considered, start.scale, sigma)
    if start.held.rms(again.final) <= NO_WORSE * start.held.rms(chain.final):
        return again
    return chain


def _fit_of(final: Candidate, work: Work, seed: int) -> FitResult:
    """The extended model as a fit with errors and scores."""
    problem, z = final.problem, final.minimum.point
    lower, upper = problem.bounds()
    width = np.where(np.isfinite(upper - lower), upper - lower, np.inf)
    near = np.where(np.isfinite(width), 1e-6 * width, 0.0)
    optimum = Optimum(
        z,
        0.5 * final.squares,
        dict(work.found.optimum.sigma),
        FitStatus.CONVERGED,
        final.minimum.reach,
        final.minimum.evaluations,
        (z - lower <= near) | (upper - z <= near),
        final.prior.centre,
    )
    wishes = Wishes.of(problem.model.parameters(), None)
    found = Identified(problem, optimum, work.found.unseen, wishes)
    return assemble(found, work.logs, work.hold_out, choice=work.choice, seed=seed)
