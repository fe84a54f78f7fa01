"""A log of two recorders is judged by the rows of the one that has the outputs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from softid.quality import inspect
from softid.quality.two_recorders import at_output_rows
from softid.readers import load

STEP_S = 2.0
"""Length of a held level: an output with a time constant of 0.15 s is at rest long before."""


@pytest.fixture
def merged(tmp_path: Path) -> Path:
    """Pressure at 100 Hz, angle at 100 Hz 3 ms later: x' = (0.4 p − x)/0.15 s, by hand."""
    rng = np.random.default_rng(3)
    levels = rng.uniform(10.0, 140.0, 20)

    def level(k: int) -> float:
        return float(levels[k]) if k >= 0 else 0.0

    rows = ["time_s,pressure_kpa,angle_deg"]
    angle_at_step = 0.0
    for k in range(levels.size):
        for i in range(int(100 * STEP_S)):
            since_s = 0.01 * i
            noisy = level(k) + 0.05 * rng.standard_normal()
            rows.append(f"{STEP_S * k + since_s:.4f},{noisy:.5f},")
            late_s = since_s + 0.003
            rest = 0.4 * level(k)
            angle = rest + (angle_at_step - rest) * np.exp(-late_s / 0.15)
            angle += 0.05 * rng.standard_normal()
            rows.append(f"{STEP_S * k + late_s:.4f},,{angle:.5f}")
        angle_at_step = 0.4 * level(k)
    path = tmp_path / "merged.csv"
    path.write_text("\n".join(rows))
    return path


def test_it_is_judged_by_the_rows_of_its_outputs(merged: Path) -> None:
    """The rows of both lie 3 and 7 ms apart, which is the rate of neither."""
    found = inspect(load(merged))
    assert found.sampling.rate_hz == pytest.approx(100.0)
    assert found.sampling.jitter < 1e-6
    assert found.ability("damping").possible == "yes"
    assert not {issue.code for issue in found.issues} & {"missing-samples", "close-samples"}
    (pressure,) = [channel for channel in found.channels if channel.name == "pressure"]
    assert pressure.noise_std == pytest.approx(0.05, rel=0.4)


def test_a_log_of_one_recorder_is_judged_as_it_is(tmp_path: Path) -> None:
    path = tmp_path / "one.csv"
    path.write_text("time_s,pressure_kpa,angle_deg\n0,0,0\n0.1,1,\n0.2,2,1\n")
    log = load(path)
    assert at_output_rows(log) is log
