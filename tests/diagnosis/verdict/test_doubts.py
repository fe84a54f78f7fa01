"""Laws that are over within a sampling interval, that others dwarf, or that the noise refutes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from handmade_diagnosis import cause, estimate, remainder
from handmade_rounds import ranked
from linear_motion import RATE_HZ, TRUTH, linear_log, linear_problem, standing
from textbook_effects import round_scale

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.refit.characteristic_scales import scale_of
from softid.diagnosis.refit.extension import extend, start_unknowns
from softid.diagnosis.search.forward_selection import Link
from softid.diagnosis.verdict.doubts import (
    dwarfed,
    has_fast_noise,
    is_within_a_sample,
    is_within_samples,
)
from softid.diagnosis_results import Doubt
from softid.effects import effect_of

Array = npt.NDArray[np.float64]

SCALE = replace(round_scale(), period_s=0.02)
NOISE = remainder(structured=False, explained=1.0)
SAMPLES = 2000


@pytest.mark.parametrize(
    ("key", "values", "within"),
    [
        ("delay", {"tau": 0.0019}, True),
        ("delay", {"tau": 0.0021}, False),
        ("sensor_lag", {"tau": 0.0019}, True),
        ("pneumatic_lag.separate", {"tau": 0.0004, "ratio": 4.0}, True),
        ("pneumatic_lag.separate", {"tau": 0.0004, "ratio": 6.0}, False),
        ("pneumatic_lag.separate", {"tau": 0.0021, "ratio": 0.1}, False),
        ("sensor_drift", {"rate": 1e-4}, False),
    ],
)
def test_the_longer_time_counts(key: str, values: dict[str, float], within: bool) -> None:
    """A tenth of an interval of 20 ms; a rate is no time."""
    effect = effect_of(key)
    parameters = [estimate(f"{effect.name}_{name}", v, "s") for name, v in values.items()]
    told = cause(key, parameters, before=2.0, after=1.0)
    assert is_within_a_sample(told, effect, SCALE) is within


@pytest.mark.parametrize(
    ("doubts", "structured", "all_of_it"),
    [
        ([Doubt.TOO_QUICK], False, True),
        ([Doubt.TOO_QUICK], True, False),
        ([Doubt.TOO_QUICK, None], False, False),
        ([], False, False),
    ],
)
def test_what_is_within_samples_is_all_or_it_is_not(
    doubts: list[Doubt | None], structured: bool, all_of_it: bool
) -> None:
    """Only where nothing else is described, and nothing is left behind it."""
    told = [replace(cause("delay", [], before=2.0, after=1.0), doubt=d) for d in doubts]
    assert is_within_samples(told, replace(NOISE, structured=structured)) is all_of_it


@pytest.mark.parametrize(("share", "is_small"), [(0.049, True), (0.051, False)])
def test_a_twentieth_of_the_largest_is_small(share: float, is_small: bool) -> None:
    """Of the root mean square that the largest takes away, whichever comes first."""
    base = ranked((), 0.0)
    for keys in (("creep", "delay"), ("delay", "creep")):
        falls = [100.0 if key == "creep" else 100.0 * share**2 for key in keys]
        before = (sum(falls) + 3.0, sum(falls[1:]) + 3.0)
        links = tuple(
            Link(base, (base,), ranked((key,), -500.0), (key,), (), squares)
            for key, squares in zip(keys, before, strict=True)
        )
        chain: Any = SimpleNamespace(links=links, final=SimpleNamespace(squares=3.0))
        assert dwarfed(chain) == ({"delay"} if is_small else set())


@pytest.mark.parametrize(
    ("key", "values"),
    [
        ("smoothing", {"period": 0.3, "order": 2.0}),
        ("smoothing.mean", {"width": 0.14}),
        ("smoothing.past", {"width": 0.14}),
    ],
)
@pytest.mark.parametrize("is_filtered", [True, False], ids=["filtered", "white"])
def test_behind_a_filter_over_a_record_there_is_no_fast_noise(
    key: str, values: dict[str, float], *, is_filtered: bool
) -> None:
    """Noise that a mean of seven samples smoothed, and white noise, which a filter over the record
    would have smoothed; behind a sensor's own average its converter may add some."""
    final = behind_a_filter(key, values, seven_samples_alike(is_filtered=is_filtered))
    assert has_fast_noise(final) is (None if key == "smoothing.past" else not is_filtered)


@pytest.mark.parametrize("is_filtered", [True, False], ids=["filtered", "white"])
def test_a_misfit_does_not_hide_fast_noise(*, is_filtered: bool) -> None:
    """A swing of 1 s, ten times as large, makes samples differ that are far apart."""
    swing = 0.1 * np.sin(2.0 * np.pi * np.arange(SAMPLES) / RATE_HZ)
    noise = seven_samples_alike(is_filtered=is_filtered)
    final = behind_a_filter("smoothing", {"period": 0.8, "order": 2.0}, noise + swing)
    assert not has_fast_noise(final)
    assert has_fast_noise(final, in_misfit=True) is not is_filtered


def seven_samples_alike(*, is_filtered: bool) -> Array:
    """White noise, or what a mean of seven samples leaves of it."""
    noise = 0.01 * np.random.default_rng(0).standard_normal(SAMPLES)
    return np.convolve(noise, np.ones(7) / 7.0, "same") if is_filtered else noise


def behind_a_filter(key: str, values: Mapping[str, float], added: Array) -> Candidate:
    """A linear model with a filter where it stands, over a log of it with an error added."""
    problem = linear_problem([linear_log(samples=SAMPLES, added=added)])
    z, effect = problem.unknowns(TRUTH), effect_of(key)
    extended = extend(problem, (effect,), scale_of(problem, z))
    named = {f"{effect.name}_{name}": value for name, value in values.items()}
    at = start_unknowns(extended, problem, z, named)
    return replace(standing(extended, at), effects=(effect,))
