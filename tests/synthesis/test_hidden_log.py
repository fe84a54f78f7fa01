"""Pairs of logs with hidden effects: their names, seeds, recordings and independence."""

from __future__ import annotations

import ast
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from fresh_process import printed_by

import softid.synthesis
from softid.effects import EFFECTS, ExtendedModel, Scale
from softid.errors import UsageError
from softid.models.base import Model
from softid.models.equilibrium import Equilibrium
from softid.models.muscle import Muscle
from softid.models.oscillator import Oscillator
from softid.synthesis import HIDDEN, PROTOCOLS, HiddenPair, Rig, hidden_log, hidden_pair, names_of
from softid.synthesis.hidden import ENTRIES

QUIET = Rig(noise=0.0, pressure_noise_kpa=0.0, zero=0.0)
FORBIDDEN = ("softid.effects", "softid.kernels", "softid.models", "softid.simulation")
MODELS: dict[str, Model] = {
    "muscle": Muscle(x_unit="mm"),
    "oscillator": Oscillator(x_unit="mm"),
    "equilibrium": Equilibrium(),
}


def scale_of(pair: HiddenPair) -> Scale:
    """The fitter's sizes, made from the generator's."""
    s = pair.sizes
    return Scale(
        u_low=s.p_low, u_high=s.p_high, x_low=s.x_low, x_high=s.x_high, v_max=s.v_max,
        force=s.force, y_low=s.x_low, y_high=s.x_high, period_s=1.0 / pair.rig.rate_hz,
        duration_s=s.duration_s, motion_s=s.motion_s, travel=s.travel, x_unit=s.x_unit,
        force_unit=s.force_unit, y_unit=s.x_unit,
    )  # fmt: skip


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("key", EFFECTS)
def test_names_and_units_are_those_of_the_catalogue(key: str, model: str) -> None:
    """So that a fitted parameter can be held against the truth of its name."""
    pair = hidden_pair((key,), model=model, protocol="step", rig=QUIET)
    declared = EFFECTS[key]().parameters(scale_of(pair))
    assert dict(pair.units[key]) == {p.name: p.unit for p in declared.values()}


def test_every_effect_of_the_catalogue_can_be_hidden() -> None:
    """And what claims to be one is one; a right answer to another form is an effect too."""
    assert set(names_of("catalogue")) == set(EFFECTS)
    known = {effect.name for effect in EFFECTS.values()}
    for name, hidden in HIDDEN.items():
        assert set(hidden.names) <= known, name
        assert (hidden.relation == "outside") == (not hidden.names), name


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("key", EFFECTS)
def test_two_codes_agree_on_the_law(key: str, model: str) -> None:
    """The fitter's simulator with the true parameters, to 1e-4 of the range; it takes the pressure
    as straight between samples at 1 kHz, and its own steps are good for 1e-4."""
    rig = replace(QUIET, rate_hz=1000.0)
    pair = hidden_pair((key,), seed=6, model=model, protocol="step", rig=rig)
    effect, base = EFFECTS[key](), MODELS[model]
    extended = ExtendedModel(base, (effect,), scale_of(pair))
    values = pair.hidden[key]
    theta = [pair.actuator.values[name] for name in base.parameters().names]
    eta = [values[name] for name in effect.parameters(scale_of(pair)).names]
    for made in (pair.train, pair.hold_out):
        segment = made.to_log().segments()[0]
        output = made.to_log().outputs[0]
        whole = np.array([*theta, *eta])
        found = extended.response(whole, segment, (output,), start=None, derivatives=False)
        np.testing.assert_allclose(
            found.outputs[output], made.truth.reading, atol=1e-4 * pair.sizes.x_span
        )


