"""An effect is hidden in a log by code apart from the fitter's, and must be found by name."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import pytest
from recovery import all_recovered

from softid.diagnosis import diagnose
from softid.diagnosis_results import Verdict
from softid.effects import EFFECTS
from softid.log import Log
from softid.synthesis import HiddenPair, hidden_pair
from softid.synthesis.hidden import names_of
from softid.synthesis.rig import Rig

Array = npt.NDArray[np.float64]

GAIN_SHARE = 0.9
"""The gain is at least nine tenths of that of the true law, which leaves the noise."""

SEEN = 0.5
"""A misfit of half of the noise is seen."""

USUAL, SLOW_NOISE = Rig(), Rig(coloured_share=0.9, rest_s=30.0)
DRAWS = range(100, 108)
PAIRS = [
    ["delay", "creep"],
    ["pneumatic_lag", "coulomb_friction"],
    ["hysteresis", "sensor_drift"],
    ["sensor_clipping", "contact"],
    ["sensor_clipping", "sensor_drift"],
    ["sensor_warmup", "sensor_clipping"],
]


def test_clean_data_are_adequate() -> None:
    """Stands on the truth of the generator: nothing is hidden, so nothing may be named."""
    pair = hidden_pair([], seed=7)
    found = diagnose(pair.logs[0], hold_out=[pair.logs[1]], model="muscle")
    assert found.verdict is Verdict.ADEQUATE
    assert not found.causes


@dataclass(frozen=True)
class Outcome:
    """One diagnosis of logs with hidden effects, held against their truth.

    Attributes
    ----------
    told, tied
        Effects that are named, and all that are in a tie.
    misfit
        Root mean square misfit of the base over the noise.
    is_right
        Whether the hidden effects are named and no others, or stand in a tie.
    is_misnamed
        Whether an effect that is not hidden is named without a tie.
    is_recovered
        Whether every hidden effect that was named is recovered.
    gain, oracle_gain
        Fall of the held-out error as a share of it, and what leaves nothing but the noise.
    """

    told: frozenset[str]
    tied: frozenset[str]
    misfit: float
    is_right: bool
    is_misnamed: bool
    is_recovered: bool
    gain: float
    oracle_gain: float


def outcome_of(names: Sequence[str], seed: int, rig: Rig = USUAL) -> Outcome:
    """Hide effects of a random size and sign, diagnose, and compare with the truth."""
    true = frozenset(name.split(".")[0] for name in names)
    pair = hidden_pair(names, seed=seed, rig=rig)
    train, hold_out = pair.logs
    found = diagnose(train, hold_out=[hold_out], model="muscle")
    told = frozenset(cause.effect for cause in found.causes)
    tied = frozenset(e for alternative in found.alternatives for e in alternative.effects)
    (channel,) = (c for c in pair.train.sigma if "pressure" not in c)
    inside, outside = (next(g for g in found.gains if g.held_out is h) for h in (False, True))
    excess = inside.rmse_before**2 / pair.train.sigma[channel] ** 2 - 1.0
    before = outside.rmse_before
    return Outcome(
        told=told,
        tied=tied,
        misfit=max(excess, 0.0) ** 0.5,
        is_right=told == true or (true <= told | tied and told <= true | tied),
        is_misnamed=bool(told - true - tied),
        is_recovered=all_recovered(found, pair) is not False,
        gain=1.0 - outside.rmse_after / before,
        oracle_gain=max(1.0 - pair.hold_out.sigma[channel] / before, 0.0),
    )


@pytest.mark.parametrize("name", ["creep", "sensor_clipping"])
def test_a_hidden_effect_is_found(name: str) -> None:
    """Stands on the generator's truth; the seed is arbitrary."""
    found = outcome_of([name], seed=7)
    assert found.told == {name}
    assert found.is_recovered
    assert found.gain >= GAIN_SHARE * found.oracle_gain


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "tau"), [(900, 0.3), (903, 0.15)])
def test_a_sensor_slower_than_its_actuator_is_found(seed: int, tau: float) -> None:
    """The base takes the sensor's time for its own, so nothing is left of it where the lag begins.

    A resonance of the line, or that and a creep, would be a wrong name.
    """
    pair = hidden_pair(["sensor_lag"], seed=seed, values={"sensor_lag": {"tau": tau}})
    found = diagnose(pair.logs[0], hold_out=[pair.logs[1]], model="muscle")
    (cause,) = found.causes
    assert cause.effect == "sensor_lag"
    assert cause.parameters[0].value == pytest.approx(tau, rel=0.02)


def with_pressure_read_by(pair: HiddenPair, read: Callable[[Array], Array]) -> tuple[Log, Log]:
    """The two logs with a pressure that is read otherwise."""

    def other(log: Log) -> Log:
        channel = log.channels[log.input]
        values = read(channel.values)
        return replace(log, channels={**log.channels, log.input: replace(channel, values=values)})

    train, hold_out = pair.logs
    return other(train), other(hold_out)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [31, 32, 33])
