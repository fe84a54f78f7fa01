"""The steps from an answer in numbers to its paragraph: each does what the order of them allows."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest
from handmade_diagnosis import FRICTION, diagnosis

from softid.diagnosis import completion
from softid.diagnosis.completion import STEPS, completed
from softid.diagnosis_results import Diagnosis, Verdict


def test_every_step_gets_what_the_one_before_gave(monkeypatch: pytest.MonkeyPatch) -> None:
    """In the order of the tuple, each with the same circumstances."""
    case: Any = SimpleNamespace()

    def step(mark: str) -> completion.Step:
        def told(answer: Diagnosis, given: completion.Circumstances) -> Diagnosis:
            assert given is case
            return replace(answer, summary=answer.summary + mark)

        return told

    monkeypatch.setattr(completion, "STEPS", tuple(map(step, "abc")))
    assert completed(replace(diagnosis(Verdict.NAMED), summary=""), case).summary == "abc"


def test_the_steps_are_named_and_each_is_there_once() -> None:
    """The paragraph is the last, for it tells what all others found."""
    names = [step.__name__ for step in STEPS]
    assert len(set(names)) == len(names)
    assert names[-1] == "_paragraph"


def test_a_parameter_keeps_its_own_reason_beside_a_misfit_without_a_name() -> None:
    """A size that varies is told before that something has no name: so the order has it, and the
    later step alone would say the other."""
    made = diagnosis(Verdict.UNKNOWN)
    assert made.extended is not None
    name = made.extended.parameters[0].name
    own = replace(made.extended.parameters[0], verdict="weakly identified", reason="its own")
    extended = replace(made.extended, parameters=(own, *made.extended.parameters[1:]))
    case: Any = SimpleNamespace()
    found = completion._unnamed_misfit(replace(made, extended=extended), case)
    assert found.extended is not None
    assert found.extended.parameter(name).reason == "its own"
    order = [step.__name__ for step in STEPS]
    assert order.index("_varying_sizes") < order.index("_unnamed_misfit")


@pytest.mark.parametrize("step", ["_rounding", "_coarse_sampling"])
def test_averages_say_nothing_of_single_samples(step: str) -> None:
    """The mean of several samples lies between the steps of a converter."""
    case: Any = SimpleNamespace(averaged=2)
    made = replace(diagnosis(Verdict.UNKNOWN), descriptive=(FRICTION,))
    assert getattr(completion, step)(made, case) is made
