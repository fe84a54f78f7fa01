"""The conventional oscillator: response, start values, units, options."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm

from softid.errors import UsageError
from softid.kernels.window_moments import window_moments
from softid.log import Log
from softid.models.oscillator import Oscillator
from softid.segment import Segment

THETA = np.array([0.5, 1.2, 30.0, 1.0, 0.0])


def driven(theta: np.ndarray, noise: float = 0.0) -> Segment:
    """Force steps and the response from rest, sampled at 100 Hz for 6 s."""
    time_s = np.arange(600) * 0.01
    force = np.where(time_s < 0.5, 0.0, np.where(time_s < 3.0, 10.0, -4.0))
    blank = Log.from_arrays(
        time_s, {"force": force, "position": time_s}, input="force", outputs=("position",)
    ).segments()[0]
    x = Oscillator().response(theta, blank, ("position",), start=None, derivatives=False)
    position = x.outputs["position"] + noise * np.random.default_rng(3).standard_normal(600)
    return Log.from_arrays(
        time_s, {"force": force, "position": position}, input="force", outputs=("position",)
    ).segments()[0]


def test_response_follows_the_matrix_exponential() -> None:
    """Free decay from (x₀, v₀) under a constant force: y∞ + exp(A t)(y₀ − y∞), within 1e-4."""
    time_s = np.linspace(0.0, 3.0, 150)
    s = Log.from_arrays(
        time_s,
        {"force": np.full(150, 6.0), "position": time_s},
        input="force",
        outputs=("position",),
    ).segments()[0]
    start = np.array([1.0, -2.0])
    theta = np.array([0.5, 1.2, 30.0, -1.0, 2.0])
    found = Oscillator().response(theta, s, ("position",), start=start, derivatives=False)
    rest = np.array([-(6.0 - 2.0) / 30.0, 0.0])
    a = np.array([[0.0, 1.0], [-60.0, -2.4]])
    expected = [rest[0] + (expm(a * t) @ (start - rest))[0] for t in time_s]
    np.testing.assert_allclose(found.outputs["position"], expected, atol=1e-4)
    assert found.start.tolist() == [1.0, -2.0]


def test_static_line() -> None:
    """x = G·(u − offset)/Q, and NaN without a spring, without a warning."""
    u = np.array([-1.0, 0.0, 5.0])
    theta = np.array([0.5, 1.2, 4.0, -1.0, 3.0])
    found = Oscillator().static_output(theta, u, "position")
    np.testing.assert_allclose(found, -(u - 3.0) / 4.0)
    theta[2] = 0.0
    assert np.isnan(Oscillator(spring="none").static_output(theta, u, "position")).all()


@pytest.mark.parametrize(("samples", "off"), [(8, 0.05), (16, 0.004)])
@pytest.mark.parametrize("phase", [0.0, 0.3, 0.7])
def test_moments_of_a_window_are_whole(samples: int, off: float, phase: float) -> None:
    """Closed form: ∫φ″x = ∫φx″ for a parabola, wherever the samples lie in the window.

    The slivers between its ends and the samples next to them are a fifth of it with eight samples.
    """
    time_s = (np.arange(6 * samples) + phase) / samples
    x = (time_s - time_s[0] - 0.5) ** 2
    first, behind = np.array([0]), np.searchsorted(time_s, time_s[:1] + 1.0)
    moments = np.empty((1, 5))
    window_moments(time_s, x, np.ones_like(x), first, behind, time_s[:1], 1.0, moments)
    second, _, _, whole, _ = moments[0]
    assert second == pytest.approx(2.0 * whole, rel=off)


@pytest.mark.parametrize("inverted", [False, True])
def test_weak_form_start_is_near_the_truth(inverted: bool) -> None:
    """The regression is exact but for its sums: M, N, Q within 25 % without noise."""
    theta = THETA.copy()
    theta[3] = -1.0 if inverted else 1.0
    model = Oscillator(inverted=inverted)
    best = model.guess([driven(theta)], "position")[0]
    for k, name in enumerate(("M", "N", "Q", "G")):
        assert best[name].value == pytest.approx(theta[k], rel=0.25), name


def test_starts_are_usable_with_noise_of_a_tenth() -> None:
    """10 % noise: the first start still explains more than three quarters of the variance."""
    s = driven(THETA, noise=0.03)
    y = s.outputs["position"]
    model = Oscillator()
    best = model.guess([s], "position")[0].values_vector()
    x = model.response(best, s, ("position",), start=None, derivatives=False).outputs["position"]
    assert np.var(y - x) < 0.25 * np.var(y)


@pytest.mark.parametrize("inverted", [False, True])
def test_starts_past_the_natural_frequency_know_the_direction(inverted: bool) -> None:
    """A sine of 4 Hz and noise of 7 % of its swing: an actuator of 1.3 Hz moves against it.

    The slope of the output over the input then has the wrong sign. The closed form of the swing is
    that of the frequency response, and the first start explains most of it.
    """
    hz, sign = 4.0, -1.0 if inverted else 1.0
    omega, own = 2.0 * np.pi * hz, 8.0
    response = 1.0 / (1.0 - (omega / own) ** 2 + 1.8j * omega / own)
    assert response.real < 0.0
    time_s = np.arange(1200) * 0.02
    swing = sign * np.imag(response * np.exp(1j * omega * time_s))
    noise = 0.07 * abs(response) * np.random.default_rng(5).standard_normal(time_s.size)
    log = Log.from_arrays(
        time_s,
        {"force": 1.2 + np.sin(omega * time_s), "position": 1.2 * sign + swing + noise},
        input="force",
        outputs=("position",),
    )
    (segment,) = log.with_intersample("smooth").segments()
    model = Oscillator(inverted=inverted)
    m, n, q, gain, _ = model.guess([segment], "position")[0].values_vector()
    found = gain / (q - m * omega**2 + 1j * n * omega)
    assert abs(found - sign * response) < 0.5 * abs(response)


def test_guess_without_a_spring_finds_mass_and_damping() -> None:
    """M ẍ + N ẋ = u − offset: the regression gives N, M and the offset within 25 %."""
    model = Oscillator(spring="none")
    time_s = np.arange(800) * 0.01
    force = 3.0 * np.sign(np.sin(2.5 * time_s)) + 0.5
    blank = Log.from_arrays(
        time_s, {"force": force, "position": time_s}, input="force", outputs=("position",)
    ).segments()[0]
    theta = np.array([0.8, 2.0, 0.0, 1.0, 0.5])
    x = model.response(theta, blank, ("position",), start=np.zeros(2), derivatives=False)
    s = Log.from_arrays(
        time_s,
        {"force": force, "position": x.outputs["position"]},
        input="force",
        outputs=("position",),
    ).segments()[0]
    best = model.guess([s], "position")[0]
    assert best["Q"].fixed
    assert best["Q"].value == 0.0
    for name, true in (("M", 0.8), ("N", 2.0), ("offset", 0.5)):
        assert best[name].value == pytest.approx(true, rel=0.25), name


def test_units_and_direction() -> None:
    """Coefficients are per output unit; a falling output holds G at −1."""
    model = Oscillator().adapted({"input": "N", "position": "mm"}, inverted=True)
    declared = model.parameters()
    assert [declared[k].unit for k in "MNQ"] == ["N/mm·s²", "N/mm·s", "N/mm"]
    assert declared["G"].value == -1.0
    assert declared["G"].fixed
    assert declared["offset"].unit == "N"


@pytest.mark.parametrize(
    ("options", "free"),
    [
        ({}, ("M", "N", "Q")),
        ({"order": "first"}, ("N", "Q")),
        ({"order": "static"}, ("Q",)),
        ({"spring": "none"}, ("M", "N", "offset")),
    ],
)
def test_options_hold_what_they_drop(options, free) -> None:
    """The gain is never free: it would make the scale arbitrary."""
    assert Oscillator(**options).parameters().free == free


def test_options_are_checked() -> None:
    """An unknown choice is refused with the choices."""
    with pytest.raises(UsageError, match="spring"):
        Oscillator(spring="cubic")  # type: ignore[arg-type]


def test_derived_and_limit() -> None:
    """Static gain 1/Q; M/N below a tenth of the period gives the first-order model."""
    values = dict(zip(("M", "N", "Q", "G", "offset"), THETA.tolist(), strict=True))
    found = Oscillator(x_unit="mm", u_unit="N").derived(values, (0.0, 1.0))
    assert found["static_gain"] == (pytest.approx(1 / 30), "mm/N")
    assert found["natural_frequency"][0] == pytest.approx(np.sqrt(60) / 2 / np.pi)
    assert Oscillator().derived(values | {"Q": 0.0}, (0.0, 1.0)) == {}
    theta = THETA.copy()
    theta[0] = 1e-6
    limit = Oscillator().limit(theta, 0.01, (0.0, 1.0), 10.0)
    assert limit is not None
    assert limit[0].order == "first"


def test_a_spring_that_comes_late_is_dropped_from_a_model_that_may_do_without() -> None:
    """N/Q of 400 s in a log of 10 s, more than thirty lengths; 200 s are fewer."""
    slow = np.array([0.5, 4.0, 0.01, 1.0, 0.0])
    found = Oscillator(x_unit="mm").limit(slow, 0.01, (0.0, 1.0), 10.0)
    assert found is not None
    assert found[0] == Oscillator(x_unit="mm", spring="none")
    assert found[1] == "the motion would come back in 4e+02 s, and the logs end after 10 s"
    slow[2] = 0.02
    assert Oscillator().limit(slow, 0.01, (0.0, 1.0), 10.0) is None
    slow[2] = 0.0
    assert Oscillator(spring="none").limit(slow, 0.01, (0.0, 1.0), 10.0) is None
