"""params.json: written, read back, and every way in which it can be wrong."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import lmfit
import numpy as np
import pytest
from edited_files import Edit, edited, set_at
from handmade import MUSCLE_VALUES, failed_fit, fit_result, step_log, validation
from jsonschema import Draft202012Validator
from linear_motion import TRUTH, linear_log

from softid.errors import IdentificationError, InputError, OutputError
from softid.fingerprint import data_fingerprint
from softid.identification import fit
from softid.records import load_params, save_fit, save_validation
from softid.records.reading import load_schema
from softid.simulation import simulate


@pytest.fixture
def saved(tmp_path: Path) -> Path:
    path = tmp_path / "params.json"
    save_fit(fit_result(), path)
    return path


def test_the_file_is_valid_by_its_schema(saved: Path) -> None:
    """The schema is the published format; strict JSON, so NaN must have become null."""

    def refuse(constant: str) -> None:
        raise AssertionError(constant)

    document = json.loads(saved.read_text(), parse_constant=refuse)
    Draft202012Validator(load_schema("softid.params/1")).validate(document)
    assert document["fit"]["bic"] is None  # was infinite
    assert document["noise"][0]["effective_n"] is None  # was NaN
    assert document["seed"] == 7
    samples = fit_result().simulations[1]
    assert document["data"][1] == {
        "log": "step_2",
        "sha256": None,
        "data_sha256": data_fingerprint(samples.time_s, samples.measured),
        "in_sample": False,
    }
    assert document["versions"]["numpy"] == np.__version__


def test_a_long_seed_keeps_every_digit(tmp_path: Path) -> None:
    """2^53 + 1 is the first whole number that is no float."""
    path = tmp_path / "params.json"
    save_fit(fit(linear_log(), model="oscillator", seed=2**53 + 1), path)
    assert json.loads(path.read_text())["seed"] == 9007199254740993


def test_schemas_are_schemas() -> None:
    """A typing error in a schema would make it accept anything; draft 2020-12 checks itself."""
    for name in ("params", "validation", "inspection", "hidden", "synthetic"):
        Draft202012Validator.check_schema(load_schema(f"softid.{name}/1"))


def test_values_come_back_exactly(saved: Path) -> None:
    """repr of a float reads back as the same float (IEEE 754, David Gay's algorithm)."""
    model = load_params(saved)
    assert dict(model.values) == MUSCLE_VALUES
    assert model.nuisances["step_1"] == fit_result().nuisances[0]
    assert model.fitted_range == {"pressure": (0.0, 80.0), "angle": (0.0, 0.5)}
    assert model.bounds["a1"] == (1e-15, np.inf)
    assert model.fitted_logs == ("step_1",)
    assert model.fingerprints == {"step_1": "a" * 64, "step_2": None}
    assert model.display["angle"][0] == "deg"
    assert model.issues == ()


def test_a_model_read_back_simulates_the_same(saved: Path) -> None:
    """The format's promise is 1e-12; equal floats give equal responses."""
    back, result, log = load_params(saved), fit_result(), step_log()
    model = back.build_model()
    ours = simulate(model, back.values, log, nuisance=back.nuisances["step_1"])
    theirs = simulate(model, result.values, log, nuisance=result.nuisances[0])
    np.testing.assert_allclose(ours.outputs["angle"], theirs.outputs["angle"], rtol=0, atol=1e-12)
    assert np.ptp(ours.outputs["angle"]) > 0.1


def test_a_failed_fit_is_not_written(tmp_path: Path) -> None:
    """Values of a fit that did not end at an optimum must not look like parameters."""
    with pytest.raises(IdentificationError, match="short of the optimum"):
        save_fit(failed_fit(), tmp_path / "params.json")
    assert list(tmp_path.iterdir()) == []


def test_an_existing_file_is_kept(saved: Path) -> None:
    """Without overwrite the earlier result stays and the remedy is named."""
    before = saved.read_bytes()
    with pytest.raises(OutputError, match="--force"):
        save_fit(fit_result(seed=8), saved)
    assert saved.read_bytes() == before
    save_fit(fit_result(seed=8), saved, overwrite=True)
    assert json.loads(saved.read_text())["seed"] == 8


def test_a_value_changed_by_hand_is_an_issue(saved: Path) -> None:
    """Still a usable model, but its errors and scores are those of other values."""

    def change(document: dict[str, Any]) -> None:
        document["parameters"][1]["value"] = 0.31

    model = load_params(edited(saved, change))
    assert model.values["a1"] == 0.31
    (issue,) = model.issues
    assert issue.code == "edited-by-hand"
    assert "no longer belong" in issue.message


@pytest.mark.parametrize(
    "place", [("fitted_range", "pressure", 1), ("parameters", 1, "stderr"), ("statistics", 0, "n")]
)
def test_a_range_or_an_error_changed_by_hand_is_an_issue(
    saved: Path, place: tuple[str | int, ...]
) -> None:
    """A wider range would hide that a log is extrapolated, a smaller error that nothing is known;
    files without the fingerprint of the whole are older, and taken as they are."""

    def change(document: Any) -> None:
        for key in place[:-1]:
            document = document[key]
        document[place[-1]] = 1000

    path = edited(saved, change)
    (issue,) = load_params(path).issues
    assert issue.code == "edited-by-hand"
    assert "fitted range" in issue.message
    older = edited(path, lambda document: document.pop("record_sha256"))
    assert load_params(older).issues == ()


def test_reformatting_is_no_edit(saved: Path) -> None:
    """Order of keys and white space carry no meaning in JSON."""
    document = json.loads(saved.read_text())
    saved.write_text(json.dumps(dict(reversed(document.items())), indent=7))
    assert load_params(saved).issues == ()


def without(key: str) -> Edit:
    def edit(document: dict[str, Any]) -> None:
        del document[key]

    return edit


@pytest.mark.parametrize(
    ("edit", "said"),
    [
        (set_at("schema", value="softid.params/2"), r"softid\.params/2.*reads softid\.params/1"),
        (set_at("schema", value="softid.validation/1"), "softid.validation file, not a"),
        (set_at("schema", value="other"), r"not a softid\.params file"),
        (without("schema"), r"not a softid\.params file"),
        (without("data"), r"\$: the key 'data' is missing"),
        (
            set_at("parameters", 1, "value", value="0.3"),
            r"\$\.parameters\[1\]\.value: expected a value of type number \(got '0\.3'\)",
        ),
        (
            set_at("parameters", 0, "verdict", value="fine"),
            r"\$\.parameters\[0\]\.verdict: expected one of identified or weakly",
        ),
        (set_at("model", "name", value="spring"), r"no such model \(got 'spring'\).*muscle"),
        (set_at("model", "options", "colour", value=1), "no such option.*colour"),
        (set_at("model", "options", "damping", value="odd"), "damping: expected exponential or"),
        (set_at("model", "options", "diameter_mm", value=20), "needs both lengths"),
        (set_at("parameters", 0, "name", value="m"), r"\[0\]\.name: unknown parameter \(got 'm'\)"),
        (set_at("parameters", 0, "name", value="a1"), "twice"),
        (set_at("parameters", 1, "value", value=-1.0), r"a1 is not within its bounds \[1e-15, inf"),
        (set_at("parameters", 1, "value", value=1e999), "JSON has no such number.*Infinity"),
        (lambda d: d["parameters"].pop(), "the parameter c2 is missing"),
        (
            set_at("parameters", 4, "tie", value="len(open('/etc/passwd').read())*1e-5"),
            r"\$\.parameters\[4\]\.tie: a tie cannot hold len\(open",
        ),
        (set_at("parameters", 4, "tie", value="0.1*d2"), "there is no parameter d2"),
    ],
)
def test_what_is_wrong_is_said(saved: Path, edit: Edit, said: str) -> None:
    """Each error names the file, the place, the value and what to do (exit code 3)."""
    with pytest.raises(InputError, match=said) as caught:
        load_params(edited(saved, edit))
    assert str(caught.value).startswith(str(saved))
    assert caught.value.remedy
    assert str(caught.value).count("\n") == 0


def test_a_number_beyond_floats_is_refused(saved: Path) -> None:
    """1e999 is valid JSON and reads as infinity, which no bound of null should let through."""
    text = saved.read_text().replace(f'"value": {MUSCLE_VALUES["a1"]!r}', '"value": 1e999')
    saved.write_text(text)
    with pytest.raises(InputError, match="a1 is not within its bounds"):
        load_params(saved)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", r"this is not a softid\.params file, for it is no JSON; name the params\.json"),
        (b"time_s,angle\n0.0,1\n", r"not a softid\.params file, for it is no JSON"),
        (b'{\n  "schema": "softid.params/1",\n', r"line 3, column 1: this is not JSON"),
        (b"[1, 2]", "JSON list"),
        (b"7", "JSON number"),
        (b"\xff\xfe\x00", "not a text file"),
        (b"[" * 100_000, "nested too deeply|not JSON"),
    ],
)
def test_not_our_json(tmp_path: Path, content: bytes, said: str) -> None:
    """A cut, foreign or binary file: line and column where the parser stopped."""
    path = tmp_path / "params.json"
    path.write_bytes(content)
    with pytest.raises(InputError, match=said):
        load_params(path)


