"""Fits of measured logs from real rigs: as good as those by other code, and what is said.

The figures to reach come from a rough script that fitted the same seven parameters and one zero per
log: 84/78/89 → 77 (three-chamber arm), 91 to 95 → 93 to 94 (gripper), 81/90 → 79/68 (two segments).
softid reaches them to within a point, or more. Floors lie half a point below what it reached, so
that a fit that gets worse is seen where the script did worse, too. Fits that leave out the repeats
of a camera have no such figure; their docstrings say what was reached with the repeats.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest

from softid.identification import fit
from softid.log import Log
from softid.readers import load
from softid.results import FitResult, FitStatistics
from softid.validation import validate


def logs(folder: Path, names: list[str]) -> list[Log]:
    return [load(folder / f"{name}.csv") for name in names]


def percent(result: FitResult) -> dict[str, float]:
    return {row.log: row.fit_percent for row in result.statistics}


def fitted(folder: Path, fit_to: list[str], held: list[str]) -> FitResult:
    result = fit(logs(folder, fit_to), model="muscle", hold_out=logs(folder, held))
    assert result.success
    assert [row.in_sample for row in result.statistics] == [True] * len(fit_to) + [False] * len(
        held
    )
    return result


def test_three_chamber_arm(measured: Path) -> None:
    """Reached 83.8/78.0/88.6 → 76.5; the floor leaves half a point for other machines."""
    names = [f"0730_step_{k}" for k in (1, 2, 4)]
    result = fitted(measured / "three-chamber-arm", names, ["0730_step_3"])
    found = percent(result)
    floors = {"0730_step_1": 83.3, "0730_step_2": 77.5, "0730_step_4": 88.1, "0730_step_3": 76.0}
    assert all(found[name] > floor for name, floor in floors.items()), found


def test_an_overdamped_arm_has_no_mass_to_show(measured: Path) -> None:
    """Time constants of a second at 60 Hz: M runs to zero, and the fit says so and goes on."""
    result = fit(logs(measured / "three-chamber-arm", ["0730_step_2"]), model="muscle")
    assert result.model.options["order"] == "first"
    assert result.parameter("M").verdict == "not identified"
    assert "not-seen" in {issue.code for issue in result.issues}


def test_leaving_the_fitted_range_is_called_extrapolation(measured: Path) -> None:
    """Fitted up to 105 kPa, the held-out log reaches 140: 21 % in the rough script too."""
    names = [f"0730_step_{k}" for k in (1, 2, 3)]
    result = fitted(measured / "three-chamber-arm", names, ["0730_step_4"])
    assert percent(result)["0730_step_4"] < 50.0
    (issue,) = [issue for issue in result.issues if issue.code == "extrapolation"]
    assert "0730_step_4" in issue.message
    assert "139.8 kPa" in issue.message


def test_gripper_finger(measured: Path) -> None:
    """Reached 88.3 to 95.5 → 90.1 to 95.4, but for the level at which the finger hardly moves.

    The camera repeats its angle for some samples and then jumps. With the repeats in the residuals
    it was 91.0 to 94.7 → 92.2 to 93.6, to the digit what scipy's least_squares on an independent
    simulation of the same law reaches; without them the mean held out is 93.4 instead of 92.8.
    """
    held = [f"calibration_flex_{k}" for k in (60, 100, 140, 180)]
    names = [f"calibration_flex_{k}" for k in (40, 80, 120, 160, 200)]
    found = percent(fitted(measured / "gripper-finger", names, held))
    assert min(found[name] for name in names) > 88.0
    assert min(found[name] for name in held) > 89.6
    assert np.mean([found[name] for name in held]) > 93.0


@pytest.mark.slow
@pytest.mark.parametrize("rate_hz", [30.0, 100.0])
def test_a_uniform_grid_is_not_needed_for_the_gripper_finger(
    measured: Path, rate_hz: float
) -> None:
    """The same logs interpolated to 30 Hz reach 91.7 to 95.2 → 92.9 to 94.6, to 100 Hz 91.3 to 95.1
    → 92.5 to 94.2: straight lines between the samples smooth the camera's jumps. On the frames of
    the held-out logs these models leave 1.01 deg rms, and one fitted to frames 1.03.
    """
    names = [f"calibration_flex_{k}" for k in (40, 80, 120, 160, 200)]
    held = [f"calibration_flex_{k}" for k in (60, 100, 140, 180)]
    smooth = [uniform(log, rate_hz) for log in logs(measured / "gripper-finger", names)]
    resampled = validate(fit(smooth, model="muscle"), logs(measured / "gripper-finger", held))
    plain = fitted(measured / "gripper-finger", names, held)
    on_frames = rms([row for row in plain.statistics if not row.in_sample])
    assert on_frames == pytest.approx(rms(resampled.statistics), rel=0.04)


def uniform(log: Log, rate_hz: float) -> Log:
    time_s = np.arange(log.time_s[0], log.time_s[-1], 1.0 / rate_hz)
    angle = np.interp(time_s, log.time_s, log.channels["angle"].values)
    pressure = np.interp(time_s, log.time_s, log.pressure_kpa)
    return Log.from_arrays(time_s, {"pressure": pressure, "angle": angle}, name=log.name)


def rms(statistics: Iterable[FitStatistics]) -> float:
    """Root mean square of what several logs leave together."""
    squares = [row.n * row.rmse**2 for row in statistics]
    return float(np.sqrt(sum(squares) / sum(row.n for row in statistics)))


@pytest.mark.slow
def test_two_segment_arm(measured: Path) -> None:
    """Reached 88.0/90.6 → 83.8/69.6. The angle of the April logs repeats each reading twice; with
    the repeats in the residuals it was 86.1/91.7 → 80.5/70.2."""
    result = fitted(measured / "two-segment-arm", ["Jan5_1", "apr4_1"], ["Jan5_2", "apr4_2"])
    found = percent(result)
    floors = {"Jan5_1": 87.5, "apr4_1": 90.0, "Jan5_2": 83.0, "apr4_2": 69.0}
    assert all(found[name] > floor for name, floor in floors.items()), found


def test_a_drive_is_recognised_as_a_mass_without_spring(measured: Path) -> None:
    """The published offset is −3.2 N; without Coulomb friction M is just within its interval."""
    result = fit(load(measured / "linear-drive-friction" / "DATA_EMPS.csv"))
    assert result.model.options["spring"] == "none"
    assert result.parameter("offset").value == pytest.approx(-3.2, abs=0.3)
    interval = result.parameter("M").ci95
    assert interval is not None
    assert interval[0] < 0.0951 < interval[1]


def test_dropped_digits_are_left_out(measured: Path) -> None:
    """Two samples of this log lost their first digit on the serial line."""
    log = load(measured / "pneunet-finger-bendsensor" / "Sin_dataset_2.csv")
    result = fit(log, model="polynomial")
    (issue,) = [issue for issue in result.issues if issue.code == "drop-out"]
    assert issue.message.startswith("Sin_dataset_2: 2 samples are drop-outs")
