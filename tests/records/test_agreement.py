"""Units of params.json that were edited by hand: the values stayed, so the file lies."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from edited_files import Edit, edited
from handmade import fit_result

from softid.errors import InputError
from softid.identification import fit
from softid.log import Log
from softid.models import Oscillator, Polynomial
from softid.records import load_params, save_fit


def channel(name: str, **fields: object) -> Edit:
    return lambda document: document["channels"][name].update(fields)


def parameter_unit(unit: str) -> Edit:
    return lambda document: document["parameters"][1].update(unit=unit)


def option(**fields: object) -> Edit:
    return lambda document: document["model"]["options"].update(fields)


CASES = {
    "parameter": (parameter_unit("1/deg"), "$.parameters[1].unit: ", "restore '1/rad'"),
    "input": (channel("pressure", unit="bar"), "$.channels.pressure.unit: ", "restore 'kPa'"),
    "output": (channel("angle", unit="deg"), "$.channels.angle.unit: ", "restore 'rad'"),
    "display": (channel("angle", display_unit="rad"), "angle.display_factor: ", "one rad is 1 rad"),
    "factor": (channel("angle", display_factor=1.0), "angle.display_factor: ", "57.2957"),
    "quantity": (channel("angle", display_unit="bar"), "angle.display_unit: ", "restore the unit"),
    "option": (option(x_unit="mm"), "$.parameters[0].unit: ", "the model computes in"),
    "lost": (lambda d: d["channels"].pop("angle"), "$.channels: ", "angle has a role but no unit"),
}


@pytest.mark.parametrize("name", sorted(CASES))
def test_a_unit_that_is_not_the_models(tmp_path: Path, name: str) -> None:
    """The field, the value and the remedy; 180/π = 57.2957… degrees are a radian."""
    edit, field, said = CASES[name]
    save_fit(fit_result(), tmp_path / "params.json")
    with pytest.raises(InputError) as caught:
        load_params(edited(tmp_path / "params.json", edit))
    assert field in str(caught.value)
    assert said in str(caught.value)
    assert caught.value.exit_code == 3
    assert caught.value.remedy


def raw_log() -> Log:
    time_s = np.arange(400) * 0.02
    current = np.round(1.0 + np.sin(time_s), 1)
    lagged = np.convolve(current, np.full(10, 0.1))[:400] * 3.0
    return Log.from_arrays(
        time_s,
        {"current": current, "grip": lagged},
        units={"current": "A", "grip": "N"},
        input="current",
        outputs=("grip",),
    )


@pytest.mark.parametrize("model", [Oscillator(), Polynomial()])
def test_raw_channels_keep_the_units_of_the_fit(
    tmp_path: Path, model: Oscillator | Polynomial
) -> None:
    """Every file that softid writes reads back; a raw channel's unit is checked by the model's."""
    save_fit(fit(raw_log(), model=model), tmp_path / "params.json")
    assert load_params(tmp_path / "params.json").units["grip"] == "N"
    both = {"unit": "mN", "display_unit": "mN"}
    with pytest.raises(InputError, match="with these units") as caught:
        load_params(edited(tmp_path / "params.json", channel("grip", **both)))
    assert "grip in mN" in str(caught.value)
