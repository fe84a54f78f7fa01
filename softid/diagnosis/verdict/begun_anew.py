"""A law that begins anew with every log, where what is held out goes on from another one.

A log that was recorded after another begins with a material that is soft and a sensor that is warm.
The law of the catalogue, which has both begin at its start, then fails there though it is true.
"""

from __future__ import annotations

import numpy as np

from softid.diagnosis.base.base_fit import BaseFit
from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.held_out import HeldOutLogs
from softid.diagnosis.search.forward_selection import Chain
from softid.diagnosis.verdict.beyond_catalogue import AS_NOISE, squares_of_noise
from softid.diagnosis.verdict.naming import LEAST_GAIN
from softid.diagnosis.verdict.refitted_laws import refitted_with, standing_of
from softid.effects.base import Effect


def law_begun_anew(chain: Chain, base: BaseFit, noise: float) -> tuple[Effect, Candidate] | None:
    """The law that would be the cause if what is held out went on from the fitted logs.

    By itself it leaves no more than noise of these, and where several causes were found no more
    than they do together: they then make up for what it fails in where it is held against.

    Parameters
    ----------
    chain
        What the search found.
    base
        The base fit.
    noise
        Variance of the noise of the first output.

    Returns
    -------
    effect, model
        None where there is no such law, where blocks of the fitted logs judge, and where the base
        or a single cause leaves noise, too: then what is held out tells which it is.
    """
    held = base.held_out
    if not isinstance(held, HeldOutLogs):
        return None
    most = AS_NOISE * squares_of_noise(base, noise)
    if len(chain.links) < 2 and chain.final.squares <= most:
        return None
    most = min(most, chain.final.squares, (1.0 - LEAST_GAIN) * base.candidate.squares)
    least = (1.0 - LEAST_GAIN) * held.rms(base.candidate)
    last = () if chain.last is None else (chain.last,)
    met = {  # a law that was met in several rounds counts as in the first
        link.added_by(row): row.plain
        for link in reversed(chain.links or last)
        for row in link.ranked
        if row is not link.before
        and row.plain.squares <= most
        and link.added_by(row).begins_with_log
    }
    found = [(effect, _alone(effect, model, base)) for effect, model in met.items()]
    refused = [
        (effect, model)
        for effect, model in found
        if model is not None and model.squares <= most and held.rms(model) > least
    ]
    return min(refused, key=lambda pair: pair[1].squares, default=None)


def _alone(effect: Effect, model: Candidate, base: BaseFit) -> Candidate | None:
    """The base with a law by itself, which was met beside others or not."""
    if len(model.effects) == 1:
        return model
    return refitted_with(standing_of(base.candidate, base), (), (effect,), near=np.inf)