def test_no_file_and_a_folder(tmp_path: Path) -> None:
    """Two slips of the hand on the command line."""
    with pytest.raises(InputError, match="no such file"):
        load_params(tmp_path / "params.json")
    with pytest.raises(InputError, match=r"folder.*inside it"):
        load_params(tmp_path)


def test_validation_is_valid_by_its_schema(tmp_path: Path) -> None:
    """The schema is the published format."""
    path = tmp_path / "validation.json"
    save_validation(validation(threshold_percent=70.0), path, params=Path("params.json"))
    document = json.loads(path.read_text())
    Draft202012Validator(load_schema("softid.validation/1")).validate(document)
    assert document["params"] == "params.json"
    assert document["statistics"][0]["fit_percent"] == 66.0


def test_a_place_is_given_as_text_too(tmp_path: Path) -> None:
    """As `softid.load` takes it, and with the same content as for a path."""
    text = str(tmp_path / "params.json")
    save_fit(fit_result(), text)
    assert load_params(text).values == load_params(Path(text)).values
    scores = str(tmp_path / "validation.json")
    save_validation(validation(), scores, params=text)
    assert json.loads(Path(scores).read_text())["params"] == text


def test_a_value_at_a_bound_is_within_it(tmp_path: Path) -> None:
    """exp(log b) rounds to less than b; what was found at the bound b is written as b, and read."""
    bound = next(b for b in np.linspace(12.0, 20.0, 50).tolist() if np.exp(np.log(b)) < b)
    asked = lmfit.Parameters()
    asked.add("N", value=bound + 1.0, min=bound)
    found = fit(linear_log(noise=0.01), model="oscillator", parameters=asked)
    assert found.parameter("N").at_bound
    assert found.parameter("N").value == bound > TRUTH["N"]
    path = tmp_path / "params.json"
    save_fit(found, path)
    assert load_params(path).values["N"] == bound
