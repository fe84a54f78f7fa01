"""Outputs that saturate or stand still, as a fit is told of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear_motion import linear_log

from softid.identification import fit
from softid.log import Log
from softid.quality import stuck_outputs


def with_angle(values: np.ndarray) -> Log:
    log = linear_log()
    return replace(
        log, channels={**log.channels, "angle": replace(log.channels["angle"], values=values)}
    )


def noisy() -> np.ndarray:
    return linear_log(noise=0.01).channels["angle"].values


@pytest.mark.parametrize(
    ("values", "code"),
    [
        (noisy(), None),
        (np.minimum(noisy(), 0.9), "saturation"),
        (np.where(np.arange(1000) // 100 == 4, noisy()[400], noisy()), "frozen-channel"),
    ],
)
def test_what_an_output_is_stuck_at(values: np.ndarray, code: str | None) -> None:
    """Cut off at 0.9 of 1.6 rad, or one value for 2 s; a fit carries it among its issues."""
    log = with_angle(values)
    codes = [issue.code for issue in stuck_outputs(log)]
    assert codes == ([code] if code else [])
    told = {issue.code for issue in fit(log, model="oscillator").issues}
    assert (code in told) is (code is not None)
    if code:
        (issue,) = stuck_outputs(log)
        assert issue.message.startswith(f"{log.name}: angle ")
