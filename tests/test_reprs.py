"""What results look like at a prompt or in a notebook."""

from __future__ import annotations

import numpy as np

import softid
from softid.log import Log

LONGEST = 6000
"""Characters that fit on two screens."""


def test_no_samples_are_printed() -> None:
    """A log of any length, what was fitted to it and what scores it are told on a screen or two."""
    t = np.arange(0.0, 20.0, 0.01)
    u = np.where(t % 4.0 < 2.0, 0.0, 100.0)
    log = Log.from_arrays(t, {"pressure": u, "angle": 0.01 * u}, name="steps")
    result = softid.fit(log, model="oscillator")
    for found in (log, result, softid.validate(result, log), softid.inspect(log)):
        text = repr(found)
        assert "steps" in text
        assert "array(" not in text
        assert len(text) < LONGEST
