"""The vector of unknowns: layout, Jacobian, ties, bounds, masks, zeros and the start at rest."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from softid.fitters.problem import Problem
from softid.fitters.rest import starts_at_rest
from softid.log import Log
from softid.models.muscle import Muscle
from softid.models.oscillator import Oscillator
from softid.parameters import ParameterSet
from softid.simulation import simulate

Array = npt.NDArray[np.float64]
TRUTH = {"M": 2e-3, "a1": 1 / 70, "b1": 2.8, "c1": 1.0, "a2": 0.02, "b2": 1.6, "c2": 0.25}
OUTPUTS = ("angle", "contraction")


def log(name: str = "one", *, zero: float = 0.0, moving: bool = False, stall: bool = False) -> Log:
    """A pressure step with the exact response of both outputs plus a sensor zero."""
    model = Muscle(fixed_length_mm=150.0, diameter_mm=20.0)
    time_s = np.arange(120) * 0.01
    if stall:
        time_s = np.where(time_s > 0.6, time_s + 3.0, time_s)
    pressure = 100.0 + (80.0 * np.sin(9 * time_s) if moving else np.where(time_s < 0.4, 0, 90.0))
    blank = Log.from_arrays(
        time_s, {"pressure": pressure, **dict.fromkeys(OUTPUTS, time_s)}, outputs=OUTPUTS, name=name
    )
    x = simulate(model, TRUTH, blank).outputs
    channels = {k: x[k] + zero for k in OUTPUTS}
    return Log.from_arrays(time_s, {"pressure": pressure, **channels}, outputs=OUTPUTS, name=name)


def arc(parameters: ParameterSet | None = None, *logs: Log, zeros: bool = True) -> Problem:
    model = Muscle(fixed_length_mm=150.0, diameter_mm=20.0)
    return Problem(model, parameters or model.parameters(), logs or (log(),), zeros=zeros)


def stacked(problem: Problem, z: Array) -> tuple[Array, Array]:
    plans = problem.plans(problem.unknowns(TRUTH))
    blocks = list(problem.blocks(z, derivatives=True, plans=plans))
    return (
        np.concatenate([b.residual for b in blocks]),
        np.concatenate([b.jacobian for b in blocks if b.jacobian is not None]),
    )


def check_jacobian(problem: Problem) -> None:
    """Central differences in every unknown, the plan held still: 1e-6 of the column."""
    z = problem.unknowns(TRUTH)
    z[len(problem.free) :] += 0.1
    _, jacobian = stacked(problem, z)
    for k in range(problem.size):
        # Zeros and states enter linearly, so that a large step only lessens the rounding.
        h = 1e-5 * max(abs(z[k]), 0.1) if k < len(problem.free) else 0.1
        step = h * np.eye(problem.size)[k]
        slope = -(stacked(problem, z + step)[0] - stacked(problem, z - step)[0]) / (2 * h)
        scale = np.abs(slope).max()
        assert np.abs(jacobian[:, k] - slope).max() <= 1e-6 * scale + 1e-9, k


def test_zeros_alone_ask_for_no_derivatives(monkeypatch: pytest.MonkeyPatch) -> None:
    """With all parameters held and every log at rest the Jacobian is one for a log's own zero."""
    problem = arc(Muscle().parameters().with_fixed(TRUTH), log("a"), log("b"))
    asked = []
    respond = Muscle.response

    def response(*given: object, derivatives: bool, **named: object) -> object:
        asked.append(derivatives)
        return respond(*given, derivatives=derivatives, **named)  # type: ignore[arg-type]

    monkeypatch.setattr(Muscle, "response", response)
    check_jacobian(problem)
    assert problem.size == 4
    assert not any(asked)
    moving = arc(Muscle().parameters().with_fixed(TRUTH), log("a", moving=True))
    check_jacobian(moving)
    assert any(asked)


def test_layout_counts_every_unknown() -> None:
    """7 parameters, a zero per log and output, two states per segment that is not at rest."""
    problem = arc(None, log("a"), log("b", moving=True), log("c", stall=True))
    assert problem.at_rest == [True, False, True, False]
    assert problem.size == 7 + 3 * 2 + 2 * 2
    positions = [problem.zero_position(k, c) for k in range(3) for c in OUTPUTS]
    assert positions == list(range(7, 13))
    assert problem.n_samples == 3 * 120 * 2


def test_jacobian_of_everything() -> None:
    """Parameters on both scales, zeros, and starts relative to the equilibrium."""
    check_jacobian(arc(None, log("a"), log("b", moving=True), log("c", stall=True)))


def test_unknowns_and_theta_are_inverse() -> None:
    """Logarithms there and back, to rounding."""
    problem = arc()
    np.testing.assert_allclose(
        problem.theta(problem.unknowns(TRUTH)), list(TRUTH.values()), rtol=1e-13
    )


