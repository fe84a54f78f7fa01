"""The verb `diagnose`: what the simulation gets wrong, the cause, the extended model, the gain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from softid.diagnoses import Cause, Diagnosis, Verdict
from softid.diagnosis.assessment import (
    gains_by,
    has_spring,
    most_variation,
    stands,
    surroundings,
    verdict_of,
)
from softid.diagnosis.beginning import Asked, Beginning, Given, Progress, require_enough
from softid.diagnosis.candidates import Candidate, catalogue
from softid.diagnosis.chain import Chain
from softid.diagnosis.change_point import change_marks
from softid.diagnosis.constancy import variations
from softid.diagnosis.credibility import credible, with_presliding
from softid.diagnosis.findings import (
    alternatives_of,
    causes_of,
    evidence_of,
    gains_of,
    told_as,
    whole_gain_of,
)
from softid.diagnosis.input_noise import without_input_noise
from softid.diagnosis.lost_input import without_lost_input
from softid.diagnosis.marks import marks_in
from softid.diagnosis.other_reading import (
    first_reading,
    is_measured,
    is_open,
    last_reading,
    read_as,
    straight_unless_told,
)
from softid.diagnosis.plainer_base import plainer, remark_on
from softid.diagnosis.remarks import averaged_over, refused, restriction, rounding
from softid.diagnosis.residual_set import sets_left
from softid.diagnosis.revision import prefixes, without_link
from softid.diagnosis.scale import fastest_time
from softid.diagnosis.searches import Found, extended, from_other_places, searched_thoroughly
from softid.diagnosis.thinning import samples_to_average, thinned
from softid.diagnosis.words import worded
from softid.fitters.output_error import Optimum
from softid.identification.assembly import Identified, assemble
from softid.identification.preparation import as_log_set, without_dropouts
from softid.identification.wishes import Wishes
from softid.identification.workflow import Work
from softid.intersample import Intersample
from softid.log import Log, LogSet
from softid.models.base import Model
from softid.parameters import ParameterSet
from softid.results import FitResult, FitStatus

if TYPE_CHECKING:
    import lmfit


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
    recorded = as_log_set(logs)
    is_in_doubt = is_open(recorded)
    given = Given(recorded, tuple(hold_out)).each(_cleaned)
    if is_measured(recorded):
        given = given.each(straight_unless_told)
    require_enough(given.logs, given.hold_out)
    asked = Asked(model, parameters, seed, lambda m, fraction: report(m, 0.3 * fraction))
    given, start, count = _prepared(given, asked)
    asked, start = plainer(given, asked, start)
    first = None
    if is_in_doubt:
        first = extended(start, catalogue(effects), report, seed, max_links=1)
        sigma = dict(start.work.found.optimum.sigma)
        reading = first_reading(start.base, first.final, sigma)
        if reading is not None:
            given, first = _read_as(given, reading), None
            start = asked.begin(given.logs, given.hold_out, thorough=False)
    found, start = searched_thoroughly(given, asked, start, effects, report, first)
    if is_in_doubt and len(found.chain.links) > 1:  # the first cause alone may have misled, too
        reading = last_reading(found.chain.final, dict(start.work.found.optimum.sigma))
        if reading is not None:
            given = _read_as(given, reading)
            start = asked.begin(given.logs, given.hold_out, thorough=False)
            found, start = searched_thoroughly(given, asked, start, effects, report, None)
    report("computing errors", 0.9)
    answer = _answer(start, found, seed)
    if answer.verdict is Verdict.UNKNOWN and not found.remainder.structured:
        other = from_other_places(start, found, effects, report, seed)
        answer = _answer(start, other, seed) if other else answer
    rounded = rounding(recorded, answer.base, answer.remainder.rms) if count == 1 else ()
    remarks = (*restriction(effects), *averaged_over(count), *rounded)
    if answer.verdict is Verdict.UNKNOWN:
        moments = change_marks(start.base, start.scale, seed=seed)
        remarks = (*moments, *remarks)
        answer = replace(answer, next_experiment=moments[0].remedy if moments else None)
    if has_spring(start.base):
        remarks = (*remarks, *sets_left(given.logs))
    return worded(replace(answer, issues=(*answer.issues, *remarks)))


def _read_as(given: Given, reading: Intersample) -> Given:
    """All logs with a declared reading of the input."""
    return Given(LogSet(read_as(given.logs.logs, reading)), read_as(given.hold_out, reading))


def _prepared(given: Given, asked: Asked) -> tuple[Given, Beginning, int]:
    """Logs without what depends on lost input or is needless, fitted; how many samples a mean.

    Both need a fit that knows how long the actuator remembers.
    """
    start = asked.begin(given.logs, given.hold_out, thorough=False)
    known = partial(
        without_lost_input, model=start.base.problem.model, values=start.base.parameters
    )
    kept = given.each(known)
    fastest_s = fastest_time(start.base.problem, start.base.minimum.point)
    count = samples_to_average((*given.logs, *given.hold_out), min(start.scale.motion_s, fastest_s))
    if count > 1:
        kept = kept.each(partial(thinned, count=count))
    if kept is not given:
        start = asked.begin(kept.logs, kept.hold_out, thorough=False)
    return kept, start, count


def _rising(progress: Progress | None) -> Progress:
    """The callback with fractions that never fall: what is searched twice begins at its start."""
    most = 0.0

    def report(message: str, fraction: float) -> None:
        nonlocal most
        most = max(most, fraction)
        if progress is not None:
            progress(message, most)

    return report


def _answer(start: Beginning, found: Found, seed: int) -> Diagnosis:
    """The diagnosis in numbers: errors of the parameters, gains, and which names stay."""
    chain, remainder, is_named = found.chain, found.remainder, found.is_named
    work, held, base = start.work, start.held, start.base
    asked_for, is_asked_for = start.asked_for, start.instead_of is None
    rng = np.random.default_rng(seed)
    first = asked_for.work
    before = assemble(first.found, first.logs, first.hold_out, choice=first.choice, seed=seed)
    after = _fit_of(chain.final, work, seed) if chain.links or not is_asked_for else None
    models = prefixes(chain, base, start.scale, dict(work.found.optimum.sigma))
    errors = [held.first_errors(model) for model in models]
    causes = _with_errors_without(causes_of(chain, errors, after, rng), chain, start)
    causes = _with_variations(causes, chain, start)
    whole = held.rms(chain.final)
    varies = most_variation(remainder)
    is_named = tuple(
        sure and after is not None and stands(cause, link.added, after, whole, varies=varies)
        for sure, cause, link in zip(is_named, causes, chain.links, strict=True)
    )
    is_named = credible(chain.links, causes, is_named, chain.final.squares)
    links = [
        with_presliding(link, cause, start.scale)
        for link, cause in zip(chain.links, causes, strict=True)
    ]
    forms = {
        link.added.key: told_as(link.added, cause.parameters).key
        for link, cause in zip(links, causes, strict=True)
    }
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
        alternatives=alternatives_of(named or links, forms),
        remainder=remainder,
        gains=gains_of(asked_for.base, chain.final, held, before),
        evidence=evidence_of(chain),
        next_experiment=None,
        issues=(
            *(after if after is not None and named else before).issues,
            *remark_on(start, unit=row.display_unit, factor=row.display_factor),
            *marks,
            *(refused(chain, held) if remainder.structured else ()),
        ),
        gain_ci95=whole_gain_of(
            errors if is_asked_for else [held.first_errors(asked_for.base), *errors], rng
        ),
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


def _with_variations(causes: Sequence[Cause], chain: Chain, start: Beginning) -> tuple[Cause, ...]:
    """The causes with how their sizes vary throughout the logs."""
    if not causes:
        return ()
    sigma = dict(start.work.found.optimum.sigma)
    varied = variations(chain.final, [link.added for link in chain.links], sigma)
    return tuple(replace(c, variation=v) for c, v in zip(causes, varied, strict=True))


def _cleaned(log: Log) -> Log:
    """The log as it is fitted, averaged and judged by: a drop-out must be in none of the three."""
    return without_dropouts(without_input_noise(log))


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
