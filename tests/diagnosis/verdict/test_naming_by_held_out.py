"""What the logs that are held out say of the names of causes."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest
from handmade_diagnosis import remainder
from handmade_rounds import bare_link

from softid.diagnosis.verdict.naming import nameable


def model(squares: float) -> Any:
    return SimpleNamespace(squares=squares)


def test_what_does_not_carry_over_is_not_named() -> None:
    """Noise alone is left on the fitted samples, but on others most of the misfit stays."""
    left = remainder(structured=False, explained=1.0)
    for share, named in ((0.71, True), (0.69, False)):
        told = nameable(
            [bare_link(100.0)], model(1.0), replace(left, held_out_share=share), gain=0.5
        )
        assert told == (named,)


@pytest.mark.parametrize(
    ("misses", "share", "of_rival", "named"),
    [
        (True, 0.94, None, True),
        (True, 0.92, None, False),
        (True, 0.92, 0.94, True),
        (True, 0.92, 0.92, False),
        (True, 0.69, 0.94, False),
        (False, 0.92, None, True),
    ],
)
def test_beside_a_rest_that_is_held_out(
    misses: bool, share: float, of_rival: float | None, named: bool
) -> None:
    """Noise alone is left on the fitted samples; what others miss a rival of the tie may not."""
    left = remainder(structured=False, explained=1.0)
    left = replace(left, misses_held_out=misses, held_out_share=share)
    of_tie = replace(left, held_out_share=of_rival) if of_rival is not None else None
    told = nameable([bare_link(100.0)], model(1.0), left, gain=0.9, of_tie=of_tie)
    assert told == (named,)


@pytest.mark.parametrize(
    ("structured", "is_another", "named"),
    [(False, True, True), (False, False, False), (True, True, False)],
)
def test_what_is_held_out_may_be_another_actuator(
    structured: bool, is_another: bool, named: bool
) -> None:
    """It does not speak against a cause that leaves noise elsewhere; asked only if it must be."""
    left = remainder(structured=structured, explained=1.0)
    missed = replace(left, misses_held_out=True, held_out_share=0.4)
    told = nameable([bare_link(100.0)], model(1.0), missed, gain=0.4, is_another=lambda: is_another)
    assert told == (named,)
    assert nameable([bare_link(100.0)], model(1.0), left, gain=0.9, is_another=pytest.fail)
