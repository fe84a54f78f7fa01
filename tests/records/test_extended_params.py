"""params.json of extended models: every effect comes back, and its file cannot lie unnoticed."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from edited_files import Edit, edited, set_at
from extended_fits import BASES, extended_fit, log_of
from handmade import fit_result
from jsonschema import Draft202012Validator

from softid.effects import EFFECTS, model_of
from softid.errors import InputError, UsageError
from softid.records import load_params, save_fit, save_validation
from softid.records.reading import load_schema
from softid.results import FitResult
from softid.simulation import simulate
from softid.validation import validate


def written(folder: Path, result: FitResult, edit: Edit | None = None) -> Path:
    path = folder / "params.json"
    save_fit(result, path)
    return path if edit is None else edited(path, edit)


@pytest.mark.parametrize("base", BASES)
@pytest.mark.parametrize("key", EFFECTS)
def test_every_effect_comes_back(tmp_path: Path, key: str, base: str) -> None:
    """The format's promise: the same numbers to 1e-12; equal floats give equal responses.

    Each effect moves the response by a million times that, or nothing would have come back.
    """
    result = extended_fit(base, key)
    path = written(tmp_path, result)
    back = load_params(path)
    assert back.issues == ()
    assert back.model == result.model
    assert dict(back.values) == result.values
    log = log_of(base)
    theirs = simulate(model_of(result.model), result.values, log)
    ours = simulate(back.build_model(), back.values, log)
    np.testing.assert_allclose(ours.outputs["angle"], theirs.outputs["angle"], rtol=0, atol=1e-12)
    model, theta = BASES[base]
    alone = simulate(model, dict(zip(model.parameters().names, theta, strict=True)), log)
    assert np.max(np.abs(alone.outputs["angle"] - ours.outputs["angle"])) > 1e-6


def test_the_file_says_what_acts_where(tmp_path: Path) -> None:
    """The schema holds; effects stand in the order in which they act, input before output."""
    result = extended_fit("muscle", "sensor_lag", "coulomb_friction", "delay")
    document = json.loads(written(tmp_path, result).read_text())
    Draft202012Validator(load_schema("softid.params/1")).validate(document)
    told = [(e["key"], e["stage"], e["parameters"]) for e in document["effects"]]
    assert told == [
        ("delay", "input", ["delay_tau"]),
        ("coulomb_friction", "state", ["coulomb_friction_Fc", "coulomb_friction_vs"]),
        ("sensor_lag", "output", ["sensor_lag_tau"]),
    ]
    assert document["effects"][0]["law"] == EFFECTS["delay"].law
    assert document["scale"]["u_unit"] == "kPa"
    save_fit(fit_result(), tmp_path / "plain.json")
    plain = json.loads((tmp_path / "plain.json").read_text())
    assert (plain["effects"], plain["scale"]) == ([], None)


def test_scores_name_the_effects(tmp_path: Path) -> None:
    """A score belongs to the extended model, so validation.json says which one that is."""
    saved = load_params(written(tmp_path, extended_fit("muscle", "delay")))
    scored = validate(saved, log_of("muscle"))
    save_validation(scored, tmp_path / "validation.json")
    document = json.loads((tmp_path / "validation.json").read_text())
    Draft202012Validator(load_schema("softid.validation/1")).validate(document)
    assert [effect["key"] for effect in document["effects"]] == ["delay"]


@pytest.mark.parametrize(
    ("edit", "said"),
    [
        (set_at("effects", 0, "key", value="static_charge"), "softid.register_effect"),
        (set_at("effects", 0, "key", value="creep"), "unknown parameter"),
        (set_at("effects", 0, "stage", value="valve"), "effects.0..stage: expected one of"),
        (set_at("scale", value=None), "the sizes that their bounds go by"),
        (set_at("scale", "v_max", value=-1.0), "scale.v_max"),
        (set_at("scale", "u_low", value="low"), "scale.u_low"),
        (set_at("scale", "y_unit", value="mm"), "the model computes in mm/s"),
        (set_at("parameters", 7, "unit", value="deg/s"), "the model computes in rad/s"),
        (set_at("effects", value=[]), "unknown parameter"),
    ],
)
def test_what_cannot_be_is_refused(tmp_path: Path, edit: Edit, said: str) -> None:
    """Each edit makes a file whose numbers would mean something else; exit code 3."""
    with pytest.raises(InputError) as caught:
        load_params(written(tmp_path, extended_fit("muscle", "sensor_drift"), edit))
    assert said.replace(".0..", "[0].") in str(caught.value)
    assert caught.value.exit_code == 3
    assert caught.value.remedy


def test_an_edited_scale_is_an_issue(tmp_path: Path) -> None:
    """Bounds move with the scale, so errors and scores are no longer those of the file."""
    edit = set_at("scale", "duration_s", value=600.0)
    back = load_params(written(tmp_path, extended_fit("muscle", "sensor_drift"), edit))
    assert [issue.code for issue in back.issues] == ["edited-by-hand"]


def test_a_specification_needs_its_effect() -> None:
    """In Python the same mistake is wrong usage, and the nearest name is proposed."""
    spec = replace(extended_fit("muscle", "delay").model, effects=("delays",))
    with pytest.raises(UsageError, match=r"did you mean delay\?.*register_effect"):
        model_of(spec)
    with pytest.raises(UsageError, match="scale is not complete"):
        model_of(replace(spec, effects=("delay",), scale={"u_low": 0.0}))
