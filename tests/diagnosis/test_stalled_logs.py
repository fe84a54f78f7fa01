"""Diagnoses of logs whose clock stalls."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from softid.diagnosis import diagnose
from softid.diagnosis_results import Verdict
from softid.log import Log
from softid.synthesis import hidden_pair

SHORTEST_S, LONGEST_S = 0.6, 2.5
STALLS = 3


def stalled(log: Log, rng: np.random.Generator) -> Log:
    """The log without three spans of 0.6 to 2.5 s."""
    since_s, kept = log.time_s - log.time_s[0], np.ones(len(log), bool)
    for first_s in rng.uniform(1.0, float(since_s[-1]) - LONGEST_S - 1.0, STALLS):
        kept &= np.abs(since_s - first_s - 0.5 * LONGEST_S) > 0.5 * rng.uniform(
            SHORTEST_S, LONGEST_S
        )
    channels = {k: replace(c, values=c.values[kept]) for k, c in log.channels.items()}
    return replace(log, time_s=log.time_s[kept], channels=channels, masked=None)


DRAWS = [
    pytest.param(
        hidden,
        seed,
        marks=() if seed == 1 and hidden not in ("creep", "softening") else pytest.mark.slow,
        id=f"{hidden}-{seed}",
    )
    for seed in range(1, 5)
    for hidden in ("softening", "creep", "hysteresis", "ageing", "sensor_lag", "nothing")
    if seed > 1 or hidden in ("softening", "creep", "nothing")
]


@pytest.mark.parametrize(("hidden", "seed"), DRAWS)
def test_a_cause_is_found_through_stalls(hidden: str, seed: int) -> None:
    """What remembers does not begin anew behind a stall; nothing hidden is nothing found."""
    names = [] if hidden == "nothing" else [hidden]
    rng = np.random.default_rng((seed, 17))
    fitted, held_out = (stalled(log, rng) for log in hidden_pair(names, seed=6000 + seed).logs)
    assert len(fitted.segments()) > 1
    found = diagnose(fitted, hold_out=held_out, model="muscle")
    if not names:
        assert found.verdict is Verdict.ADEQUATE
        return
    ties = {name for tie in found.alternatives for name in tie.effects}
    named = {cause.effect for cause in found.causes}
    assert hidden in ties if found.verdict is Verdict.AMBIGUOUS else named == {hidden}
