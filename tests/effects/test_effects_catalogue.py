"""Every effect of the catalogue: bounds, and its law against one that scipy solves."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from muscle_rig import times
from textbook_effects import (
    LAWS,
    MUSCLE,
    OSCILLATOR,
    driven,
    segment,
    sizes,
    textbook_motion,
)

from softid.effects import (
    EFFECTS,
    Effect,
    ExtendedModel,
    Scale,
    StateEffect,
    effects_of,
)
from softid.models.base import Model
from softid.models.muscle import Muscle
from softid.models.oscillator import Oscillator
from softid.parameters import Parameter
from softid.segment import Segment

BASES: dict[str, tuple[Model, np.ndarray]] = {
    "muscle": (Muscle(), MUSCLE),
    "oscillator": (Oscillator(), OSCILLATOR),
}
SAMPLINGS = ("100 Hz", "50 Hz", "irregular")
STATE = [key for key, effect in EFFECTS.items() if issubclass(effect, StateEffect)]
OUTPUT = ("position",)


@cache
def rig(base: str) -> tuple[Segment, Scale]:
    """The drive of a base model and the sizes of its motion."""
    drive = driven(base)
    return drive, sizes(base, drive)


@cache
def sampled(base: str, sampling: str) -> Segment:
    """That drive as it was, or read off at other times."""
    drive = rig(base)[0]
    if sampling == "100 Hz":
        return drive
    time_s = times(sampling)
    time_s = time_s[time_s <= drive.time_s[-1]]
    return segment(time_s, np.interp(time_s, drive.time_s, drive.input))


def moved(model: Model, theta: np.ndarray, drive: Segment) -> np.ndarray:
    """The simulated output, from rest."""
    found = model.response(theta, drive, OUTPUT, start=None, derivatives=False)
    return found.outputs[OUTPUT[0]]


def eta_of(effect: Effect, scale: Scale, values: dict[str, float]) -> np.ndarray:
    """Parameter values in their order."""
    return np.array([values[name] for name in effect.parameters(scale)])


@pytest.mark.parametrize("base", BASES)
@pytest.mark.parametrize("key", ["line_resonance", "sensor_resonance"])
def test_an_overdamped_resonance_is_a_lag(key: str, base: str) -> None:
    """Its own word for it moves the same within 4 % of the range, and at ζ = 0.9 there is none.

    The faster of its two time constants, a thirty-fourth of the other at ζ = 3, is what is left.
    """
    (model, theta), (drive, scale) = BASES[base], rig(base)
    effect, values = EFFECTS[key](), {"period": 0.3, "zeta": 3.0}
    simpler = effect.simpler(values)
    assert simpler is not None
    lag = EFFECTS[simpler[0]]()
    both = [
        moved(
            ExtendedModel(model, (which,), scale),
            np.concatenate((theta, eta_of(which, scale, dict(at)))),
            drive,
        )
        for which, at in ((effect, values), (lag, simpler[1]))
    ]
    alone = moved(model, theta, drive)
    assert np.max(np.abs(both[0] - both[1])) < 0.04 * np.ptp(alone)
    assert np.max(np.abs(both[0] - alone)) > 0.2 * np.ptp(alone)
    assert effect.simpler(values | {"zeta": 0.9}) is None


@pytest.mark.parametrize("base", BASES)
@pytest.mark.parametrize("key", EFFECTS)
def test_parameters_and_starts(key: str, base: str) -> None:
    """Bounds, units and meaning are set; starts are complete, few, inside, and not nothing."""
    effect, scale = EFFECTS[key](), rig(base)[1]
    declared = effect.parameters(scale)
    assert set(effect.amplitudes) <= set(declared)
    for p in declared.values():
        assert np.isfinite([p.lower, p.upper]).all()
        assert p.lower < p.value < p.upper
        assert p.meaning
        assert p.source
        assert p.unit
        assert p.scale == "linear" or p.lower > 0.0
    for name in effect.amplitudes:
        assert (declared[name].lower < 0.0) == effect.changes_sign
    starts = effect.starts(scale)
    assert 1 <= len(starts) <= 4
    for start in starts:
        assert tuple(start) == declared.names
        for name, value in start.items():
            assert declared[name].lower <= value <= declared[name].upper, name
        assert not effect.amplitudes or any(start[name] != 0.0 for name in effect.amplitudes)


@pytest.mark.parametrize(
    "odd",
    [{"duration_s": 0.1, "period_s": 0.01}, {"u_low": 0.0, "u_high": 0.0}],
    ids=["ten samples", "no input"],
)
@pytest.mark.parametrize("key", EFFECTS)
def test_sizes_at_the_edge_give_bounds_and_starts(key: str, odd: dict[str, float]) -> None:
    """A log of a few samples, and one whose input is zero throughout, leave a way to search."""
    effect, scale = EFFECTS[key](), replace(rig("muscle")[1], **odd)
    declared = effect.parameters(scale)
    for p in declared.values():
        assert np.isfinite([p.lower, p.upper]).all()
    for start in effect.starts(scale):
        for name, value in start.items():
            assert declared[name].lower <= value <= declared[name].upper


@pytest.mark.parametrize("sampling", SAMPLINGS)
@pytest.mark.parametrize("base", BASES)
@pytest.mark.parametrize("key", [key for key in EFFECTS if EFFECTS[key]().amplitudes])
def test_nothing_at_zero_amplitude(key: str, base: str, sampling: str) -> None:
    """With its amplitudes at zero an effect leaves the base model's response, to 1e-9 of it.

    At the largest of its starts it changes the response by a thousandth or more.
    """
    (model, theta), scale, drive = BASES[base], rig(base)[1], sampled(base, sampling)
    effect = EFFECTS[key]()
    extended = ExtendedModel(model, (effect,), scale)
    starts = [np.concatenate((theta, eta_of(effect, scale, dict(s)))) for s in effect.starts(scale)]
    values = effect.parameters(scale).values_dict() | dict.fromkeys(effect.amplitudes, 0.0)
    whole = np.concatenate((theta, eta_of(effect, scale, values)))
    # in the equation of motion by the same rule: another errs otherwise, by 1e-5
    plan = extended.plan(whole, drive) if key in STATE else None
    found = extended.response(whole, drive, OUTPUT, start=None, derivatives=False, plan=plan)
    alone = ExtendedModel(model, (), scale).response(
        theta, drive, OUTPUT, start=None, derivatives=False, plan=plan
    )
    expected = alone.outputs[OUTPUT[0]]
    span = np.ptp(expected)
    np.testing.assert_allclose(found.outputs[OUTPUT[0]], expected, rtol=0.0, atol=1e-9 * span)
    shown = max(np.max(np.abs(moved(extended, at, drive) - expected)) for at in starts)
    assert shown > 1e-3 * span, "the effect would not show"


def test_every_state_effect_has_a_textbook_law() -> None:
    """The comparison below leaves no effect of the table out."""
    assert set(STATE) == set(LAWS)


@pytest.mark.parametrize("base", BASES)
@pytest.mark.parametrize("key", STATE)
def test_motion_agrees_with_scipy(key: str, base: str) -> None:
    """Every start, within 1e-4 of the range of LSODA at 1e-9 on a law that is written apart."""
    (model, theta), (drive, scale) = BASES[base], rig(base)
    effect = EFFECTS[key]()
    for start in effect.starts(scale):
        values = dict(start)
        expected = textbook_motion(base, drive, key, values, scale)[0]
        whole = np.concatenate((theta, eta_of(effect, scale, values)))
        found = moved(ExtendedModel(model, (effect,), scale), whole, drive)
        span = np.ptp(expected)
        np.testing.assert_allclose(found, expected, atol=1e-4 * span)
        alone = moved(model, theta, drive)
        assert np.max(np.abs(alone - expected)) > 30 * 1e-4 * span, "the effect would not show"


SHARPEST = {
    "contact": {"kw": 90.0, "xw": 0.6},
    "contact.lower": {"kw": 90.0, "xw": 0.4},
    "hysteresis": {"alpha": 0.3, "zs": 3e-3},
    "hysteresis.branch": {"alpha": 0.3, "zs": 3e-3, "z0": -1.0},
    "hysteresis.pressure": {"alpha": 0.15, "zs": 3e-3, "k": 1.0},
    "coulomb_friction": {"Fc": 0.05, "vs": 1e-3},
    "coulomb_friction.stribeck": {"Fc": 0.05, "vs": 3e-3, "beta": 0.5, "vb": 0.1},
    "coulomb_friction.pressure": {"Fc": 0.03, "vs": 3e-3, "k": 1.0},
    "asymmetric_damping": {"eps": -0.9, "v0": 3e-3},
    "quadratic_damping": {"d2": 10.0},
}
"""In the effects' natural sizes."""


