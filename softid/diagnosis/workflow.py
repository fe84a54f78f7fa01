"""The verb `diagnose`: what the simulation gets wrong, the cause, the extended model, the gain."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from softid.diagnoses import Diagnosis
from softid.diagnosis.assessment import assess, nameable, verdict_of
from softid.diagnosis.candidates import Candidate, advance, catalogue, prior_about
from softid.diagnosis.chain import Chain, find_chain
from softid.diagnosis.findings import alternatives_of, causes_of, evidence_of, gains_of
from softid.diagnosis.held_out import BETTER, NO_WORSE, HeldOut, hold_out_blocks
from softid.diagnosis.input_noise import without_input_noise
from softid.diagnosis.revision import revised
from softid.diagnosis.scale import scale_of
from softid.diagnosis.thinning import samples_to_average, thinned
from softid.diagnosis.words import averaged_over, restriction, worded
from softid.effects.base import Scale
from softid.fitters.levenberg_marquardt import Minimum, Normal
from softid.fitters.output_error import Optimum
from softid.fitters.problem import Problem
from softid.identification.assembly import Identified, assemble
from softid.identification.preparation import as_log_set, without_dropouts
from softid.identification.wishes import Wishes
from softid.identification.workflow import Work, identify
from softid.log import Log, LogSet
from softid.models import MODELS
from softid.models.base import Model
from softid.parameters import ParameterSet
from softid.results import FitResult, FitStatus

if TYPE_CHECKING:
    import lmfit

Progress = Callable[[str, float], None]

RESTORING_LAP = 15
HIDDEN_PERIODS = 0.1
"""A restored term dies out within a tenth of the sampling interval."""


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
    report = progress or (lambda message, fraction: None)
    log_set = LogSet(tuple(_cleaned(log) for log in as_log_set(logs)))
    hold_out = tuple(_cleaned(log) for log in hold_out)

    begin = _Beginning(model, parameters, seed, lambda m, fraction: report(m, 0.3 * fraction))
    work, held, base, scale = begin(log_set, hold_out)
    count = samples_to_average((*log_set, *hold_out), scale.motion_s)
    if count > 1:
        log_set = LogSet(tuple(thinned(log, count) for log in log_set))
        work, held, base, scale = begin(log_set, [thinned(log, count) for log in hold_out])
    chain = _searched(base, scale, work, held, effects, report)
    report("looking at what is left", 0.85)
    rng = np.random.default_rng(seed)
    remainder = assess(base, chain.final, scale, rng=rng)
    is_named = nameable(chain.links, chain.final, remainder)
    verdict = verdict_of(chain.links, is_named, remainder)
    report("computing errors", 0.9)
    before = assemble(work.found, work.logs, work.hold_out, choice=work.choice, seed=seed)
    after = _fit_of(chain.final, work, seed) if chain.links else None
    told = list(zip(causes_of(chain, base, after, held, rng), is_named, strict=True))
    named = [link for link, sure in zip(chain.links, is_named, strict=True) if sure]
    found = Diagnosis(
        verdict=verdict,
        summary="",
        base=before,
        extended=after,
        causes=tuple(cause for cause, sure in told if sure),
        descriptive=tuple(cause for cause, sure in told if not sure),
        alternatives=alternatives_of(named),
        remainder=remainder,
        gains=gains_of(base, chain.final, held, before),
        evidence=evidence_of(chain),
        next_experiment=None,
        issues=(*before.issues, *restriction(effects), *averaged_over(count)),
    )
    return worded(found)


def _cleaned(log: Log) -> Log:
    """The log as it is fitted, averaged and judged by: a drop-out must be in none of the three."""
    return without_dropouts(without_input_noise(log))


@dataclass(frozen=True)
class _Beginning:
    """The base fit and what is held out, as asked for."""

    model: Model | str | None
    parameters: ParameterSet | lmfit.Parameters | None
    seed: int
    progress: Progress

    def __call__(
        self, log_set: LogSet, hold_out: Sequence[Log]
    ) -> tuple[Work, HeldOut, Candidate, Scale]:
        trained, held = (log_set, None) if hold_out else hold_out_blocks(log_set)
        work = identify(
            trained.logs,
            model=self.model,
            hold_out=hold_out,
            parameters=self.parameters,
            seed=self.seed,
            progress=self.progress,
        )
        base = _base(work, self.model)
        scale = scale_of(base.problem, base.minimum.point)
        return work, held or HeldOut(work.hold_out), base, scale


def _searched(
    base: Candidate,
    scale: Scale,
    work: Work,
    held: HeldOut,
    effects: Sequence[str],
    report: Progress,
) -> Chain:
    """The chain of causes, each judged by what is held out."""
    sigma, considered = dict(work.found.optimum.sigma), catalogue(effects)

    def holds(before: Candidate, after: Candidate) -> bool:
        limit = BETTER if before.effects else NO_WORSE
        return held.rms(after) <= limit * held.rms(before)

    chain = find_chain(
        base,
        considered,
        scale,
        sigma,
        holds=holds,
        report=lambda message, fraction: report(message, 0.3 + 0.4 * fraction),
    )
    if len(chain.links) < 2:
        return chain
    report("checking the first causes again", 0.75)
    return revised(chain, base, considered, scale, sigma)


def _base(work: Work, asked: Model | str | None) -> Candidate:
    """The base fit as the candidate without effects, with every term that its limit had dropped.

    What was asked for by the user stays dropped.

    A term that cannot be seen behind a misfit may be seen once its cause is in the model: without
    it another effect would take its place.
    """
    optimum = work.found.optimum
    problem, z = _whole_problem(work, asked), optimum.unknowns
    if problem is not work.found.problem:
        z = problem.unknowns(_whole_values(work, problem))
    size = problem.size
    empty = Normal(z, optimum.cost, np.zeros(size), np.eye(size), problem.n_samples)
    variance = 2.0 * optimum.cost / max(problem.n_samples - size, 1)
    prior = prior_about(problem, z, problem.free, variance)
    candidate = Candidate((), problem, Minimum(z, empty, 0, 0.0), prior)
    return advance(
        candidate, dict(optimum.sigma), RESTORING_LAP if z is not optimum.unknowns else 1
    )


def _whole_problem(work: Work, asked: Model | str | None) -> Problem:
    """The problem of the model of full order, or of the order that was asked for."""
    problem = work.found.problem
    options = dict(problem.model.spec().options)
    wanted = asked.spec().options if isinstance(asked, Model) else {}
    order = wanted.get("order", "second")
    if options.get("order", order) == order:
        return problem
    whole: Model = MODELS[problem.model.name](**(options | {"order": order}))
    return Problem(whole, work.found.wishes.over(whole.parameters()), work.logs.logs)


def _whole_values(work: Work, problem: Problem) -> dict[str, float]:
    """Fitted values, with a restored term as large as it may be without being seen."""
    fitted = work.found.problem
    theta = fitted.theta(work.found.optimum.unknowns)
    values = dict(zip(fitted.parameters.names, theta.tolist(), strict=True))
    law = fitted.model.motion_law(theta)
    if law is None:
        return values
    u = np.concatenate([segment.input for segment in problem.segments])
    damping, stiffness, _ = (float(np.median(c)) for c in law.coefficients(u))
    hidden_s = HIDDEN_PERIODS * float(np.median([log.period_s for log in work.logs]))
    slow = damping if damping > 0.0 else hidden_s * stiffness
    restored = {"M": hidden_s * slow, "N": slow, "c2": slow, "a2": 0.1 * slow}
    for name in problem.free:
        if values.get(name, 0.0) == 0.0 and name in restored:
            values[name] = restored[name]
    return values


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
