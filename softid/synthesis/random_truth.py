"""Random actuators and ready-made muscle logs for statistical tests."""

from __future__ import annotations

from collections.abc import Mapping
from math import exp, log

import numpy as np

from softid.synthesis.laws import Arc
from softid.synthesis.recipe import Recipe
from softid.synthesis.sensors import Sampling, Sensor
from softid.synthesis.synthetic import SyntheticLog, synthesize
from softid.synthesis.truth import Valve
from softid.synthesis.waveforms import Waveform

SINE_PEAK_BAR = 2.4
"""Peak of the sine that logs are made with, for which the share of the growing damping is drawn."""

PRESSURE_NOISE_KPA = 0.2
"""Standard deviation of the white noise of the pressure in ready-made logs."""

VALVE_TIME_CONSTANT_S = 0.04
"""First-order lag between command and measured pressure in ready-made logs."""


def random_muscle_truth(rng: np.random.Generator) -> dict[str, float]:
    """Seven parameters of a muscle that somebody could have built; all are assumptions.

    Drawn: largest contraction 55 to 85 mm, midpoint 1.2 to 1.7 bar, b1 2.2 to 3.6 per bar, time
    constant N/Q at the midpoint 50 to 300 ms, damping ratio there 0.7 to 3, and a part of the
    damping that grows with pressure to 0.1 to 0.6 of the constant part at 2.4 bar.

    Parameters
    ----------
    rng
        Generator to draw from.

    Returns
    -------
    dict
        M, a1, b1, c1, a2, b2, c2 with x in mm and p in bar.

    Examples
    --------
    >>> sorted(random_muscle_truth(np.random.default_rng(1)))
    ['M', 'a1', 'a2', 'b1', 'b2', 'c1', 'c2']
    """
    a1 = 1.0 / rng.uniform(55.0, 85.0)
    b1 = rng.uniform(2.2, 3.6)
    midpoint_bar = rng.uniform(1.2, 1.7)
    time_constant_s = exp(rng.uniform(log(0.05), log(0.3)))
    damping_ratio = exp(rng.uniform(log(0.7), log(3.0)))
    growing_share = rng.uniform(0.1, 0.6)
    b2 = rng.uniform(1.2, 2.4)

    c1 = a1 * exp(b1 * midpoint_bar)
    stiffness = 2.0 * c1
    damping = time_constant_s * stiffness
    midpoint_share = growing_share * exp(b2 * (midpoint_bar - SINE_PEAK_BAR))
    c2 = damping / (1.0 + midpoint_share)
    return {
        "M": (damping / (2.0 * damping_ratio)) ** 2 / stiffness,
        "a1": a1,
        "b1": b1,
        "c1": c1,
        "a2": growing_share * c2 * exp(-b2 * SINE_PEAK_BAR),
        "b2": b2,
        "c2": c2,
    }


def muscle_log(
    truth: Mapping[str, float],
    excitation: Waveform,
    *,
    name: str = "muscle",
    seed: int = 0,
    columns: tuple[str, ...] = ("contraction_mm",),
    rate_hz: float = 100.0,
    noise_mm: float = 0.3,
    geometry: Arc | None = None,
) -> SyntheticLog:
    """A muscle log with white noise, made without a recipe file.

    Parameters
    ----------
    truth
        M, a1, b1, c1, a2, b2, c2 with x in mm.
    excitation
        Commanded pressure.
    name, seed
        Name of the log and seed of its noise.
    columns
        Output columns; those in rad get the noise divided by the diameter, those in deg likewise.
    rate_hz
        Sampling rate.
    noise_mm
        Standard deviation of the white noise of a contraction.
    geometry
        Arc, needed for distance, length and angle columns.

    Examples
    --------
    >>> from softid.synthesis.waveforms import Steps
    >>> truth = random_muscle_truth(np.random.default_rng(1))
    >>> made = muscle_log(truth, Steps((0.0, 150.0), 0.5))
    >>> made.to_log().outputs, len(made.time_s)
    (('contraction',), 101)
    """
    sensors = {"pressure_kpa": Sensor(decimals=3, noise_sd=PRESSURE_NOISE_KPA)}
    for column in columns:
        scale = 1.0
        if column.startswith("angle") and geometry is not None:
            scale = 1.0 / geometry.diameter_mm
            if column.endswith("deg"):
                scale = float(np.degrees(scale))
        sensors[column] = Sensor(decimals=6, noise_sd=noise_mm * scale)
    return synthesize(
        Recipe(
            name=name,
            model="muscle",
            parameters=truth,
            excitation=excitation,
            sampling=Sampling(rate_hz=rate_hz),
            sensors=sensors,
            seed=seed,
            geometry=geometry,
            valve=Valve(VALVE_TIME_CONSTANT_S),
        )
    )
