"""From a chain of refits to plain results."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.held_out import HeldOut
from softid.diagnosis.search.forward_selection import Chain, Link
from softid.diagnosis.verdict.gain_interval import gain_interval
from softid.diagnosis.verdict.sample_errors import candidate_at_samples
from softid.diagnosis_results import Alternative, Cause, Evidence, Gain
from softid.effects import EFFECTS, belongs_to, effect_of, extended_name, own_values
from softid.effects.base import Effect
from softid.effects.scale import Scale
from softid.results import FitResult, ParameterEstimate
from softid.scores import fit_percent

Array = npt.NDArray[np.float64]

SAME_RATIO = 0.05
"""A richer form whose ratio differs from that of the plain one by less than this share is told as
plain: so much is the work of what else is not in the model. A vent that is 2 % slower is none."""


def causes_of(
    chain: Chain,
    errors: Sequence[Array],
    after: FitResult | None,
    scale: Scale,
    lengths: Sequence[int] = (),
) -> tuple[Cause, ...]:
    """The links in words and numbers.

    Parameters
    ----------
    chain
        The chain.
    errors
        Held-out errors of the models with the first causes: none, one, two, and so on.
    after
        The fit with all causes, whose parameters are told.
    scale
        Sizes of the logs and of the base model.
    lengths
        Of the runs of held-out samples that follow each other in time; without any, all are one.
    """
    found: list[Cause] = []
    for link, (before_rows, after_rows) in zip(chain.links, pairwise(errors), strict=True):
        effect = link.added
        own = [p for p in after.parameters if belongs_to(effect, p.name)] if after else []
        values = own_values(effect, {p.name: p.value for p in own})
        told = told_as(effect, own).wording(values)
        found.append(
            Cause(
                effect=effect.name,
                key=effect.key,
                title=told.title,
                law=effect.law_at(scale),
                meaning=told.meaning,
                remedy=told.remedy,
                parameters=tuple(own),
                added_to=tuple(earlier.key for earlier in found),
                delta_bic=link.delta_bic,
                holdout_rmse_before=_rms(before_rows),
                holdout_rmse_after=_rms(after_rows),
                gain_ci95=gain_interval(before_rows, after_rows, lengths),
            )
        )
    return tuple(found)


def told_as(effect: Effect, parameters: Sequence[ParameterEstimate]) -> Effect:
    """The effect, or its plain form where its parameters do not tell the two apart, or hardly.

    Parameters
    ----------
    effect
        What was fitted.
    parameters
        Its parameters, named as in the extended model.
    """
    if effect.plain_at is None or effect.name not in EFFECTS:
        return effect
    name, value = effect.plain_at
    for p in parameters:
        if p.name == extended_name(effect, name) and p.ci95 is not None:
            is_near = abs(p.value - value) < SAME_RATIO * abs(value)
            is_plain = is_near or p.ci95[0] <= value <= p.ci95[1]
            return effect_of(effect.name) if is_plain else effect
    return effect


def whole_gain_of(
    errors: Sequence[Array], lengths: Sequence[int] = ()
) -> tuple[float, float] | None:
    """95 % interval of what all causes together gain; None without a cause or with few samples.

    Parameters
    ----------
    errors, lengths
        As in `causes_of`.
    """
    return gain_interval(errors[0], errors[-1], lengths) if len(errors) > 1 else None


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2))) if values.size else float("nan")


def gains_of(
    base: Candidate, final: Candidate, held: HeldOut, fitted: FitResult
) -> tuple[Gain, ...]:
    """Error of every log and channel before and after, fitted samples and held-out ones.

    Parameters
    ----------
    base, final
        The first and the last model.
    held
        What was held out.
    fitted
        The base fit, for the units.
    """
    units = {row.channel: row.unit for row in fitted.statistics}
    found = []
    for is_held, rows in (
        (False, (_fitted(candidate_at_samples(base)), _fitted(candidate_at_samples(final)))),
        (True, (held.errors(base), held.errors(final))),
    ):
        for (log, channel, measured, before), (*_, after) in zip(*rows, strict=True):
            if measured.size == 0:
                continue
            found.append(
                Gain(
                    log=log,
                    channel=channel,
                    unit=units.get(channel, ""),
                    held_out=is_held,
                    n=measured.size,
                    rmse_before=_rms(before),
                    rmse_after=_rms(after),
                    fit_percent_before=fit_percent(measured, measured - before),
                    fit_percent_after=fit_percent(measured, measured - after),
                )
            )
    return tuple(found)


def _fitted(candidate: Candidate) -> list[tuple[str, str, Array, Array]]:
    problem = candidate.problem
    found = []
    for block in problem.blocks(candidate.minimum.point, derivatives=False):
        segment = problem.segments[block.segment]
        measured = segment.outputs[block.channel][segment.used[block.channel]]
        found.append((segment.log_name, block.channel, measured, block.residual))
    return found


def alternatives_of(
    links: Sequence[Link], told: Mapping[str, str] = MappingProxyType({})
) -> tuple[Alternative, ...]:
    """Sets of effects that explain the logs equally well.

    Parameters
    ----------
    links
        The chain.
    told
        Key → that of the form as which it is told, where this is another.
    """
    found = []
    for link in links:
        if len(link.rivals) < 2:
            continue
        best = {link.added.name: link.chosen}
        for row in link.extending:
            if row.candidate.keys != link.before.candidate.keys:
                best.setdefault(link.added_by(row).name, row)
        behind = {
            name: best[name].bic - link.chosen.bic if name in best else 0.0 for name in link.rivals
        }
        forms = [link.added_by(best[name]).key if name in best else name for name in link.rivals]
        delta_bic = {name: max(bic, 0.0) for name, bic in behind.items()}
        keys = tuple(told.get(key, key) for key in forms)
        found.append(Alternative(link.rivals, delta_bic, "", keys))
    return tuple(found)


def evidence_of(chain: Chain) -> tuple[Evidence, ...]:
    """Every candidate of every round, with its share of the sum of squares for white noise.

    That of one which raced is what a refit took away; the whitened squares, by which its BIC goes,
    are no shares of what the promises of the others are.

    Parameters
    ----------
    chain
        The chain.
    """
    rounds = [*chain.links, *([chain.last] if chain.last is not None else [])]
    found = []
    for number, link in enumerate(rounds, start=1):
        ranked = {link.added_by(row).key: row for row in link.extending}
        whole = max(link.squares_before, 1e-300)
        for signature in link.signatures:
            key = signature.effect.key
            row = ranked.get(key)
            found.append(
                Evidence(
                    round=number,
                    effect=key,
                    delta_bic=link.before.bic - row.bic if row is not None else None,
                    drop_share=1.0 - row.plain.squares / whole
                    if row is not None
                    else signature.drop / whole,
                )
            )
    return tuple(found)
