"""Channels: canonical values inside, the file's unit outside."""

from __future__ import annotations

import numpy as np
import pytest

from softid.channels import OUTPUT_PREFERENCE, default_outputs, make_channel
from softid.errors import InputError
from softid.units import CHANNEL_QUANTITY


def test_a_known_channel_is_converted_and_can_be_shown_as_it_was() -> None:
    """0.5 bar is 50 kPa by definition; the way back is exact to rounding."""
    channel = make_channel("pressure", [0.0, 0.5], "bar", column="P1")
    assert channel.values.tolist() == [0.0, 50.0]
    assert (channel.unit, channel.display_unit, channel.column) == ("kPa", "bar", "P1")
    np.testing.assert_allclose(channel.displayed, [0.0, 0.5], rtol=1e-15)


def test_a_raw_channel_keeps_its_numbers_and_its_unit() -> None:
    channel = make_channel("flex", [1.0, 2.0], "V")
    assert (channel.unit, channel.display_unit, channel.display_factor) == ("V", "V", 1.0)
    assert make_channel("flex", [1.0]).unit == "1"


def test_the_unit_must_measure_what_the_channel_is() -> None:
    with pytest.raises(InputError, match="deg is a unit of angle"):
        make_channel("pressure", [1.0], "deg")


def test_values_cannot_be_changed_from_outside() -> None:
    given = np.array([1.0, 2.0])
    channel = make_channel("pressure", given)
    given[0] = 9.0
    assert channel.values[0] == 1.0
    with pytest.raises(ValueError, match="read-only"):
        channel.values[0] = 9.0


def test_the_preferred_output_that_is_not_the_input_is_taken() -> None:
    channels = {name: make_channel(name, [0.0, 1.0]) for name in ("force", "position", "pressure")}
    assert default_outputs(channels, "pressure", where="x") == ("position",)
    assert default_outputs(channels, "position", where="x") == ("force",)


def test_no_output_names_what_there_is_and_the_option() -> None:
    with pytest.raises(InputError, match="no output channel") as caught:
        default_outputs({"flex": make_channel("flex", [1.0])}, "pressure", where="a.csv")
    assert caught.value.where == "a.csv"
    assert "flex" in str(caught.value)
    assert "--output" in str(caught.value)


def test_every_preferred_output_is_a_known_channel() -> None:
    assert set(OUTPUT_PREFERENCE) <= set(CHANNEL_QUANTITY)
