"""The rounding of a reading that no noise blurs is no misfit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear_motion import at_truth, linear_log

from softid.diagnosis import diagnose
from softid.diagnosis.residual.rounding_floor import rounding_floor
from softid.diagnosis_results import Verdict
from softid.log import Log
from softid.synthesis import hidden_pair
from softid.synthesis.rig import Rig

STEP = 0.05


def rounded(log: Log) -> Log:
    angle = log.channels["angle"]
    values = STEP * np.round(angle.values / STEP)
    return replace(log, channels={**log.channels, "angle": replace(angle, values=values)})


def test_power_of_the_rounding() -> None:
    """Closed form: q²/12, and what the truth leaves of a rounded log is about that."""
    model = at_truth(rounded(linear_log()))
    floor = rounding_floor(model)
    assert floor is not None
    assert floor.variance == pytest.approx(STEP**2 / 12.0, rel=0.01)
    (block,) = model.problem.blocks(model.minimum.point, derivatives=False)
    moving = np.abs(np.gradient(linear_log().channels["angle"].values)) > 1e-3
    assert np.mean(block.residual[moving] ** 2) == pytest.approx(floor.variance, rel=0.2)


def test_long_rests_are_few_draws() -> None:
    """By hand: runs of 90 and ten of 1 are 100²/(90² + 10) draws, with 0.8 over them."""
    log = linear_log(samples=100)
    values = STEP * np.concatenate((np.zeros(90), np.tile([1.0, 2.0, 3.0, 4.0, 5.0], 2)))
    channels = {**log.channels, "angle": replace(log.channels["angle"], values=values)}
    floor = rounding_floor(at_truth(replace(log, channels=channels)))
    assert floor is not None
    assert floor.relative_sd == pytest.approx(np.sqrt(0.8 * (90.0**2 + 10.0) / 100.0**2))


def test_what_lies_on_no_grid_has_none() -> None:
    assert rounding_floor(at_truth(linear_log(noise=0.01))) is None


@pytest.mark.slow
@pytest.mark.parametrize(("names", "verdict"), [([], Verdict.ADEQUATE), (["creep"], Verdict.NAMED)])
def test_steps_of_a_fiftieth_of_the_range(names: list[str], verdict: Verdict) -> None:
    """Nothing but rounding is left of the clean log, and of the other what creeps is found."""
    rig = Rig(noise=0.0, pressure_noise_kpa=0.0, quantum=0.02)
    pair = hidden_pair(names, seed=2, rig=rig)
    found = diagnose(pair.logs[0], hold_out=[pair.logs[1]], model="muscle")
    assert found.verdict is verdict
    assert [cause.effect for cause in found.causes] == names
