"""Exact derivatives of the simulated motion against central differences, and the plan of steps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from softid.kernels.step_counts import MAX_SUBSTEPS
from softid.log import Log
from softid.models.base import Model
from softid.models.division import divide
from softid.models.equilibrium import Equilibrium
from softid.models.muscle import Muscle
from softid.models.muscle_law import MuscleLaw
from softid.models.oscillator import Oscillator, OscillatorLaw
from softid.models.polynomial import Polynomial
from softid.models.second_order import simulate_law
from softid.models.time_scales import Speeds, order_seen, speeds_of
from softid.segment import Segment

Array = npt.NDArray[np.float64]
MUSCLE = np.array([2e-3, 1 / 70, 2.8, 1.0, 0.02, 1.6, 0.25])
OSCILLATOR = np.array([0.3, 1.1, 20.0, -1.0, 0.4])
MODES = (
    (None, False),
    (np.array([3.0, -20.0]), False),
    (np.array([3.0, -20.0]), True),
)


def segment(channel: str = "pressure", outputs: tuple[str, ...] = ("contraction",)) -> Segment:
    """Irregular times, jumps and a ramp, 1.6 s long."""
    rng = np.random.default_rng(2)
    time_s = np.cumsum(rng.uniform(0.005, 0.04, 70))
    u = np.where(time_s < 0.4, 60.0, 180.0) + 40.0 * time_s
    u[45:] -= 100.0
    blank = np.linspace(0.0, 1.0, time_s.size)
    log = Log.from_arrays(
        time_s, {channel: u, **dict.fromkeys(outputs, blank)}, input=channel, outputs=outputs
    )
    return log.segments()[0]


def require_slopes(
    model: Model,
    theta: Array,
    s: Segment,
    outputs: tuple[str, ...],
    start: Array | None,
    relative: bool,
) -> None:
    """Every derivative within 1e-6 of its column's largest value: the differences' own error.

    Differences of O(h⁴) with a relative step of 1e-3 keep rounding (1e-16/1e-3) and truncation
    (1e-12 times the fifth derivative) both below 1e-8.
    """
    plan = model.plan(theta, s)

    def output(at: Array, first: Array | None) -> dict[str, Array]:
        found = model.response(
            at, s, outputs, start=first, derivatives=False, relative=relative, plan=plan
        )
        return dict(found.outputs)

    def difference(move, h: float, name: str) -> Array:
        y = {k: output(*move(k * h))[name] for k in (-2, -1, 1, 2)}
        return (8 * (y[1] - y[-1]) - (y[2] - y[-2])) / (12 * h)

    exact = model.response(
        theta, s, outputs, start=start, derivatives=True, relative=relative, plan=plan
    )
    assert exact.by_parameter is not None
    assert exact.by_state is not None
    for name in outputs:
        for k in range(theta.size):
            if model.parameters()[model.parameters().names[k]].fixed and theta[k] == 0.0:
                continue

            def moved(by: float, k: int = k) -> tuple[Array, Array | None]:
                return theta + by * np.eye(theta.size)[k], start

            expected = difference(moved, 1e-3 * max(abs(theta[k]), 1e-6), name)
            near(exact.by_parameter[name][:, k], expected, (name, k))
        for j in range(len(model.start_states) if start is not None else 0):

            def shifted(by: float, j: int = j) -> tuple[Array, Array | None]:
                assert start is not None
                return theta, start + by * np.eye(2)[j]

            expected = difference(shifted, 1e-3 * max(abs(start[j]), 1.0), name)
            near(exact.by_state[name][:, j], expected, (name, "state", j))
        assert exact.by_state[name].shape == (s.time_s.size, len(model.start_states))


def near(exact: Array, expected: Array, where: object) -> None:
    scale = float(np.abs(expected).max())
    assert np.abs(exact - expected).max() <= 1e-6 * scale + 1e-12, where


@pytest.mark.parametrize("order", ["second", "first", "static"])
@pytest.mark.parametrize(("start", "relative"), MODES)
def test_muscle_derivatives(order: str, start: Array | None, relative: bool) -> None:
    """All seven parameters and the initial state, for every order and every kind of start."""
    model = Muscle(order=order)
    theta = np.where([p.fixed for p in model.parameters().values()], 0.0, MUSCLE)
    require_slopes(model, theta, segment(), ("contraction",), start, relative)


@pytest.mark.parametrize("inverted", [False, True])
@pytest.mark.parametrize(("start", "relative"), MODES)
def test_muscle_derivatives_through_the_geometry(
    inverted: bool, start: Array | None, relative: bool
) -> None:
    """The chain rule through angle, contraction, length and distance."""
    model = Muscle(fixed_length_mm=150.0, diameter_mm=20.0, inverted=inverted)
    outputs = ("angle", "contraction", "length", "distance")
    require_slopes(model, MUSCLE, segment(outputs=outputs), outputs, start, relative)


def test_muscle_derivatives_with_constant_damping() -> None:
    """a2 = b2 = 0 are held; the other five keep their exact derivatives."""
    theta = MUSCLE.copy()
    theta[4:6] = 0.0
    require_slopes(Muscle(damping="constant"), theta, segment(), ("contraction",), None, False)


@pytest.mark.parametrize("order", ["second", "first", "static"])
@pytest.mark.parametrize(("start", "relative"), MODES)
def test_oscillator_derivatives(order: str, start: Array | None, relative: bool) -> None:
    """M, N, Q, G and offset, with a spring."""
    model = Oscillator(order=order)
    theta = np.where(
        [p.fixed and p.value == 0.0 for p in model.parameters().values()], 0.0, OSCILLATOR
    )
    theta[4] = 0.4
    require_slopes(model, theta, segment("force", ("position",)), ("position",), start, relative)


@pytest.mark.parametrize("order", ["second", "first"])
def test_oscillator_derivatives_without_spring(order: str) -> None:
    """Q = 0: no equilibrium, so only an absolute start makes sense."""
    model = Oscillator(order=order, spring="none")
    theta = OSCILLATOR.copy()
    theta[2] = 0.0
    if order == "first":
        theta[0] = 0.0
    start = np.array([3.0, -20.0])
    require_slopes(model, theta, segment("force", ("position",)), ("position",), start, False)


def test_a_relative_start_is_a_deviation_from_equilibrium() -> None:
    """start = d with relative equals start = x∞(u₀) + d without: the same motion to rounding."""
    s = segment()
    law = MuscleLaw(MUSCLE)
    d = np.array([3.0, -20.0])
    rest = np.array([law.equilibrium(float(s.input[0])), 0.0])
    one = simulate_law(law, s.time_s, s.input, d, derivatives=False, relative=True)
    two = simulate_law(law, s.time_s, s.input, rest + d, derivatives=False)
    np.testing.assert_allclose(one.x, two.x, rtol=1e-14)
    assert (one.x[0], one.v[0]) == (rest[0] + 3.0, -20.0)


def test_rest_stays_at_rest() -> None:
    """Constant input from equilibrium: x = F/Q for ever and v = 0, to rounding."""
    time_s = np.linspace(0.0, 5.0, 100)
    x = simulate_law(MuscleLaw(MUSCLE), time_s, np.full(100, 170.0), None, derivatives=False)
    np.testing.assert_allclose(x.x, MuscleLaw(MUSCLE).equilibrium(170.0), rtol=1e-12)
    np.testing.assert_allclose(x.v, 0.0, atol=1e-8)


def test_a_plan_covers_each_interval_exactly() -> None:
    """The steps of an interval add up to it and each last step ends on its sample."""
    s = segment()
    plan = divide(MuscleLaw(MUSCLE), s.time_s, s.input)
    assert plan.counts.sum() == plan.step_s.size == plan.stage_input.shape[0]
    at = np.cumsum(plan.step_s)[plan.ends]
    np.testing.assert_allclose(at, s.time_s[1:] - s.time_s[0], rtol=1e-12)
    np.testing.assert_allclose(plan.stage_input[plan.ends, 2], s.input[1:], rtol=1e-12)
    assert plan.counts.max() > 1


def test_a_plan_survives_absurd_parameters() -> None:
    """Overflowing coefficients give no warning and a bounded number of steps."""
    s = segment()
    absurd = MUSCLE.copy()
    absurd[2] = 299.0
    absurd[5] = -299.0
    for theta in (absurd, np.full(7, 1e-300), np.zeros(7)):
        plan = divide(MuscleLaw(theta), s.time_s, s.input * 10)
        assert 1 <= plan.counts.min() <= plan.counts.max() <= MAX_SUBSTEPS


def test_speeds_of_known_coefficients() -> None:
    """N/Q, √(Q/M)/2π and N/(2√(QM)) for M = 2, N = 4, Q = 8: 0.5 s, 1/π Hz and 0.5."""
    found = speeds_of(OscillatorLaw(np.array([2.0, 4.0, 8.0, 1.0, 0.0])), 0.0)
    assert found.time_constant_s == 0.5
    assert found.natural_frequency_hz == pytest.approx(1 / np.pi, rel=1e-12)
    assert found.damping_ratio == pytest.approx(0.5, rel=1e-12)


@pytest.mark.parametrize(
    ("mass", "damping", "spring", "there"),
    [
        (0.0, 4.0, 8.0, ["time_constant"]),
        (2.0, 0.0, 8.0, ["natural_frequency", "damping_ratio"]),
        (2.0, 4.0, 0.0, []),
    ],
    ids=["no inertia", "no damping", "no spring"],
)
def test_speeds_that_a_motion_does_not_have(
    mass: float, damping: float, spring: float, there: list[str]
) -> None:
    """Without inertia nothing rings, without damping nothing settles, without a spring nothing
    comes back."""
    found = speeds_of(OscillatorLaw(np.array([mass, damping, spring, 1.0, 0.0])), 0.0)
    assert list(found.named()) == there


@pytest.mark.parametrize("model", [Muscle(), Oscillator(), Equilibrium()], ids=lambda m: m.name)
def test_speeds_are_the_derived_quantities(model: Model) -> None:
    """What people read is what the library goes by, at the input that the name says."""
    p = model.parameters()
    values = dict(zip(p.names, p.values_vector().tolist(), strict=True))
    own = model.speeds(values, 100.0)
    assert own != Speeds()
    told = model.derived(values, (100.0, 100.0))
    for name, row in own.named().items():
        assert [value for key, value in told.items() if key.startswith(name)] == [row]


def test_a_static_model_has_no_speeds() -> None:
    """A polynomial does not move."""
    assert Polynomial().speeds({}, 10.0) == Speeds()


@pytest.mark.parametrize(
    ("mass", "damping", "order", "expected"),
    [
        (1e-2, 1.0, "second", None),  # M/N = 10 ms, a period of 20 ms sees it
        (1e-3, 1.0, "second", "first"),  # M/N = 1 ms < 0.1 · 20 ms
        (0.0, 1e-3, "first", "static"),  # N/Q = 1 ms
        (0.0, 1.0, "first", None),
    ],
)
def test_what_cannot_be_seen_fades(mass: float, damping: float, order, expected) -> None:
    """A mode that dies out within a tenth of the sampling interval is dropped, no other."""
    law = OscillatorLaw(np.array([mass, damping, 1.0, 1.0, 0.0]))
    found = order_seen(law, order, 0.02, np.array([0.0, 1.0]))
    assert (found[0] if found else None) == expected


@pytest.mark.parametrize(("hz", "expected"), [(49.0, None), (51.0, "first")])
def test_a_swing_past_half_the_sampling_rate_is_an_alias(hz: float, expected: str | None) -> None:
    """At 100 samples a second no more than 50 Hz can be seen; a motion that does not ring lasts."""
    mass, spring = 0.5, 0.5 * (2.0 * np.pi * hz) ** 2
    light, heavy = 0.02 * np.sqrt(spring * mass), 2.1 * np.sqrt(spring * mass)
    inputs = np.array([0.0, 1.0])
    law = OscillatorLaw(np.array([mass, light, spring, 1.0, 0.0]))
    found = order_seen(law, "second", 0.01, inputs)
    assert (found[0] if found else None) == expected
    creeping = OscillatorLaw(np.array([mass, heavy, spring, 1.0, 0.0]))
    assert order_seen(creeping, "second", 0.01, inputs) is None


def test_a_plan_held_still_makes_the_output_smooth() -> None:
    """With one plan the output moves by O(h) for a move of h, even where a new plan would jump."""
    s = segment()
    model = Muscle()
    plan = model.plan(MUSCLE, s)
    y = [
        model.response(
            MUSCLE * np.array([f, 1, 1, 1, 1, 1, 1]),
            s,
            ("contraction",),
            start=None,
            derivatives=False,
            plan=plan,
        ).outputs["contraction"]
        for f in 1 + 1e-6 * np.arange(5)
    ]
    second = np.abs(np.diff(y, n=2, axis=0)).max()
    assert second < 1e-9
    assert replace(plan, counts=plan.counts + 1).same_as(plan) is False


class Hidden(MuscleLaw):
    """The muscle's law as one that the affine kernels do not know."""

    def affine(self) -> None:
        return None


