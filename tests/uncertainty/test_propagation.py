"""Errors of computed quantities against closed forms."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

from softid.uncertainty import propagated_errors

VALUES = {"a": 2.0, "b": 5.0, "c": 0.0}


def quantities(values: Mapping[str, float]) -> dict[str, tuple[float, str]]:
    a, b, c = values["a"], values["b"], values["c"]
    return {"product": (a * b, "1"), "ratio": (a / b, "1"), "shifted": (a + c, "1")}


def test_product_and_ratio() -> None:
    """Relative variances add, and twice the correlation with the sign of the exponents:
    (0.1)² + (0.2)² ± 2·0.5·0.1·0.2; the central difference errs by 1e-8."""
    sd = np.array([0.1 * 2.0, 0.2 * 5.0])
    covariance = np.outer(sd, sd) * np.array([[1.0, 0.5], [0.5, 1.0]])
    found = propagated_errors(quantities, VALUES, ["a", "b"], covariance)
    assert found["product"] == pytest.approx(10.0 * (0.01 + 0.04 + 0.02) ** 0.5, rel=1e-6)
    assert found["ratio"] == pytest.approx(0.4 * (0.01 + 0.04 - 0.02) ** 0.5, rel=1e-6)
    assert found["shifted"] == pytest.approx(0.2, rel=1e-6)


def test_what_rests_on_an_undetermined_parameter_is_not_known() -> None:
    """Without an error of b neither product nor ratio has one; the sum does without b."""
    covariance = np.array([[0.04]])
    found = propagated_errors(quantities, VALUES, ["a"], covariance, undetermined=["b"])
    assert (found["product"], found["ratio"]) == (None, None)
    assert found["shifted"] == pytest.approx(0.2, rel=1e-6)


def test_without_a_covariance_nothing_is_known() -> None:
    """Every quantity is there, and none has an error."""
    assert set(propagated_errors(quantities, VALUES, [], None).values()) == {None}