def test_the_rounding_of_the_pressure_is_no_misfit(seed: int) -> None:
    """A converter of 64 steps over the range: a level is off as long as it is held, and that is no
    misfit of the model. A creep is found through it all the same."""

    def rounded(values: Array) -> Array:
        step = np.ptp(values) / 64.0
        coarse: Array = step * np.round(values / step)
        return coarse

    train, hold_out = with_pressure_read_by(hidden_pair([], seed=seed), rounded)
    assert diagnose(train, hold_out=[hold_out], model="muscle").verdict is Verdict.ADEQUATE
    train, hold_out = with_pressure_read_by(hidden_pair(["creep"], seed=seed), rounded)
    (cause,) = diagnose(train, hold_out=[hold_out], model="muscle").causes
    assert cause.effect == "creep"


@pytest.mark.slow
@pytest.mark.parametrize("seed", [31, 32])
def test_a_pressure_smoothed_afterwards_is_no_resonance(seed: int) -> None:
    """A mean over five samples, as one takes to make a plot look clean; nothing is hidden.

    A resonance of the line of six samples without damping undoes the mean. It only describes the
    misfit; what is told is the mean itself, of five times 10 ms.
    """

    def smoothed(values: Array) -> Array:
        return np.convolve(np.pad(values, 2, "edge"), np.full(5, 0.2), "valid")

    train, hold_out = with_pressure_read_by(hidden_pair([], seed=seed), smoothed)
    found = diagnose(train, hold_out=[hold_out], model="muscle")
    assert found.verdict is Verdict.UNKNOWN
    assert not found.causes
    assert not found.alternatives
    assert [described.effect for described in found.descriptive] == ["line_resonance"]
    told = re.search(r"a pressure whose record was smoothed, .*? \((\S+) s\)", found.summary)
    assert told is not None
    assert float(told[1]) == pytest.approx(0.05, rel=0.1)


@pytest.mark.slow
def test_a_resonance_slower_than_its_actuator_is_found() -> None:
    """The base takes a part of its period for its own: no start near the base's own time leads on,
    and one from afar is needed."""
    pair = hidden_pair(["line_resonance"], seed=4, size=3.0)
    found = diagnose(pair.logs[0], hold_out=[pair.logs[1]], model="muscle")
    (cause,) = found.causes
    assert cause.effect == "line_resonance"
    true = pair.hidden["line_resonance"]
    for parameter in cause.parameters:
        assert parameter.value == pytest.approx(true[parameter.name.split("_")[-1]], rel=0.02)


@pytest.mark.slow
def test_a_wall_that_stands_for_clipping_is_seen_through() -> None:
    """A wall of the largest stiffness leaves what looks like noise, and its numbers refuse a name.

    Other first causes are tried all the same.
    """
    assert outcome_of(["sensor_clipping", "contact"], seed=104).told == {
        "sensor_clipping",
        "contact",
    }


@pytest.mark.slow
def test_a_curve_that_stands_for_two_is_seen_through() -> None:
    """A static curve in the place of a spring that softens takes most of what a valve does, too.

    It misses what is held out, so that it may not stay in a tie with that spring.
    """
    names = ["stiffening", "valve_flow"]
    pair = hidden_pair(names, seed=140521, model="oscillator", protocol="triangles")
    found = diagnose(pair.logs[0], hold_out=[pair.logs[1]], model="oscillator")
    assert {cause.effect for cause in found.causes} == set(names)


@pytest.mark.slow
def test_a_reading_that_drifts_is_clipped() -> None:
    """What drifts passes the end of the range later or not at all.

    Behind the clipping only, a drift would leave something for a static curve to describe.
    """
    names = ["sensor_clipping", "sensor_drift"]
    assert outcome_of(names, seed=401).told == set(names)


def test_two_hidden_effects_are_both_found() -> None:
    """Stands on the generator's truth: a lag and a drift hide each other in nothing."""
    assert outcome_of(["sensor_drift", "delay"], seed=7).told == {"sensor_drift", "delay"}


def test_what_the_catalogue_does_not_know_is_not_named() -> None:
    """Stands on the generator's truth: a gain that swings in time is no effect of the catalogue."""
    assert outcome_of(["periodic_gain"], seed=7).told == frozenset()


def test_a_slow_sine_does_not_split_delay_and_lag() -> None:
    """Stands on algebra: at one frequency a delay and a lag turn the phase alike."""
    pair = hidden_pair(["delay"], seed=7, protocol="sine")
    found = diagnose(pair.logs[0], hold_out=[pair.logs[1]], model="muscle")
    assert found.verdict is Verdict.AMBIGUOUS
    assert {"delay", "pneumatic_lag"} <= set(found.alternatives[0].effects)


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(EFFECTS))
def test_every_hidden_effect_is_found(name: str) -> None:
    """Eight draws; the truth is the generator's.

    At a rate of 98 % two of eight fail once in a hundred times, so that one may. A misfit below
    half of the noise may stay unnamed. The gain is held against that of the true law.
    """
    drawn = [outcome_of([name], seed) for seed in DRAWS]
    seen = [o for o in drawn if o.misfit >= SEEN]
    assert sum(not o.is_right for o in seen) <= 1
    assert sum(not o.is_recovered for o in seen) <= 1
    assert sum(o.gain < GAIN_SHARE * o.oracle_gain for o in seen) <= 1
    assert sum(o.is_misnamed for o in drawn) <= 1


