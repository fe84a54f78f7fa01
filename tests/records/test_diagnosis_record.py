"""diagnosis.json: valid by its schema for every verdict, with models that can be read back."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from handmade import failed_fit
from handmade_diagnosis import FRICTION, diagnosis, odd_diagnosis
from jsonschema import Draft202012Validator

from softid.diagnosis_results import Doubt, NotNoise, Variation, Verdict
from softid.errors import OutputError
from softid.records import load_params, save_diagnosis
from softid.records.reading import load_schema
from softid.results import FitStatus


def strict(path: Path) -> dict[str, Any]:
    """JSON without NaN, valid by its schema."""

    def refuse(constant: str) -> None:
        raise AssertionError(constant)

    document: dict[str, Any] = json.loads(path.read_text(), parse_constant=refuse)
    Draft202012Validator(load_schema(document["schema"])).validate(document)
    return document


def test_the_schema_is_a_schema() -> None:
    """A typing error would make it accept anything; draft 2020-12 checks itself."""
    Draft202012Validator.check_schema(load_schema("softid.diagnosis/1"))


def test_a_folder_is_given_as_text_too(tmp_path: Path) -> None:
    """As `softid.load` takes a file; the files are named below it."""
    written = save_diagnosis(diagnosis(Verdict.UNKNOWN), str(tmp_path / "found"))
    assert written[0] == tmp_path / "found" / "diagnosis.json"
    assert all(path.is_file() for path in written)


@pytest.mark.parametrize("doubt", Doubt)
def test_every_doubt_is_written(tmp_path: Path, doubt: Doubt) -> None:
    made = diagnosis(Verdict.UNKNOWN)
    described = replace(FRICTION, doubt=doubt)
    save_diagnosis(replace(made, causes=(), descriptive=(described,)), tmp_path)
    (written,) = strict(tmp_path / "diagnosis.json")["descriptive"]
    assert written["doubt"] == doubt.name.lower()


@pytest.mark.parametrize("mark", NotNoise)
def test_every_mark_against_noise_is_written(tmp_path: Path, mark: NotNoise) -> None:
    made = diagnosis(Verdict.UNKNOWN)
    save_diagnosis(replace(made, remainder=replace(made.remainder, against_noise=mark)), tmp_path)
    assert strict(tmp_path / "diagnosis.json")["remainder"]["against_noise"] == mark.name.lower()


@pytest.mark.parametrize("verdict", Verdict)
def test_every_verdict_is_written(tmp_path: Path, verdict: Verdict) -> None:
    """The published keys, and an extended model exactly where something was added."""
    files = save_diagnosis(diagnosis(verdict), tmp_path / "out")
    document = strict(tmp_path / "out" / "diagnosis.json")
    assert document["verdict"] == verdict.value
    names = [path.relative_to(tmp_path / "out").as_posix() for path in files]
    expected = None if verdict is Verdict.ADEQUATE else "extended_params.json"
    assert document["extended"] == expected
    assert names == ["diagnosis.json", "params.json", *([expected] if expected else [])]
    assert document["seed"] == 7
    first = document["data"][0]
    assert (first["log"], first["sha256"], first["in_sample"]) == ("step_1", "a" * 64, True)
    assert document["issues"][0]["code"] == "few-samples"
    assert load_params(tmp_path / "out" / document["base"]["params"]).issues == ()


def test_causes_have_their_numbers(tmp_path: Path) -> None:
    """Errors in the unit of the channel: 2 degrees are 0.0349 rad."""
    save_diagnosis(diagnosis(Verdict.NAMED), tmp_path)
    document = strict(tmp_path / "diagnosis.json")
    (cause,) = document["causes"]
    assert cause["effect"] == "coulomb_friction"
    assert cause["holdout_rmse_before"] == pytest.approx(0.034906585)
    assert cause["gain_ci95"] == [0.7, 0.8]
    assert cause["variation"] is None
    assert [p["name"] for p in cause["parameters"]] == [
        "coulomb_friction_Fc",
        "coulomb_friction_vs",
    ]
    assert document["channels"]["angle"] | {"display_factor": 0} == {
        "unit": "rad",
        "display_unit": "deg",
        "display_factor": 0,
    }
    extended = load_params(tmp_path / document["extended"])
    assert extended.model.effects == ("coulomb_friction",)
    assert extended.issues == ()


def test_the_chain_can_be_read_from_the_record(tmp_path: Path) -> None:
    """Causes and descriptions stand in tables of their own; each names all that was before it."""
    found = diagnosis(Verdict.NAMED)
    (first,) = found.causes
    second = replace(first, key="creep", added_to=(first.key,))
    third = replace(first, key="delay", added_to=(first.key, "creep"))
    save_diagnosis(replace(found, causes=(first, third), descriptive=(second,)), tmp_path)
    document = strict(tmp_path / "diagnosis.json")
    links = [*document["causes"], *document["descriptive"]]
    chain = sorted(links, key=lambda link: len(link["added_to"]))
    assert [link["key"] for link in chain] == ["coulomb_friction", "creep", "delay"]
    assert [link["added_to"] for link in chain] == [
        [],
        ["coulomb_friction"],
        ["coulomb_friction", "creep"],
    ]


def test_a_record_without_what_a_cause_was_added_to_is_valid(tmp_path: Path) -> None:
    """As those are that were written before it was told."""
    save_diagnosis(diagnosis(Verdict.NAMED), tmp_path)
    document = strict(tmp_path / "diagnosis.json")
    del document["causes"][0]["added_to"]
    Draft202012Validator(load_schema(document["schema"])).validate(document)


def test_a_size_that_varies_is_written(tmp_path: Path) -> None:
    """With the variable, how much, what that takes away, and the odds of chance."""
    found = diagnosis(Verdict.NAMED)
    varied = replace(found.causes[0], variation=Variation("v", 0.2, 0.01, 1e-12))
    save_diagnosis(replace(found, causes=(varied,)), tmp_path)
    (cause,) = strict(tmp_path / "diagnosis.json")["causes"]
    assert cause["variation"] == {"by": "v", "spread": 0.2, "share": 0.01, "chance": 1e-12}


def test_unknown_has_descriptions_and_no_causes(tmp_path: Path) -> None:
    """What lowers the error without being a cause stands apart."""
    save_diagnosis(diagnosis(Verdict.UNKNOWN), tmp_path)
    document = strict(tmp_path / "diagnosis.json")
    assert document["causes"] == []
    assert [c["effect"] for c in document["descriptive"]] == ["coulomb_friction"]


def test_what_is_not_a_number_is_null(tmp_path: Path) -> None:
    """JSON has no NaN and no infinity."""
    save_diagnosis(odd_diagnosis(), tmp_path)
    document = strict(tmp_path / "diagnosis.json")
    assert document["causes"][0]["delta_bic"] is None
    assert document["causes"][0]["gain_ci95"] is None
    assert document["remainder"]["rms"] is None
    assert document["gains"][0]["fit_percent_after"] is None


def test_an_extended_model_that_did_not_converge_is_not_written(tmp_path: Path) -> None:
    """Its values are parameters of nothing; the record says why there is no file."""
    stuck = replace(diagnosis(Verdict.NAMED).base, status=FitStatus.MAX_EVALUATIONS)
    save_diagnosis(diagnosis(Verdict.NAMED, extended=stuck), tmp_path)
    document = strict(tmp_path / "diagnosis.json")
    assert document["extended"] is None
    assert document["issues"][-1]["code"] == "extended-not-converged"
    assert not (tmp_path / "extended_params.json").exists()


def test_what_is_wrong_with_a_base_that_did_not_converge_is_told(tmp_path: Path) -> None:
    """Its values are no parameters, and an earlier result's are not left in their place."""
    save_diagnosis(diagnosis(Verdict.UNKNOWN), tmp_path)
    found = replace(diagnosis(Verdict.UNKNOWN), base=failed_fit())
    save_diagnosis(found, tmp_path, overwrite=True)
    document = strict(tmp_path / "diagnosis.json")
    assert document["verdict"] == "unknown"
    assert document["base"]["params"] is None
    assert document["issues"][-1]["code"] == "base-not-converged"
    assert not (tmp_path / "params.json").exists()


