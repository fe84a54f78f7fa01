"""Errors of logs so long that derivatives are not kept at every sample."""

from __future__ import annotations

import numpy as np
import pytest
from linear_motion import linear_log

import softid
from softid.fitters import normal_equations, objective
from softid.identification import parameter_covariance
from softid.log import Log
from softid.models import Oscillator
from softid.results import FitResult

MODEL = Oscillator(x_unit="rad", u_unit="kPa")
SAMPLES = 4000


def logs() -> list[Log]:
    """Two: white noise in one, of which a tenth is left out, slow noise in the other."""
    lost = np.random.default_rng(3).random(SAMPLES) < 0.1
    slow = np.zeros(SAMPLES)
    pushed = 0.003 * np.random.default_rng(4).standard_normal(SAMPLES)
    for k in range(1, SAMPLES):
        slow[k] = 0.95 * slow[k - 1] + pushed[k]
    return [
        linear_log(noise=0.01, seed=1, samples=SAMPLES).with_masked(lost),
        linear_log(noise=0.003, seed=2, samples=SAMPLES, added=slow),
    ]


def fitted(most: int | None, monkeypatch: pytest.MonkeyPatch) -> FitResult:
    """A fit that keeps no more derivatives than so many."""
    with monkeypatch.context() as patched:
        for module in (normal_equations, objective, parameter_covariance):
            if most is not None:
                patched.setattr(module, "KEPT_ENTRIES", most)
        return softid.fit(logs(), model=MODEL)


def test_errors_over_averages_are_those_of_all_samples(monkeypatch: pytest.MonkeyPatch) -> None:
    """Averages of three samples, 0.06 s of an actuator of 0.2 s: errors within 8 %, the same noise.

    What is fitted does not ask how much is kept.
    """
    whole = fitted(None, monkeypatch)
    free = sum(not p.fixed for p in whole.parameters) + 2
    short = fitted(2 * SAMPLES * free // 3 + 1, monkeypatch)
    for exact, found in zip(whole.parameters, short.parameters, strict=True):
        assert found.value == pytest.approx(exact.value, rel=1e-5)
        if exact.stderr is not None:
            assert found.stderr == pytest.approx(exact.stderr, rel=0.08)
            assert found.stderr != exact.stderr
    for exact_noise, noise in zip(whole.noise, short.noise, strict=True):
        assert noise.sigma == pytest.approx(exact_noise.sigma, rel=1e-4)
        assert noise.ar == pytest.approx(exact_noise.ar, abs=1e-3)


def test_a_law_that_no_kernel_sums_keeps_its_derivatives(monkeypatch: pytest.MonkeyPatch) -> None:
    """An effect in the motion: the errors are those of all samples, however many they are."""
    crept = 0.2 * np.tanh(np.arange(1500) / 300)
    log = linear_log(noise=0.002, samples=1500, added=crept)

    def errors(most: int) -> list[float]:
        with monkeypatch.context() as patched:
            for module in (normal_equations, objective, parameter_covariance):
                patched.setattr(module, "KEPT_ENTRIES", most)
            found = softid.diagnose(log, model=MODEL, effects=["creep"])
        assert found.extended is not None
        return [p.stderr or 0.0 for p in found.extended.parameters]

    assert errors(8_000_000) == pytest.approx(errors(3_000), rel=1e-3)