def test_the_package_stands_apart_from_the_fitter() -> None:
    """No module of it names the effects, kernels, models or the simulator, in functions either."""
    folder = Path(softid.synthesis.__file__).parent
    for path in folder.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            names += [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            assert not [n for n in names if n.startswith(FORBIDDEN)], f"{path.name}: {names}"


def test_making_a_log_loads_nothing_of_the_fitter() -> None:
    """Stands on the modules of a fresh interpreter after a pair was made."""
    code = (
        "import sys; from softid.synthesis import hidden_pair; "
        "hidden_pair(('creep',), protocol='step').logs; "
        f"print([m for m in sys.modules if m.startswith({(*FORBIDDEN, 'numba')!r})])"
    )
    assert printed_by(code) == "[]\n"


def test_seeds() -> None:
    """The same seed gives the same bytes; another effect leaves actuator and noise alone."""
    first, again = (hidden_pair(("creep",), seed=8, protocol="step") for _ in range(2))
    other = hidden_pair(("delay", "creep"), seed=8, protocol="step")
    for name, values in first.train.columns.items():
        assert np.array_equal(values, again.train.columns[name])
    assert first.actuator == other.actuator
    assert first.hidden["creep"] == other.hidden["creep"]
    column = "contraction_mm"
    noise = [p.train.columns[column] - p.train.truth.reading for p in (first, other)]
    np.testing.assert_allclose(*noise, atol=2e-6)
    assert hidden_pair(("creep",), seed=9, protocol="step").actuator != first.actuator


def test_size_scales_the_effect_and_keeps_its_sign() -> None:
    """Every parameter that scales is in proportion, as long as no limit cuts it."""
    small, large = (hidden_pair(("sensor_drift",), seed=3, size=s) for s in (0.5, 1.0))
    assert large.hidden["sensor_drift"]["rate"] == pytest.approx(
        2.0 * small.hidden["sensor_drift"]["rate"]
    )


@cache
def without_effects() -> HiddenPair:
    """The pair that the next test compares with."""
    return hidden_pair((), seed=2)


def test_no_two_effects_share_a_name() -> None:
    """The later one would stand for both."""
    assert len(HIDDEN) == len(ENTRIES)


@pytest.mark.parametrize("name", HIDDEN)
def test_every_effect_shows(name: str) -> None:
    """At size 1 it moves the reading of the rich protocol by 0.1 % of the range or more (rms)."""
    plain, pair = without_effects(), hidden_pair((name,), seed=2)
    change = pair.train.truth.reading - plain.train.truth.reading
    assert np.sqrt(np.mean(change**2)) > 1e-3 * pair.sizes.x_span
    assert np.isfinite(pair.hold_out.truth.reading).all()


def test_signs_come_both_ways() -> None:
    """Effects that may have either sign are drawn with either."""
    for name, parameter in (("ageing", "r"), ("asymmetric_damping", "eps"), ("stiffening", "k3")):
        drawn = [
            hidden_pair((name,), seed=s, protocol="step").hidden[name][parameter] for s in range(8)
        ]
        assert min(drawn) < 0.0 < max(drawn)


def test_the_recorded_pressure_is_that_of_the_valve() -> None:
    """Before the hidden lag, 40 ms behind the command, with the noise that was asked for."""
    pair = hidden_pair(("pneumatic_lag",), seed=1, protocol="step", rig=Rig(pressure_noise_kpa=0.5))
    made = pair.train
    error = made.columns["pressure_kpa"] - made.truth.pressure_kpa
    assert np.std(error) == pytest.approx(0.5, rel=0.1)
    rising = made.time_s > 1.0
    expected = 192.0 * (1.0 - np.exp(-(made.time_s[rising] - 1.0) / 0.04))
    np.testing.assert_allclose(made.truth.pressure_kpa[rising], expected, atol=1e-4)
    assert np.max(np.abs(made.truth.pressure_kpa - made.truth.arriving_kpa)) > 10.0


def test_coloured_noise_has_its_share_and_its_time() -> None:
    """90 % of the variance with 1 s: the correlation at 0.5 s is 0.9 e^{−1/2} = 0.55, and at 0.01 s
    0.89; the bounds are four standard errors of 600 s with 1 s of correlation."""
    rig = Rig(noise=0.01, coloured_share=0.9, rest_s=600.0)
    pair = hidden_pair((), seed=5, protocol="step", rig=rig)
    made = pair.train
    noise = made.columns["contraction_mm"] - made.truth.reading
    noise = noise - noise.mean()
    assert np.std(noise) == pytest.approx(0.01 * pair.sizes.x_span, rel=0.25)
    assert made.sigma["contraction_mm"] == pytest.approx(0.01 * pair.sizes.x_span, rel=1e-6)
    for lag, expected in ((1, 0.891), (50, 0.546)):
        found = np.mean(noise[lag:] * noise[:-lag]) / np.mean(noise**2)
        assert found == pytest.approx(expected, abs=0.2 if lag > 1 else 0.04)


def test_recordings_of_other_rigs() -> None:
    """50 Hz, degrees, jitter, lost rows, blank cells and a coarse converter, all at once."""
    rig = Rig(
        rate_hz=50.0, unit="deg", jitter=0.1, lost_fraction=0.05, blank_fraction=0.02, quantum=0.01
    )
    pair = hidden_pair(("stiffening",), seed=2, protocol="step", rig=rig)
    log = pair.train.to_log()
    assert log.outputs == ("angle",)
    assert log.channels["angle"].display_unit == "deg"
    intervals = np.diff(pair.train.time_s)
    assert np.median(intervals) == pytest.approx(0.02, rel=0.1)
    assert intervals.max() > 0.035
    values = pair.train.columns["angle_deg"]
    assert 0 < np.isnan(values).sum() < 0.1 * values.size
    quantum = 0.01 * np.degrees(pair.sizes.x_span)
    steps = values[~np.isnan(values)] / quantum
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-4)
    assert pair.units["stiffening"]["k3"] == "1/rad³"
    same = hidden_pair((), seed=2, protocol="step", rig=replace(QUIET, unit="rad"))
    plain = hidden_pair((), seed=2, protocol="step", rig=QUIET)
    np.testing.assert_allclose(
        same.train.truth.position * 20.0, plain.train.truth.position, rtol=1e-6
    )


