"""Arrays behind the plots: bands, levels, zeros, cycles, branches."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from handmade import MUSCLE_VALUES, fit_result, simulation, step_log

from softid.models import Muscle
from softid.plots.branches import rising_samples
from softid.plots.curves import (
    HasDamping,
    common_zero,
    curve_sd,
    damping_curve,
    input_grid,
    settled_levels,
    static_curve,
    zero_shift,
)
from softid.plots.cycles import families_by_rate, find_cycles
from softid.results import FitResult, Simulation

A2, B2, C2 = 0.02, 1.5, 0.3


def damped(covariance: np.ndarray, free: tuple[str, ...]) -> FitResult:
    """A fit with N = 0.02 exp(1.5 p) + 0.3 and the given covariance."""
    values = MUSCLE_VALUES | {"a2": A2, "b2": B2, "c2": C2}
    base = fit_result()
    parameters = tuple(
        replace(p, value=values[p.name], fixed=p.name not in free, stderr=None)
        for p in base.parameters
    )
    return replace(base, parameters=parameters, covariance=covariance, free=free)


def test_band_of_constant_damping_is_that_of_c2() -> None:
    """Closed form: N = c2, so log N has the standard deviation sd(c2)/c2 = 0.1 at any pressure."""
    base = fit_result()
    parameters = tuple(replace(p, fixed=p.name != "c2") for p in base.parameters)
    c2 = MUSCLE_VALUES["c2"]
    result = replace(
        base, parameters=parameters, free=("c2",), covariance=np.array([[(0.1 * c2) ** 2]])
    )
    model = Muscle(damping="constant", x_unit="rad")
    assert isinstance(model, HasDamping)
    curve = damping_curve(model, result)
    assert curve.band is not None
    assert curve.value == pytest.approx(np.full(curve.input.size, c2))
    assert curve.band[1] == pytest.approx(curve.value * np.exp(0.1 * 1.959964), rel=1e-6)
    assert curve.band[0] == pytest.approx(curve.value / np.exp(0.1 * 1.959964), rel=1e-6)


def test_band_of_exponential_damping_follows_the_gradient() -> None:
    """Closed form: ∂N = (e^{b2 p}, a2 p e^{b2 p}, 1), with a2 and b2 correlated by −0.98."""
    sd = np.array([0.3 * A2, 0.2 * B2, 0.05 * C2])
    correlation = np.array([[1, -0.98, 0.2], [-0.98, 1, -0.1], [0.2, -0.1, 1]])
    covariance = correlation * np.outer(sd, sd)
    result = damped(covariance, ("a2", "b2", "c2"))
    curve = damping_curve(Muscle(x_unit="rad"), result)
    p = curve.input / 100.0
    slope = np.stack([np.exp(B2 * p), A2 * p * np.exp(B2 * p), np.ones_like(p)], axis=1)
    expected = np.sqrt(np.einsum("gi,ij,gj->g", slope, covariance, slope)) / curve.value
    assert curve.band is not None
    assert np.log(curve.band[1] / curve.value) / 1.959964 == pytest.approx(expected, rel=1e-5)
    assert np.all(curve.band[0] > 0)


def test_band_agrees_with_sampling() -> None:
    """Sampling of small errors (1 to 3 %): delta method and quantiles differ by second order."""
    sd = np.array([0.03, 0.01, 0.01]) * [A2, B2, C2]
    result = damped(np.diag(sd**2), ("a2", "b2", "c2"))
    curve = damping_curve(Muscle(x_unit="rad"), result)
    rng = np.random.default_rng(5)
    a2, b2, c2 = rng.normal([A2, B2, C2], sd, (20_000, 3)).T
    p = curve.input[-1] / 100.0
    sampled = np.quantile(a2 * np.exp(b2 * p) + c2, [0.025, 0.975])
    assert curve.band is not None
    drawn = np.array([curve.band[0][-1], curve.band[1][-1]])
    width = sampled[1] - sampled[0]
    assert np.abs(drawn - sampled).max() < 0.05 * width


def test_a_parameter_without_error_leaves_no_band() -> None:
    """c2 is free, matters and has no standard error: a band from a2 alone would lie."""
    result = damped(np.diag([1e-6]), ("a2",))
    loose = tuple(replace(p, fixed=p.name not in ("a2", "c2")) for p in result.parameters)
    assert damping_curve(Muscle(x_unit="rad"), replace(result, parameters=loose)).band is None
    on_bound = tuple(replace(p, at_bound=p.name == "c2") for p in loose)
    known = replace(result, parameters=on_bound)
    assert damping_curve(Muscle(x_unit="rad"), known).band is not None
    assert damping_curve(Muscle(x_unit="rad"), replace(result, covariance=None)).band is None


def test_a_tied_parameter_moves_with_its_master() -> None:
    """Closed form: a2 = 0.1 c2 and b2 = 0 make N = 1.1 c2, so sd(N) = 1.1 sd(c2)."""
    result = damped(np.diag([0.01**2]), ("c2",))
    values = {"a2": 0.1 * C2, "b2": 0.0}
    parameters = tuple(
        replace(
            p,
            value=values.get(p.name, p.value),
            fixed=p.name not in ("a2", "c2"),
            tie="0.1*c2" if p.name == "a2" else None,
        )
        for p in result.parameters
    )
    result = replace(result, parameters=parameters)
    names = [p.name for p in parameters]

    def damping(values: Mapping[str, float]) -> np.ndarray:
        theta = np.array([values[n] for n in names])
        return Muscle(x_unit="rad").damping_curve(theta, np.array([0.0, 100.0]))

    assert curve_sd(damping, result) == pytest.approx([0.011, 0.011], rel=1e-6)


def staircase(zero: float = 0.0, *, samples: int = 200) -> Simulation:
    """0, 40, 80, 40, 0 kPa, each held 4 s; 0.01 rad/kPa + zero, 0.02 rad lower on the way up."""
    log = step_log("stairs", samples=5 * samples)
    levels = np.repeat([0.0, 40.0, 80.0, 40.0, 0.0], samples)
    lag = np.repeat([0.0, -0.02, -0.02, 0.0, 0.0], samples)
    sim = simulation(log)
    output = 0.01 * levels + lag + zero
    return replace(
        sim,
        input=levels + 0.05 * np.random.default_rng(6).standard_normal(levels.size),
        outputs={"angle": output},
        measured={"angle": output},
        used={"angle": np.ones(levels.size, bool)},
    )


def test_levels_know_where_they_came_from() -> None:
    """The staircase as built: first level, two rises, two falls, and the output at each."""
    levels = settled_levels(staircase(), "angle", in_sample=True)
    assert levels.direction.tolist() == [0, 1, 1, -1, -1]
    assert levels.input == pytest.approx([0, 40, 80, 40, 0], abs=0.05)
    assert levels.output == pytest.approx([0, 0.38, 0.78, 0.4, 0], abs=1e-9)


def test_levels_leave_out_what_was_not_used() -> None:
    """A masked level is not a measured level; a path point that is missing is not drawn."""
    sim = staircase()
    used = np.ones(sim.time_s.size, bool)
    used[400:600] = False
    levels = settled_levels(replace(sim, used={"angle": used}), "angle", in_sample=True)
    assert levels.input == pytest.approx([0, 40, 40, 0], abs=0.05)
    assert np.nanmax(levels.path_output) < 0.5


def test_zeros_are_taken_out_before_logs_are_compared() -> None:
    """Zeros 0.1/3 and 0.5: the fitted log's is the common one, the other moves by the gap."""
    result = fit_result()
    held = replace(result.nuisances[1], zero={"angle": 0.5})
    result = replace(result, nuisances=(result.nuisances[0], held))
    assert common_zero(result, "angle") == pytest.approx(0.1 / 3)
    assert zero_shift(result, "step_1", "angle") == 0.0
    assert zero_shift(result, "step_2", "angle") == pytest.approx(0.1 / 3 - 0.5)


