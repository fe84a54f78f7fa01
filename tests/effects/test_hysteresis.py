"""Hysteresis: exponential branches, no dependence on speed, closed loops."""

from __future__ import annotations

import numpy as np
from textbook_effects import oscillation, segment

from softid.effects.base import StateEffect
from softid.effects.hysteresis import BranchHysteresis, Hysteresis, PressureHysteresis
from softid.models.oscillator import Oscillator

VALUES = {"alpha": 0.2, "zs": 0.05}
STIFFNESS = 2.0


def slowly(
    path: np.ndarray,
    duration_s: float,
    samples: int = 600,
    effect: StateEffect | None = None,
    values: dict[str, float] = VALUES,
) -> np.ndarray:
    """Position without inertia and damping along a path of inputs."""
    time_s = np.linspace(0.0, duration_s, samples)
    u = np.interp(time_s / duration_s, np.linspace(0.0, 1.0, path.size), path)
    return oscillation(
        effect or Hysteresis(), values, segment(time_s, u), (0.0, 0.0, STIFFNESS),
        model=Oscillator(order="static"),
    )  # fmt: skip


def test_first_branch_is_exponential() -> None:
    """z = 1 − exp(−x/zs) on the way up from rest, so u = Q x + α (1 − exp(−x/zs)), to 1e-6."""
    x = slowly(np.array([0.0, 1.0]), 4.0)
    u = STIFFNESS * x + VALUES["alpha"] * (1.0 - np.exp(-x / VALUES["zs"]))
    np.testing.assert_allclose(u, np.linspace(0.0, 1.0, 600), atol=1e-6)


def test_branch_after_a_turn() -> None:
    """From a turn at (x₁, z₁ ≈ 1) back: z = −1 + 2 exp(−(x₁ − x)/zs), to 1e-3 of the force.

    x₁ is eight zs away; the turn falls on a sample.
    """
    x = slowly(np.array([0.0, 1.0, 0.0]), 8.0, 801)[400:]
    z = -1.0 + 2.0 * np.exp(-(x[0] - x) / VALUES["zs"])
    u = STIFFNESS * x + VALUES["alpha"] * z
    np.testing.assert_allclose(u, np.linspace(1.0, 0.0, 401), atol=1e-3)


def test_speed_does_not_matter() -> None:
    """The same path a thousand times slower gives the same positions, to 1e-4 of the range.

    Not closer, since the fast path is given smaller steps.
    """
    path = np.array([0.0, 1.0, 0.2, 0.6, 0.4, 0.8, 0.0])
    fast, slow = slowly(path, 6.0, 1201), slowly(path, 6000.0, 1201)
    np.testing.assert_allclose(slow, fast, atol=1e-4 * np.ptp(fast))


def test_state_keeps_its_bounds() -> None:
    """|z| ≤ 1 on any path, so the position is off the spring's by α/Q at most."""
    path = np.random.default_rng(7).uniform(-1.0, 1.0, 40)
    path[0] = 0.0
    x = slowly(path, 40.0, 4000)
    u = np.interp(np.linspace(0.0, 1.0, 4000), np.linspace(0.0, 1.0, 40), path)
    z = (u - STIFFNESS * x) / VALUES["alpha"]
    assert np.max(np.abs(z)) < 1.0 + 1e-6
    assert np.max(np.abs(z)) > 0.9


def test_a_log_may_begin_on_the_way_down() -> None:
    """At z0 = −1 under no input it rests at α/Q, and the way up is z = 1 − 2 exp(−(x − x₀)/zs)."""
    x = slowly(np.array([0.0, 1.0]), 4.0, 600, BranchHysteresis(), {**VALUES, "z0": -1.0})
    assert np.isclose(x[0], VALUES["alpha"] / STIFFNESS, atol=1e-9)
    z = 1.0 - 2.0 * np.exp(-(x - x[0]) / VALUES["zs"])
    np.testing.assert_allclose(
        STIFFNESS * x + VALUES["alpha"] * z, np.linspace(0.0, 1.0, 600), atol=1e-6
    )


def test_a_branch_of_nothing_is_the_plain_form() -> None:
    """z0 = 0 changes nothing on any path."""
    path = np.array([0.0, 1.0, 0.2, 0.6, 0.4, 0.8, 0.0])
    found = slowly(path, 6.0, 1201, BranchHysteresis(), {**VALUES, "z0": 0.0})
    np.testing.assert_allclose(found, slowly(path, 6.0, 1201), atol=1e-12)


def test_the_loop_is_wider_at_high_pressure() -> None:
    """Closed form, to 1e-6: on the way up u = Q x + α (1 + k u) (1 − exp(−x/zs))."""
    k = 3.0
    x = slowly(np.array([0.0, 1.0]), 4.0, effect=PressureHysteresis(), values={**VALUES, "k": k})
    u = np.linspace(0.0, 1.0, 600)
    z = 1.0 - np.exp(-x / VALUES["zs"])
    np.testing.assert_allclose(STIFFNESS * x + VALUES["alpha"] * (1.0 + k * u) * z, u, atol=1e-6)
