"""Errors of logs whose derivatives are not kept, and of such as show no noise at some samples."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from linear_motion import TRUTH, linear_angle, linear_log
from noise import ar1

import softid
from softid.diagnosis import answer
from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.effects import ExtendedModel, effect_of
from softid.fitters import normal_equations, objective
from softid.fitters.problem import Problem
from softid.identification import parameter_covariance
from softid.log import Log
from softid.models import Oscillator
from softid.results import FitResult

Array = npt.NDArray[np.float64]

MODEL = Oscillator(x_unit="rad", u_unit="kPa")
SAMPLES = 4000


def logs() -> list[Log]:
    """Two: white noise in one, of which a tenth is left out, slow noise in the other."""
    lost = np.random.default_rng(3).random(SAMPLES) < 0.1
    slow = 0.01 * ar1(np.random.default_rng(4), SAMPLES, 0.95)
    return [
        linear_log(noise=0.01, seed=1, samples=SAMPLES).with_masked(lost),
        linear_log(noise=0.003, seed=2, samples=SAMPLES, added=slow),
    ]


def fitted(made: Sequence[Log], monkeypatch: pytest.MonkeyPatch, *, summed: bool) -> FitResult:
    """A fit that keeps derivatives at every sample, or none of them."""
    with monkeypatch.context() as patched:
        most = 0 if summed else 10**9
        patched.setattr(objective, "CHEAP_ENTRIES", most)
        for module in (objective, parameter_covariance):
            patched.setattr(module, "SUMMED_ENTRIES", most)
        return softid.fit(made, model=MODEL)


def test_errors_over_averages_are_those_of_all_samples(monkeypatch: pytest.MonkeyPatch) -> None:
    """Averages of four samples, 0.08 s of an actuator of 0.2 s: errors within 8 %, the same noise.

    What is fitted does not ask how much is kept.
    """
    whole, short = (fitted(logs(), monkeypatch, summed=summed) for summed in (False, True))
    for exact, found in zip(whole.parameters, short.parameters, strict=True):
        assert found.value == pytest.approx(exact.value, rel=1e-5)
        if exact.stderr is not None:
            assert found.stderr == pytest.approx(exact.stderr, rel=0.08)
            assert found.stderr != exact.stderr
    for exact_noise, noise in zip(whole.noise, short.noise, strict=True):
        assert noise.sigma == pytest.approx(exact_noise.sigma, rel=1e-4)
        assert noise.ar == pytest.approx(exact_noise.ar, abs=1e-3)


@pytest.mark.parametrize("rows", [2, 3, 5])
def test_a_log_of_a_few_samples_shares_the_noise_of_a_longer_one(rows: int) -> None:
    """Its own zero and state may follow all of them; the errors are those of the long log alone."""
    long = linear_log(noise=0.01, seed=1, samples=SAMPLES)
    other = linear_log(noise=0.01, seed=2, samples=SAMPLES)
    names = ("pressure", "angle")
    short = Log.from_arrays(
        other.time_s[:rows],
        {name: other.channels[name].values[2000 : 2000 + rows] for name in names},
        units={name: other.channels[name].unit for name in names},
        name="cut off",
    )
    alone, both = (softid.fit(made, model=MODEL) for made in ([long], [long, short]))
    for name in ("M", "N", "Q"):
        one, other_one = alone.parameter(name), both.parameter(name)
        assert other_one.value == pytest.approx(one.value, rel=0.02)
        assert other_one.stderr == pytest.approx(one.stderr, rel=0.1)


def test_averages_longer_than_the_motion_know_what_the_samples_know(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Samples 0.1 s apart of an actuator of 0.2 s under white noise: errors within 8 %.

    By the averages of four alone they would be larger by half and more.
    """
    rng = np.random.default_rng(5)
    time_s = 0.1 * np.arange(SAMPLES)
    pressure = np.repeat(rng.uniform(0.0, 100.0, SAMPLES // 8), 8)
    angle = linear_angle(time_s, pressure) + 0.01 * rng.standard_normal(SAMPLES)
    channels = {"pressure": pressure, "angle": angle}
    coarse = [Log.from_arrays(time_s, channels).with_intersample("straight")]
    whole, short = (fitted(coarse, monkeypatch, summed=summed) for summed in (False, True))
    with monkeypatch.context() as patched:
        patched.setattr(parameter_covariance, "known_better", lambda averaged, _: averaged)
        alone = fitted(coarse, monkeypatch, summed=True)
    ratios = {
        name: [fit.parameter(name).stderr / whole.parameter(name).stderr for fit in (short, alone)]
        for name in ("M", "N", "Q")
    }
    assert all(abs(near - 1.0) < 0.08 for near, _ in ratios.values()), ratios
    assert max(far for _, far in ratios.values()) > 1.5


@pytest.mark.slow
def test_a_law_that_no_kernel_sums_keeps_its_derivatives(monkeypatch: pytest.MonkeyPatch) -> None:
    """An effect in the motion: the errors are those of all samples, however many they are.

    The fit itself keeps what it keeps, for it would end elsewhere within its tolerance.
    """
    crept = 0.2 * np.tanh(np.arange(1500) / 300)
    log = linear_log(noise=0.002, samples=1500, added=crept)
    assembled = answer._assembled

    def errors(most: int) -> list[float]:
        def with_few(*given: Any) -> FitResult:
            with monkeypatch.context() as patched:
                patched.setattr(normal_equations, "KEPT_ENTRIES", most)
                return assembled(*given)

        with monkeypatch.context() as patched:
            patched.setattr(answer, "_assembled", with_few)
            found = softid.diagnose(log, model=MODEL, effects=["creep"])
        assert found.extended is not None
        return [p.stderr or 0.0 for p in found.extended.parameters]

    assert errors(8_000_000) == pytest.approx(errors(3_000), rel=1e-3)


def clipped_fit(log: Log, noise: Array | float) -> FitResult:
    """A fit of the actuator and the end of a sensor that adds some noise to what it clips."""
    base = Problem(MODEL, MODEL.parameters().with_values(TRUTH), [log])
    scale = scale_of(base, base.unknowns(TRUTH))
    model = ExtendedModel(MODEL, (effect_of("sensor_clipping"),), scale)
    values = np.minimum(log.channels["angle"].values, 1.2) + noise
    channels = {**log.channels, "angle": replace(log.channels["angle"], values=values)}
    declared = model.parameters().with_values({**TRUTH, "sensor_clipping_upper": 1.2})
    return softid.fit(replace(log, channels=channels), model=model, parameters=declared)


def test_what_stands_at_the_end_of_a_sensor_says_nothing_of_its_noise() -> None:
    """A converter clips its noise with the reading in a third of the samples; an amplifier ends and
    trembles on. Motion is seen in the same other samples, and known as well, within the scatter of
    a variance. The limit counts from the zero and is known no better."""
    trembling = 0.01 * np.random.default_rng(7).standard_normal(SAMPLES)
    silent = clipped_fit(linear_log(samples=SAMPLES, added=trembling), 0.0)
    loud = clipped_fit(linear_log(samples=SAMPLES), trembling)
    assert silent.statistics[0].rmse < 0.9 * loud.statistics[0].rmse
    for name in ("N", "Q"):
        one, other = (fitted.parameter(name).stderr for fitted in (silent, loud))
        assert one == pytest.approx(other, rel=0.1)
    zero = silent.nuisances[0].zero_stderr["angle"]
    assert silent.parameter("sensor_clipping_upper").stderr == pytest.approx(zero, rel=0.1)
