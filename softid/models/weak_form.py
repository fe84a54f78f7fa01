"""Regression of M·ẍ + N·ẋ + Q·x = G·(u − offset) that never differentiates the data.

Multiplied by a smooth bump φ that vanishes with its slope at both ends and integrated by parts,
the law reads M ∫φ″x − N ∫φ′x + Q ∫φx + c ∫φ = G ∫φu: linear in its coefficients (Preisig and
Rippin, Comput. Chem. Eng. 17, 1993: modulating functions).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from softid.segment import Segment

Array = npt.NDArray[np.float64]

MIN_SAMPLES_PER_WINDOW = 8
"""Samples in a window at least: the ∫φ″x of a parabola about its middle is then off by up to 4 %,
with 16 samples by 0.3 %, enough for a start."""

MAX_WINDOWS = 400
"""Windows of one segment, overlapping, for four coefficients; more hardly add to what the data tell
and cost a pass over their samples each."""


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
    blocks = [row for s in segments for row in _rows(s, output, length_s)]
    if len(blocks) < 8:
        return []
    moments = np.array(blocks)
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


def _rows(segment: Segment, output: str, length_s: float) -> list[Array]:
    time = segment.time_s
    rows = []
    for start in np.linspace(time[0], time[-1] - length_s, MAX_WINDOWS).tolist():
        inside = slice(*np.searchsorted(time, (start, start + length_s)).tolist())
        t = time[inside]
        if t.size < MIN_SAMPLES_PER_WINDOW or not segment.used[output][inside].all():
            continue
        s = (t - start) / length_s
        x, u = segment.outputs[output][inside], segment.input[inside]
        # φ = (s(1 − s))⁴ and its first two derivatives in time.
        product = s * (1 - s)
        bump = product**4
        slope = 4 * product**3 * (1 - 2 * s) / length_s
        curve = (12 * product**2 * (1 - 2 * s) ** 2 - 8 * product**3) / length_s**2
        terms = np.array([curve * x, -slope * x, bump * x, bump, bump * u])
        # All of them vanish at both ends of the window, which lie between two samples.
        whole_s = np.concatenate(([start], t, [start + length_s]))
        rows.append(np.trapezoid(np.pad(terms, ((0, 0), (1, 1))), whole_s))
    return rows
