"""What the user may say about a parameter that the model holds with its options."""

from __future__ import annotations

from dataclasses import replace

import lmfit
import pytest

from softid.errors import UsageError
from softid.identification.parameter_constraints import ParameterConstraints
from softid.models import Muscle, Oscillator


def test_bounds_of_a_held_parameter_are_refused() -> None:
    """They would be ignored, or the held value moved into them without a word."""
    declared = Oscillator().parameters()
    bounded = declared.replacing(replace(declared["offset"], lower=-10.0, upper=10.0))
    with pytest.raises(UsageError, match="the model holds offset at 0 with these options"):
        ParameterConstraints.of(declared, bounded)
    wishes = declared.to_lmfit()
    wishes["G"].set(value=5.0, min=5.0, max=10.0)
    with pytest.raises(UsageError, match="the model holds G at 1 with these options"):
        ParameterConstraints.of(declared, wishes)


def test_a_held_parameter_may_be_held_elsewhere() -> None:
    """The whole set, as it comes from the model or by lmfit, and other values are no bounds."""
    for model in (Oscillator(), Muscle(damping="constant")):
        declared = model.parameters()
        assert ParameterConstraints.of(declared, declared.to_lmfit()).changed == {}
        held = next(p.name for p in declared.values() if p.fixed)
        other = declared.with_fixed({held: 2.0})
        assert ParameterConstraints.of(declared, other).asked[held].value == 2.0
    wishes = lmfit.Parameters()
    wishes.add("G", value=2.0, vary=False)
    declared = Oscillator().parameters()
    assert ParameterConstraints.of(declared, wishes).asked["G"].value == 2.0
