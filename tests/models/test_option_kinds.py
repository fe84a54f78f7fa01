"""A model is made of options of the right kind only, and says which one is not."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from softid.errors import UsageError
from softid.models import MODELS
from softid.models.option_kinds import option_kinds

WRONG: dict[str, tuple[object, ...]] = {
    "number": ("abc", True, float("nan"), float("inf"), [3.0]),
    "whole number": ("abc", True, float("nan"), float("inf"), 2.5),
    "text": (5, 5.0, ["a"]),
}
OPTIONS = [(name, option) for name, model in MODELS.items() for option in option_kinds(model)]


@pytest.mark.parametrize(("name", "option"), OPTIONS)
def test_what_is_of_another_kind_is_refused(name: str, option: str) -> None:
    """Never by an error of Python's own, which a user could not read."""
    for value in WRONG[option_kinds(MODELS[name])[option]]:
        options: dict[str, Any] = {option: value}
        with pytest.raises(UsageError) as refused:
            MODELS[name](**options)
        assert refused.value.where == f"option {option}", value


def test_numbers_of_numpy_are_numbers() -> None:
    """A script may take them from an array."""
    options: dict[str, Any] = {"height_mm": np.float64(35.0), "chambers": np.int64(13)}
    assert MODELS["yeoh"](**options) == MODELS["yeoh"]()
    assert MODELS["polynomial"](**{"order": 4.0}) == MODELS["polynomial"]()
