"""Laws in no catalogue that account for a misfit."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from late_gauge import with_a_late_gauge

from softid.diagnosis.base.base_fit import BaseFit, Request
from softid.diagnosis.refit.candidates import begun
from softid.diagnosis.refit.extension import extend, named_values, start_unknowns
from softid.diagnosis.residual.assessment import noise_variance
from softid.diagnosis.search.forward_selection import converged
from softid.diagnosis.verdict.beyond_catalogue import (
    BeyondCatalogue,
    beyond_and_cause,
    beyond_catalogue,
)
from softid.diagnosis.verdict.unlisted_curves import FreeSpring
from softid.diagnosis.verdict.unlisted_drifts import LoadDrift
from softid.diagnosis.verdict.unlisted_laws import InputPlay, Law, OutputPlay
from softid.diagnosis.verdict.unlisted_pneumatics import RateLimit, ReliefLeak
from softid.diagnosis.verdict.unlisted_readings import LateGauge
from softid.effects import effect_of
from softid.effects.base import Effect
from softid.log import Log, LogSet
from softid.synthesis import hidden_pair


def base_over(*names: str, seed: int) -> BaseFit:
    (log, judge) = hidden_pair(names, seed=seed, size=1.5).logs
    request = Request("muscle", None, 0, lambda message, fraction: None)
    return request.fit_base(LogSet((log,)), (judge,), thorough=False)


@pytest.mark.parametrize(
    ("hidden", "law"),
    [
        ("position_damping", "position_damping"),
        ("damping_slope", "position_damping"),
        ("inertia_slope", "position_inertia"),
        ("input_backlash", "input_play"),
        ("output_backlash", "output_play"),
        ("rate_limit", "rate_limit"),
        ("supply_limit", "input_limit"),
        ("self_heating", "recovering_softening"),
        ("wavy_spring", "free_spring"),
        ("damping_drift", "damping_drift"),
        ("pressure_gain_drift", "pressure_gain_drift"),
    ],
)
def test_what_is_hidden_is_told(hidden: str, law: str) -> None:
    """Stands on the generator: it takes nearly all, also on the other log, before all others."""
    base = base_over(hidden, seed=710005)
    found = beyond_catalogue(base, noise_variance(base.candidate, base.scale))
    assert found is not None
    assert found.laws[0].name == law
    assert min(found.share, found.held_out_share) > 0.9


@pytest.mark.parametrize(
    ("hidden", "protocol", "seed", "law"),
    [
        ("rate_limit", "rich", 740000, RateLimit),
        ("input_backlash", "lever", 740001, InputPlay),
    ],
)
def test_what_leads_a_base_far_away_is_told(
    hidden: str, protocol: str, seed: int, law: type[Law]
) -> None:
    """Stands on the generator: from where the base ends without it no way leads back."""
    fitted, judge = hidden_pair((hidden,), seed=seed, size=4.0, protocol=protocol).logs
    request = Request("muscle", None, 0, lambda message, fraction: None)
    base = request.fit_base(LogSet((fitted,)), (judge,), thorough=False)
    found = beyond_catalogue(base, noise_variance(base.candidate, base.scale), (law,))
    assert found is not None
    assert min(found.share, found.held_out_share) > 0.98


def test_what_lies_beyond_a_valley_is_told_from_start_values_of_the_base() -> None:
    """Stands on the generator: the base has a damping that acts without pressure alone, and an
    optimiser creeps along with that."""
    fitted, judge = hidden_pair(("load_drift",), seed=885000).logs
    request = Request("muscle", None, 0, lambda message, fraction: None)
    base = request.fit_base(LogSet((fitted,)), (judge,), thorough=False)
    noise = noise_variance(base.candidate, base.scale)
    assert beyond_catalogue(base, noise, (LoadDrift,)) is None
    found = beyond_catalogue(base, noise, at_starts=True)
    assert found is not None
    assert found.laws[0].name == "load_drift"
    assert min(found.share, found.held_out_share) > 0.98


def with_a_settling_gain(log: Log) -> Log:
    """The log of a sensor that reads 15 % more once it is warm, after a few times 8 s."""
    (name,) = log.outputs
    channel = log.channels[name]
    grown = channel.values * (1.15 - 0.15 * np.exp(-log.time_s / 8.0))
    return replace(log, channels={**log.channels, name: replace(channel, values=grown)})


def test_a_gain_that_settles_is_told_from_a_stiffness_that_does() -> None:
    """Known truth: the sensor's gain; the stiffness would change the time of the motion, too."""
    fitted, judge = (with_a_settling_gain(log) for log in hidden_pair(seed=710008).logs)
    request = Request("muscle", None, 0, lambda message, fraction: None)
    base = request.fit_base(LogSet((fitted,)), (judge,), thorough=False)
    found = beyond_catalogue(base, noise_variance(base.candidate, base.scale))
    assert found is not None
    assert [law.name for law in found.laws] == ["settling_gain"]
    assert found.sizes[0][0] == pytest.approx(0.15, rel=0.1)
    assert found.sizes[1][0] == pytest.approx(8.0, rel=0.1)


