"""Results built by hand, so that tests of records and commands need no fit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from softid.errors import Issue
from softid.log import Log
from softid.results import (
    FitResult,
    FitStatistics,
    FitStatus,
    LogNuisance,
    ModelSpec,
    NoiseModel,
    ParameterEstimate,
    SegmentStart,
    Simulation,
    Validation,
)

MUSCLE_VALUES = {
    # digits that a short decimal form would lose
    "M": 1.0 / 3.0 * 1e-3,
    "a1": 0.1 + 0.2,
    "b1": 2.0 / 7.0 * 10,
    "c1": 1.1 * 1.1,
    "a2": 0.0,
    "b2": 0.0,
    "c2": 1.0 / 7.0,
}
DEGREE = np.pi / 180


MUSCLE_UNITS = {
    "M": "s²/rad",
    "a1": "1/rad",
    "b1": "1/bar",
    "c1": "1/rad",
    "a2": "s/rad",
    "b2": "1/bar",
    "c2": "s/rad",
}


def muscle_spec() -> ModelSpec:
    options = {
        "damping": "constant",
        "order": "second",
        "fixed_length_mm": None,
        "diameter_mm": None,
        "x_unit": "rad",
        "inverted": False,
    }
    return ModelSpec("muscle", options)


def step_log(name: str = "step_1", samples: int = 50) -> Log:
    """A pressure step of 80 kPa and an angle that follows it."""
    time_s = np.arange(samples) * 0.02
    pressure = np.where(time_s < 0.2, 0.0, 80.0)
    angle = 30.0 * (1 - np.exp(-np.maximum(time_s - 0.2, 0.0) / 0.1))
    return Log.from_arrays(
        time_s, {"pressure": pressure, "angle": angle}, units={"angle": "deg"}, name=name
    )


def simulation(log: Log) -> Simulation:
    measured = log.channels["angle"].values
    return Simulation(
        log=log.name,
        time_s=log.time_s,
        input_name="pressure",
        input=log.pressure_kpa,
        input_unit="kPa",
        outputs={"angle": measured + 0.01},
        measured={"angle": measured},
        used={"angle": np.ones(len(log), bool)},
        units={"angle": "rad"},
    )


def statistics(log: str, *, in_sample: bool, fit_percent: float = 91.25) -> FitStatistics:
    nrmse = 1 - fit_percent / 100
    return FitStatistics(
        log=log,
        channel="angle",
        unit="rad",
        in_sample=in_sample,
        kind="simulated",
        n=50,
        rmse=0.01,
        nrmse=nrmse,
        fit_percent=fit_percent,
        r2=1 - nrmse**2,
        vaf=99.5,
        display_unit="deg",
        display_factor=1 / DEGREE,
    )


def nuisance(log: str) -> LogNuisance:
    rest = SegmentStart(0.0, True, (0.1, 0.0))
    return LogNuisance(log, {"angle": 0.1 / 3}, {"angle": None}, (rest,))


def estimate(name: str, value: float) -> ParameterEstimate:
    fixed = value == 0.0
    weak = name == "M"
    return ParameterEstimate(
        name=name,
        unit=MUSCLE_UNITS[name],
        value=value,
        stderr=None if fixed else 0.05 * value,
        ci95=None if fixed else (0.9 * value, 1.1 * value),
        ci_method=None if fixed else "ar-sandwich",
        lower=None if fixed else 1e-15,
        upper=None,
        fixed=fixed,
        tie=None,
        at_bound=False,
        verdict="fixed" if fixed else "weakly identified" if weak else "identified",
        reason="a faster step would show it" if weak else "",
    )


def fit_result(
    *, status: FitStatus = FitStatus.CONVERGED, seed: int = 7, issues: tuple[Issue, ...] = ()
) -> FitResult:
    """A fit of step_1 with step_2 held out."""
    return FitResult(
        model=muscle_spec(),
        input="pressure",
        outputs=("angle",),
        status=status,
        message=status.value,
        parameters=tuple(estimate(k, v) for k, v in MUSCLE_VALUES.items()),
        derived={"x_max": (1 / MUSCLE_VALUES["a1"], "rad")},
        nuisances=(nuisance("step_1"), nuisance("step_2")),
        statistics=(
            statistics("step_1", in_sample=True),
            statistics("step_2", in_sample=False, fit_percent=88.5),
        ),
        noise=(NoiseModel("angle", 0.01, 0.004, (0.8, 0.1), False, 1e-6, float("nan")),),
        correlation=np.eye(2),
        covariance=np.eye(2) * 1e-4,
        free=("a1", "b1"),
        condition_number=120.0,
        aic=-312.5,
        bic=float("inf"),
        fitted_range={"pressure": (0.0, 80.0), "angle": (0.0, 0.5)},
        simulations=(simulation(step_log("step_1")), simulation(step_log("step_2"))),
        evaluations=42,
        issues=issues,
        choice="the steps show the inertia",
        fingerprints={"step_1": "a" * 64, "step_2": ""},
        seed=seed,
    )


def failed_fit() -> FitResult:
    return replace(fit_result(), status=FitStatus.NOT_OPTIMAL, message="stopped at a saddle")


def validation(*, passed: bool = True, threshold_percent: float | None = None) -> Validation:
    return Validation(
        model=muscle_spec(),
        input="pressure",
        outputs=("angle",),
        threshold_percent=threshold_percent,
        passed=passed,
        statistics=(statistics("step_2", in_sample=False, fit_percent=66.0),),
        nuisances=(nuisance("step_2"),),
        simulations=(simulation(step_log("step_2")),),
        issues=(Issue("extrapolation", "warning", "step_2 goes to 120 kPa", "fit it too"),),
        fingerprints={"step_2": "b" * 64},
    )