def test_names_belong_to_values_and_to_unknowns() -> None:
    """A value that is fixed has no unknown, and one on a logarithmic scale has its logarithm."""
    problem = arc(Muscle().parameters().with_values(TRUTH).with_fixed({"b1": TRUTH["b1"]}))
    z = problem.unknowns(TRUTH)
    assert problem.values(z) == pytest.approx(TRUTH)
    by_name = problem.free_by_name(z)
    assert set(by_name) == set(TRUTH) - {"b1"}
    assert by_name["a1"] == pytest.approx(np.log(TRUTH["a1"]))


def test_truth_has_no_residual_and_zeros_come_from_the_data() -> None:
    """The zeros' optimum is the mean residual: 0.4 in every channel, and then nothing is left."""
    problem = arc(None, log(zero=0.4))
    z = problem.unknowns(TRUTH)
    np.testing.assert_allclose(z[7:9], 0.4, rtol=1e-9)
    assert np.abs(stacked(problem, z)[0]).max() < 1e-9


def test_ties_follow_value_and_chain_rule() -> None:
    """c2 = 0.125·M^0.5 + 0.1·b2, and M1's slope includes it: against differences."""
    declared = arc().parameters
    tied = declared.replacing(replace(declared["c2"], tie="0.125*sqrt(M) + 0.1*b2"))
    problem = arc(tied)
    assert "c2" not in problem.free
    theta = problem.theta(problem.unknowns(TRUTH))
    assert theta[6] == pytest.approx(0.125 * np.sqrt(TRUTH["M"]) + 0.1 * TRUTH["b2"], rel=1e-12)
    check_jacobian(problem)


def test_tie_slope_at_zero_and_on_a_bound() -> None:
    """c2 = 0.3 + 0.1·b2: ∂c2/∂b2 = 0.1 at b2 = 0 (no size to scale a step with) and on a bound."""
    declared = arc().parameters
    tied = declared.replacing(replace(declared["c2"], tie="0.3 + 0.1*b2"))
    for value, upper in ((0.0, 300.0), (2.0, 2.0 + 0.0)):
        parameters = tied.replacing(replace(tied["b2"], value=0.0, upper=upper))
        problem = arc(parameters)
        z = problem.unknowns(TRUTH | {"b2": value})
        chain = problem.chain(z)
        column = problem.free.index("b2")
        assert chain[6, column] == pytest.approx(0.1, rel=1e-6)
        assert chain[5, column] == pytest.approx(1.0, rel=1e-6)


def test_ties_do_not_mix_between_threads() -> None:
    """Two threads at different points get the values of their own point, every time."""
    declared = arc().parameters
    problem = arc(declared.replacing(replace(declared["c2"], tie="2*M")))
    points = [problem.unknowns(TRUTH | {"M": m}) for m in (1e-3, 5e-3)] * 100
    with ThreadPoolExecutor(max_workers=4) as pool:
        thetas = list(pool.map(problem.theta, points))
    for theta in thetas:
        assert theta[6] == pytest.approx(2 * theta[0], rel=1e-12)
    found = [theta[0] for theta in thetas]
    np.testing.assert_allclose(found, [1e-3, 5e-3] * 100, rtol=1e-12)


def test_fixed_and_bounded_parameters() -> None:
    """A fixed one leaves the unknowns; bounds are on the scale of the search."""
    declared = arc().parameters.with_fixed({"M": 2e-3})
    declared = declared.replacing(replace(declared["c1"], lower=0.5, upper=3.0))
    problem = arc(declared)
    assert "M" not in problem.free
    lower, upper = problem.bounds()
    k = problem.free.index("c1")
    assert (lower[k], upper[k]) == (pytest.approx(np.log(0.5)), pytest.approx(np.log(3.0)))
    b2 = problem.free.index("b2")
    assert (lower[b2], upper[b2]) == (-300.0, 300.0)
    assert np.all(np.isinf(lower[len(problem.free) :]))


def test_masked_and_missing_samples_do_not_count() -> None:
    """A spike of 1e6 that is masked and a NaN leave the residuals of the others alone."""
    good = log()
    values = good.channels["angle"].values.copy()
    values[50] = np.nan
    values[60] = 1e6
    spoilt = Log.from_arrays(
        good.time_s,
        {
            "pressure": good.pressure_kpa,
            "angle": values,
            "contraction": good.channels["contraction"].values,
        },
        outputs=OUTPUTS,
    ).with_masked(np.arange(120) == 60)
    problem = arc(None, spoilt)
    assert problem.n_samples == 120 * 2 - 3
    r, jacobian = stacked(problem, problem.unknowns(TRUTH))
    assert np.abs(r).max() < 1e-9
    assert np.isfinite(jacobian).all()


def test_without_a_spring_the_state_is_absolute_and_there_is_no_zero() -> None:
    """Q = 0 has no equilibrium: a zero would be the same as the initial position."""
    time_s = np.arange(50) * 0.02
    data = {"force": np.sin(time_s), "position": 5.0 + time_s}
    data["position"][0] = np.nan
    problem = Problem(
        Oscillator(spring="none"),
        Oscillator(spring="none").parameters(),
        (Log.from_arrays(time_s, data, input="force", outputs=("position",)),),
    )
    assert not problem.zeros
    assert not problem.has_equilibrium
    assert problem.at_rest == [False]
    z = problem.unknowns({"M": 1.0, "N": 1.0, "offset": 0.0})
    assert z[3:].tolist() == [pytest.approx(5.02), 0.0]