def test_static_curve_has_the_zero_applied() -> None:
    """Ru's closed form 1/(a1 + c1) at p = 0, plus the zero 0.1/3."""
    result = fit_result()
    curve = static_curve(Muscle(damping="constant", x_unit="rad"), result, "angle")
    at_zero = 1 / (MUSCLE_VALUES["a1"] + MUSCLE_VALUES["c1"]) + 0.1 / 3
    assert (curve.input[0], curve.value[0]) == pytest.approx((0.0, at_zero))
    assert curve.band is None


def test_the_grid_covers_all_logs_and_stays_at_physical_pressures() -> None:
    """0 to 80 kPa fitted: 10 % beyond the top, nothing below zero."""
    grid = input_grid(fit_result())
    assert (grid[0], grid[-1]) == pytest.approx((0.0, 88.0))
    lifted = replace(fit_result(), fitted_range={"pressure": (300.0, 400.0)}, simulations=())
    grid = input_grid(lifted)
    assert (grid[0], grid[-1]) == pytest.approx((290.0, 410.0))


@pytest.mark.parametrize("hz", [0.1, 0.5, 2.0])
def test_cycles_of_a_noisy_sine_have_its_rate(hz: float) -> None:
    """Known frequency; 2 % of noise moves a crossing of the middle by far less than 3 %."""
    t = np.arange(0.0, 6.2 / hz, 0.01 / hz)
    u = -np.cos(2 * np.pi * hz * t) + 0.02 * np.random.default_rng(7).standard_normal(t.size)
    cycles = find_cycles(t, u)
    assert len(cycles) == 6
    assert [c.rate_hz for c in cycles] == pytest.approx([hz] * 6, rel=0.03)


