"""A rig: how the signals of a log with hidden effects are recorded."""

from __future__ import annotations

from dataclasses import dataclass
from math import exp
from typing import Annotated, Literal

from softid.synthesis.sensors import Sampling, Sensor
from softid.synthesis.tables import Checked, Fraction, NonNegative, Positive, Range


@dataclass(frozen=True)
class Rig(Checked):
    """How the signals are recorded; all shares are of the output's range.

    Attributes
    ----------
    rate_hz
        Sampling rate.
    noise
        Standard deviation of the output's noise, white and coloured together.
    coloured_share
        Share of that variance that is coloured.
    correlation_s
        Correlation time of the coloured noise.
    pressure_noise_kpa
        Standard deviation of the pressure's white noise.
    quantum
        Resolution of the output.
    zero
        Standard deviation of the output's unknown zero.
    jitter
        Standard deviation of the sample times in sampling intervals.
    lost_fraction, blank_fraction
        Shares of the rows that are missing and of the output's cells that are blank.
    valve_s
        Time constant between command and recorded pressure.
    rest_s
        Rest added at the end.
    unit
        Unit of the output: ``"mm"``, or ``"deg"`` and ``"rad"`` for a bending angle.
    """

    rate_hz: Annotated[float, Range(above=0.0, upper=1e5)] = 100.0
    noise: NonNegative = 0.005
    coloured_share: Annotated[float, Range(lower=0.0, upper=1.0)] = 0.0
    correlation_s: Positive = 1.0
    pressure_noise_kpa: NonNegative = 0.3
    quantum: NonNegative = 0.0
    zero: NonNegative = 0.03
    jitter: NonNegative = 0.0
    lost_fraction: Fraction = 0.0
    blank_fraction: Fraction = 0.0
    valve_s: Positive = 0.04
    rest_s: Annotated[float, Range(lower=0.0, upper=3600.0)] = 0.0
    unit: Literal["mm", "deg", "rad"] = "mm"

    @property
    def x_unit(self) -> Literal["mm", "rad"]:
        """Unit of the position in the law of motion."""
        return "mm" if self.unit == "mm" else "rad"

    def sampling(self) -> Sampling:
        """The clock."""
        return Sampling(
            self.rate_hz,
            jitter_s=self.jitter / self.rate_hz,
            decimals=6 if self.jitter else 4,
            lost_fraction=self.lost_fraction,
        )

    def output_sensor(self, span: float, zero: float) -> Sensor:
        """The sensor of an output with a range, both in the column's unit."""
        coloured = self.coloured_share > 0.0 and self.noise > 0.0
        share = self.coloured_share
        period_s = 1.0 / self.rate_hz
        return Sensor(
            decimals=6,
            zero=zero,
            noise_sd=span * self.noise * (1.0 - share) ** 0.5,
            coloured_sd=span * self.noise * share**0.5,
            coloured_ar=(exp(-period_s / self.correlation_s),) if coloured else (),
            quantum=self.quantum * span,
            blank_fraction=self.blank_fraction,
        )


RIG = Rig()