def resting(shape: Array, noise: float, n: int = 200) -> bool:
    rng = np.random.default_rng(1)
    time_s = np.arange(n) * 0.02
    values = shape + noise * rng.standard_normal(n)
    made = Log.from_arrays(time_s, {"pressure": shape * 2, "contraction": values})
    spans = {"input": float(np.ptp(shape * 2)), "contraction": float(np.ptp(shape))}
    return starts_at_rest(made.segments()[0], spans)


def test_at_rest_detection() -> None:
    """Held for 0.3 s with noise of 1 % is rest; a ramp from the first sample is not."""
    t = np.arange(200) * 0.02
    assert resting(np.where(t < 1.0, 0.0, 50.0), 0.5)
    assert not resting(20.0 * t, 0.0)
    assert not resting(50.0 * np.sin(3 * t), 0.0)
    assert not resting(np.where(t < 0.1, 0.0, 50.0), 0.0)


@pytest.mark.parametrize(
    ("fall", "noise", "rests"),
    [(0.9, 0.01, False), (0.9, 0.6, True), (0.2, 0.01, True), (1.1, 0.6, False)],
)
def test_how_far_an_output_may_move_at_rest(fall: float, noise: float, rests: bool) -> None:
    """Of a range of 50: less than a half per cent is rest, more than 2 % is none, and in between
    what four standard errors of the noise let be seen. The output falls so much in the second
    before the input moves."""
    time_s = np.arange(200) * 0.02
    pressure = np.where(time_s < 1.0, 0.0, 100.0)
    values = np.where(time_s < 1.0, -fall * time_s / 0.7, 50.0)  # windows are 0.7 s apart
    values += noise * np.random.default_rng(2).standard_normal(200)
    made = Log.from_arrays(time_s, {"pressure": pressure, "contraction": values})
    spans = {"input": 100.0, "contraction": 50.0}
    assert starts_at_rest(made.segments()[0], spans) is rests


@pytest.mark.parametrize(("swing", "rests"), [(2.0, False), (1.0, True)])
@pytest.mark.parametrize("noise", [0.01, 0.6])
def test_what_swings_about_one_place_does_not_rest(swing: float, noise: float, rests: bool) -> None:
    """Of a range of 50, by a standard deviation of more than 2 %; both ends have the same mean."""
    time_s = np.arange(200) * 0.02
    still = time_s < 1.2
    values = np.where(
        still, np.sqrt(2.0) * swing * 0.72 * np.sin(2.0 * np.pi * time_s / 0.15), 50.0
    )
    values += noise * np.random.default_rng(3).standard_normal(200)
    made = Log.from_arrays(time_s, {"pressure": 100.0 * ~still, "contraction": values})
    spans = {"input": 100.0, "contraction": 50.0}
    assert starts_at_rest(made.segments()[0], spans) is rests


def test_a_spike_does_not_end_a_rest() -> None:
    """It is in the noise between neighbours as much as in the whole variance."""
    time_s = np.arange(200) * 0.02
    values = np.where(time_s < 1.2, 0.0, 50.0)
    values += 0.1 * np.random.default_rng(5).standard_normal(200)
    values[30] += 10.0
    made = Log.from_arrays(time_s, {"pressure": 2.0 * (time_s >= 1.2), "contraction": values})
    assert starts_at_rest(made.segments()[0], {"input": 2.0, "contraction": 50.0})


def test_a_log_whose_outputs_are_missing_at_first_is_not_at_rest() -> None:
    """No finite sample in the window: nothing shows that it rests."""
    t = np.arange(200) * 0.02
    values = np.where(t < 0.5, np.nan, t)
    made = Log.from_arrays(t, {"pressure": np.where(t < 1, 0.0, 9.0), "contraction": values})
    assert not starts_at_rest(made.segments()[0], {"input": 9.0, "contraction": 3.5})


def test_other_segments_are_the_same_problem_with_other_states() -> None:
    """Of two logs the second in two pieces: the first has no zero then, and the later piece begins
    in motion, with two unknowns of its own."""
    whole = arc(None, log("one"), log("two"))
    assert whole.at_rest == [True, True]
    second = whole.segments[1]
    pieces = [second.part(slice(0, 20)), second.part(slice(20, None))]
    found = Problem.with_segments(whole, pieces, [(1, True), (1, False)])
    assert [one.name for one in found.logs] == ["two"]
    assert found.owner == [0, 0]
    assert found.at_rest == [True, False]
    assert found.size == len(whole.free) + len(found.outputs) + 2
    assert found.n_samples == sum(int(s.used[n].sum()) for s in pieces for n in found.outputs)
    assert (found.free, found.zeros) == (whole.free, whole.zeros)
    assert whole.segments[1] is second
    assert len(whole.logs) == 2
    same = Problem.with_segments(whole, whole.segments)
    assert (same.size, same.at_rest, same.logs) == (whole.size, whole.at_rest, whole.logs)
