"""The noise of an output without the motion: from rest stretches, or from its fastest part."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from softid.diagnosis.residual.structure import ResidualContext
from softid.excitation import SECOND_DIFFERENCE
from softid.uncertainty.autoregression import contiguous_runs, fit_ar
from softid.uncertainty.noise import effective_n

Array = npt.NDArray[np.float64]

REST_S = 15.0
"""Shortest rest, in one piece and after the motion has died out, that shows the noise's colour."""

DEAD_AFTER = 5.0
"""Time constants after which the motion counts as dead: less than a hundredth is left."""

STILL_SPAN = 0.02
"""The input rests while it stays within this share of its span over all logs."""

MOST_OF_IT, SPREAD = 0.8, 1.5
"""Share of the samples of a still piece, and most tolerances that they lie off its middle, as of
noise with a deviation of the tolerance itself: with half of that deviation, a few samples of a
piece do not go beyond by chance."""

SPIKE_SHARE = 0.04
"""Largest share of a still piece of the input that lies far off its middle: a spike or two."""

FAR_OFF = 3.0
"""Distance from the middle of a piece that is far off, in tolerances."""

LOOK_S = 0.5
"""Length of the pieces in which the input is looked at."""

PIECE_S = 4.0
"""Length of the pieces of a rest that are held against each other."""

FEWEST_PIECES = 4
"""Fewest pieces of a rest that show what the usual one is."""

EVENTFUL = 10.0
"""In a piece something happened that is no noise when it holds so many times the power of the usual
one, which varies far less from piece to piece in slow noise."""

FEWEST_SAMPLES = 3
"""Measured samples of a rest: fewer make no noise model."""

SQUARES_COST = 5.0
"""Relative variance of the estimate, times the number of differences: 3.9 for their squares, which
are correlated, and more for a quantile in place of the mean."""

SMALLEST_EXCESS = 0.15
"""The residual is larger than the noise when its variance is so far above it, as a share: pressure
noise leaves less."""

EXCESS_SDS = 3.0
"""Standard deviations of the estimate of the noise variance that are added to the least excess at
which a residual is larger than the noise."""

SAMPLES_OF_LINE = 20
"""Samples of a rest that show a straight line at least: of fewer, chance makes one."""

MOSTLY_LINE = 0.5
"""A line that leaves more than this share of a rest's power is no drift to speak of."""

BLOCK_SAMPLES = 32
"""Samples whose fastest part has one size. Noise that grows with the reading, and that of the
pressure where the static curve is steep, has another one elsewhere."""

QUANTILE, AT_QUANTILE = 0.75, 1.15035
"""A quarter of a block's differences may be jumps, and are left out: its deviation is this quantile
of their sizes over that of a standard normal. The square of it is fair to 1 % for so few samples,
which a median's is not."""


@dataclass(frozen=True)
class NoiseFloor:
    """Variance of the noise and how well it is known.

    Attributes
    ----------
    variance
        In the square of the output's unit.
    relative_sd
        Standard deviation of the variance, as a share of it.
    from_rest
        Whether rest stretches told it; otherwise it is what is left in the fastest part of the
        residual, and slow noise looks like a misfit.
    from_rounding
        Whether the rounding of the reading told it, which no noise blurs.
    """

    variance: float
    relative_sd: float
    from_rest: bool
    from_rounding: bool = False

    @property
    def is_known(self) -> bool:
        """Whether rests or rounding told the noise, which no misfit of the motion changes."""
        return self.from_rest or self.from_rounding

    def largest_excess(self, deviations: float = EXCESS_SDS) -> float:
        """How much more a residual may have that is no larger than the noise, as a share.

        Parameters
        ----------
        deviations
            Of the estimate, that are added to `SMALLEST_EXCESS`.
        """
        return SMALLEST_EXCESS + deviations * self.relative_sd


