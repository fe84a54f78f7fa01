"""Logs whose header names another unit than that of their column."""

from __future__ import annotations

from dataclasses import replace

import pytest
from linear_motion import linear_log
from slow_camera import slow

from softid.channels import make_channel
from softid.diagnosis import diagnose
from softid.errors import InputError
from softid.identification import fit
from softid.identification.slow_outputs import at_readings
from softid.identification.unit_slips import UNIT_SLIP, unit_slips
from softid.log import Log
from softid.models import Muscle, Oscillator
from softid.synthesis import hidden_pair
from softid.validation import validate

FITTED = linear_log(noise=0.01)


def headed(log: Log, name: str, unit: str, *, is_in: str) -> Log:
    """The log with the numbers of a channel under the header of another unit."""
    channel = log.channels[name]
    factor = make_channel(name, [1.0], is_in).values[0]
    made = make_channel(name, channel.values / factor, unit)
    return replace(log, channels={**log.channels, name: made})


@pytest.mark.parametrize(
    ("name", "unit", "is_in"),
    [("pressure", "psi", "kPa"), ("pressure", "bar", "kPa"), ("angle", "rad", "deg")],
)
def test_a_wrong_header_is_told(name: str, unit: str, is_in: str) -> None:
    """By fit and validate as an error of the log, and by diagnose before it searches."""
    other = headed(linear_log(noise=0.01, seed=1), name, unit, is_in=is_in)
    found = fit(FITTED, model="oscillator", hold_out=[other])
    for issues in (found.issues, validate(found, other).issues):
        (slip,) = (issue for issue in issues if issue.code == UNIT_SLIP)
        assert f"{name} is given in {unit}" in slip.message
        assert f"only if it is in {is_in}" in slip.message
    with pytest.raises(InputError, match=f"only if it is in {is_in}"):
        diagnose(FITTED, hold_out=[other], model="oscillator", effects=["delay"])


def test_a_slow_output_is_told_of_its_input() -> None:
    """The course between its readings is in the wrong unit, too."""
    other = headed(
        slow(linear_log(noise=0.01, seed=1, samples=2000)), "pressure", "psi", is_in="kPa"
    )
    model = Oscillator(x_unit="rad", u_unit="kPa")
    values = fit(FITTED, model="oscillator").values
    (slip,) = unit_slips(model, values, [at_readings(other)])
    assert "only if it is in kPa" in slip.message


def test_what_no_unit_explains_is_left_alone() -> None:
    """A log of another actuator, of noise, and one that fits as it stands."""
    good = linear_log(noise=0.01, seed=1)
    model = Oscillator(x_unit="rad", u_unit="kPa")
    values = fit(FITTED, model="oscillator").values
    softer = replace(good.channels["angle"], values=2.2 * good.channels["angle"].values)
    backward = replace(good.channels["angle"], values=good.channels["angle"].values[::-1])
    others = [
        replace(good, channels={**good.channels, "angle": angle}) for angle in (softer, backward)
    ]
    assert unit_slips(model, values, [good, *others]) == ()


def test_a_model_that_runs_away_is_told_in_words() -> None:
    """e^(b1 p) of a muscle overflows at kPa that are read as MPa; with the right unit it fits."""
    pair = hidden_pair(seed=2)
    model = Muscle(x_unit=pair.actuator.x_unit)
    log = pair.logs[1]
    other = headed(log, "pressure", "MPa", is_in="kPa")
    (slip,) = unit_slips(model, dict(pair.actuator.values), [other])
    assert "only if it is in kPa" in slip.message
    assert "runs away as it stands" in slip.message
    assert unit_slips(model, dict(pair.actuator.values), [log]) == ()
