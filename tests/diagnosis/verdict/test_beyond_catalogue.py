"""Laws in no catalogue that account for a misfit."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from softid.diagnosis.base.base_fit import BaseFit, Request
from softid.diagnosis.residual.assessment import noise_variance
from softid.diagnosis.verdict.beyond_catalogue import BeyondCatalogue, beyond_catalogue
from softid.diagnosis.verdict.unlisted_curves import FreeSpring
from softid.diagnosis.verdict.unlisted_laws import OutputPlay
from softid.log import LogSet
from softid.synthesis import hidden_pair


def base_over(*names: str, seed: int) -> BaseFit:
    (log, judge) = hidden_pair(names, seed=seed, size=1.5).logs
    request = Request("muscle", None, 0, lambda message, fraction: None)
    return request.fit_base(LogSet((log,)), (judge,), thorough=False)


@pytest.mark.parametrize(
    ("hidden", "law"),
    [
        ("position_damping", "position_damping"),
        ("damping_slope", "position_damping"),
        ("input_backlash", "input_play"),
        ("output_backlash", "output_play"),
        ("rate_limit", "rate_limit"),
        ("supply_limit", "input_limit"),
        ("self_heating", "recovering_softening"),
        ("wavy_spring", "free_spring"),
    ],
)
def test_what_is_hidden_is_told(hidden: str, law: str) -> None:
    """Stands on the generator: it takes nearly all, also on the other log, before all others."""
    base = base_over(hidden, seed=710005)
    found = beyond_catalogue(base, noise_variance(base.candidate, base.scale))
    assert found is not None
    assert found.laws[0].name == law
    assert min(found.share, found.held_out_share) > 0.9


@pytest.mark.parametrize("hidden", ["creep", "coulomb_friction", "sensor_lag", "swinging_load"])
def test_other_laws_are_not_told_for_it(hidden: str) -> None:
    base = base_over(hidden, seed=710006)
    assert beyond_catalogue(base, noise_variance(base.candidate, base.scale)) is None


def test_noise_is_no_law() -> None:
    base = base_over(seed=710007)
    noise = noise_variance(base.candidate, base.scale)
    assert beyond_catalogue(base, noise) is None
    assert beyond_catalogue(base, 4.0 * noise) is None


@pytest.mark.parametrize(
    ("share", "squares", "cause", "outdoes"),
    [
        (0.99, 120.0, 200.0, True),
        (0.99, 140.0, 200.0, False),
        (0.99, 120.0, 125.0, False),
        (0.95, 120.0, 200.0, False),
    ],
)
def test_only_what_leaves_noise_ends_a_search(
    share: float, squares: float, cause: float, outdoes: bool
) -> None:
    """A misfit of 30 times the noise of 100 loses 96 % to a law that leaves more than twice it: the
    rest may be a second cause. It must leave clearly less than the best cause, too."""
    found = BeyondCatalogue((OutputPlay(),), share, share, squares, 100.0)
    best: Any = SimpleNamespace(squares=cause)
    assert found.outdoes(best) is outdoes


def test_a_spring_of_any_shape_leaves_a_second_cause_open() -> None:
    """A stiffening up to a wall is such a spring, too, and has two causes."""
    best: Any = SimpleNamespace(squares=200.0)
    found = BeyondCatalogue((FreeSpring(),), 0.99, 0.99, 120.0, 100.0)
    assert not found.outdoes(best)
