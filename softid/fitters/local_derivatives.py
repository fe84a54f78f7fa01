"""Values and derivatives of noisy samples by polynomials fitted to short windows.

On even samples this is the filter of Savitzky and Golay (Anal. Chem. 36, 1964, 1627); the windows
here hold the nearest samples of any clock.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.errors import InputError

Array = npt.NDArray[np.float64]

DEGREE = 4
"""Degree of the local polynomials. The second derivative of a quartic is itself a parabola over the
window; a higher degree follows more noise, and a window needs two samples more than the degree."""


@dataclass(frozen=True, eq=False)
class Derivatives:
    """Smoothed samples and their derivatives in time, each of shape (n,)."""

    value: Array
    slope: Array
    curvature: Array


def local_derivatives(time_s: Array, values: Array, *, window_s: float) -> Derivatives:
    """Fit a polynomial around every sample and read it and its derivatives there.

    Parameters
    ----------
    time_s, values
        Samples without NaN, each of shape (n,).
    window_s
        Length of a window; it always holds at least two samples more than `DEGREE`.

    Raises
    ------
    InputError
        There are fewer samples than one window needs.

    Examples
    --------
    >>> t = np.linspace(0.0, 1.0, 21)
    >>> local_derivatives(t, t**3, window_s=0.5).curvature[10].round(9)
    np.float64(3.0)
    """
    count = _samples_of_window(time_s, window_s)
    first = np.clip(np.arange(time_s.size) - count // 2, 0, time_s.size - count)
    window = first[:, None] + np.arange(count)
    half_s = 0.5 * count * float(np.median(np.diff(time_s)))
    offset = (time_s[window] - time_s[:, None]) / half_s
    basis = offset[:, :, None] ** np.arange(DEGREE + 1)
    q, r = np.linalg.qr(basis)
    right = np.einsum("nmk,nm->nk", q, values[window])
    coefficients = np.linalg.solve(r, right[:, :, None])[:, :, 0]
    return Derivatives(
        coefficients[:, 0],
        coefficients[:, 1] / half_s,
        2.0 * coefficients[:, 2] / half_s**2,
    )


def samples_per_window(time_s: Array, window_s: float) -> int:
    """Odd number of samples that a window of the given length holds at the median rate."""
    period_s = float(np.median(np.diff(time_s))) if time_s.size > 1 else window_s
    return max(round(window_s / period_s) | 1, (DEGREE + 2) | 1)


def _samples_of_window(time_s: Array, window_s: float) -> int:
    """The same, or an `InputError` where there are fewer samples than that."""
    count = samples_per_window(time_s, window_s)
    if time_s.size < count:
        raise InputError(
            f"a window needs {count} samples",
            value=int(time_s.size),
            remedy="use a longer log or a shorter window",
        )
    return count


def local_polynomial(
    time_s: Array, values: Array, *, near_s: float, window_s: float
) -> np.polynomial.Polynomial:
    """The polynomial in ``t − near_s`` fitted to the samples nearest to ``near_s``."""
    count = _samples_of_window(time_s, window_s)
    middle = int(np.searchsorted(time_s, near_s))
    first = min(max(middle - count // 2, 0), time_s.size - count)
    window = slice(first, first + count)
    fitted = np.polynomial.Polynomial.fit(time_s[window] - near_s, values[window], DEGREE)
    return fitted.convert()


def vertex_s(curve: np.polynomial.Polynomial, reach_s: float) -> float | None:
    """Where a local polynomial is flat, nearest to its centre and within ± ``reach_s``, or None."""
    roots = curve.deriv().roots()
    real = roots[np.isreal(roots)].real
    near = real[np.abs(real) <= reach_s]
    return float(near[np.argmin(np.abs(near))]) if near.size else None
