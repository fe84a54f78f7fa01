"""The closed form of the χ² tail against scipy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import chdtrc

from softid.chi_square import chi_square_tail


@pytest.mark.parametrize("freedom", [1, 2, 3, 10, 25, 200])
def test_the_tail_of_chi_square_equals_that_of_scipy(freedom: int) -> None:
    """scipy's own to 1e-10, from far below the mean to far above it."""
    values = np.linspace(0.0, 4.0 * freedom, 30)
    found = [chi_square_tail(value, freedom) for value in values.tolist()]
    assert found == pytest.approx(chdtrc(freedom, values), rel=1e-10, abs=1e-14)
