"""Whether logs visit the same levels of their input, and so can be held against each other."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from softid.log import Log

Array = npt.NDArray[np.float64]

SAME_RANGE = 0.6
"""Logs are held against each other whose inputs have so much of their common range in common: what
differs from level to level is the model, not the log."""

RANGE_PARTS, VISITED_SHARE, MET_SHARE = 12, 0.005, 0.8
"""Parts of the common range of two logs' inputs; least share of the samples in a part, or beside
it, from which it is known; least share of another log that lies in known parts. Between two levels
that alone were fitted the static curve is a guess, and a third one shows that, not another load."""


def have_same_levels(known: Sequence[Log], others: Sequence[Log]) -> bool:
    """Whether every other log has nearly the levels of the input of those that are known.

    Parameters
    ----------
    known
        Logs that a model was fitted to.
    others
        Logs that it is held against.
    """
    fitted = _levels_of(known)
    return all(_is_among(_levels_of([log]), fitted) for log in others)


def _levels_of(logs: Sequence[Log]) -> Array:
    u = np.concatenate([log.channels[log.input].values for log in logs])
    finite: Array = u[np.isfinite(u)]
    return finite


def _is_among(u: Array, known: Array) -> bool:
    (low, high), (begin, end) = (known.min(), known.max()), (u.min(), u.max())
    common = min(high, end) - max(low, begin)
    if common < SAME_RANGE * (max(high, end) - min(low, begin)):
        return False
    edges = np.linspace(low, high, RANGE_PARTS + 1)
    visited = np.histogram(known, edges)[0] >= VISITED_SHARE * known.size
    near = np.convolve(visited, np.ones(3), "same") > 0.0
    part = np.clip(np.searchsorted(edges, u, side="right") - 1, 0, RANGE_PARTS - 1)
    return bool(np.mean(near[part]) >= MET_SHARE)
