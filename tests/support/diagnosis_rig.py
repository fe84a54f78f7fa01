"""Diagnoses put together from small real fits, so that plots of them need no search."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import muscle_rig
import numpy as np
from muscle_rig import THETA

import softid
from softid.diagnosis_results import (
    Alternative,
    Cause,
    Diagnosis,
    Evidence,
    Gain,
    Remainder,
    Verdict,
)
from softid.effects import EFFECTS, ExtendedModel
from softid.log import Log
from softid.models.muscle import Muscle
from softid.results import FitResult

SCALE = replace(muscle_rig.SCALE, period_s=0.02, duration_s=50.0, travel=30.0)
MUSCLE = Muscle(x_unit="rad")
NOISE_RAD = 0.01


def extended(key: str | None) -> ExtendedModel:
    """The muscle with one effect or none."""
    effects = () if key is None else (EFFECTS[key](),)
    return ExtendedModel(MUSCLE, effects, SCALE)


def pressure(time_s: np.ndarray, *, cycles: bool) -> np.ndarray:
    """Triangles of three rates between holds, or steps up only."""
    if not cycles:
        return np.interp(time_s, [0, 2, 2.05, 6, 6.05, 12], [10, 10, 70, 70, 130, 130])
    corners, levels = [0.0], [20.0]
    for half_s, count in ((1.5, 1), (0.4, 2)):
        for _ in range(count):
            for level in (140.0, 20.0):
                corners.append(corners[-1] + half_s)
                levels.append(level)
        corners.append(corners[-1] + 1.0)
        levels.append(20.0)
    return np.interp(time_s, corners, levels)


def hidden_log(
    name: str, key: str | None, *, seed: int, size: float = 1.0, cycles: bool = True
) -> Log:
    """A log of the muscle with an effect at `size` times its moderate parameters, in degrees."""
    time_s = np.arange(0.0, 7.5 if cycles else 12.0, 0.02)
    channels = {"pressure": pressure(time_s, cycles=cycles), "angle": np.zeros(time_s.size)}
    (segment,) = Log.from_arrays(time_s, channels, units={"angle": "rad"}, name=name).segments()
    model = extended(key)
    theta = np.array([p.value for p in model.parameters().values()])
    theta[: THETA.size] = THETA
    theta[THETA.size : THETA.size + 1] *= size
    found = model.response(theta, segment, ("angle",), start=None, derivatives=False)
    noise = NOISE_RAD * np.random.default_rng(seed).standard_normal(time_s.size)
    channels["angle"] = np.degrees(found.outputs["angle"] + noise)
    return Log.from_arrays(time_s, channels, units={"angle": "deg"}, name=name)


@cache
def fitted(hidden: str | None, key: str | None, *, cycles: bool = True) -> FitResult:
    """A fit of the muscle, with an effect or without, to logs that hide one or none."""
    size = 3.0 if hidden is not None else 1.0
    logs = [hidden_log("cycles_1", hidden, seed=1, size=size, cycles=cycles)]
    held = [hidden_log("cycles_2", hidden, seed=2, size=size, cycles=cycles)]
    model = MUSCLE if key is None else extended(key)
    start = dict(zip(MUSCLE.parameters().names, THETA.tolist(), strict=True))
    parameters = model.parameters().with_values(start)
    return softid.fit(logs, model=model, hold_out=held, parameters=parameters)


def cause(key: str, before: float, after: float, *, interval: bool = True) -> Cause:
    """A link with errors in radians."""
    effect = EFFECTS[key]()
    gain = 1.0 - after / before
    return Cause(
        effect=effect.name,
        key=key,
        title=effect.title,
        law=effect.law,
        meaning=effect.meaning,
        remedy=effect.remedy,
        parameters=(),
        added_to=(),
        delta_bic=900.0,
        holdout_rmse_before=before,
        holdout_rmse_after=after,
        gain_ci95=(gain - 0.08, gain + 0.05) if interval else None,
    )


def rmse(result: FitResult) -> float:
    """Held-out error in radians."""
    return next(s.rmse for s in result.statistics if not s.in_sample)


def evidence(first: str) -> tuple[Evidence, ...]:
    """Two rounds over the catalogue; a third of it races in the first and less in the second."""
    others = [key for key in EFFECTS if key != first]
    found = [Evidence(1, "", 0.0, 0.0), Evidence(1, first, 2310.0, 0.93)]
    for k, key in enumerate(others):
        racing = 2304.0 if k == 0 else 1700.0 - 260.0 * k if k < 9 else None
        found.append(Evidence(1, key, racing, 0.9 / (k + 1.0)))
    found.append(Evidence(2, "", 0.0, 0.0))
    for k, key in enumerate(others):
        found.append(Evidence(2, key, 14.0 - 9.0 * k if k < 4 else None, 0.02 / (k + 1.0)))
    return tuple(found)


def remainder(structured: bool) -> Remainder:
    """Nothing left, or a little."""
    return Remainder(
        rms=NOISE_RAD,
        explained_share=0.98,
        structure_share=0.02,
        structure_limit=0.05,
        by={"x": 0.01},
        structured=structured,
        excess=0.02,
        noise_from_rest=True,
    )


def diagnosis(
    hidden: str | None = "hysteresis", key: str | None = "hysteresis", *, cycles: bool = True
) -> Diagnosis:
    """What a search hands over for logs that hide an effect; without a key nothing is named."""
    base = fitted(hidden, None, cycles=cycles)
    after = fitted(hidden, key, cycles=cycles) if key is not None else None
    causes = () if key is None or after is None else (cause(key, rmse(base), rmse(after)),)
    tie = next(k for k in EFFECTS if k != key)
    return Diagnosis(
        verdict=Verdict.ADEQUATE if key is None else Verdict.NAMED,
        summary="",
        base=base,
        extended=after,
        causes=causes,
        descriptive=(),
        alternatives=() if key is None else (Alternative((key, tie), {key: 0.0, tie: 6.0}, ""),),
        remainder=remainder(False),
        gains=gains(base, after),
        evidence=evidence(key or "delay"),
        next_experiment=None,
    )


def gains(base: FitResult, after: FitResult | None) -> tuple[Gain, ...]:
    """One row a log."""
    return tuple(
        Gain(b.log, b.channel, b.unit, not b.in_sample, b.n, b.rmse, a.rmse, b.fit_percent,
             a.fit_percent)
        for b, a in zip(base.statistics, (after or base).statistics, strict=True)
    )  # fmt: skip
