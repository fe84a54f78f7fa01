"""In which experiment two causes differ most: the table of `softid.diagnosis.verdict.separations`.

    python tests/benchmarks/separation_of_causes.py

One cause is hidden in logs of a random muscle, the other is fitted to them together with the model,
and the other way round. What is left, in units of 0.5 % of the range, says how far the two are
apart: the larger of both directions, for a law that holds the other as a limit fits its data as
well, and the median over the seeds.
"""
# ruff: noqa: T201 (a script that prints its result)

from __future__ import annotations

import argparse
from itertools import permutations

import numpy as np

from softid.diagnosis import diagnose
from softid.diagnosis.verdict.separations import EXPERIMENTS, SEPARATIONS
from softid.synthesis import Rig, hidden_pair
from softid.synthesis.protocols import PROTOCOLS, Protocol
from softid.synthesis.waveforms import (
    Chirp,
    Hold,
    Rest,
    Sine,
    Staircase,
    Steps,
    Waveform,
)

NOISE = 0.005
"""The unit, in ranges of the output."""

QUIET = Rig(noise=0.1 * NOISE, pressure_noise_kpa=0.03)
"""The logs have a tenth of that noise, so that small differences show."""


def _levels(top: float) -> tuple[float, ...]:
    return tuple(share * top for share in (0.0, 0.5, 1.0, 0.3, 0.8, 0.2, 0.6, 0.0, 0.9, 0.4))


def commands(top: float, experiment: str) -> tuple[Waveform, ...]:
    """The input of an experiment that the table names, up to a pressure."""
    sine, staircase, steps, hold, chirp = EXPERIMENTS
    return {
        sine: (Rest(1.0), Sine(0.0, top, frequency_hz=0.5, cycles=12.0)),
        staircase: (Rest(1.0), Staircase(0.0, top, steps=6, hold_s=3.0, back=True)),
        steps: (Rest(1.0), Steps(_levels(top), 1.2), Steps(_levels(0.8 * top), 1.2)),
        hold: (Rest(1.0), Hold(0.7 * top, 20.0), Rest(20.0)),
        chirp: (Rest(1.0), Chirp(0.1 * top, 0.9 * top, first_hz=0.1, last_hz=4.0, duration_s=25.0)),
    }[experiment]


def left(hidden: str, fitted: str, experiment: str, seed: int) -> float:
    """Rms that one cause leaves of another's data, beside the noise and in units of `NOISE`."""
    PROTOCOLS[experiment] = Protocol(
        experiment,
        lambda top: commands(top, experiment),
        lambda top: commands(0.9 * top, experiment),
    )
    pair = hidden_pair([hidden], seed=seed, protocol=experiment, rig=QUIET)
    train, hold_out = pair.logs
    found = diagnose([train], hold_out=[hold_out], model="muscle", effects=[fitted])
    (row,) = [g for g in found.gains if not g.held_out]
    channel = next(c for c in pair.train.sigma if "pressure" not in c)
    factor = 1.0 / train.channels[train.outputs[0]].display_factor
    sigma = factor * pair.train.sigma[channel]
    unit = sigma * NOISE / QUIET.noise
    rms = min(row.rmse_before, row.rmse_after)
    return float(np.sqrt(max(rms**2 - sigma**2, 0.0)) / unit)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--draws", type=int, default=3)
    parser.add_argument("--pairs", default="", help="such as delay+pneumatic_lag,creep+hysteresis")
    asked = parser.parse_args()
    pairs = [tuple(p.split("+")) for p in asked.pairs.split(",") if p]
    pairs = pairs or [tuple(sorted(pair)) for pair in SEPARATIONS]
    print("| causes | " + " | ".join(EXPERIMENTS) + " |")
    for pair in pairs:
        row = []
        for experiment in EXPERIMENTS:
            drawn = [
                max(left(a, b, experiment, seed) for a, b in permutations(pair))
                for seed in range(asked.seed, asked.seed + asked.draws)
            ]
            row.append(float(np.median(drawn)))
        told = " | ".join(f"{value:.2f}" for value in row)
        print(f"| {', '.join(pair)} | {told} |", flush=True)


if __name__ == "__main__":
    main()
