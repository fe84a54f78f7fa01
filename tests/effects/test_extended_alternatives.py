"""Other starts of an extended model name all of its parameters."""

from __future__ import annotations

import numpy as np
from muscle_rig import extended


def test_alternatives_keep_the_effects() -> None:
    """A start that lacks a parameter ends the fit; the effect keeps the value that it had."""
    model, theta = extended("pneumatic_lag")
    names = model.parameters().names
    values = dict(zip(names, theta.tolist(), strict=True))
    found = model.alternatives(values)
    assert len(found) == len(model.model.alternatives(values)) > 0
    for start in found:
        assert start.names == names
        np.testing.assert_allclose(start["pneumatic_lag_tau"].value, values["pneumatic_lag_tau"])
