"""What a user may mistype about a model ends in one sentence that names the option."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields

import pytest
from desk import Desk, Outcome

from softid.models import MODELS
from softid_cli.model_options import follows_from_logs

Cli = Callable[..., Outcome]

OPTIONS = [
    (name, f.name)
    for name, model in MODELS.items()
    for f in fields(model)
    if not follows_from_logs(f.name)
]


@pytest.mark.parametrize(("name", "option"), OPTIONS)
def test_a_word_that_is_no_value(softid: Cli, desk: Desk, name: str, option: str) -> None:
    """No choice, number or list of names of any model is called abc."""
    told = softid("fit", "a.csv", "--model", name, "--option", f"{option}=abc")
    assert told.code == 2
    assert f"error: --option {option}: " in told.err
    assert "(got 'abc'); " in told.err
    assert "logs" not in desk.asked


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("oscillator", "--bound", "offset=-10:10"), "--bound offset: the model holds offset at 0"),
        (("oscillator", "--bound", "G=5:10"), "--bound G: the model holds G at 1 with these opt"),
        (("muscle", "--damping", "constant", "--bound", "a2=1:2"), "the model holds a2 at 0"),
    ],
)
def test_a_bound_of_what_the_model_holds(
    softid: Cli, desk: Desk, arguments: tuple[str, ...], said: str
) -> None:
    """Taken, it would do nothing, or move the value that is held."""
    told = softid("fit", "a.csv", "--model", *arguments)
    assert told.code == 2
    assert said in told.err
    assert "logs" not in desk.asked


@pytest.mark.parametrize(
    ("model", "fixed", "remedy"),
    [
        ("oscillator", "Q=0", "or drop its term with --option spring=none"),
        ("oscillator", "M=0", "or drop its term with --option order=first"),
        ("muscle", "a2=0", "or drop its term with --damping constant"),
        ("muscle", "c1=0", "give a positive value"),
    ],
)
def test_the_remedy_for_zero_drops_that_parameter(
    softid: Cli, desk: Desk, model: str, fixed: str, remedy: str
) -> None:
    """A stiffness goes with the spring, not with the order; without such an option none is told."""
    told = softid("fit", "a.csv", "--model", model, "--fix", fixed)
    assert told.code == 2
    assert told.err.endswith(f"{remedy}.\n")
    assert "logs" not in desk.asked


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--option", "fixed_length_mm=abc", "--option", "diameter_mm=3"), "fixed_length_mm: this"),
        (("--option", "fixed_length_mm=-1", "--option", "diameter_mm=3"), "fixed_length_mm is not"),
        (("--model", "equilibrium", "--option", "assumed=5"), "no such value to be assumed"),
        (("--model", "equilibrium", "--option", "wall_m=99"), "--option wall_m: a value between"),
        (("--model", "polynomial", "--option", "order=2.5"), "--option order: this is no whole"),
        (("--model", "polynomial", "--option", "order=99"), "--option order: the order of a poly"),
        (("--model", "yeoh", "--option", "foot_mm=90"), "the foot of the wall is as high"),
    ],
)
def test_a_value_that_makes_no_model(
    softid: Cli, desk: Desk, arguments: tuple[str, ...], said: str
) -> None:
    told = softid("fit", "a.csv", *arguments)
    assert told.code == 2
    assert said in told.err


def test_a_typographic_minus_is_a_minus(softid: Cli, desk: Desk) -> None:
    """As in a log: what was copied from a paper has U+2212."""
    bound = "offset=\N{MINUS SIGN}0.5:0.5"
    arguments = ("--option", "spring=none", "--bound", bound)
    told = softid("fit", "a.csv", "--model", "oscillator", *arguments)
    assert told.code == 0, told.err
    assert desk.asked["parameters"]["offset"].lower == -0.5