@pytest.mark.slow
@pytest.mark.parametrize("names", PAIRS, ids="+".join)
def test_pairs_are_found(names: list[str]) -> None:
    """Eight draws of pairs of different kinds; both right in nine of ten, so in six of eight but
    once in twenty times, and a third name beside them no oftener than a wrong one."""
    drawn = [outcome_of(names, seed) for seed in DRAWS]
    assert sum(o.is_right for o in drawn) >= 6
    assert sum(o.is_misnamed for o in drawn) <= 1


@pytest.mark.slow
@pytest.mark.parametrize("name", names_of("outside"))
def test_nothing_outside_the_catalogue_is_misnamed(name: str) -> None:
    """Eight draws; none of these laws is in the catalogue, and 95 % may not be misnamed."""
    drawn = [outcome_of([name], seed) for seed in DRAWS]
    assert sum(o.is_misnamed for o in drawn) <= 1


@pytest.mark.parametrize(
    ("names", "verdict"),
    [
        ([], Verdict.ADEQUATE),
        pytest.param(["creep"], Verdict.NAMED, marks=pytest.mark.slow),
    ],
)
def test_slow_noise_needs_no_rest(names: list[str], verdict: Verdict) -> None:
    """Noise that is coloured by 90 %, of which no rest shows anything, is told by its marks."""
    pair = hidden_pair(names, seed=193001, rig=Rig(coloured_share=0.9))
    found = diagnose(pair.logs[0], hold_out=[pair.logs[1]], model="muscle")
    assert found.verdict is verdict
    assert [cause.effect for cause in found.causes] == names
    assert found.remainder.colour_s is not None


@pytest.mark.slow
@pytest.mark.parametrize("rig", [USUAL, SLOW_NOISE], ids=["white", "slow"])
def test_clean_data_stay_adequate(rig: Rig) -> None:
    """Eight draws with noise that is white, and that is slow beside a rest that shows it."""
    assert not any(outcome_of([], seed, rig).told for seed in DRAWS)


@pytest.mark.slow
def test_a_contact_beyond_what_the_model_reaches_is_found() -> None:
    """Known truth: the hold-out leans on a wall at 74.6 mm, and the base bends down before it."""
    truth = {"xw": 74.6, "kw": 5.0}
    pair = hidden_pair(["contact"], seed=2, values={"contact": truth})
    found = diagnose(pair.logs[0], hold_out=[pair.logs[1]], model="muscle")
    assert [cause.effect for cause in found.causes] == ["contact"]
    assert found.extended is not None
    place = found.extended.parameter("contact_xw")
    low, high = place.ci95
    assert low <= truth["xw"] <= high


@pytest.mark.slow
def test_a_hysteresis_that_turns_over_the_whole_range_is_found() -> None:
    """Known truth: a loop whose branches never arrive, as long as the range without it.

    The bound of its distance lies beyond that.
    """
    sizes = hidden_pair([], seed=231003, model="oscillator").sizes
    values = {"alpha": 0.6 * sizes.force, "zs": sizes.x_span}
    pair = hidden_pair(
        ["hysteresis"], seed=231003, model="oscillator", values={"hysteresis": values}
    )
    found = diagnose(pair.logs[0], hold_out=[pair.logs[1]], model="oscillator")
    (cause,) = found.causes
    assert cause.effect == "hysteresis"
    told = {p.name: p.value for p in cause.parameters}
    assert told["hysteresis_zs"] == pytest.approx(values["zs"], rel=0.05)


@pytest.mark.slow
def test_a_cause_that_errs_elsewhere_for_want_of_another_is_found() -> None:
    """Stands on the generator's truth: held-out logs reach the end of the sensor's range further.

    So an inertia that grows with the pressure predicts worse until the clipping is in the model,
    and a slow clock keeps the two from leaving noise.
    """
    values = {
        "pressure_mass": {"m": 0.012128667082459871},
        "sensor_clipping": {"upper": 66.17689964741061},
        "clock_rate": {"rate": -9.807610118380213e-05},
    }
    pair = hidden_pair(tuple(values), seed=312000, values=values)
    found = diagnose(pair.logs[0], hold_out=[pair.logs[1]], model="muscle")
    assert {cause.effect for cause in found.causes} == set(values)
    assert found.causes[0].effect == "pressure_mass"
    assert all_recovered(found, pair)