@pytest.mark.parametrize(("start", "relative"), MODES)
def test_any_other_law_runs_step_by_step(start: Array | None, relative: bool) -> None:
    """The general kernel and the affine one take the same Radau steps: equal to 1e-10."""
    s = segment()
    plan = divide(Hidden(MUSCLE), s.time_s, s.input)
    assert plan.rule == "radau"
    how = {"derivatives": True, "relative": relative, "plan": plan}
    general = simulate_law(Hidden(MUSCLE), s.time_s, s.input, start, **how)
    affine = simulate_law(MuscleLaw(MUSCLE), s.time_s, s.input, start, **how)
    np.testing.assert_allclose(general.x, affine.x, rtol=1e-10)
    np.testing.assert_allclose(general.v, affine.v, atol=1e-10 * np.abs(general.v).max())
    for one, two in (
        (general.by_parameter, affine.by_parameter),
        (general.by_state, affine.by_state),
    ):
        assert one is not None
        assert two is not None
        assert np.all(np.abs(one - two) <= 1e-9 * np.abs(one).max(axis=0))


@pytest.mark.parametrize(
    ("factor", "period_s", "rule"),
    [(100.0, 0.001, "rk4"), (1.0, 0.001, "rk4"), (1.0, 0.02, "radau"), (1e-5, 0.005, "radau"),
     (0.0, 0.005, "radau")],
)  # fmt: skip
def test_the_rule_follows_the_stiffness(factor: float, period_s: float, rule: str) -> None:
    """Explicit steps only with h·ω ≤ 0.3 and h·d ≤ 1.5, and either rule errs by less than 1e-4.

    The reference takes 64 times as many steps of the Radau rule, which itself stands on an adaptive
    solver in tests/kernels/test_radau.py.
    """
    theta = MUSCLE * np.array([factor, 1, 1, 1, 1, 1, 1])
    law = MuscleLaw(theta)
    u = np.repeat([0.0, 240.0, 60.0, 300.0], round(0.4 / period_s))
    time_s = period_s * np.arange(u.size)
    plan = divide(law, time_s, u)
    assert plan.rule == rule
    if rule == "rk4":
        damping, stiffness, _ = law.coefficients(u)
        steps = np.diff(time_s) / plan.counts
        assert np.all(steps * np.sqrt(stiffness / law.mass)[1:] <= 0.3 + 1e-12)
        assert np.all(steps * damping[1:] / law.mass <= 1.5 + 1e-12)
    fine = replace(plan, counts=(64 * plan.counts).astype(np.int16), rule="radau")
    x = simulate_law(law, time_s, u, None, derivatives=False, plan=plan).x
    exact = simulate_law(law, time_s, u, None, derivatives=False, plan=fine).x
    assert np.abs(x - exact).max() <= 1e-4 * np.ptp(exact)


