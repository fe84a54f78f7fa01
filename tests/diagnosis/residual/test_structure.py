"""How much of a residual follows from the state of the actuator."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from linear_motion import linear_angle, pressure_course
from noise import ar1

from softid.diagnosis.residual.structure import ResidualContext, Structure, structure_of

Array = npt.NDArray[np.float64]

MOTION_S = 0.2
TIME_S = np.arange(3000) / 50.0
PRESSURE = pressure_course(TIME_S)
X = linear_angle(TIME_S, PRESSURE)
V = np.gradient(X, TIME_S)
SEEDS = range(20)


def look(residual: Array, seed: int = 0) -> Structure:
    part = ResidualContext(TIME_S, X, V, PRESSURE, residual)
    return structure_of([part], MOTION_S, rng=np.random.default_rng(seed))


def of_power(shape: Array) -> Array:
    """The shape with mean zero and unit power."""
    centred = shape - shape.mean()
    scaled: Array = centred / centred.std()
    return scaled


SHAPES = {
    "v": np.tanh(V / 0.05),
    "x": (X - 0.5) ** 2,
    "p": (PRESSURE - 40.0) ** 2,
}
RIPPLE = np.sin(2.0 * np.pi * 5.0 * X / np.ptp(X))
"""Of a rack or of pleats: five periods within the stroke."""


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("share", [0.2, 0.8])
def test_structure_is_found_with_its_share(name: str, share: float) -> None:
    """Known truth: a function of one variable in white noise, with a known share of the power.

    The smooth function is wide enough to bring nine tenths of the shape, less a hundredth for what
    it learns from noise; it never finds more than there is, within the chance of 3000 samples.
    """
    noise = np.random.default_rng(1).standard_normal(TIME_S.size)
    residual = np.sqrt(share) * of_power(SHAPES[name]) + np.sqrt(1.0 - share) * noise
    found = look(residual)
    assert found.significant
    assert 0.85 * share - 0.02 < found.share < share + 0.04
    assert 0.8 * share - 0.02 < found.by[name] < share + 0.04


def test_structure_does_not_go_with_the_units() -> None:
    """Known law: the smooth function is one of shares. In units of 1e13 the same is found."""
    residual = SHAPES["v"] + np.random.default_rng(1).standard_normal(TIME_S.size)
    small = ResidualContext(TIME_S, 1e-13 * X, 1e-13 * V, 1e-13 * PRESSURE, residual)
    found = structure_of([small], MOTION_S, rng=np.random.default_rng(0))
    usual = look(residual)
    assert found.share == pytest.approx(usual.share, rel=1e-6)
    assert found.by == pytest.approx(usual.by, rel=1e-6, abs=1e-9)


def test_what_repeats_within_the_stroke_follows_from_the_position() -> None:
    """Known truth: a ripple, half of the power. Of the pressure, which is late to it, less."""
    noise = np.random.default_rng(1).standard_normal(TIME_S.size)
    found = look(np.sqrt(0.5) * (of_power(RIPPLE) + noise))
    assert found.significant
    assert found.by["x"] == max(found.by.values())
    assert 0.4 < found.by["x"] < 0.54
    assert found.by["p"] < 0.5 * found.by["x"]


def test_the_variable_is_told_apart() -> None:
    """Friction goes by the sign of the speed, which the position alone does not tell."""
    found = look(of_power(SHAPES["v"]))
    assert found.by["v"] == max(found.by.values())
    assert found.by["x"] < 0.5 * found.by["v"]
    assert found.by["t"] < 0.1


@pytest.mark.parametrize("phi", [0.0, 0.9, 0.99])
def test_noise_of_any_colour_is_no_structure(phi: float) -> None:
    """Known truth: nothing. At 5 % each, more than three of 20 come up once in 60 tries."""
    called = 0
    for seed in SEEDS:
        noise = ar1(np.random.default_rng(seed), TIME_S.size, phi)
        called += look(noise, seed).significant
    assert called <= 3


def test_slow_noise_reaches_more_by_chance() -> None:
    """The limit goes with the colour: white noise has none.

    On samples that were seen, 50 coefficients of 3000 samples would find 1.5 % of it.
    """
    white = np.random.default_rng(0).standard_normal(TIME_S.size)
    slow = np.cumsum(white)
    assert look(white).limit < 0.005
    assert look(slow - slow.mean()).limit > 0.1


def test_a_wandering_drive_is_not_asked_for_the_time() -> None:
    """A slow course in white noise follows from the time, and from nothing else that is looked at.

    What position and input still make of it by chance is a small part.
    """
    noise = np.random.default_rng(1).standard_normal(TIME_S.size)
    residual = of_power(np.cos(np.pi * TIME_S / TIME_S[-1])) + 0.5 * noise
    part = ResidualContext(TIME_S, X, V, PRESSURE, residual)
    kept, without = (
        structure_of([part], MOTION_S, rng=np.random.default_rng(0), wanders=wanders)
        for wanders in (False, True)
    )
    assert kept.by["t"] > 0.5
    assert "t" not in without.by
    assert without.share < 0.3 * kept.share


def test_unused_samples_and_several_segments() -> None:
    """NaN is left out, and a second segment adds to the first: the share stays the known one."""
    noise = np.random.default_rng(2).standard_normal((2, TIME_S.size))
    residual = np.sqrt(0.5) * of_power(SHAPES["x"]) + np.sqrt(0.5) * noise
    residual[0, 500:900] = np.nan
    residual[1, :50] = np.nan
    parts = [ResidualContext(TIME_S, X, V, PRESSURE, rows) for rows in residual]
    found = structure_of(parts, MOTION_S, rng=np.random.default_rng(0))
    assert found.share == pytest.approx(0.5, abs=0.08)


def test_the_same_seed_gives_the_same_answer() -> None:
    """Randomness comes only from the generator that is passed."""
    noise = np.random.default_rng(3).standard_normal(TIME_S.size)
    assert look(noise, 4) == look(noise, 4)
    assert look(noise, 4).limit != look(noise, 5).limit


@pytest.mark.parametrize(
    ("share", "limit", "significant"),
    [(0.03, 0.01, True), (0.03, 0.04, False), (0.019, 0.0, False)],
)
def test_what_counts_as_significant(share: float, limit: float, significant: bool) -> None:
    """Above chance and above a fiftieth of the power."""
    assert Structure(share, limit, {}).significant is significant
