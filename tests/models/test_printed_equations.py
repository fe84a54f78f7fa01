"""The equation that is printed above a model's parameters."""

from __future__ import annotations

import pytest
from printed_laws import unnamed_in

from softid.models import MODELS


@pytest.mark.parametrize("name", MODELS)
def test_the_equation_names_every_parameter(name: str) -> None:
    model = MODELS[name]()
    assert unnamed_in(model.equation, model.parameters().names) == set()
