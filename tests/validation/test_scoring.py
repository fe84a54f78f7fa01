"""Scores of a model on other logs, from a result and from its file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from linear_motion import linear_log

from softid.diagnosis import diagnose
from softid.errors import UsageError
from softid.identification import fit
from softid.log import Log
from softid.readers import load
from softid.records import load_params, save_fit
from softid.results import FitResult
from softid.synthesis import bundled_datasets, hidden_pair
from softid.synthesis.rig import Rig
from softid.validation import validate

DATA = bundled_datasets() / "data"


@pytest.fixture(scope="module")
def fitted() -> FitResult:
    return fit(
        [load(DATA / "muscle_steps.csv"), load(DATA / "muscle_sine_050.csv")],
        model="muscle",
        hold_out=[load(DATA / "muscle_sine_025.csv")],
    )


def test_the_score_is_that_of_the_held_out_log(fitted: FitResult) -> None:
    """Same parameters, same log, same nuisance estimate: the same number."""
    (row,) = [s for s in fitted.statistics if not s.in_sample]
    (scored,) = validate(fitted, load(DATA / "muscle_sine_025.csv")).statistics
    assert scored.rmse == pytest.approx(row.rmse, rel=1e-12)
    assert not scored.in_sample


def test_a_file_scores_as_the_fit_itself(fitted: FitResult, tmp_path: Path) -> None:
    """Numbers are written in full, so the round trip changes nothing beyond 1e-12."""
    save_fit(fitted, tmp_path / "params.json")
    log = load(DATA / "muscle_sine_025.csv")
    direct = validate(fitted, log)
    saved = validate(load_params(tmp_path / "params.json"), log)
    named = validate(tmp_path / "params.json", log)
    assert named.statistics == saved.statistics
    for a, b in zip(direct.simulations, saved.simulations, strict=True):
        assert b.outputs["contraction"] == pytest.approx(a.outputs["contraction"], rel=1e-12)
    assert direct.fitted_range == saved.fitted_range == fitted.fitted_range


def test_a_fitted_log_is_known_by_its_bytes(fitted: FitResult) -> None:
    result = validate(fitted, load(DATA / "muscle_steps.csv"))
    assert result.statistics[0].in_sample
    assert "in-sample" in {issue.code for issue in result.issues}


def test_a_fitted_log_is_known_by_its_samples(tmp_path: Path) -> None:
    """Given as arrays, under whatever name, and from a record; its second half and other noise are
    other data. A record of before has no such fingerprint and loads as it did."""
    log = linear_log(noise=0.01)
    first = log.between(0.0, 10.0)
    model = fit(first, model="oscillator")
    save_fit(model, tmp_path / "params.json")
    saved = load_params(tmp_path / "params.json")
    for known in (model, saved):
        for other, expected in (
            (first, True),
            (replace(first, name="another"), True),
            (log.between(10.0, 20.0), False),
            (linear_log(noise=0.01, seed=1).between(0.0, 10.0), False),
        ):
            found = validate(known, other)
            assert [row.in_sample for row in found.statistics] == [expected]
            assert ("in-sample" in {issue.code for issue in found.issues}) == expected
    (row,) = validate(replace(saved, data_fingerprints={}), first).statistics
    assert not row.in_sample


def test_a_fitted_file_is_known_when_given_as_arrays(fitted: FitResult) -> None:
    """And a log that was held out is none of them."""
    for name, expected in (("muscle_steps", True), ("muscle_sine_025", False)):
        log = replace(load(DATA / f"{name}.csv"), source=None, name="arrays")
        assert [row.in_sample for row in validate(fitted, log).statistics] == [expected]


def test_the_bar(fitted: FitResult) -> None:
    log = load(DATA / "muscle_sine_025.csv")
    assert validate(fitted, log, threshold_percent=95.0).passed
    assert not validate(fitted, log, threshold_percent=99.9).passed


def test_other_roles_are_refused(fitted: FitResult) -> None:
    with pytest.raises(UsageError, match="the model links pressure → contraction"):
        validate(fitted, load(DATA / "muscle_steps.csv", outputs=("distance",)))


def test_a_model_of_a_diagnosis_takes_the_input_as_it_was_fitted(tmp_path: Path) -> None:
    """Its input was taken without the noise of the gauge, which softening takes for motion: with
    the noise the fitted log is missed by far more. The record says it, so that a file scores as the
    diagnosis does."""
    rig = replace(Rig(), pressure_noise_kpa=1.5, noise=0.002)
    log, hold_out = hidden_pair(["softening"], seed=3, model="oscillator", rig=rig).logs
    found = diagnose(log, hold_out=[hold_out], model="oscillator", effects=["softening"])
    assert found.extended is not None
    (told, _) = (gain.rmse_after for gain in found.gains)
    save_fit(found.extended, tmp_path / "extended_params.json")
    saved = load_params(tmp_path / "extended_params.json")
    for model in (found.extended, saved):
        assert validate(model, log).statistics[0].rmse == pytest.approx(told, rel=1e-6)
    noisy = replace(saved, input_noise=None)
    assert validate(noisy, log).statistics[0].rmse > 1.3 * told


def test_a_log_that_its_own_zero_can_follow_is_not_held_against_the_bar() -> None:
    """Two samples, a zero and two states: any model passes through them, a wrong one too."""
    moving, other = linear_log(noise=0.01), linear_log(noise=0.01, seed=1)
    rows = {name: channel.values for name, channel in other.channels.items()}
    two = Log.from_arrays(
        other.time_s[50:52], {name: y[50:52] for name, y in rows.items()}, name="two"
    )
    model = fit(moving, model="oscillator", hold_out=two)
    told = {row.log: row.fit_percent for row in model.statistics}
    assert np.isnan(told["two"])
    assert "fit-undefined" in {issue.code for issue in model.issues}
    alone = validate(model, two, threshold_percent=99.99)
    assert not alone.passed
    (issue,) = (issue for issue in alone.issues if issue.code == "fit-undefined")
    assert issue.message.startswith("two: 2 samples of angle cannot judge a model")
    assert validate(model, [two, other], threshold_percent=50.0).passed


def test_a_log_that_never_moves_is_not_held_against_the_bar() -> None:
    """Closed form: at rest an exact model misses nothing, and a fit of 0/0 is none. With nothing
    else the bar is not reached; beside a log that moves, that one decides."""
    moving = linear_log(noise=0.01)
    time_s = np.arange(500) / 50.0
    still = {"pressure": np.zeros(500), "angle": np.zeros(500)}
    rest = Log.from_arrays(time_s, still, name="rest")
    model = fit(moving, model="oscillator")
    other = linear_log(noise=0.01, seed=1)
    both = validate(model, [rest, other], threshold_percent=50.0)
    assert both.passed
    (told,) = (issue for issue in both.issues if issue.code == "fit-undefined")
    assert "rest: angle was measured as constant" in told.message
    assert told.severity == "info"
    assert not validate(model, [rest, other], threshold_percent=99.99).passed
    alone = validate(model, rest, threshold_percent=50.0)
    assert not alone.passed
    (only,) = (i for i in alone.issues if i.code == "fit-undefined")
    assert only.severity == "warning"
    assert "held against" not in only.message
    assert "fit-undefined" not in {issue.code for issue in validate(model, rest).issues}
