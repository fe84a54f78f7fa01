"""Synthetic logs: what is recorded, what stays hidden, and where the randomness comes from."""

from __future__ import annotations

import csv
import io
from dataclasses import replace

import numpy as np
import pytest

from softid.errors import InputError
from softid.synthesis import (
    Arc,
    Sensor,
    bundled_datasets,
    load_recipe,
    muscle_log,
    random_muscle_truth,
    synthesize,
    to_csv_bytes,
)
from softid.synthesis.waveforms import Steps

STEPS = Steps((0.0, 120.0, 200.0), 0.5)


@pytest.fixture(scope="module")
def demo():
    return synthesize(load_recipe(bundled_datasets() / "recipes" / "demo_step.toml"))


def test_csv_holds_the_columns_and_no_truth(demo) -> None:
    """Header = time and sensors; every cell reads back to the recorded value; blanks are empty."""
    rows = list(csv.reader(io.StringIO(to_csv_bytes(demo).decode("ascii"))))
    assert rows[0] == ["time_s", "pressure_command_kpa", "pressure_kpa", "angle_deg"]
    cells = np.array([[float(c) if c else np.nan for c in row] for row in rows[1:]])
    recorded = np.column_stack([demo.time_s, *demo.columns.values()])
    assert np.array_equal(cells, recorded, equal_nan=True)
    assert np.isnan(cells[:, 3]).any()
    assert not np.isnan(cells[:, :3]).any()


def test_recorded_is_true_plus_what_the_sensor_adds(demo) -> None:
    """Mean of the difference = zero and its deviation = sigma, to 10 % (3,900 coloured rows)."""
    for column, sensor in demo.recipe.sensors.items():
        added = demo.columns[column] - demo.truth_columns[column]
        added = added[np.isfinite(added)]
        assert added.mean() == pytest.approx(sensor.zero, abs=0.05), column
        if sensor.noise_sd > 0:
            assert added.std() == pytest.approx(demo.sigma[column], rel=0.1), column


def test_demo_has_its_flaws(demo) -> None:
    """Irregular clock, lost rows and blank angles are there, for the reader to find."""
    intervals = np.diff(demo.time_s)
    assert 0.0005 < np.std(intervals[intervals < 0.015]) < 0.002
    assert (intervals > 0.016).sum() >= 5
    assert 3_800 < demo.time_s.size <= 6_000


def test_to_log_has_canonical_units(demo) -> None:
    """Degrees become radians; the roles are pressure → angle."""
    log = demo.to_log()
    assert (log.input, log.outputs, log.name) == ("pressure", ("angle",), "demo_step")
    angle = log.channels["angle"]
    assert angle.unit == "rad"
    assert np.nanmax(np.abs(angle.displayed - demo.columns["angle_deg"])) < 1e-12


def test_seed_decides_all_that_is_random() -> None:
    """Same seed, same bytes; another seed, other noise on the same truth."""
    truth = random_muscle_truth(np.random.default_rng(2))
    one, same, other = (muscle_log(truth, STEPS, seed=s) for s in (1, 1, 2))
    assert to_csv_bytes(one) == to_csv_bytes(same) != to_csv_bytes(other)
    hidden = [log.truth_columns["contraction_mm"] for log in (one, other)]
    assert np.array_equal(*hidden)
    assert synthesize(one.recipe, seed=2).seed == 2
    assert to_csv_bytes(synthesize(one.recipe, seed=2)) == to_csv_bytes(other)
    with pytest.raises(InputError, match="a seed cannot be negative"):
        synthesize(one.recipe, seed=-1)


def test_sensors_have_streams_of_their_own() -> None:
    """A noisier pressure sensor leaves the output's noise as it was."""
    recipe = muscle_log(random_muscle_truth(np.random.default_rng(2)), STEPS).recipe
    quiet = {**recipe.sensors, "pressure_kpa": Sensor(decimals=3)}
    first, second = synthesize(recipe), synthesize(replace(recipe, sensors=quiet))
    assert np.array_equal(first.columns["contraction_mm"], second.columns["contraction_mm"])
    assert not np.array_equal(first.columns["pressure_kpa"], second.columns["pressure_kpa"])


def test_outputs_of_the_arc_agree() -> None:
    """Contraction, length, angle and distance are one motion: L = L0 − x, θ = x/d, D(x)."""
    arc = Arc(150.0, 20.0)
    columns = ("contraction_mm", "length_mm", "angle_deg", "distance_mm")
    truth = random_muscle_truth(np.random.default_rng(2))
    made = muscle_log(truth, STEPS, geometry=arc, columns=columns)
    x = made.truth_columns["contraction_mm"]
    assert np.allclose(made.truth_columns["length_mm"], 150.0 - x, atol=1e-12)
    assert np.allclose(np.radians(made.truth_columns["angle_deg"]), x / 20.0, atol=1e-12)
    assert np.allclose(made.truth_columns["distance_mm"], arc.distance_mm(x), atol=1e-12)
    assert made.sigma["angle_deg"] == pytest.approx(np.degrees(0.3 / 20.0), rel=1e-3)


def test_noise_free_columns_cannot_be_changed() -> None:
    """Truth that a test could spoil by accident would be no truth."""
    made = muscle_log(random_muscle_truth(np.random.default_rng(2)), STEPS)
    with pytest.raises(ValueError, match="read-only"):
        made.truth_columns["contraction_mm"][0] = 1.0


def test_recording_may_start_in_the_middle_of_a_motion() -> None:
    """Skipping 0.5 s gives the same truth from there on, with the clock at zero."""
    recipe = muscle_log(random_muscle_truth(np.random.default_rng(2)), STEPS).recipe
    whole = synthesize(recipe)
    late = synthesize(replace(recipe, sampling=replace(recipe.sampling, skip_s=0.55)))
    assert late.time_s[0] == 0.0
    tail = whole.truth_columns["contraction_mm"][55:]
    assert np.abs(late.truth_columns["contraction_mm"] - tail).max() < 1e-9


def test_random_muscles_are_realistic() -> None:
    """200 draws: positive, largest contraction 55–85 mm, midpoint 1.2–1.7 bar, N/Q 50–300 ms."""
    rng = np.random.default_rng(11)
    for _ in range(200):
        t = random_muscle_truth(rng)
        midpoint = np.log(t["c1"] / t["a1"]) / t["b1"]
        damping = t["a2"] * np.exp(t["b2"] * midpoint) + t["c2"]
        assert min(t.values()) > 0
        assert 55 < 1 / t["a1"] < 85
        assert 1.2 < midpoint < 1.7
        assert 0.05 < damping / (2 * t["c1"]) < 0.3
        ratio = damping / (2 * np.sqrt(2 * t["c1"] * t["M"]))
        assert 0.69 < ratio < 3.01
