"""`softid simulate`: the library's numbers as CSV, also for a log of pressure alone."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from desk import Outcome
from handmade import MUSCLE_VALUES, fit_result

from softid.prediction import simulate as predict
from softid.readers import load
from softid.records import load_params, save_fit
from softid.results import LogNuisance
from softid.simulation import simulate

Cli = Callable[..., Outcome]
ZERO_RAD = 0.1 / 3  # the hand-made sensor zero of both logs


@pytest.fixture
def plan(tmp_path: Path) -> Path:
    """Time and pressure, nothing measured; the highest pressure is that of the fit."""
    path = tmp_path / "plan.csv"
    rows = [f"{0.02 * k:.2f},{min(10 * k, 80)}" for k in range(30)]
    path.write_text("time_s,pressure_kpa\n" + "\n".join(rows) + "\n")
    return path


def table(text: str) -> dict[str, np.ndarray]:
    rows = list(csv.reader(io.StringIO(text)))
    return {
        name: np.array([float(row[k] or "nan") for row in rows[1:]])
        for k, name in enumerate(rows[0])
    }


def test_pressure_alone_is_enough(softid: Cli, params: Path, plan: Path) -> None:
    """Starts at the sigmoid's value at rest plus the fitted logs' zero, and rises below it."""
    told = softid("simulate", params, "--input", plan)
    assert (told.code, told.err) == (0, "")
    found = table(told.out)
    assert list(found) == ["time_s", "pressure_kpa", "angle_deg"]
    pressure_kpa = found["pressure_kpa"]
    assert pressure_kpa.tolist() == [min(10.0 * k, 80.0) for k in range(30)]
    theta = np.array(list(MUSCLE_VALUES.values()))
    static = load_params(params).build_model().static_output(theta, pressure_kpa, "angle")
    first = (static[0] + ZERO_RAD) * 180 / np.pi
    assert found["angle_deg"][0] == pytest.approx(first, rel=1e-12)
    assert np.all(np.diff(found["angle_deg"]) > 0)
    assert found["angle_deg"][-1] < (static[-1] + ZERO_RAD) * 180 / np.pi


def test_a_measured_log_is_shown_beside(softid: Cli, params: Path, tmp_path: Path) -> None:
    """Simulated numbers are the library's, measured ones the file's."""
    path = tmp_path / "other.csv"
    path.write_text("time_s,pressure_kpa,angle_deg\n0,0,1.5\n0.1,40,\n0.2,80,3.25\n")
    told = softid("simulate", params, "--input", path)
    found = table(told.out)
    # degrees to radians and back costs one rounding each way
    np.testing.assert_allclose(found["measured_angle_deg"], [1.5, np.nan, 3.25], rtol=1e-15)
    saved = load_params(params)
    zero = LogNuisance("other", {"angle": ZERO_RAD}, {"angle": None}, ())
    ours = simulate(saved.build_model(), saved.values, load(path), nuisance=zero)
    factor = saved.display["angle"][1]
    np.testing.assert_allclose(
        found["angle_deg"], ours.outputs["angle"] * factor, rtol=0, atol=1e-12
    )


def test_a_gauge_that_repeats_its_values_is_no_later(
    softid: Cli, params: Path, tmp_path: Path
) -> None:
    """A sine of 0.5 Hz in rows of 50 Hz from a gauge of 10 Hz: taken as it stands it would be late
    by 0.04 s; as a fit takes it, a spline through its readings, it is not."""
    time_s = np.arange(500) / 50.0

    def predicted(pressure_kpa: np.ndarray, name: str) -> np.ndarray:
        path = tmp_path / f"{name}.csv"
        rows = [f"{t:.2f},{p:.9g}" for t, p in zip(time_s, pressure_kpa, strict=True)]
        path.write_text("time_s,pressure_kpa\n" + "\n".join(rows) + "\n")
        told = softid("simulate", params, "--input", path)
        assert told.code == 0
        assert ("repeats each value for about 5 samples" in told.err) == (name == "slow")
        return table(told.out)["angle_deg"]

    def sine(at_s: np.ndarray) -> np.ndarray:
        return 40.0 + 39.0 * np.sin(np.pi * at_s)

    true, late = predicted(sine(time_s), "true"), predicted(sine(time_s - 0.04), "late")
    slow = predicted(sine(time_s[np.arange(500) // 5 * 5]), "slow")
    assert np.std((slow - true)[50:-50]) < 0.02 * np.std((late - true)[50:-50])


@pytest.mark.parametrize("course", ["plan", "slow gauge", "held"])
def test_python_gives_the_same_numbers(softid: Cli, tmp_path: Path, course: str) -> None:
    """Digit for digit, and the same remarks: of pressure alone, of a gauge that repeats its values,
    and where the fit took its input as held; from the file and from the fit itself."""
    result = replace(fit_result(), intersample="zoh" if course == "held" else None)
    save_fit(result, tmp_path / "params.json")
    time_s = np.arange(300) / 50.0
    read_s = time_s[np.arange(300) // 5 * 5] if course == "slow gauge" else time_s
    rows = [f"{t:.2f},{45 + 45 * np.sin(3 * r):.9g}" for t, r in zip(time_s, read_s, strict=True)]
    (tmp_path / "plan.csv").write_text("time_s,pressure_kpa\n" + "\n".join(rows) + "\n")
    told = softid("simulate", "params.json", "--input", "plan.csv")
    log = load(tmp_path / "plan.csv", outputs=None)
    saved = load_params(tmp_path / "params.json")
    for model in (saved, result):
        found = predict(model, log)
        shown = found.outputs["angle"] * saved.display["angle"][1]
        np.testing.assert_array_equal(shown, table(told.out)["angle_deg"])
        said = " ".join(f"softid: {issue.severity}: {issue.message}" for issue in found.issues)
        assert said.split() == told.err.replace(str(tmp_path) + "/", "").split()


def test_a_file_is_written_once(softid: Cli, params: Path, plan: Path) -> None:
    """--out takes the same bytes as stdout and keeps an earlier file without --force."""
    printed = softid("simulate", params, "--input", plan).out
    told = softid("simulate", params, "--input", plan, "--out", "predicted.csv")
    assert (told.code, told.out) == (0, "")
    assert told.err == "softid: written to predicted.csv\n"
    assert Path("predicted.csv").read_text() == printed
    refused = softid("simulate", params, "--input", plan, "--out", "predicted.csv")
    assert refused.code == 3
    assert "--force" in refused.err
    forced = ("simulate", params, "--input", plan, "--out", "predicted.csv", "--force", "--quiet")
    assert softid(*forced) == Outcome(0, "", "")


def test_beyond_the_fitted_range_is_told(softid: Cli, params: Path, tmp_path: Path) -> None:
    """The fit ended at 80 kPa; the prediction at 200 kPa is printed with a warning."""
    path = tmp_path / "far.csv"
    path.write_text("time_s,pressure_kpa\n0,0\n0.1,100\n0.2,200\n")
    told = softid("simulate", params, "--input", path)
    assert told.code == 0
    assert "reaches 200 kPa" in told.err
    assert "extrapolation" in told.err
    assert softid("simulate", params, "--input", path, "--quiet").err == ""


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (["params.json"], 2, "missing option '--input'"),
        (["params.json", "--input", "none.csv"], 3, "none.csv"),
        (["none.json", "--input", "plan.csv"], 3, "none.json: there is no such file"),
        (["plan.csv", "--input", "plan.csv"], 3, "for it is no JSON"),
        (["params.json", "--input", "angle.csv"], 3, "the log has no channel pressure"),
        (["params.json", "--input", "plan.csv", "--out", "no/x.csv"], 3, "make the folder first"),
        (["params.json", "--input", "plan.csv", "--out", "."], 3, "a folder, not a file"),
    ],
)
def test_what_is_wrong_is_said(
    softid: Cli, params: Path, plan: Path, arguments: list[str], code: int, said: str
) -> None:
    """One line on stderr, the documented code, nothing on stdout and no file."""
    Path("angle.csv").write_text("time_s,angle_deg\n0,1\n1,2\n")
    before = sorted(p.name for p in Path().iterdir())
    told = softid("simulate", *arguments)
    assert told.code == code
    assert said in told.err
    assert told.err.count("\n") == 1
    assert told.out == ""
    assert sorted(p.name for p in Path().iterdir()) == before