def test_cycles_of_a_square_wave_have_its_rate() -> None:
    """The low lies anywhere in the hold; the rate must come from the edges (10 s period)."""
    t = np.arange(0.0, 41.0, 0.02)
    u = np.where((t % 10.0 > 3.0) & (t % 10.0 < 8.0), 50.0, 0.0)
    u = u + np.random.default_rng(8).standard_normal(t.size)
    cycles = find_cycles(t, u)
    assert [c.rate_hz for c in cycles[:3]] == pytest.approx([0.1] * 3, rel=0.01)


def test_no_cycle_crosses_a_stall_or_stands_still() -> None:
    """A sine cut in its middle loses the cycle that spans the cut; noise has no cycles."""
    t = np.arange(0.0, 20.0, 0.01)
    u = -np.cos(2 * np.pi * 0.25 * t)
    assert len(find_cycles(t, u)) == 5
    cut = find_cycles(t, u, (0, 1000))
    assert len(cut) == 4
    assert all(c.stop <= 1000 or c.start >= 1000 for c in cut)
    assert find_cycles(t, 0.01 * u, smallest_span=0.05) == ()
    assert find_cycles(t, np.zeros_like(t)) == ()
    assert find_cycles(t, t) == ()


def test_a_log_that_ends_half_way_down_has_no_cycle() -> None:
    """0 → 100 → 60: the loop does not close; down to 10 it does, within a quarter of the range."""
    t = np.arange(0.0, 20.0, 0.01)
    assert find_cycles(t, np.interp(t, [0, 10, 20], [0, 100, 60])) == ()
    (cycle,) = find_cycles(t, np.interp(t, [0, 10, 20], [0, 100, 10]))
    assert cycle.rate_hz == pytest.approx(0.05, rel=0.01)


def test_rates_fall_into_few_families() -> None:
    """Rates a factor 1.25 apart are one family; ten octaves are still four line styles."""
    two = families_by_rate([0.5, 0.1, 0.52])
    assert [f.members for f in two] == [(1,), (0, 2)]
    many = families_by_rate([0.01 * 2.0**k for k in range(10)])
    assert len(many) == 4
    assert sorted(k for f in many for k in f.members) == list(range(10))
    assert families_by_rate([]) == ()


def test_branches_ignore_noise() -> None:
    """Up and down ramp of 100 with noise of 1, below the 5 % that counts as a turn."""
    ramp = np.concatenate([np.linspace(0, 100, 500), np.linspace(100, 0, 500)])
    rising = rising_samples(ramp + np.random.default_rng(9).uniform(-1, 1, 1000))
    assert rising[:490].all()
    assert not rising[510:].any()
