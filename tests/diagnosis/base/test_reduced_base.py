"""A base with a term less, where that predicts logs that were left out better."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import pytest
from linear_motion import linear_log

from softid.diagnosis.base import reduced_base
from softid.diagnosis.base.base_fit import Recordings, Request
from softid.diagnosis.base.reduced_base import reduced_base_issues, reduced_if_better, share_left
from softid.log import Log, LogSet
from softid.models import Muscle, Oscillator
from softid.models.base import Model

EXPONENTIAL, CONSTANT = Muscle(x_unit="rad"), Muscle(x_unit="rad", damping="constant")
LOGS = tuple(replace(linear_log(), name=f"{k} bar") for k in range(1, 4))


def begun(model: Model, error: float, instead_of: Any = None) -> Any:
    """A beginning of which only the model and the error on what is held out are known."""
    problem = SimpleNamespace(model=model, free=model.parameters().free)
    held = SimpleNamespace(rms=lambda base: error if base.problem is problem else 2.0)
    return SimpleNamespace(
        candidate=SimpleNamespace(problem=problem),
        scale=None,
        held_out=held,
        instead_of=instead_of,
        gauges={},
    )


@dataclass(frozen=True)
class Table(Request):
    """Errors by the damping and the log left out, instead of fits."""

    errors: Mapping[tuple[str, str], float] = None  # type: ignore[assignment]

    def fit_base(self, logs: LogSet, hold_out: Sequence[Log], *, thorough: bool) -> Any:
        assert isinstance(self.model, Muscle)
        left_out = hold_out[0].name
        assert left_out not in [log.name for log in logs]
        return begun(self.model, self.errors[self.model.damping, left_out], self.instead_of)


def request(constant: Sequence[float], **options: Any) -> Table:
    """The exponential damping leaves 1 on every log that is left out, and 1 on the hold-out."""
    names = [*(log.name for log in LOGS), "other"]
    errors = dict.fromkeys((("exponential", name) for name in names), 1.0)
    errors |= {("constant", n): e for n, e in zip(names, (*constant, 0.7), strict=True)}
    wishes = {"model": "muscle", "parameters": None, "seed": 0, "progress": None} | options
    return Table(**wishes, errors=errors)


def recordings(count: int = 3) -> Recordings:
    return Recordings(LogSet(LOGS[:count]), (replace(linear_log(seed=9), name="other"),))


@pytest.fixture(autouse=True)
def structure(monkeypatch: pytest.MonkeyPatch) -> None:
    """The base leaves structure; what it leaves is not computed here."""
    left = SimpleNamespace(structured=True)
    monkeypatch.setattr(reduced_base, "assess", lambda *args, rng, gauges: left)


def test_a_muscle_may_do_without_growing_damping() -> None:
    """Once only, and not where there is no damping at all; the oscillator has none to give up."""
    assert EXPONENTIAL.plainer() == CONSTANT
    assert CONSTANT.plainer() is None
    assert Muscle(order="static").plainer() is None
    assert Oscillator().plainer() is None


def test_the_share_left_is_a_geometric_mean() -> None:
    """By hand: (½ · 2 · ⅛)^(1/3) = ½."""
    table = request((0.5, 2.0, 0.125))
    assert share_left(recordings(), table, CONSTANT, EXPONENTIAL) == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("constant", "changes"),
    [((0.94, 0.94, 0.94), True), ((0.96, 0.96, 0.96), False), ((0.5, 1.2, 1.4), True)],
)
def test_the_reduced_base_must_predict_better(constant: Sequence[float], changes: bool) -> None:
    """Stands on the share of 0.95; what it takes the place of is remembered and told."""
    start = begun(EXPONENTIAL, 1.0)
    wishes, found = reduced_if_better(recordings(), request(constant), start)
    assert found.candidate.problem.model == (CONSTANT if changes else EXPONENTIAL)
    assert found.instead_of is (start if changes else None)
    assert (wishes.model == CONSTANT) is changes
    told = [issue.message for issue in reduced_base_issues(found, unit="deg", factor=10.0)]
    assert len(told) == changes
    if changes:
        assert told[0].startswith("a2 and b2 of the muscle model did not carry over")
        assert "7 deg without and 20 deg with them" in told[0]


def test_a_base_stays_where_it_cannot_or_need_not_change(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two logs, values that the user gave, a model that has nothing to give up, and noise."""
    better = (0.1, 0.1, 0.1)
    start = begun(EXPONENTIAL, 1.0)
    assert reduced_if_better(recordings(2), request(better), start)[1] is start
    bounded = request(better, parameters=EXPONENTIAL.parameters())
    assert reduced_if_better(recordings(), bounded, start)[1] is start
    plain = begun(CONSTANT, 1.0)
    assert reduced_if_better(recordings(), request(better), plain)[1] is plain
    noise = SimpleNamespace(structured=False)
    monkeypatch.setattr(reduced_base, "assess", lambda *args, rng, gauges: noise)
    assert reduced_if_better(recordings(), request(better), start)[1] is start
