"""A log without any noise, of which nothing but the sampling of the input is left."""

from __future__ import annotations

import numpy as np

from softid.diagnosis import diagnose
from softid.diagnosis.base.base_fit import NEGLIGIBLE
from softid.diagnosis_results import Verdict
from softid.synthesis import Rig, hidden_pair

SILENT = Rig(noise=0.0, pressure_noise_kpa=0.0)


def test_what_sampling_leaves_has_no_cause() -> None:
    """Stands on the generator's truth: the base is the law, and the input moves between samples.

    Its misfit is above rounding and below the share that counts, and the answer says so.
    """
    pair = hidden_pair([], seed=5, protocol="paper", rig=SILENT)
    found = diagnose(pair.logs[0], hold_out=[pair.logs[1]], model="muscle")
    rms = found.base.statistics[0].rmse
    assert 1e-6 * pair.sizes.x_span < rms < NEGLIGIBLE * pair.sizes.x_span
    assert found.verdict is Verdict.ADEQUATE
    assert found.evidence == ()
    assert "below 0.03 % of its range" in found.summary
    assert "looks like" not in found.summary


def test_an_effect_without_noise_is_found() -> None:
    """Stands on the generator's truth: a misfit of a hundredth of the range counts."""
    pair = hidden_pair(["delay"], seed=5, protocol="paper", rig=SILENT)
    found = diagnose(pair.logs[0], hold_out=[pair.logs[1]], model="muscle", effects=["delay"])
    assert [cause.effect for cause in found.causes] == ["delay"]
    assert np.isclose(found.causes[0].parameters[0].value, pair.hidden["delay"]["tau"], rtol=0.1)