def noise_floor(parts: Sequence[ResidualContext], motion_s: float, *, alike: int = 1) -> NoiseFloor:
    """Estimate the noise from the residuals of all segments.

    Rests tell its colour. What its fastest part has more elsewhere, where the reading is larger or
    a coarse converter does not stand still, is noise, too.

    Parameters
    ----------
    parts
        Residuals with their input.
    motion_s
        Time constant of the motion.
    alike
        Noise of samples that are fewer apart is alike, as a filter behind the sensor leaves it.
    """
    u_span = input_span(parts)
    rests = [
        _without_drift(part.residual[span], part.time_s[span], alike)
        for part in parts
        for span in rest_spans(part, motion_s, u_span)
        if np.isfinite(part.residual[span]).any()
    ]
    rests = [rest for rest in rests if np.isfinite(rest).sum() >= FEWEST_SAMPLES]
    whole = [run for part in parts for run in contiguous_runs(part.residual)]
    everywhere = fastest_part(whole, alike)
    if rests:
        runs = [run for rest in rests for run in contiguous_runs(rest)]
        lengths = [run.size for run in runs]
        known = effective_n(fit_ar(runs), lengths)
        # those of a mean, fewer than a variance has: the power of what is held against this
        # estimate is as little known
        degrees = max(known - len(rests), 1.0)
        total = sum(float(run @ run) for run in runs)
        variance = total / sum(lengths) * (known / degrees)
        variance += max(everywhere.variance - fastest_part(runs, alike).variance, 0.0)
        return NoiseFloor(variance, float(np.sqrt(2.0 / degrees)), from_rest=True)
    return everywhere


