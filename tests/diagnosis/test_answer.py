"""What an answer says of causes that others need."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from handmade_diagnosis import FRICTION
from handmade_searches import base_fit, chain_of

from softid.diagnosis import answer, diagnose
from softid.synthesis import hidden_pair


@pytest.mark.parametrize(
    ("interval", "is_told"),
    [((0.1, 0.9), True), ((0.0, 0.9), True), ((-0.1, 0.9), False), (None, True)],
    ids=["gain", "no loss", "perhaps a loss", "too few samples"],
)
def test_what_others_leave_without_a_cause_speaks_for_it_where_it_is_no_loss(
    interval: tuple[float, float] | None, is_told: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first of two causes gains nothing alone. An interval that begins at 0 holds no loss, for
    that is where it is cut off if the error falls throughout the logs."""
    alone = replace(FRICTION, holdout_rmse_after=FRICTION.holdout_rmse_before)
    monkeypatch.setattr(answer, "refit_without", lambda *args: None)
    monkeypatch.setattr(answer, "gain_interval", lambda *args: interval)
    errors = np.ones(10)
    held_out: Any = SimpleNamespace(first_errors=lambda model: errors, rms=lambda model: 1.7)
    chain = chain_of("coulomb_friction", "delay")
    found, _ = answer._with_errors_without(
        (alone, FRICTION), chain, base_fit(), held_out, errors, ()
    )
    assert found.holdout_rmse_without == (1.7 if is_told else None)


def test_a_term_that_the_base_could_not_see_is_known_beside_a_cause() -> None:
    """Known truth: behind a hysteresis the inertia is lost, and beside it it is known to 2 %."""
    pair = hidden_pair(
        ["hysteresis"], seed=226000, model="oscillator", protocol="triangles", size=2.0
    )
    train, hold_out = pair.logs
    found = diagnose(train, hold_out=[hold_out], model="oscillator", effects=["hysteresis"])
    assert found.extended is not None
    (before, after) = (
        next(p for p in fit.parameters if p.name == "M") for fit in (found.base, found.extended)
    )
    assert before.verdict == "not identified"
    assert after.verdict == "identified"
    assert after.ci95 is not None
    assert after.ci95[0] < pair.actuator.values["M"] < after.ci95[1]
    assert "not-seen" not in {issue.code for issue in found.issues}