def test_a_jump_of_microseconds_needs_no_pieces() -> None:
    """Within it the coefficients bend e²⁴-fold, but nothing moves: 1e-4 of the motion.

    Against the same jump in 64 pieces.
    """
    law = MuscleLaw(np.array([3e-2, 1e-9, 10.0, 0.95, 1.5e-3, 2.0, 0.28]))
    time_s = np.sort(np.append(0.01 * np.arange(100), 0.5 - 1e-5))
    u = np.where(time_s < 0.5, 0.0, 240.0)
    plan = divide(law, time_s, u)
    jump = int(np.flatnonzero(np.diff(u))[0])
    assert plan.counts[jump] == 1
    counts = plan.counts.copy()
    counts[jump] = 64
    found, fine = (
        simulate_law(law, time_s, u, None, derivatives=False, plan=p).x
        for p in (plan, replace(plan, counts=counts))
    )
    np.testing.assert_allclose(found, fine, rtol=0.0, atol=1e-4 * np.ptp(fine))


def test_a_segment_keeps_its_last_division() -> None:
    """The same one for the same parameters; for others, and in a copy of the segment, another."""
    model, stretch = Muscle(), segment()
    first = model.plan(MUSCLE, stretch)
    assert model.plan(MUSCLE.copy(), stretch) is first
    assert model.plan(MUSCLE, replace(stretch)) is not first
    faster = model.plan(np.array([2e-5, *MUSCLE[1:]]), stretch)
    assert not faster.same_as(first)
    assert model.plan(MUSCLE, stretch).same_as(first)
