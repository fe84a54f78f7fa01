"""Which logs hold the same samples."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear_motion import linear_log

from softid.diagnosis import diagnose
from softid.errors import UsageError
from softid.identification import fit
from softid.identification.preparation import same_stretch
from softid.log import Log, Source

LOG = linear_log(noise=0.01)


@pytest.mark.parametrize(
    ("a", "b", "expected"),
    [
        (LOG, replace(LOG, name="again"), True),
        (LOG, replace(LOG, name="from-file", source=Source("a.csv", "a" * 64, "csv")), True),
        (LOG, LOG.between(3.0, 8.0), True),
        (LOG.between(0.0, 8.0), LOG.between(3.0, 20.0), True),
        (LOG.between(0.0, 8.0), LOG.between(8.0, 20.0), False),
        (LOG, linear_log(noise=0.01, seed=1), False),
        (LOG, LOG.every(2), False),
    ],
)
def test_logs_of_arrays_are_known_by_their_samples(a: Log, b: Log, expected: bool) -> None:
    """As those of a file are by its bytes: all of them, or those of their common time."""
    assert same_stretch(a, b) == same_stretch(b, a) == expected


def test_two_rests_are_two_logs() -> None:
    """Nothing moves there, so that equal samples do not say that they are the same."""
    still = {"pressure": np.zeros(100), "angle": np.full(100, np.nan)}
    one, other = (Log.from_arrays(np.arange(100) / 50.0, still, name=name) for name in "ab")
    assert not same_stretch(one, other)


def test_the_same_arrays_are_not_fitted_and_held_out() -> None:
    """Under another name they judge nothing."""
    again = replace(LOG, name="again")
    with pytest.raises(UsageError, match="the same samples as linear-0, which is fitted"):
        fit(LOG, model="oscillator", hold_out=again)
    with pytest.raises(UsageError, match="the same samples as linear-0"):
        diagnose(LOG, model="oscillator", hold_out=again, effects=["delay"])
