"""What a user should know about how a diagnosis was made."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from softid.diagnosis.base.base_fit import NEGLIGIBLE, BaseFit
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.held_out import HeldOut, HeldOutBlocks
from softid.diagnosis.report.phrases import DOUBTS, percent
from softid.diagnosis.report.rest_phrases import OF_INPUT
from softid.diagnosis.residual.jump_timing import untimed_jumps
from softid.diagnosis.search.forward_selection import FIRST, Chain, is_accepted
from softid.diagnosis.verdict.naming import LEAST_GAIN
from softid.diagnosis_results import Cause, Doubt, Remainder
from softid.effects import EFFECTS
from softid.effects.base import Effect
from softid.errors import Issue
from softid.fitters.problem import Problem
from softid.identification.gauge_errors import NO_ERRORS, GaugeErrors
from softid.log import Log
from softid.results import FitResult
from softid.sentences import listed, lowered
from softid.uncertainty import standard_error

REFUSED = "not-held-out"
"""Code of the remark that a law does not carry over."""

BEGUN_ANEW = "begins-anew"
"""Code of the remark that a law does not carry over which begins anew with every log."""

LEAST_BEGUN = 0.1
"""Share of the squared error of which a law that begins anew takes more if that may be why it does
not carry over: a misfit of half of the noise is a fifth of the squared error."""

UNSURE = "unsure-law"
"""Code of the remark that a law explains a little and may be chance."""

UNSURE_REMEDIES = {
    Doubt.TOO_QUICK: "sample the input faster, which would show what it does meanwhile",
}
"""What to do about a doubt that more of the same moves would not settle."""

FAST_INPUT = "fast-input"
"""Code of the remark that nobody knows what the input did between its samples."""

NEGLIGIBLE_MISFIT = "negligible-misfit"
"""Code of the remark that no cause was looked for, since the misfit is negligible."""


def negligible_issues(base: BaseFit) -> tuple[Issue, ...]:
    """That a misfit is too small to be looked into; nothing where it is not.

    Parameters
    ----------
    base
        The base fit.
    """
    if not base.is_negligible:
        return ()
    return (
        Issue(
            NEGLIGIBLE_MISFIT,
            "info",
            f"the misfit of {base.candidate.problem.outputs[0]} is below "
            f"{100.0 * NEGLIGIBLE:.2g} % of its range, as much as the sampling of the input leaves "
            "by itself: no cause was looked for",
            None,
        ),
    )


def restriction_issues(effects: Sequence[str]) -> tuple[Issue, ...]:
    """What a search among some effects cannot say; nothing for the whole catalogue.

    Parameters
    ----------
    effects
        Keys of the effects that were considered; empty for all.
    """
    left_out = [key for key in EFFECTS if effects and key not in effects]
    if not left_out:
        return ()
    return (
        Issue(
            "few-effects",
            "warning",
            f"only {listed(list(effects))} {'was' if len(effects) == 1 else 'were'} considered: "
            "another effect may explain the logs as well or better",
            "diagnose again without --effects",
        ),
    )


def averaging_issues(count: int) -> tuple[Issue, ...]:
    """That the logs were averaged, which hides what is faster than a mean; nothing if not.

    Parameters
    ----------
    count
        Samples in a mean.
    """
    if count == 1:
        return ()
    return (
        Issue(
            "averaged",
            "info",
            f"the causes were searched in means of {count} samples, of which a time constant of "
            "the motion has more than thirty; the errors are those of the samples",
            None,
        ),
    )


def refusal_issues(chain: Chain, held: HeldOut) -> tuple[Issue, ...]:
    """That what is held out speaks against the best law; nothing where a law was added.

    Nor is anything told of a law that takes away next to nothing.

    Parameters
    ----------
    chain
        What the search found.
    held
        What was held out.
    """
    if chain.links or chain.last is None or not is_accepted(chain.last, FIRST):
        return ()
    return refused_law_issues(chain.last.added, chain.last.chosen.plain, chain.final, held)


def refused_law_issues(
    law: Effect, model: Candidate, base: Candidate, held: HeldOut
) -> tuple[Issue, ...]:
    """The same of any law; nothing where it carries over or takes away next to nothing.

    Parameters
    ----------
    law, model
        The law, and the base with it.
    base
        The base alone.
    held
        What was held out.
    """
    before, after = held.rms(base), held.rms(model)
    taken = 1.0 - model.squares / base.squares
    if taken < LEAST_GAIN or not after > (1.0 - LEAST_GAIN) * before:
        return ()
    takes = percent(taken)
    worse = after > (1.0 + LEAST_GAIN) * before
    change = f"adds {percent(after / before - 1.0)} to it" if worse else "leaves it as it is"
    code = REFUSED
    remedy = "hold out a log like the fitted ones, or none: then blocks of the logs judge"
    if isinstance(held, HeldOutBlocks):
        remedy = "record the same once more, from a rest, and hold that log out"
    elif law.begins_with_log and taken > LEAST_BEGUN:
        code = BEGUN_ANEW
        remedy = (
            "if what is held out was recorded after the others, hold out none, and blocks of the "
            "logs judge: this law begins anew with every log"
        )
    return (
        Issue(
            code,
            "info",
            f"{lowered(law.title)} would take away {takes} of the squared error on the fitted "
            f"samples, but on what is held out it {change}",
            remedy,
        ),
    )


def unsure_issues(descriptions: Sequence[Cause]) -> tuple[Issue, ...]:
    """Which laws explain a little of what is no more than noise, and why none is claimed.

    Parameters
    ----------
    descriptions
        The laws with what speaks against their names.
    """
    return tuple(
        Issue(
            UNSURE,
            "info",
            f"{lowered(cause.title)} would lower the BIC by {cause.delta_bic:.0f}, but it "
            f"{DOUBTS[cause.doubt]}",
            UNSURE_REMEDIES.get(
                cause.doubt, "record more of the same moves, which would show whether it is there"
            ),
        )
        for cause in descriptions
        if cause.doubt in DOUBTS
    )


def jump_issues(remainder: Remainder, problem: Problem) -> tuple[Issue, ...]:
    """That the moments of jumps of the input were left open, with the first one.

    Parameters
    ----------
    remainder
        What the last model leaves.
    problem
        The logs.
    """
    if remainder.open_jumps == 0:
        return ()
    found = ((segment, untimed_jumps(segment)) for segment in problem.segments)
    segment, spans_s = next((s, spans_s) for s, spans_s in found if spans_s.size)
    count = remainder.open_jumps
    others = f", the first of {count} such jumps in all logs" if count > 1 else ""
    begin_s, end_s = spans_s[0].tolist()
    ends = "samples" if segment.input_read_s is None else "readings"
    return (
        Issue(
            "untimed-jumps",
            "info",
            f"{segment.log_name}: the input jumps between the {ends} at {begin_s:.6g} and "
            f"{end_s:.6g} s{others}; when exactly is not recorded, and what that changes in the "
            "motion is counted as no misfit",
            "sample faster than the input moves, or record when the valve switches",
        ),
    )


def input_noise_issues(
    remainder: Remainder, problem: Problem, gauges: Mapping[str, GaugeErrors]
) -> tuple[Issue, ...]:
    """That the noise of the input, or its course between samples, makes a part of what is left.

    Parameters
    ----------
    remainder
        What the last model leaves.
    problem
        The logs.
    gauges
        Log → errors of the input that was recorded.
    """
    noisiest = max(problem.logs, key=lambda log: gauges.get(log.name, NO_ERRORS).sd)
    driving, first = noisiest.channels[noisiest.input], problem.outputs[0]
    output = noisiest.channels[first]
    course = remainder.input_course
    noise = _noise_of(noisiest, gauges.get(noisiest.name, NO_ERRORS))
    found = []
    for share, code, what, remedy in (
        (
            1.0 - course,
            "noisy-input",
            f"{noisiest.name}: {driving.name} has {noise}; what averaging leaves of it",
            f"record {driving.name} with a gauge or an amplifier of less noise or finer steps",
        ),
        (
            course,
            FAST_INPUT,
            f"{driving.name} moves fast beside its samples; what it may have done between them",
            f"sample {driving.name} several times as fast",
        ),
    ):
        if share * remainder.input_noise <= OF_INPUT:
            continue
        moves = remainder.rms * (share * remainder.input_noise) ** 0.5 * output.display_factor
        message = (
            f"{what} moves the simulated {first} by {moves:.3g} {output.display_unit} rms, which "
            "is counted as no misfit"
        )
        found.append(Issue(code, "info", message, remedy))
    return tuple(found)


def _noise_of(log: Log, gauge: GaugeErrors) -> str:
    """Noise and steps of a log's input, in words."""
    driving = log.channels[log.input]
    factor, unit = driving.display_factor, driving.display_unit
    steps = f" and steps of {gauge.step * factor:.3g} {unit}" if gauge.step > 0.0 else ""
    return f"a noise of {gauge.sd * factor:.3g} {unit}{steps}"


def unsure_input_issues(fit: FitResult, least_sd: Mapping[str, float]) -> tuple[Issue, ...]:
    """That what is not known of the input makes intervals wider than the residuals tell.

    Parameters
    ----------
    fit
        What is told.
    least_sd
        As in `softid.identification.assembly.assemble`.
    """
    wider = [
        p.name
        for p in fit.parameters
        if p.stderr is not None
        and p.name in least_sd
        and np.isclose(p.stderr, standard_error(p.value, p.scale, least_sd[p.name]) or 0.0)
    ]
    if not wider:
        return ()
    whose = "intervals of" if len(wider) > 1 else "interval of"
    return (
        Issue(
            "unsure-input",
            "info",
            f"the {whose} {listed(wider)} {'allow' if len(wider) > 1 else 'allows'} for what is "
            f"not known of {fit.input}, its noise and its course between samples: the residuals "
            "alone tell smaller errors",
            f"record {fit.input} with less noise and several times as fast",
        ),
    )
