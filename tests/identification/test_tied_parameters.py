"""Ties that leave their bounds: no silent clipping, but a rejected step or a sentence."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from softid import Log, fit
from softid.errors import IdentificationError, UsageError
from softid.fitters.problem import Problem
from softid.models import Oscillator
from softid.parameters import ParameterSet

TRUTH = {"M": 5.0, "N": 30.0, "Q": 100.0}


def log() -> Log:
    """Steps of 100 kPa into an oscillator of `TRUTH`, by small steps, with 2 mrad of noise."""
    t = np.arange(0.0, 8.0, 0.02)
    u = np.where(t % 4.0 < 2.0, 0.0, 100.0)
    x = v = 0.0
    angle = np.zeros_like(t)
    for k in range(1, t.size):
        for _ in range(20):
            v += 1e-3 * (u[k - 1] - TRUTH["N"] * v - TRUTH["Q"] * x) / TRUTH["M"]
            x += 1e-3 * v
        angle[k] = x
    noise = 2e-3 * np.random.default_rng(1).standard_normal(t.size)
    return Log.from_arrays(t, {"pressure": u, "angle": angle + noise})


def tied(
    tie: str, *, lower: float = 1e-15, upper: float = 1e15, stiffness: float = 100.0
) -> ParameterSet:
    declared = Oscillator().parameters()
    n = replace(
        declared["N"], tie=tie, lower=lower, upper=upper, value=float(np.clip(1.0, lower, upper))
    )
    return declared.replacing(n).replacing(replace(declared["Q"], value=stiffness))


@pytest.mark.parametrize(
    ("tie", "upper", "told"),
    [
        ("0.3*Q", 10.0, r"takes N out of its bounds, 1e-15 to 10, .*got 30.*widen the bounds of N"),
        ("-Q", 1e15, r"the tie -Q takes N out of its bounds.*got -100.*stays positive"),
        ("log(Q)/0", 1e15, r"the tie log\(Q\)/0 gives N no finite value"),
        ("Q**Q**Q**Q", 1e15, r"gives N no finite value at Q = [0-9.]+, where the search begins"),
    ],
)
def test_a_tie_that_cannot_be_followed_at_the_start_is_refused(
    tie: str, upper: float, told: str
) -> None:
    """One sentence with the tie, its value and the bound, not the value at the bound."""
    with pytest.raises(UsageError, match=told):
        fit(log(), model="oscillator", parameters=tied(tie, upper=upper, stiffness=1.0))


@pytest.mark.parametrize(
    ("lower", "upper", "stiffness"), [(40.0, 1e15, 200.0), (1e-15, 20.0, 30.0)]
)
def test_a_search_that_ends_against_a_tie_is_told(
    lower: float, upper: float, stiffness: float
) -> None:
    """N = 0.3·Q is 30 at the truth: a start on the allowed side is led to the bound."""
    parameters = tied("0.3*Q", lower=lower, upper=upper, stiffness=stiffness)
    bound = lower if lower > 1.0 else upper
    with pytest.raises(IdentificationError, match=rf"beyond the bound {bound:g} of N.*0\.3\*Q"):
        fit(log(), model="oscillator", parameters=parameters)


def test_a_tie_within_its_bounds_is_followed() -> None:
    """Bounds that it keeps change nothing: Q is the truth's to 1 %, for Euler's steps."""
    found = fit(log(), model="oscillator", parameters=tied("0.3*Q", lower=20.0, upper=40.0))
    q = found.parameter("Q")
    assert found.success
    assert q.value == pytest.approx(TRUTH["Q"], rel=0.01)
    assert found.values["N"] == pytest.approx(0.3 * q.value, rel=1e-12)


def test_what_is_tied_and_what_is_computed_have_errors() -> None:
    """N = 0.3·Q errs by 0.3 of Q's error; 1/Q errs by its relative error, N/Q and a tie of √Q by
    none and by half of it."""
    found = fit(log(), model="oscillator", parameters=tied("0.3*Q"))
    n, q = found.parameter("N"), found.parameter("Q")
    assert q.stderr is not None
    assert q.ci95 is not None
    assert (n.verdict, n.stderr) == ("tied", pytest.approx(0.3 * q.stderr, rel=1e-6))
    assert n.ci95 == pytest.approx(tuple(0.3 * end for end in q.ci95), rel=1e-6)
    gain = found.derived_stderr["static_gain"]
    assert gain == pytest.approx(found.derived["static_gain"][0] * q.stderr / q.value, rel=1e-4)
    assert found.derived_stderr["time_constant"] == pytest.approx(0.0, abs=1e-6)
    assert found.derived_stderr["natural_frequency"] is not None
    root = fit(log(), model="oscillator", parameters=tied("3*sqrt(Q)"))
    n, q = root.parameter("N"), root.parameter("Q")
    assert n.stderr is not None
    assert q.stderr is not None
    assert n.stderr / n.value == pytest.approx(0.5 * q.stderr / q.value, rel=1e-6)


def test_what_rests_on_an_unknown_parameter_has_no_error() -> None:
    """Q on its bound has no error, nor has what is tied to it."""
    parameters = tied("0.3*Q")
    bounded = parameters.replacing(replace(parameters["Q"], value=80.0, upper=90.0))
    found = fit(log(), model="oscillator", parameters=bounded)
    assert found.parameter("Q").at_bound
    assert found.parameter("N").stderr is None
    assert found.derived_stderr["static_gain"] is None


def test_a_point_that_breaks_a_tie_has_no_response_and_its_slope_stays() -> None:
    """NaN where N = 0.3·Q passes 10, and no clipped side of the difference on the bound itself."""
    problem = Problem(Oscillator(), tied("0.3*Q", upper=10.0), [log()])
    column = problem.free.index("Q")
    outside = problem.free_unknowns(TRUTH | {"Q": 40.0})
    assert np.isnan(problem.theta(outside)[1])
    assert problem.plans(outside) == [None]
    blocks = list(problem.blocks(outside, derivatives=True))
    assert all(np.isnan(block.residual).all() for block in blocks)
    on_it = problem.free_unknowns(TRUTH | {"Q": 10.0 / 0.3})
    assert problem.theta(on_it)[1] == pytest.approx(10.0, rel=1e-12)
    assert problem.chain(on_it)[1, column] == pytest.approx(10.0, rel=1e-6)
