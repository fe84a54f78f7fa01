"""Profile likelihood: agrees with the covariance where that is right, and says where it is not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from linear_motion import SIGMA, linear_log, linear_problem

from softid.errors import UsageError
from softid.fitters.objective import Objective
from softid.fitters.problem import Problem
from softid.identification import fit
from softid.identification.profile_likelihood import ProfileRefits, Starts, profile_parameter
from softid.log import Log
from softid.models import Oscillator
from softid.readers import load


def first_order_log(hold_s: float, *, seed: int = 3) -> Log:
    """0.3 s lag of gain 0.01 rad/kPa by its closed form at every step, with 0.5 % white noise."""
    time = np.arange(0.0, 16.0, 0.02)
    level = np.where(time % (2 * hold_s) < hold_s, 20.0, 100.0)
    angle = np.empty_like(time)
    angle[0] = 0.2
    decay = np.exp(-0.02 / 0.3)
    for k in range(1, time.size):
        # The input is straight between samples: exact first-order hold.
        u0, u1 = 0.01 * level[k - 1], 0.01 * level[k]
        slope = (u1 - u0) / 0.02
        particular = u1 - slope * 0.3
        start = u0 - slope * 0.3
        angle[k] = particular + (angle[k - 1] - start) * decay
    noise = 0.004 * np.random.default_rng(seed).standard_normal(time.size)
    return Log.from_arrays(time, {"pressure": level, "angle": angle + noise}, name="lag")


def test_an_identified_parameter_has_the_interval_of_the_covariance() -> None:
    """A nearly linear problem: both intervals agree to a few per cent of their width."""
    log = first_order_log(2.0)
    result = fit(log, model=Oscillator(order="first"))
    estimate = result.parameter("Q")
    found = profile_parameter(result, log, "Q")
    assert estimate.ci95 is not None
    width = estimate.ci95[1] - estimate.ci95[0]
    for end, expected in zip(found.ci95, estimate.ci95, strict=True):
        assert end is not None
        assert end == pytest.approx(expected, abs=0.05 * width)


def test_an_unseen_saturation_is_open_on_one_side() -> None:
    """Between 0.2 and 1 bar a curve that saturates beyond 5 bar cannot be told from one that never
    does: the largest contraction 1/a1 has no upper limit, so a1 has none below."""
    rng = np.random.default_rng(8)
    time = np.arange(0.0, 20.0, 0.02)
    bar = 0.2 + 0.2 * (time // 4.0)
    at_rest = 1.0 / (0.01 + 20.0 * np.exp(-1.2 * bar))
    log = Log.from_arrays(
        time,
        {
            "pressure": 100.0 * bar,
            "angle": at_rest + 1e-3 * rng.standard_normal(time.size),
        },
        name="low",
    )
    result = fit(log, model="muscle")
    found = profile_parameter(result, log, "a1")
    assert found.ci95[0] is None
    assert found.ci95[1] is not None


def test_a_parameter_that_was_not_free_is_refused() -> None:
    log = first_order_log(2.0)
    result = fit(log, model="oscillator")
    with pytest.raises(UsageError, match="G was not free"):
        profile_parameter(result, log, "G")


def test_a_log_that_was_not_fitted_is_refused(tmp_path: Path) -> None:
    """Known by its name, and by its file where there is one."""
    log = first_order_log(2.0)
    result = fit(log, model="oscillator")
    with pytest.raises(UsageError, match="this log was not fitted") as caught:
        profile_parameter(result, replace(log, name="other"), "N")
    assert "lag" in str(caught.value)
    path = tmp_path / "lag.csv"
    rows = np.column_stack((log.time_s, log.pressure_kpa, log.channels["angle"].values))
    header = "time_s,pressure_kpa,angle_rad"
    np.savetxt(path, rows, delimiter=",", header=header, comments="")
    result = fit(load(path), model="oscillator")
    np.savetxt(path, rows[:-1], delimiter=",", header=header, comments="")
    with pytest.raises(UsageError, match="not the one that was fitted"):
        profile_parameter(result, load(path), "N")


@pytest.mark.slow
def test_a_valley_that_bends_is_followed(measured: Path) -> None:
    """Starts at the optimum alone end in a false minimum beyond M = 2.9, at half of the threshold.

    The limit lies where the cost has risen to the threshold, within 1 % of its root.
    """
    logs = [load(measured / "two-segment-arm" / f"{name}.csv") for name in ("Jan5_1", "apr4_1")]
    found = profile_parameter(fit(logs, model="muscle"), logs, "M")
    assert found.unbounded_below
    assert found.ci95[1] is not None
    rise = dict(zip(found.values, found.cost_rise, strict=True))[found.ci95[1]]
    assert np.sqrt(rise / found.threshold) == pytest.approx(1.0, abs=0.0101)


def test_a_refit_begins_where_the_tangent_or_the_last_two_point_to() -> None:
    """Fifty times nearer to what is found there than the last refit is, on either side."""
    problem = linear_problem([linear_log(noise=0.01)])
    optimum = Objective(problem, SIGMA).solve(problem.unknowns({"M": 1.0, "N": 8.0, "Q": 50.0}), 40)
    values = problem.values(optimum.point)
    shares: list[float] = []

    def solve(rival: Problem, starts: Starts) -> tuple[float, np.ndarray]:
        found = Objective(rival, SIGMA).solve(starts.nearest, 40)
        predicted, nearest = (
            float(np.linalg.norm(z - found.point)) for z in (starts.predicted, starts.nearest)
        )
        shares.append(predicted / nearest)
        return 2.0 * found.normal.cost, found.point

    refits = ProfileRefits(problem, "Q", optimum.point, values, solve, matrix=optimum.normal.matrix)
    for factor in (1.001, 1.002, 0.999, 0.998):
        refits.refit(factor * values["Q"])
    assert max(shares) < 0.02
