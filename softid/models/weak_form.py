"""Regression of M·ẍ + N·ẋ + Q·x = G·(u − offset) that never differentiates the data.

Multiplied by a smooth bump φ that vanishes with its slope at both ends and integrated by parts,
the law reads M ∫φ″x − N ∫φ′x + Q ∫φx + c ∫φ = G ∫φu: linear in its coefficients (Preisig and
Rippin, Comput. Chem. Eng. 17, 1993: modulating functions).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from softid.kernels.window_moments import window_moments
from softid.models.division import held
from softid.segment import Segment

Array = npt.NDArray[np.float64]

MIN_SAMPLES_PER_WINDOW = 8
"""Samples in a window at least: the ∫φ″x of a parabola about its middle is then off by up to 4 %,
with 16 samples by 0.3 %, enough for a start."""

MAX_WINDOWS = 400
"""Windows of one segment, overlapping, for four coefficients; more hardly add to what the data tell
and cost a pass over their samples each."""

LEAST_WINDOWS = 8
"""Fewest windows of a start: twice as many as there are coefficients."""


def weak_form_coefficients(
    segments: Sequence[Segment], output: str, window: float, *, gain: float, spring: bool
) -> list[tuple[float, float, float, float]]:
    """Coefficients (M, N, Q, offset) by least squares over sliding windows.

    Parameters
    ----------
    segments
        Data; windows with unused samples are skipped.
    output
        Channel taken as x.
    window
        Length of a window as a fraction of the longest segment.
    gain
        G.
    spring
        Whether Q is estimated; without it Q = 0.

    Returns
    -------
    list of tuples
        The full solution and the one without inertia, negative coefficients replaced by small
        positive ones; empty when there are too few windows.
    """
    length_s = window * max(float(s.time_s[-1] - s.time_s[0]) for s in segments)
    moments = np.concatenate([_rows(s, output, length_s) for s in segments])
    if len(moments) < LEAST_WINDOWS:
        return []
    columns = [0, 1, 2, 3] if spring else [0, 1, 3]
    found = []
    for kept in (columns, columns[1:]):
        full = _solve(moments[:, kept], gain * moments[:, 4])
        by_column = dict(zip(kept, full, strict=True))
        m, n, q = (by_column.get(k, 0.0) for k in range(3))
        typical = max(abs(n), abs(q) * length_s, 1e-12)
        n = max(n, 1e-3 * typical)
        m = max(m, 1e-4 * n * length_s)
        q = max(q, 1e-3 * n / length_s) if spring else 0.0
        found.append((m, n, q, by_column[3] / gain))
    return found


def _solve(matrix: Array, target: Array) -> list[float]:
    scale = np.linalg.norm(matrix, axis=0)
    scale[scale == 0] = 1.0
    solution = np.linalg.lstsq(matrix / scale, target, rcond=1e-10)[0] / scale
    values: list[float] = solution.tolist()
    return values


def _rows(segment: Segment, output: str, length_s: float) -> Array:
    """Moments of the windows of one segment, shape (W, 5)."""
    time_s, x, u = held(segment.time_s), held(segment.outputs[output]), held(segment.input)
    starts = np.linspace(time_s[0], time_s[-1] - length_s, MAX_WINDOWS)
    first, behind = np.searchsorted(time_s, starts), np.searchsorted(time_s, starts + length_s)
    missing = np.concatenate(([0], np.cumsum(~segment.used[output])))
    whole = (behind - first >= MIN_SAMPLES_PER_WINDOW) & (missing[behind] == missing[first])
    moments = np.empty((int(whole.sum()), 5))
    window_moments(time_s, x, u, first[whole], behind[whole], starts[whole], length_s, moments)
    return moments
