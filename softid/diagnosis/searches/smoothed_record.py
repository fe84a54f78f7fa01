"""A record that was smoothed after it was taken, where that is all that is missing.

A filter that ran there and back takes the fast noise away, so that what a true model leaves looks
larger than the noise between neighbouring samples. What the filter does to the motion may be too
little for a gain on what is held out: then the model is not to blame, nor is anything to be named.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.search.bic_ranking import is_likelier
from softid.diagnosis.search.forward_selection import Chain
from softid.diagnosis.searches.cause_search import CauseSearch
from softid.diagnosis.searches.search_result import SearchResult
from softid.diagnosis.verdict.doubts import NO_GAIN, OVER_RECORD
from softid.diagnosis.verdict.refitted_laws import refitted_with, standing_of
from softid.diagnosis_results import Cause
from softid.effects import effect_of, own_values
from softid.errors import Issue

SMOOTHED_RECORD = "smoothed-record"
"""Code of the remark that a record was smoothed, and that this is all that is missing."""

SMOOTHING = "smoothing"
"""Name of the effect whose forms are tried."""


def smoothed_alone(
    search: CauseSearch, described: Sequence[Cause]
) -> tuple[SearchResult, Issue] | None:
    """The base alone with a remark, where nothing but a smoothed record is missing.

    The base with a filter over its readings leaves no more than the noise that such a filter makes,
    on what is held out as well, and is likelier than the base.

    Parameters
    ----------
    search
        The search over the base, which has come to no name.
    described
        What it describes: nothing else than a smoothing that gains nothing.
    """
    if any(cause.effect != SMOOTHING or cause.doubt not in NO_GAIN for cause in described):
        return None
    base = search.base
    standing = standing_of(base.candidate, base)
    tried = (refitted_with(standing, (), (effect_of(key),), near=np.inf) for key in OVER_RECORD)
    found = [model for model in tried if model is not None and search.leaves_noise(model)]
    smoothed = min(found, key=lambda model: model.squares, default=None)
    if smoothed is None or not is_likelier(smoothed, base.candidate, base.sigma):
        return None
    left = replace(
        search.remainder_of(smoothed),
        rms=search.remainder_of(base.candidate).rms,
        explained_share=1.0,
    )
    alone = SearchResult(Chain((), None, base.candidate), left, ())
    return alone, smoothed_issue(smoothed)


def smoothed_issue(smoothed: Candidate) -> Issue:
    """That a record was smoothed, and within what time its noise is alike.

    Parameters
    ----------
    smoothed
        The base with a filter over its readings.
    """
    (effect,) = smoothed.effects
    within_s = effect.alike_within(own_values(effect, smoothed.parameters))
    return Issue(
        SMOOTHED_RECORD,
        "info",
        f"{smoothed.problem.outputs[0]} looks as if it was smoothed after it was recorded, or "
        f"moved by what its input does between samples: readings within {within_s:.2g} s of each "
        "other have noise in common; a model that allows for that leaves nothing else, and does "
        "not surely predict better, so there is nothing to name",
        effect.remedy,
    )