def test_nothing_is_half_written(tmp_path: Path) -> None:
    """An existing result stays without overwrite."""
    save_diagnosis(diagnosis(Verdict.NAMED), tmp_path / "out")
    before = (tmp_path / "out" / "diagnosis.json").read_bytes()
    with pytest.raises(
        OutputError, match=r"exists already; say --force \(overwrite=True in Python\)"
    ):
        save_diagnosis(diagnosis(Verdict.PARTIAL), tmp_path / "out")
    assert (tmp_path / "out" / "diagnosis.json").read_bytes() == before
    save_diagnosis(diagnosis(Verdict.PARTIAL), tmp_path / "out", overwrite=True)
    assert strict(tmp_path / "out" / "diagnosis.json")["verdict"] == "partial"


def test_a_later_result_takes_its_predecessors_model_along(tmp_path: Path) -> None:
    """An extended model beside a record that names none would be taken for its own."""
    save_diagnosis(diagnosis(Verdict.NAMED), tmp_path)
    save_diagnosis(diagnosis(Verdict.ADEQUATE), tmp_path, overwrite=True)
    assert not (tmp_path / "extended_params.json").exists()
    save_diagnosis(diagnosis(Verdict.NAMED), tmp_path, overwrite=True)
    (tmp_path / "extended_params.json").write_text("{}")  # somebody's own by now
    save_diagnosis(diagnosis(Verdict.ADEQUATE), tmp_path, overwrite=True)
    assert (tmp_path / "extended_params.json").read_text() == "{}"
