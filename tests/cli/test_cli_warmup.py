"""`softid warmup` where it can do nothing."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from desk import Outcome


def test_without_a_folder_to_write_to_it_says_so(
    softid: Callable[..., Outcome], monkeypatch: pytest.MonkeyPatch
) -> None:
    """One line with the remedy, exit code 3, and nothing is compiled in vain."""
    monkeypatch.setattr("softid.kernels.cache_folder", lambda: None)
    told = softid("warmup")
    assert (told.code, told.out) == (3, "")
    assert told.err.count("\n") == 1
    assert "NUMBA_CACHE_DIR" in told.err
