"""Motion under an input that is known at the stages of the implicit rule."""

from __future__ import annotations

import numpy as np
import pytest

from softid.models.arrived_input import simulate_law_through
from softid.models.division import Division, held
from softid.models.muscle_law import MuscleLaw
from softid.models.oscillator import OscillatorLaw
from softid.models.second_order import Law, simulate_law

LAWS = {
    "muscle": MuscleLaw(np.array([0.002, 0.02, 2.2, 1.5, 0.02, 0.5, 0.15])),
    "without inertia": MuscleLaw(np.array([0.0, 0.02, 2.2, 1.5, 0.02, 0.5, 0.15])),
    "oscillator": OscillatorLaw(np.array([0.01, 0.2, 3.0, 0.7, 5.0])),
}


def drawn(n: int = 300) -> tuple[np.ndarray, np.ndarray, Division]:
    """Irregular times, random pressures and one to three steps an interval."""
    rng = np.random.default_rng(4)
    time_s = np.cumsum(rng.uniform(0.004, 0.02, n))
    u = rng.uniform(0.0, 200.0, n)
    counts = rng.integers(1, 4, n - 1).astype(np.int16)
    return time_s, u, Division(held(time_s), held(u), counts, "radau")


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
@pytest.mark.parametrize("start", [None, np.array([1.0, -3.0])])
def test_a_straight_input_gives_the_same_motion(law: Law, start: np.ndarray | None) -> None:
    """Fed with the straight line's own values at the stages it is `simulate_law`, to rounding."""
    time_s, u, plan = drawn()
    expected = simulate_law(law, time_s, u, start, derivatives=True, plan=plan)
    found = simulate_law_through(
        law, plan, float(u[0]), plan.stage_input, start, derivatives=True, relative=False
    )
    assert found is not None
    for name in ("x", "v", "by_parameter", "by_state"):
        ours, theirs = getattr(found, name), getattr(expected, name)
        np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=1e-10 * np.abs(theirs).max())


def test_without_derivatives_nothing_else_changes() -> None:
    """The same kernel with its second half left out: the same numbers, no derivatives."""
    _, u, plan = drawn()
    both = [
        simulate_law_through(
            LAWS["muscle"], plan, u[0], plan.stage_input, None, derivatives=d, relative=False
        )
        for d in (False, True)
    ]
    np.testing.assert_array_equal(both[0].x, both[1].x)
    assert both[0].by_parameter is None
