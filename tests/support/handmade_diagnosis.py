"""Diagnoses built by hand, one of each verdict, so that records and words need no search."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from extended_fits import extended_fit
from handmade import DEGREE, fit_result

from softid.diagnosis_results import (
    Alternative,
    Cause,
    Diagnosis,
    Evidence,
    Gain,
    Remainder,
    Verdict,
)
from softid.effects import EFFECTS
from softid.errors import Issue
from softid.results import FitResult, ParameterEstimate


def estimate(name: str, value: float, unit: str) -> ParameterEstimate:
    """A parameter with a standard error of 2.5 % and the interval that belongs to it."""
    return ParameterEstimate(
        name=name,
        unit=unit,
        value=value,
        stderr=0.025 * value,
        ci95=(0.95 * value, 1.05 * value),
        ci_method="ar-sandwich",
        lower=0.0,
        upper=100.0 * value,
        fixed=False,
        tie=None,
        at_bound=False,
        verdict="identified",
    )


def cause(
    key: str,
    parameters: Sequence[ParameterEstimate],
    *,
    before: float,
    after: float,
    added_to: Sequence[str] = (),
) -> Cause:
    effect = EFFECTS[key]()
    return Cause(
        effect=effect.name,
        key=key,
        title=effect.title,
        law=effect.law,
        meaning=effect.meaning,
        remedy=effect.remedy,
        parameters=tuple(parameters),
        added_to=tuple(added_to),
        delta_bic=412.0,
        holdout_rmse_before=before * DEGREE,
        holdout_rmse_after=after * DEGREE,
        gain_ci95=(0.7, 0.8),
    )


def gain(log: str, *, before: float, after: float, held_out: bool) -> Gain:
    """Errors in degrees; the fit follows from a signal of 12.5 degrees rms."""
    return Gain(
        log,
        "angle",
        "rad",
        held_out,
        1000,
        before * DEGREE,
        after * DEGREE,
        100.0 * (1.0 - before / 12.5),
        100.0 * (1.0 - after / 12.5),
    )


def remainder(*, structured: bool, explained: float) -> Remainder:
    by = {"x": 0.01, "v": 0.31, "p": 0.05, "lagged p": 0.22}
    return Remainder(
        rms=0.2 * DEGREE,
        explained_share=explained,
        structure_share=0.37 if structured else 0.004,
        structure_limit=0.03,
        by=by if structured else dict.fromkeys(by, 0.0),
        excess=0.8 if structured else 0.02,
        noise_from_rest=True,
        structured=structured,
    )


FRICTION = cause(
    "coulomb_friction",
    [estimate("coulomb_friction_Fc", 0.08, "1"), estimate("coulomb_friction_vs", 0.02, "rad/s")],
    before=2.0,
    after=0.5,
)
DELAY = cause("delay", [estimate("delay_tau", 0.05, "s")], before=2.0, after=0.5)
EVIDENCE = (
    Evidence(1, "", 0.0, 0.0),
    Evidence(1, "coulomb_friction", 412.0, 0.9),
    Evidence(1, "delay", 410.0, 0.9),
    Evidence(1, "pneumatic_lag", 409.0, 0.9),
    Evidence(1, "hysteresis", 300.0, 0.8),
    Evidence(1, "creep", None, 0.1),
)
TIE = Alternative(("delay", "pneumatic_lag"), {"delay": 0.0, "pneumatic_lag": 3.0}, "no chirp")


def diagnosis(verdict: Verdict, *, extended: FitResult | None = None) -> Diagnosis:
    """A diagnosis of the hand-made fit; an error of 2 degrees goes to 0.5 with a cause."""
    named = verdict in (Verdict.NAMED, Verdict.PARTIAL)
    causes = (FRICTION,) if named else (DELAY,) if verdict is Verdict.AMBIGUOUS else ()
    mended = verdict is not Verdict.ADEQUATE
    after = 0.5 if mended else 2.0
    return Diagnosis(
        verdict=verdict,
        summary="The muscle model misses angle by 2 deg.",
        base=fit_result(),
        extended=extended or (extended_fit("muscle", "coulomb_friction") if mended else None),
        causes=causes,
        descriptive=(FRICTION,) if verdict is Verdict.UNKNOWN else (),
        alternatives=(TIE,) if verdict is Verdict.AMBIGUOUS else (),
        remainder=remainder(
            structured=verdict in (Verdict.PARTIAL, Verdict.UNKNOWN),
            explained={Verdict.PARTIAL: 0.95, Verdict.UNKNOWN: 0.6}.get(verdict, 1.0),
        ),
        gains=(
            gain("step_1", before=1.5, after=0.4, held_out=False),
            gain("step_2", before=2.0, after=after, held_out=True),
        ),
        evidence=EVIDENCE if verdict is Verdict.AMBIGUOUS else (*EVIDENCE[:2], *EVIDENCE[4:]),
        next_experiment="record a chirp" if verdict is Verdict.AMBIGUOUS else None,
        issues=(Issue("few-samples", "info", "step_2 is short", "record longer"),),
    )


def odd_diagnosis() -> Diagnosis:
    """Numbers that JSON cannot hold, in every place that may have them."""
    nan = float("nan")
    whole = diagnosis(Verdict.NAMED)
    return replace(
        whole,
        causes=(
            replace(
                FRICTION,
                delta_bic=float("inf"),
                holdout_rmse_before=nan,
                holdout_rmse_after=nan,
                gain_ci95=None,
            ),
        ),
        remainder=replace(whole.remainder, rms=nan, structure_share=nan, by={"x": nan}),
        gains=(replace(whole.gains[0], fit_percent_after=nan, rmse_after=nan),),
        evidence=(Evidence(1, "delay", None, nan),),
    )
