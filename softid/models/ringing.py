"""Start values of the muscle law where it rings, by regression instead of simulation.

A simulated ringing response is in step with the measured one only very near the true parameters, so
that its error has many false minima. The equation itself has not: at given b1 the weak form

    M ∫φ″y − c2 ∫φ′y + a1 ∫φ·exp(b1·p)·y + c1 ∫φy + k ∫φ = (1 + a1·z) ∫φ·exp(b1·p)

over windows φ of several lengths is linear in M, c2, a1, c1 and the constant k = −c1·z of the
sensor zero z (Preisig and Rippin, Comput. Chem. Eng. 17, 1993: modulating functions).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
import numpy.typing as npt

from softid.kernels.muscle import KPA_PER_BAR
from softid.models.second_order import Law
from softid.models.starts import as_values, damping_shapes, diverse, motion_kind, score
from softid.models.stretches import Stretch, block_means, thinned
from softid.segment import Segment

Array = npt.NDArray[np.float64]

STEEPNESS = np.geomspace(0.5, 18.0, 12)
"""Steepnesses that are tried: b1 times the range of the pressure."""

SHORTEST_WINDOW_PERIODS = 16.0
"""Shortest window, in sampling periods: over fewer the sums of φ″ no longer stand for its integral
(16 samples err by up to 1.6 % in a parabola's, 8 by 13 %)."""

LONGEST_WINDOW = 1.0 / 6.0
"""Longest window as a share of the longest segment, of which six lie side by side in it. A
judgement: long windows average ringing away."""

N_LENGTHS = 6
"""Lengths of windows from the shortest to the longest: which one sees the motion best depends on
its frequency, which is what is sought."""

N_WINDOWS = 200
"""Windows of one length over all segments together, overlapping. They are rows for four
coefficients and one zero per segment; more hardly add to what the data tell."""

MIN_SAMPLES_PER_WINDOW = 8
"""Samples in a window at least, where the sampling leaves gaps: half of the usual fewest."""

MAX_SAMPLES_PER_WINDOW = 256
"""Most samples in a window: of twice as many means of consecutive samples are taken, for a smooth φ
needs no more, and the moments cost less."""

N_KEPT = 3
"""Motions that are kept, each of another kind; with every shape of the damping, nine starts."""

_REWEIGHTS = 4
"""Passes of the regression: the weights need Q, which the pass before gives. A judgement: whether
it has settled is not asked."""

_PRESSURES = 20
"""Pressures at which the damping ratio is looked at, evenly over the range."""

_LEAST = 1e-4
"""Least c1/a1 in the weights, and least damping in units of √(M·c1): what noise makes negative
counts as so little."""


@dataclass(frozen=True, eq=False)
class _Windows:
    """Moments of one segment: ``curve @ y`` stands for ∫φ″y, and so on, each of shape (W, n)."""

    own: int
    samples: npt.NDArray[np.intp]
    bump: Array
    slope: Array
    curve: Array
    pressure_bar: Array
    motion: Array


def ringing_starts(
    segments: Sequence[Segment],
    motions: Sequence[Array],
    output: str,
    law: Callable[[Array], Law],
) -> list[dict[str, float]]:
    """Start values for the muscle law that ring somewhere in the range of the pressure.

    Parameters
    ----------
    segments
        Fitted segments.
    motions
        Measured x up to a zero, one array per segment.
    output
        Channel whose unused samples are left out.
    law
        Builds the law from theta of shape (7,).

    Returns
    -------
    list of dict
        Empty when no window length gives a motion that rings.
    """
    pressures = np.concatenate([s.input for s in segments]) / KPA_PER_BAR
    low, span = float(pressures.min()), float(np.ptp(pressures))
    if span <= 0.0:
        return []
    stretches = thinned(segments, motions, output)
    shortest_s = SHORTEST_WINDOW_PERIODS * min(
        float(np.median(np.diff(s.time_s))) for s in segments
    )
    longest_s = LONGEST_WINDOW * max(float(s.time_s[-1] - s.time_s[0]) for s in segments)
    if longest_s <= shortest_s:
        return []
    found = []
    for length_s in np.geomspace(shortest_s, longest_s, N_LENGTHS).tolist():
        windows = _windows(segments, motions, output, length_s)
        for steep in (STEEPNESS / span).tolist() if windows else ():
            theta = _regression(windows, steep, len(segments))
            if theta is not None and _rings(theta, law, low, span):
                found.append((*score(stretches, law, theta), theta))
    kept = diverse(sorted(found, key=lambda row: row[0]), N_KEPT, motion_kind)
    order = product(range(len(damping_shapes(kept[0][2]))) if kept else (), kept)
    return [as_values(damping_shapes(theta)[shape], gain) for shape, (_, gain, theta) in order]


def _rings(theta: Array, law: Callable[[Array], Law], low: float, span: float) -> bool:
    """Whether the damping ratio is below one at some pressure of the range."""
    inputs = KPA_PER_BAR * (low + span * np.linspace(0.0, 1.0, _PRESSURES))
    damping, stiffness, _ = law(theta).coefficients(inputs)
    return bool(np.any(damping**2 < 4.0 * theta[0] * stiffness))


def _windows(
    segments: Sequence[Segment], motions: Sequence[Array], output: str, length_s: float
) -> list[_Windows]:
    """Sliding windows of one length over all segments, without those that hold unused samples."""
    total_s = sum(float(s.time_s[-1] - s.time_s[0]) for s in segments)
    found = []
    for own, (segment, motion) in enumerate(zip(segments, motions, strict=True)):
        stretch = _averaged(segment, motion, output, length_s)
        time, used = stretch.time_s, stretch.used
        if time.size < MIN_SAMPLES_PER_WINDOW or time[-1] - time[0] < length_s:
            continue
        count = max(2, int(N_WINDOWS * (time[-1] - time[0]) / total_s))
        starts = np.linspace(time[0], time[-1] - length_s, count)
        first, stop = np.searchsorted(time, starts), np.searchsorted(time, starts + length_s)
        samples = first[:, None] + np.arange(int((stop - first).max()))
        inside = samples < stop[:, None]
        samples = np.minimum(samples, time.size - 1)
        whole = (used[samples] | ~inside).all(axis=1) & (stop - first >= MIN_SAMPLES_PER_WINDOW)
        if not whole.any():
            continue
        samples, inside, starts = samples[whole], inside[whole], starts[whole]
        # φ = (s(1 − s))⁴ and its first two derivatives in time, times the width of a sample.
        s = (time[samples] - starts[:, None]) / length_s
        product_s = np.where(inside, s * (1.0 - s), 0.0)
        width = np.gradient(time)[samples] * inside
        bump = product_s**4 * width
        slope = 4.0 * product_s**3 * (1.0 - 2.0 * s) / length_s * width
        curve = 12.0 * product_s**2 * (1.0 - 2.0 * s) ** 2 - 8.0 * product_s**3
        curve = curve / length_s**2 * width
        pressure_bar = stretch.input / KPA_PER_BAR
        found.append(_Windows(own, samples, bump, slope, curve, pressure_bar, stretch.motion))
    return found


def _averaged(segment: Segment, motion: Array, output: str, length_s: float) -> Stretch:
    """A segment with its motion, averaged where a window would hold too many samples."""
    period_s = float(np.median(np.diff(segment.time_s)))
    k = max(1, int(length_s / period_s / MAX_SAMPLES_PER_WINDOW))
    return block_means(segment, motion, output, k)


def _regression(windows: Sequence[_Windows], b1: float, n_segments: int) -> Array | None:
    """Theta with a1 = 1 by weighted least squares; None where the coefficients make no actuator.

    A row is divided by about ∫φQ, which makes its error one of position, alike at all pressures.
    """
    rows, targets, areas = [], [], []
    for w in windows:
        force, x = np.exp(b1 * w.pressure_bar)[w.samples], w.motion[w.samples]
        area = w.bump.sum(axis=1)
        constants = np.zeros((area.size, n_segments))
        constants[:, w.own] = area
        moments = ((w.curve * x), -(w.slope * x), (w.bump * force * x), (w.bump * x))
        rows.append(np.column_stack([*(m.sum(axis=1) for m in moments), constants]))
        targets.append((w.bump * force).sum(axis=1))
        areas.append(area)
    matrix, target, area = np.concatenate(rows), np.concatenate(targets), np.concatenate(areas)
    if not (np.isfinite(matrix).all() and np.isfinite(target).all()):
        return None
    weight = 1.0 / target
    for _ in range(_REWEIGHTS):
        weighted = matrix * weight[:, None]
        size = np.linalg.norm(weighted, axis=0)
        size[size == 0.0] = 1.0
        solved = np.linalg.lstsq(weighted / size, target * weight, rcond=1e-10)[0] / size
        mass, damping, a1, c1 = solved[:4].tolist()
        if a1 <= 0.0:
            return None
        weight = 1.0 / (target + max(c1 / a1, _LEAST) * area)
    if mass <= 0.0 or c1 <= 0.0:
        return None
    damping = max(damping, _LEAST * float(np.sqrt(mass * c1)))
    return np.array([mass / a1, 1.0, b1, c1 / a1, 0.0, 0.0, damping / a1])