@pytest.mark.parametrize(("name", "seconds"), [
    ("rich", 48), ("paper", 24), ("slow", 50), ("triangles", 51.6), ("multisine", 52),
    ("levels", 50.2), ("lever", 57.6),
])  # fmt: skip
def test_protocols(name: str, seconds: float) -> None:
    """Lengths as described, random ones within 15 %; a rest at the end if asked for."""
    plan = PROTOCOLS[name]
    rng = np.random.default_rng(0)
    last = plan.excitation(200.0, hold_out=False).pieces(0.0, np.random.default_rng(0))[-1]
    close = 0.15 if name in ("levels", "lever") else 1e-9
    assert last.stop_s == pytest.approx(seconds, rel=close)
    rested = plan.excitation(200.0, hold_out=False, rest_s=30.0)
    rested = rested.pieces(0.0, np.random.default_rng(0))
    assert rested[-1].stop_s == last.stop_s + 30.0
    assert rested[-1].command_kpa(rested[-1].start_s) == 0.0
    for piece in plan.excitation(200.0, hold_out=True).pieces(0.0, rng):
        for time_s in np.linspace(piece.start_s, piece.stop_s, 20):
            assert 0.0 <= piece.command_kpa(time_s) <= 200.0


def test_the_rich_hold_out_is_24_s() -> None:
    """12 s of 0.25 Hz and ten levels of 1.2 s."""
    pieces = PROTOCOLS["rich"].excitation(1.0, hold_out=True).pieces(0.0, np.random.default_rng(0))
    assert pieces[-1].stop_s == pytest.approx(24.0)


@pytest.mark.parametrize("name", PROTOCOLS)
def test_every_protocol_makes_logs(name: str) -> None:
    """Both logs have a drive and one output, and `hidden_log` is the first of them."""
    pair = hidden_pair(("contact", "sensor_drift"), seed=1, protocol=name, model="oscillator")
    for log in pair.logs:
        assert (log.input, log.outputs) == ("pressure", ("position",))
    alone = hidden_log(("contact", "sensor_drift"), seed=1, protocol=name, model="oscillator")
    assert np.array_equal(alone.pressure_kpa, pair.logs[0].pressure_kpa)


def test_what_broke_stays_broken() -> None:
    """A stiffness that jumps in the log has its new value throughout the hold-out."""
    pair = hidden_pair(
        ("stiffness_jump",), seed=1, model="oscillator", protocol="step", rig=QUIET,
        values={"stiffness_jump": {"at": 5.99}},
    )  # fmt: skip
    assert np.ptp(pair.hold_out.truth.position[-200:]) < 1e-3 * pair.sizes.x_span
    change = pair.hidden["stiffness_jump"]["change"]
    top = 0.6 * 200.0 / pair.actuator.values["Q"]
    assert pair.hold_out.truth.position[-1] == pytest.approx(top / (1.0 + change), rel=1e-3)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"names": ("delayy",)}, "delay, pneumatic_lag"),
        ({"names": ("delay", "delay")}, "twice"),
        ({"size": 0.0}, "positive"),
        ({"seed": -1}, "negative"),
        ({"model": "polynomial"}, "muscle, oscillator"),
        ({"protocol": "best"}, "rich, paper"),
        ({"names": ("delay",), "values": {"creep": {"k": 1.0}}}, "not hidden"),
        ({"names": ("delay",), "values": {"delay": {"k": 1.0}}}, "tau"),
    ],
)
def test_wrong_usage(arguments: dict, words: str) -> None:
    """Exit code 2, and the error lists what may be chosen."""
    with pytest.raises(UsageError, match=words) as caught:
        hidden_pair(**arguments)
    assert caught.value.exit_code == 2


def test_given_values_take_the_place_of_drawn_ones() -> None:
    """The others stay as they were drawn."""
    drawn = hidden_pair(("creep",), seed=1, protocol="step")
    given = hidden_pair(("creep",), seed=1, protocol="step", values={"creep": {"tau": 5.0}})
    assert given.hidden["creep"] == {"k": drawn.hidden["creep"]["k"], "tau": 5.0}


@pytest.mark.parametrize("seed", [1, 5])
def test_a_long_rest_ends(seed: int) -> None:
    """Two minutes at rest are thousands of time constants of the valve: e⁻³⁰⁰⁰ is no number, and
    the solver must not lose its way for it."""
    (log, _) = hidden_pair([], seed=seed, protocol="step", rig=Rig(rest_s=120.0)).logs
    values = log.channels[log.outputs[0]].values
    assert log.time_s[-1] > 120.0
    assert np.isfinite(values).all()
