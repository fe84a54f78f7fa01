"""Burg's recursion over lagged products against the recursion over samples."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from softid.uncertainty import burg as module
from softid.uncertainty.burg import burg


@pytest.mark.parametrize("phi", [(), (0.9,), (1.8, -0.81), (-0.7, 0.2, 0.1)])
def test_by_lags_is_the_same(phi: tuple[float, ...], monkeypatch: pytest.MonkeyPatch) -> None:
    """Two stretches, to 1e-10: products of samples are good to 1e-16 of the power, of which a
    thousandth is left at the double root 0.9."""
    rng = np.random.default_rng(3)
    runs = [lfilter([1.0], [1.0, *(-p for p in phi)], rng.normal(size=n)) for n in (700, 301)]
    plain = burg(runs, 8)
    monkeypatch.setattr(module, "LONG_RUN", 1)
    np.testing.assert_allclose(burg(runs, 8), plain, atol=1e-10)


def test_a_ramp_ends_the_recursion_alike(monkeypatch: pytest.MonkeyPatch) -> None:
    """A straight line is predicted down to `MIN_LEFT`, beyond which both give zeros."""
    runs = [np.linspace(1.0, 2.0, 400)]
    plain = burg(runs, 6)
    monkeypatch.setattr(module, "LONG_RUN", 1)
    found = burg(runs, 6)
    np.testing.assert_allclose(found, plain, atol=1e-9)
    assert not found[-3:].any()
