"""Moments of a motion in windows that vanish smoothly at both ends."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.kernels.decorators import kernel

Array = npt.NDArray[np.float64]
Rows = npt.NDArray[np.intp]


@kernel
def window_moments(
    time_s: Array,
    x: Array,
    u: Array,
    first: Rows,
    behind: Rows,
    starts: Array,
    length_s: float,
    moments: Array,
) -> None:
    """∫φ″x, −∫φ′x, ∫φx, ∫φ and ∫φu with φ = (s(1 − s))⁴ by the trapezoidal rule.

    All of them vanish at both ends of a window, which lie between two samples.

    Parameters
    ----------
    time_s, x, u
        Samples, each of shape (n,).
    first, behind
        First sample of every window, and the one behind its last, each of shape (W,).
    starts
        Where the windows begin, in s, shape (W,).
    length_s
        Length of a window.
    moments
        Receives the sums, shape (W, 5).
    """
    for k in range(starts.size):
        begin, end = starts[k], starts[k] + length_s
        curved, sloped, moved, whole, driven = 0.0, 0.0, 0.0, 0.0, 0.0
        for i in range(first[k], behind[k]):
            earlier = time_s[i - 1] if i > first[k] else begin
            later = time_s[i + 1] if i + 1 < behind[k] else end
            s = (time_s[i] - begin) / length_s
            product, tilt = s * (1.0 - s), 1.0 - 2.0 * s
            weight = 0.5 * (later - earlier) * product * product
            bump = weight * product * product
            curved += weight * (12.0 * tilt * tilt - 8.0 * product) * x[i]
            sloped -= weight * 4.0 * product * tilt * x[i]
            moved += bump * x[i]
            whole += bump
            driven += bump * u[i]
        moments[k, 0] = curved / (length_s * length_s)
        moments[k, 1] = sloped / length_s
        moments[k, 2], moments[k, 3], moments[k, 4] = moved, whole, driven