@pytest.mark.parametrize("hidden", ["creep", "coulomb_friction", "sensor_lag", "swinging_load"])
def test_other_laws_are_not_told_for_it(hidden: str) -> None:
    base = base_over(hidden, seed=710006)
    assert beyond_catalogue(base, noise_variance(base.candidate, base.scale)) is None


def base_with_a_late_gauge(*names: str, seed: int) -> BaseFit:
    """Logs with hidden causes whose pressure is recorded late, by 0.06 s."""
    fitted, judge = (with_a_late_gauge(log, 0.06) for log in hidden_pair(names, seed=seed).logs)
    request = Request("muscle", None, 0, lambda message, fraction: None)
    return request.fit_base(LogSet((fitted,)), (judge,), thorough=False)


@pytest.mark.slow
def test_a_law_together_with_a_cause() -> None:
    """Known truth: a gauge that lags by 0.06 s, and friction, of which each alone leaves much."""
    base = base_with_a_late_gauge("coulomb_friction", seed=5)
    noise = noise_variance(base.candidate, base.scale)
    effects = [effect_of(name) for name in ("creep", "coulomb_friction", "delay")]
    found = beyond_and_cause(base, noise, effects)
    assert found is not None
    assert [law.name for law in (*found.laws, *found.beside)] == ["gauge_lag", "coulomb_friction"]
    assert found.sizes[0][0] == pytest.approx(0.06, rel=0.1)
    assert found.is_whole
    assert beyond_catalogue(base, noise, (LateGauge,)) is None


def test_a_law_beside_a_cause_that_stands() -> None:
    """Known truth: a gauge that lags by 0.06 s, and a creep that is known already."""
    base, creep = base_with_a_late_gauge("creep", seed=8), effect_of("creep")
    known, values = base.candidate, named_values(creep, creep.starts(base.scale)[0])
    problem = extend(known.problem, [creep], base.scale)
    start = start_unknowns(problem, known.problem, known.minimum.point, values)
    creeping = converged(begun(known, (creep,), problem, start), base.sigma)
    noise = noise_variance(base.candidate, base.scale)
    found = beyond_catalogue(base, noise, (LateGauge,), beside=creeping)
    assert found is not None
    assert found.beside == (creep,)
    assert found.is_whole
    assert found.sizes[0][0] == pytest.approx(0.06, rel=0.05)


def test_noise_is_no_law() -> None:
    base = base_over(seed=710007)
    noise = noise_variance(base.candidate, base.scale)
    assert beyond_catalogue(base, noise) is None
    assert beyond_catalogue(base, 4.0 * noise) is None


@pytest.mark.parametrize(
    ("share", "squares", "cause", "outdoes"),
    [
        (0.99, 120.0, 200.0, True),
        (0.99, 140.0, 200.0, False),
        (0.99, 120.0, 125.0, False),
        (0.95, 120.0, 200.0, False),
    ],
)
def test_only_what_leaves_noise_ends_a_search(
    share: float, squares: float, cause: float, outdoes: bool
) -> None:
    """A misfit of 30 times the noise of 100 loses 96 % to a law that leaves more than twice it: the
    rest may be a second cause. It must leave clearly less than the best cause, too."""
    found = BeyondCatalogue((OutputPlay(),), share, share, squares, 100.0)
    best: Any = SimpleNamespace(squares=cause)
    assert found.outdoes(best) is outdoes


@pytest.mark.parametrize("law", [FreeSpring(), ReliefLeak()])
def test_what_two_causes_may_do_leaves_a_second_one_open(law: Effect) -> None:
    """A stiffening up to a wall is a spring of some shape, and a lag with a curve at rest looks
    like a leak: the search goes on."""
    best: Any = SimpleNamespace(squares=200.0)
    found = BeyondCatalogue((law,), 0.99, 0.99, 120.0, 100.0)
    assert not found.outdoes(best)