@pytest.mark.parametrize("base", BASES)
@pytest.mark.parametrize("key", SHARPEST)
def test_sharp_laws_get_the_steps_they_need(key: str, base: str) -> None:
    """Corners at the ends of the bounds: the step goes by `rate`, and 3e-4 of the range holds."""
    (model, theta), (drive, scale) = BASES[base], rig(base)
    natural = {
        "kw": scale.force / scale.x_span, "xw": scale.x_span, "alpha": scale.force,
        "zs": scale.x_span, "Fc": scale.force, "vs": scale.v_max, "beta": 1.0, "vb": scale.v_max,
        "z0": 1.0, "eps": 1.0, "v0": scale.v_max, "d2": scale.force / scale.v_max**2,
        "k": 1.0 / scale.u_high,
    }  # fmt: skip
    values = {name: share * natural[name] for name, share in SHARPEST[key].items()}
    if "xw" in values:
        values["xw"] += scale.x_low
    expected = textbook_motion(base, drive, key, values, scale)[0]
    effect = EFFECTS[key]()
    whole = np.concatenate((theta, eta_of(effect, scale, values)))
    found = moved(ExtendedModel(model, (effect,), scale), whole, drive)
    np.testing.assert_allclose(found, expected, atol=3e-4 * np.ptp(expected))


