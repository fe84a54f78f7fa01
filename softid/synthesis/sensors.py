"""What a rig does to the true signals: clock, lost rows, noise, zero, resolution, blank cells."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np
import numpy.typing as npt

from softid.errors import InputError
from softid.synthesis.tables import Checked, Count, Decimals, Fraction, NonNegative, Positive

Array = npt.NDArray[np.float64]

LARGEST_JITTER_PERIODS = 0.4
"""A row is shifted by less than half of a period, so that rows keep their order."""

MOST_ROWS = 1_000_000
"""More is a slip in a recipe; a file of so many rows has tens of megabytes."""

_SETTLING_SAMPLES = 500
"""Samples after which coloured noise has forgotten that it began at zero."""

_HALF_ULP = 2.0**-54
"""Half the distance of two draws, by which zero, whose quantile is infinite, is none."""


@dataclass(frozen=True)
class Sampling(Checked):
    """The clock of the rig.

    Attributes
    ----------
    rate_hz
        Nominal rate.
    jitter_s
        Standard deviation of the sample times around the nominal ones, cut at 0.4 periods. The
        recorded time is the true one.
    decimals
        Decimals of the recorded time.
    skip_s
        The recording starts this long after the excitation; its time starts at zero again.
    lost_fraction
        Probability of each row to be missing.
    stall_at_s, stall_s
        Recorded times at which the clock stalls, and for how long.
    """

    rate_hz: Positive
    jitter_s: NonNegative = 0.0
    decimals: Decimals = 4
    skip_s: NonNegative = 0.0
    lost_fraction: Fraction = 0.0
    stall_at_s: tuple[NonNegative, ...] = ()
    stall_s: NonNegative = 0.0

    def times(self, duration_s: float, rng: np.random.Generator) -> Array:
        """Recorded times in s, shape (n,), the first of them zero.

        Parameters
        ----------
        duration_s
            Length of the excitation.
        rng
            Generator of the clock alone.

        Raises
        ------
        InputError
            Fewer than two rows are left, the rows are too many, or two of them share a time.
        """
        count = int(np.floor((duration_s - self.skip_s) * self.rate_hz + 1e-9)) + 1
        if not 2 <= count <= MOST_ROWS:
            raise InputError(
                f"the recording has {count} rows",
                where="sampling",
                value=self.rate_hz,
                remedy=f"choose rate_hz and skip_s for 2 to {MOST_ROWS} rows",
            )
        limit_s = LARGEST_JITTER_PERIODS / self.rate_hz
        shift_s = np.clip(self.jitter_s * standard_normal(rng, count), -limit_s, limit_s)
        shift_s[0] = 0.0
        times_s = rounded(np.arange(count) / self.rate_hz + shift_s, self.decimals)
        times_s = np.minimum(times_s, duration_s - self.skip_s)
        kept = rng.random(count) >= self.lost_fraction
        kept[0] = True
        for start_s in self.stall_at_s:
            kept &= (times_s <= start_s) | (times_s >= start_s + self.stall_s)
        times_s = times_s[kept]
        if times_s.size < 2 or not (np.diff(times_s) > 0).all():
            raise InputError(
                "two rows would have the same time, or fewer than two are left",
                where="sampling",
                remedy="give more decimals, or lose fewer rows",
            )
        return times_s


@dataclass(frozen=True)
class Sensor(Checked):
    """One recorded column: y = round(true + zero + white noise + coloured noise).

    Attributes
    ----------
    decimals
        Decimals written to the file.
    zero
        Constant that the sensor adds, in the column's unit like all that follows.
    noise_sd
        Standard deviation of the white noise.
    coloured_sd, coloured_ar
        Standard deviation of a second, coloured noise and its autoregressive coefficients,
        c_k = Σ φ_j c_{k−j} + e_k, counted in rows.
    quantum
        Resolution of the converter; values are multiples of it.
    blank_fraction, blank_rows
        Share of the samples that are missing, and how many in a row at a time.
    """

    decimals: Decimals
    zero: float = 0.0
    noise_sd: NonNegative = 0.0
    coloured_sd: NonNegative = 0.0
    coloured_ar: tuple[float, ...] = ()
    quantum: NonNegative = 0.0
    blank_fraction: Fraction = 0.0
    blank_rows: Count = 1

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.coloured_sd > 0.0 and not self.coloured_ar:
            raise InputError(
                "coloured noise needs its autoregressive coefficients",
                where="Sensor",
                value=self.coloured_sd,
                remedy="add coloured_ar, for example [0.9]",
            )
        if self.coloured_ar and not _stationary(self.coloured_ar):
            raise InputError(
                "the coloured noise would grow without end",
                where="Sensor",
                value=list(self.coloured_ar),
                remedy="choose coloured_ar inside the stationary region, for example [0.9]",
            )

    @property
    def sigma(self) -> float:
        """Standard deviation of all that the sensor adds, zero apart."""
        step = max(self.quantum, 10.0**-self.decimals)
        return sqrt(self.noise_sd**2 + self.coloured_sd**2 + step**2 / 12.0)

    def read(self, true_values: Array, rng: np.random.Generator) -> Array:
        """The recorded values, shape (n,); NaN where a cell is blank."""
        count = true_values.size
        values = true_values + self.zero + self.noise_sd * standard_normal(rng, count)
        if self.coloured_sd > 0.0:
            values = values + self.coloured_sd * coloured_noise(self.coloured_ar, count, rng)
        if self.quantum > 0.0:
            values = np.floor(values / self.quantum + 0.5) * self.quantum
        values = rounded(values, self.decimals)
        if self.blank_fraction > 0.0:
            starts = np.flatnonzero(rng.random(count) < self.blank_fraction / self.blank_rows)
            for offset in range(self.blank_rows):
                values[np.minimum(starts + offset, count - 1)] = np.nan
        return values


def standard_normal(rng: np.random.Generator, count: int) -> Array:
    """Standard normal numbers, shape (count,), by inversion of the generator's uniform numbers.

    The uniform stream is a fixed function of the generator's bits; numpy promises nothing of the
    kind for its own normal stream, and logs are to be the same bytes years from now.
    """
    from scipy.special import ndtri  # 0.1 s, and `softid --help` needs none of it

    found: Array = ndtri(rng.random(count) + _HALF_ULP)
    return found


def coloured_noise(ar: tuple[float, ...], count: int, rng: np.random.Generator) -> Array:
    """Stationary autoregressive noise of unit variance, shape (count,).

    Parameters
    ----------
    ar
        φ_1 … φ_q of c_k = Σ φ_j c_{k−j} + e_k.
    count
        Number of samples.
    rng
        Generator of this sensor alone.
    """
    innovations = standard_normal(rng, count + _SETTLING_SAMPLES)
    noise = _filtered(ar, innovations)[_SETTLING_SAMPLES:]
    pulse = np.zeros(20 * _SETTLING_SAMPLES)
    pulse[0] = 1.0
    response = _filtered(ar, pulse)
    unit_variance: Array = noise / np.sqrt(np.sum(response**2))
    return unit_variance


def _filtered(ar: tuple[float, ...], innovations: Array) -> Array:
    past = [0.0] * len(ar)
    found = []
    for innovation in innovations.tolist():
        value = innovation + sum(a * b for a, b in zip(ar, past, strict=True))
        past = [value, *past[:-1]]
        found.append(value)
    return np.array(found)


def _stationary(ar: tuple[float, ...]) -> bool:
    roots = np.roots([1.0, *(-a for a in ar)])
    return bool((np.abs(roots) < 0.999).all())


def rounded(values: Array, decimals: int) -> Array:
    """Values as they read back from text with that many decimals; no negative zero."""
    return np.array([float(f"{v:.{decimals}f}") for v in values.tolist()]) + 0.0
