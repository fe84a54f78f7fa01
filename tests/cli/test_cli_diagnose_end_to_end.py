"""From a log with a hidden effect to an extended model that the other commands accept."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from desk import Outcome
from jsonschema import Draft202012Validator

from softid.records.reading import load_schema

Cli = Callable[..., Outcome]


@pytest.mark.slow
def test_diagnose_validate_simulate(softid: Cli, tmp_path: Path) -> None:
    """Friction hidden at moderate size is named, and its model scores as the record says.

    The error after is the held-out rmse of the extended model, which `validate` computes again
    with the same parameters; 1 % for the sensor zero that it estimates anew.
    """
    assert (
        softid("synthesize", "--hide", "coulomb_friction", "--seed", "11", "--out", "h").code == 0
    )
    told = softid(
        "diagnose", "h/train.csv", "--hold-out", "h/hold_out.csv", "--model", "muscle",
        "--effects", "coulomb_friction,delay,creep", "--out", "d", "--no-plots", "--quiet",
    )  # fmt: skip
    assert told.code == 0, told.err
    record = json.loads((tmp_path / "d" / "diagnosis.json").read_text())
    Draft202012Validator(load_schema("softid.diagnosis/1")).validate(record)
    assert [cause["effect"] for cause in record["causes"]] == ["coulomb_friction"]
    assert "dry friction" in " ".join(told.out.split())
    assert "few-effects" in [issue["code"] for issue in record["issues"]]
    extended = tmp_path / "d" / record["extended"]
    scored = json.loads(softid("validate", extended, "h/hold_out.csv", "--json").out)
    after = record["causes"][0]["holdout_rmse_after"]
    assert scored["statistics"][0]["rmse"] == pytest.approx(after, rel=0.01)
    assert scored["effects"][0]["key"] == "coulomb_friction"
    predicted = softid("simulate", extended, "--input", "h/hold_out.csv", "--quiet")
    assert predicted.code == 0, predicted.err
    assert "nan" not in predicted.out
    again = softid("diagnose", "h/train.csv", "--params", extended, "--out", "e", "--quiet")
    assert again.code == 3
    assert "has effects already" in again.err
