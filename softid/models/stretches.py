"""Block averages of logs, over which start values are ranked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.segment import Segment

Array = npt.NDArray[np.float64]

MAX_SAMPLES = 1000
"""Samples over which the narrow grids are ranked: enough to find a basin, not its optimum."""

MOST_AVERAGED_AWAY = 0.1
"""Share of the input's variance within blocks, beyond which they hide what moves the actuator."""

WHOLE_SHARE = 0.7
"""A log is covered as a whole where windows would leave out less than the rest."""

WINDOWS = 4
"""Windows of a segment at most: each but the first loses its lead-in."""

LEAST_WINDOW = 50
"""Fewest blocks in a window."""

LEAD_IN = 0.2
"""Share of a window in which its motion comes from rest into step."""


@dataclass(frozen=True, eq=False)
class Stretch:
    """One segment, thinned: times, input and motion of shape (n,), and which samples count."""

    time_s: Array
    input: Array
    motion: Array
    used: npt.NDArray[np.bool_]


def thinned(
    segments: Sequence[Segment], motions: Sequence[Array], output: str, *, most: int = MAX_SAMPLES
) -> list[Stretch]:
    """Block averages, about so many in total: enough to find the basin.

    Where blocks over the whole log would average the input away, they are shorter and cover
    windows of the log alone. A window begins somewhere in a motion and is simulated from rest, so
    that its first part does not count.
    """
    total = sum(s.time_s.size for s in segments)
    longest = max(1, int(np.ceil(total / most)))
    k = longest
    while k > 1 and _averaged_away(segments, k) > MOST_AVERAGED_AWAY:
        k = k // 2
    out = []
    for segment, motion in zip(segments, motions, strict=True):
        whole = block_means(segment, motion, output, k)
        if whole.time_s.size < 2:
            continue
        share = k / longest
        out += [whole] if share > WHOLE_SHARE else _windows(whole, share)
    return out


def _averaged_away(segments: Sequence[Segment], k: int) -> float:
    """Share of the variance of the input that blocks of so many samples do not show."""
    shown = power = 0.0
    for u in (s.input[: s.input.size // k * k] for s in segments if s.input.size >= k):
        means = _means(u, k)
        centre = float(means.mean())
        power += float(u @ u) - u.size * centre**2
        shown += k * (float(means @ means) - means.size * centre**2)
    return 1.0 - shown / power if power > 0.0 else 0.0


def block_means(segment: Segment, motion: Array, output: str, k: int) -> Stretch:
    """Means over so many samples each, which count where all of their samples do."""
    n = segment.time_s.size // k
    every, used = segment.used[output][: n * k], np.ones(n, bool)
    if not every.all():
        used = np.asarray(every.reshape(n, k).all(axis=1), bool)
        motion = np.where(np.isfinite(motion), motion, 0.0)
    time_s, inputs, x = (_means(a[: n * k], k) for a in (segment.time_s, segment.input, motion))
    return Stretch(time_s, inputs, x, used)


def _means(values: Array, k: int) -> Array:
    """Means over so many values each; a product of matrices is several times as fast as a mean."""
    means: Array = values.reshape(-1, k) @ np.full(k, 1.0 / k)
    return means


def _windows(whole: Stretch, share: float) -> list[Stretch]:
    """Windows spread evenly over a stretch that make up a share of it together."""
    n = whole.time_s.size
    count = max(1, min(WINDOWS, int(share * n) // LEAST_WINDOW))
    size = max(2, int(share * n) // count)
    found = []
    for begin in np.linspace(0, n - size, count).astype(int).tolist():
        part = slice(begin, begin + size)
        used = whole.used[part].copy()
        used[: int(LEAD_IN * size) if begin else 0] = False
        found.append(Stretch(whole.time_s[part], whole.input[part], whole.motion[part], used))
    return found
