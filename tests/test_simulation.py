"""Simulation of a whole log: segments, sensor zeros, initial states, errors."""

from __future__ import annotations

import numpy as np
import pytest

from softid.errors import IdentificationError, UsageError
from softid.log import Log
from softid.models.muscle import Muscle
from softid.results import LogNuisance, SegmentStart
from softid.simulation import parameter_vector, simulate

TRUTH = {"M": 2e-3, "a1": 1 / 70, "b1": 2.8, "c1": 1.0, "a2": 0.02, "b2": 1.6, "c2": 0.25}


def stalled_log() -> Log:
    """Two stretches of 1 s and between them one lone sample, each 2 s apart."""
    time_s = np.concatenate([np.arange(50) * 0.02, [3.0], 5.0 + np.arange(50) * 0.02])
    pressure = np.where(time_s < 0.3, 0.0, 150.0)
    contraction = np.linspace(0.0, 5.0, time_s.size)
    contraction[7] = np.nan
    return Log.from_arrays(time_s, {"pressure": pressure, "contraction": contraction})


def sigmoid(p_bar: float) -> float:
    return 1 / (TRUTH["a1"] + TRUTH["c1"] * np.exp(-TRUTH["b1"] * p_bar))


def test_every_segment_starts_at_rest_without_nuisance() -> None:
    """x∞ of each segment's first pressure; NaN only at the lone sample between the stalls."""
    found = simulate(Muscle(), TRUTH, stalled_log())
    x = found.outputs["contraction"]
    assert np.flatnonzero(np.isnan(x)).tolist() == [50]
    assert x[0] == pytest.approx(sigmoid(0.0), rel=1e-12)
    np.testing.assert_allclose(x[51:], sigmoid(1.5), rtol=1e-9)
    assert found.segment_starts == (0, 51)
    used = found.used["contraction"]
    assert np.flatnonzero(~used).tolist() == [7, 50]
    assert found.units == {"contraction": "mm"}
    assert found.input_unit == "kPa"


def test_zeros_and_initial_states_are_taken_over() -> None:
    """y = x + zero, and an estimated state is absolute: the first sample shows both."""
    nuisance = LogNuisance(
        "log",
        {"contraction": 2.5},
        {"contraction": None},
        (SegmentStart(0.0, False, (40.0, -3.0)), SegmentStart(5.0, True, (0.0, 0.0))),
    )
    x = simulate(Muscle(), TRUTH, stalled_log(), nuisance=nuisance).outputs["contraction"]
    assert x[0] == pytest.approx(42.5, rel=1e-12)
    assert x[1] < x[0]  # moving back, at −3 mm/s and pulled by the spring
    np.testing.assert_allclose(x[51:], sigmoid(1.5) + 2.5, rtol=1e-9)


def test_a_first_order_state_needs_only_a_position() -> None:
    """A start stored by a model with one state simulates too."""
    values = TRUTH | {"M": 0.0}
    nuisance = LogNuisance("log", {}, {}, (SegmentStart(0.0, False, (40.0, 0.0)),))
    x = simulate(Muscle(order="first"), values, stalled_log(), nuisance=nuisance)
    assert x.outputs["contraction"][0] == pytest.approx(40.0)
    assert np.isfinite(x.outputs["contraction"][1])


def test_names_must_match() -> None:
    """A missing and an unknown name are both listed."""
    values = dict(TRUTH)
    values["mass"] = values.pop("M")
    with pytest.raises(UsageError, match="exactly") as error:
        parameter_vector(Muscle(), values)
    assert "'M'" in str(error.value)
    assert "'mass'" in str(error.value)


@pytest.mark.parametrize("changed", [{"b1": 1e5}, {"a1": 0.0, "c1": 0.0}])
def test_a_response_without_numbers_is_an_error(changed: dict[str, float]) -> None:
    """Overflow and a missing stiffness end in a sentence, not in NaN or a numpy warning."""
    with pytest.raises(IdentificationError, match="not finite"):
        simulate(Muscle(), TRUTH | changed, stalled_log())