@pytest.mark.parametrize("sampling", SAMPLINGS)
@pytest.mark.parametrize("base", BASES)
@pytest.mark.parametrize("key", EFFECTS)
def test_jacobian(key: str, base: str, sampling: str) -> None:
    """Derivatives against central differences of whole simulations, to 1e-4 of each column.

    The flow through a valve turns where the pressures meet, and both sides are differences there:
    3e-4.

    At a start times 1.0173, since a corner that falls on a sample has a derivative on each side.
    """
    (model, theta), scale, drive = BASES[base], rig(base)[1], sampled(base, sampling)
    effect = EFFECTS[key]()
    extended = ExtendedModel(model, (effect,), scale)
    values = {name: 1.0173 * value for name, value in effect.starts(scale)[0].items()}
    whole = np.concatenate((theta, eta_of(effect, scale, values)))
    plan = extended.plan(whole, drive)

    def outputs(at: np.ndarray) -> np.ndarray:
        found = extended.response(at, drive, OUTPUT, start=None, derivatives=False, plan=plan)
        return found.outputs[OUTPUT[0]]

    exact = extended.response(whole, drive, OUTPUT, start=None, derivatives=True, plan=plan)
    assert exact.by_parameter is not None
    by = exact.by_parameter[OUTPUT[0]]
    natural = np.abs(np.concatenate((theta, effect.parameters(scale).values_vector())))
    for k, size in enumerate(natural):
        h = 1e-5 * max(size, 1e-3)
        step = h * np.eye(whole.size)[k]
        expected = (outputs(whole + step) - outputs(whole - step)) / (2 * h)
        share = 3e-4 if key == "valve_flow" else 1e-4
        atol = share * np.max(np.abs(expected)) + 1e-8 * scale.x_span / max(size, 1e-3)
        np.testing.assert_allclose(by[:, k], expected, atol=atol, err_msg=f"column {k}")