def fastest_part(runs: Sequence[Array], alike: int = 1) -> NoiseFloor:
    """Variance from the second differences: the mean over blocks of what a quantile in each says.

    Within a block the quantile leaves out what jumps there; the mean adds up noise whose size
    changes from block to block.

    Parameters
    ----------
    runs
        Residuals of samples that follow each other.
    alike
        As in `noise_floor`: differences are those of samples so many apart.
    """
    second = _second_differences(runs, alike)
    blocks = np.array_split(second, max(second.size // BLOCK_SAMPLES, 1))
    deviations = [float(np.quantile(np.abs(block), QUANTILE)) / AT_QUANTILE for block in blocks]
    variance = float(np.mean(np.square(deviations))) / SECOND_DIFFERENCE
    return NoiseFloor(variance, float(np.sqrt(SQUARES_COST * alike / second.size)), from_rest=False)


def of_single_samples(runs: Sequence[Array], alike: int = 1) -> float:
    """Variance of what knows nothing of its neighbours, whatever its distribution.

    The mean square of the second differences, over that of a white one: outliers that last for one
    sample, which `fastest_part` leaves out, add to it and to the mean square alike.

    Parameters
    ----------
    runs, alike
        As in `fastest_part`.
    """
    return float(np.mean(_second_differences(runs, alike) ** 2)) / SECOND_DIFFERENCE


def _second_differences(runs: Sequence[Array], alike: int) -> Array:
    spaced = [run[first::alike] for run in runs for first in range(alike)]
    return np.concatenate([np.diff(run, 2) for run in spaced if run.size > 2] or [np.zeros(1)])


def _without_events(rest: Array, time_s: Array) -> Array:
    """The residual of a rest about its mean; NaN where something touched the actuator."""
    pieces = np.array_split(rest, max(int((time_s[-1] - time_s[0]) / PIECE_S), 1))
    seen = [piece for piece in pieces if np.isfinite(piece).any()]
    if len(seen) < FEWEST_PIECES:
        return rest - float(np.nanmean(rest))
    level = float(np.median([np.nanmedian(piece) for piece in seen]))
    power = [
        float(np.nanmean((piece - level) ** 2)) if np.isfinite(piece).any() else np.nan
        for piece in pieces
    ]
    limit = EVENTFUL * float(np.nanmedian(power))
    kept = [
        piece if own <= limit else np.full(piece.size, np.nan)
        for piece, own in zip(pieces, power, strict=True)
    ]
    quiet = np.concatenate(kept)
    return quiet - float(np.nanmean(quiet))


def _without_drift(residual: Array, time_s: Array, alike: int) -> Array:
    """The rest without events, about a straight line where that is most of it and leaves no colour.

    Slow noise is not straight: a reading that drifts at a constant rate is a cause to be found.
    """
    rest = _without_events(residual, time_s)
    seen = np.isfinite(rest)
    if seen.sum() < SAMPLES_OF_LINE:
        return rest
    offset_s, values = time_s[seen] - time_s[seen].mean(), rest[seen]
    about = np.full(rest.size, np.nan)
    about[seen] = values - (offset_s @ values) / (offset_s @ offset_s) * offset_s
    white = fastest_part(contiguous_runs(about), alike)
    power = float(np.nanmean(about**2))
    is_white = power <= (1.0 + white.largest_excess()) * white.variance
    return about if is_white and power < MOSTLY_LINE * float(np.mean(values**2)) else rest


def rest_spans(part: ResidualContext, motion_s: float, u_span: float) -> tuple[slice, ...]:
    """Samples at which the input has been still for so long that the motion has died out.

    Where the motion begins at rest there is none to die out before the input first moves.

    Parameters
    ----------
    part
        A residual with its input.
    motion_s
        Time constant of the motion.
    u_span
        Span of the input over all logs, from `input_span`: in a log that is one rest it moves by
        the noise of its gauge alone.
    """
    found: list[slice] = []
    for still in still_spans(part.u, part.time_s, STILL_SPAN * u_span):
        moved = still.start > 0 or not part.begins_at_rest
        found += _settled(part.time_s, still, DEAD_AFTER * motion_s if moved else 0.0)
    return tuple(found)


def input_span(parts: Sequence[ResidualContext]) -> float:
    """How far the input goes over all segments."""
    return float(np.ptp(np.concatenate([part.u for part in parts])))


def still_spans(
    u: Array, time_s: Array, tolerance: float, *, look_s: float = LOOK_S
) -> tuple[slice, ...]:
    """Stretches in which an input stays where it was at their beginning, by pieces of equal time.

    A piece is still where its median is within the tolerance of that of the first one, and so are
    most of its samples of its own: noise of the gauge and a spike are no motion at any sampling
    rate, and a slow ramp is one when it has gone further than the tolerance.

    Parameters
    ----------
    u, time_s
        Input and times, each of shape (n,).
    tolerance
        How far the input may be off and still be where it was.
    look_s
        Length of the pieces.

    Examples
    --------
    >>> time_s = np.arange(400) / 100.0
    >>> u = np.where(time_s < 2.0, 0.0, 50.0) + 0.1 * (-1.0) ** np.arange(400)
    >>> [(span.start, span.stop) for span in still_spans(u, time_s, 1.0)]
    [(0, 200), (250, 400)]
    """
    edges = np.searchsorted(time_s, np.arange(time_s[0], time_s[-1] + look_s, look_s)).tolist()
    edges[-1] = u.size
    found: list[slice] = []
    begin, level = 0, float(np.median(u[: max(edges[1], 1)]))
    for first, stop in pairwise(edges):
        piece = u[first:stop]
        if _is_still(piece, level, tolerance):
            continue
        found.append(slice(begin, first))
        begin, level = stop, float(np.median(piece)) if piece.size else level
    found.append(slice(begin, u.size))
    return tuple(span for span in found if span.stop > span.start)


def _is_still(piece: Array, level: float, tolerance: float) -> bool:
    """Whether an input stays at a level throughout a piece; not where nothing was recorded."""
    if not piece.size:
        return False
    middle = float(np.median(piece))
    off = np.sort(np.abs(piece - middle))
    most = off[int(MOST_OF_IT * (off.size - 1))]
    rare = off[off.size - 1 - round(SPIKE_SHARE * off.size)]
    return bool(
        abs(middle - level) <= tolerance
        and most <= SPREAD * tolerance
        and rare <= FAR_OFF * tolerance
    )


def _settled(time_s: Array, still: slice, after_s: float) -> list[slice]:
    """A still stretch without its first seconds, if it is long enough."""
    first = int(np.searchsorted(time_s, time_s[still.start] + after_s))
    if first >= still.stop or time_s[still.stop - 1] - time_s[first] < REST_S:
        return []
    return [slice(first, still.stop)]
