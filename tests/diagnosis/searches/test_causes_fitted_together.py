"""A slow log shows a cause and hardly the motion; a fast one tells whether more is missing."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

from softid.diagnosis.base.base_fit import Recordings, Request
from softid.diagnosis.searches.cause_search import CauseSearch
from softid.diagnosis.searches.fitted_together import TOLD_TOGETHER, causes_fitted_together
from softid.effects import effects_of
from softid.errors import Issue
from softid.log import Log, LogSet

Array = npt.NDArray[np.float64]

PERIOD_S, SUBSTEPS = 0.01, 10
TIME_S = np.arange(3000) * PERIOD_S
SINE = 90.0 - 90.0 * np.cos(2.0 * np.pi * 0.1 * np.maximum(TIME_S - 2.0, 0.0))
SQUARE = 92.5 + 82.5 * np.clip(40.0 * np.sin(np.pi * TIME_S / 2.0), -1.0, 1.0)
"""Each edge takes 32 ms, as behind a valve."""


def against_a_wall(pressure: Array, *, stiffness: float) -> Array:
    """M ẍ + N ẋ + Q x + kw (x − xw)₊ = p, M = 4, N = 50, kw = 3000, xw = 0.4, in midpoint steps."""
    fine_s = np.arange((TIME_S.size - 1) * SUBSTEPS * 2 + 1) * PERIOD_S / SUBSTEPS / 2.0
    u = np.interp(fine_s, TIME_S, pressure).tolist()
    h = PERIOD_S / SUBSTEPS

    def acceleration(x: float, v: float, p: float) -> float:
        return (p - 50.0 * v - stiffness * x - 3000.0 * max(x - 0.4, 0.0)) / 4.0

    x, v, found = u[0] / stiffness, 0.0, []
    for k in range(0, len(u) - 2, 2):
        if k % (2 * SUBSTEPS) == 0:
            found.append(x)
        half_v = v + 0.5 * h * acceleration(x, v, u[k])
        half_x = x + 0.5 * h * v
        x, v = x + h * half_v, v + h * acceleration(half_x, half_v, u[k + 1])
    return np.array([*found, x])


def recorded(
    pressure: Array, name: str, *, delay_s: float = 0.0, stiffness: float = 360.0, seed: int
) -> Log:
    """With 0.4 kPa of noise of the gauge, and 2 mrad of the angle."""
    rng = np.random.default_rng((seed, len(name)))
    angle = against_a_wall(np.interp(TIME_S - delay_s, TIME_S, pressure), stiffness=stiffness)
    angle += 0.002 * rng.standard_normal(TIME_S.size)
    gauge = pressure + 0.4 * rng.standard_normal(TIME_S.size)
    return Log.from_arrays(TIME_S, {"pressure": gauge, "angle": angle}, name=name)


def asked(train: Log, judge: Log) -> Issue | None:
    """What a fit to both says of an oscillator with a contact that was fitted to one."""
    request = Request("oscillator", None, 0, lambda message, fraction: None)
    recordings = Recordings(LogSet((train,)), (judge,))
    base = request.fit_base(recordings.logs, recordings.hold_out, thorough=False)
    search = CauseSearch(base, effects_of(("contact",)), 0, lambda message, fraction: None)
    model = search.first_cause().final
    assert model.keys == ("contact",)
    return causes_fitted_together(recordings, request, search, model, search.remainder_of(model))


@pytest.mark.parametrize("seed", [2, 5, 9])
def test_a_contact_is_all_where_only_the_motion_was_not_seen(seed: int) -> None:
    """Known truth: an oscillator and a wall. A fit to a slow sine errs in the square wave, for its
    inertia is not seen; with a contact, fitted to both, it leaves noise on both. (With half of all
    seeds the noise lets it be seen, and nothing is asked.)"""
    found = asked(recorded(SINE, "sine", seed=seed), recorded(SQUARE, "square", seed=seed))
    assert found is not None
    assert found.code == TOLD_TOGETHER
    nothing = "nothing else is missing from the oscillator model with its cause, for fitted to sine"
    assert nothing in found.message
    assert "M is 4" in found.message or "M is 3.9" in found.message


@pytest.mark.parametrize(
    ("of_both", "of_one"),
    [({"delay_s": 0.03}, {}), ({}, {"stiffness": 372.0})],
    ids=["delay", "another actuator"],
)
@pytest.mark.parametrize("seed", [2, 3])
def test_what_is_missing_beside_a_contact_is_not_told_away(
    of_both: dict[str, float], of_one: dict[str, float], seed: int
) -> None:
    """Known truth: a wall, and a delay that a slow sine does not show, or a stiffness that differs
    by a thirtieth."""
    train = recorded(SINE, "sine", seed=seed, **of_both)
    assert asked(train, recorded(SQUARE, "square", seed=seed, **of_both, **of_one)) is None


def test_a_square_wave_asks_for_no_second_fit() -> None:
    """Known truth: square waves foretell each other, so the question does not arise."""
    train = recorded(SQUARE, "train", seed=1)
    assert asked(train, recorded(SQUARE[::-1].copy(), "square", seed=1)) is None