GENTLE = {
    "coulomb_friction": {"Fc": 0.05, "vs": 0.3},
    "coulomb_friction.stribeck": {"Fc": 0.05, "vs": 0.3, "beta": 0.1, "vb": 1.0},
    "coulomb_friction.pressure": {"Fc": 0.02, "vs": 0.3, "k": 1.0},
    "hysteresis.branch": {"alpha": 0.05, "zs": 0.01, "z0": -0.8},
}
"""In shares of force, range and largest speed. Without inertia and damping nothing but the spring
holds the stages of sharp friction together, and Newton's method does not find them; and friction
that falls with the speed faster than the damping grows has no unique motion at all. On which branch
a jump ends depends on how far it overshoots, unless the loop turns within less."""


@pytest.mark.parametrize("base", BASES)
@pytest.mark.parametrize(
    ("order", "key"),
    [
        *(("first", key) for key in STATE),
        *(("static", key) for key in STATE if not key.endswith("stribeck")),
    ],
)
def test_lower_orders_are_the_limits_of_higher_ones(order: str, key: str, base: str) -> None:
    """With M, and with M and N, a millionth of what they were, to 3e-3 of the range at the median.

    The median, because a mode that dies out within microseconds is seen right after a jump only;
    3e-3, because the turns of a hysteresis fall between the steps in both.
    """
    (model, theta), (drive, scale) = BASES[base], rig(base)
    effect = EFFECTS[key]()
    values = dict(effect.starts(scale)[0])
    if key in GENTLE:
        natural = {
            "Fc": scale.force, "vs": scale.v_max, "vb": scale.v_max, "beta": 1.0,
            "alpha": scale.force, "zs": scale.x_span, "z0": 1.0, "k": 1.0 / scale.u_high,
        }  # fmt: skip
        values = {name: share * natural[name] for name, share in GENTLE[key].items()}
    eta = eta_of(effect, scale, values)
    names = model.parameters().names
    gone = ("M",) if order == "first" else ("M", "N", "a2", "c2")
    faded = [k for k, name in enumerate(names) if name in gone]
    small, none = theta.copy(), theta.copy()
    small[faded] *= 1e-6
    none[faded] = 0.0
    limit = replace(model, order=order)
    found = moved(ExtendedModel(limit, (effect,), scale), np.concatenate((none, eta)), drive)
    near = moved(ExtendedModel(model, (effect,), scale), np.concatenate((small, eta)), drive)
    assert np.isfinite(found).all()
    assert np.median(np.abs(found - near)) < 3e-3 * np.ptp(found)


def test_all_state_effects_act_together() -> None:
    """All at a fifth of their start at once: finite, and every one of them changes the motion."""
    (model, theta), (drive, scale) = BASES["muscle"], rig("muscle")
    plain = [EFFECTS[key]() for key in STATE if not EFFECTS[key].variant]
    extended = ExtendedModel(model, tuple(plain), scale)
    weak = []
    for effect in plain:
        values = dict(effect.starts(scale)[0])
        values |= {name: 0.2 * values[name] for name in effect.amplitudes}
        weak.append(eta_of(effect, scale, values))
    together = moved(extended, np.concatenate((theta, *weak)), drive)
    assert np.isfinite(together).all()
    for k, effect in enumerate(plain):
        fewer = ExtendedModel(model, tuple(e for e in plain if e is not effect), scale)
        rest = [eta for j, eta in enumerate(weak) if j != k]
        without = moved(fewer, np.concatenate((theta, *rest)), drive)
        assert np.max(np.abs(without - together)) > 1e-4 * np.ptp(together), effect.name


@pytest.mark.parametrize(
    ("value", "lower", "upper", "size"),
    [
        (-2.0, -5.0, 5.0, 2.0),
        (0.0, -5.0, 15.0, 20.0),
        (0.0, -np.inf, np.inf, 1.0),
        (0.0, 0.0, np.inf, 1.0),
    ],
)
def test_a_value_of_zero_has_a_size(value: float, lower: float, upper: float, size: float) -> None:
    """By the definition: its value, the width of its bounds, or one; it is moved in proportion."""
    assert Parameter("d", value, "1", lower, upper).usual_size == size


def test_the_catalogue_or_what_is_named() -> None:
    """All effects in the order of the table, or the ones asked for in theirs."""
    assert [effect.key for effect in effects_of()] == list(EFFECTS)
    assert [effect.key for effect in effects_of(["creep", "delay"])] == ["creep", "delay"]
