"""What copies know alike is not sent; whether they do is asked."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import dataclass, replace
from functools import cached_property, partial
from types import MappingProxyType

import numpy as np
import pytest

from softid.parallel.known_objects import FEW_NUMBERS, KnownObjects, NotKnownError


@dataclass(frozen=True, eq=False)
class Signal:
    """A value as those of softid: frozen, with something worked out by the way."""

    values: np.ndarray
    name: str
    parts: MappingProxyType[str, object]

    @cached_property
    def total(self) -> float:
        return float(self.values.sum())


class Plain:
    """The same without declared fields."""

    def __init__(self, level: float) -> None:
        self.level = level

    @cached_property
    def double(self) -> float:
        return 2.0 * self.level


def signal_of(level: float = 1.0, size: int = 500) -> Signal:
    return Signal(np.full(size, level), "pressure", MappingProxyType({"a": Plain(level)}))


def test_another_copy_reads_its_own_in_place_of_what_is_known() -> None:
    """However deep, and also inside something new; a signal takes no bytes."""
    ours = signal_of()
    theirs = deepcopy(ours.parts["a"]), signal_of()
    theirs = Signal(ours.values.copy(), "pressure", MappingProxyType({"a": theirs[0]}))
    new = replace(ours, name="angle")
    data = KnownObjects(abs, [ours]).packed({0: (ours, ours.parts["a"], new)})
    same, part, other = KnownObjects(abs, [theirs]).unpacked(data)[0]
    assert same is theirs
    assert part is theirs.parts["a"]
    assert other.name == "angle"
    assert other.values is theirs.values
    assert len(data) < ours.values.nbytes / 4


def test_what_was_worked_out_by_the_way_is_no_difference() -> None:
    """One copy has asked for a sum, the other has not: they mean the same."""
    ours, theirs = signal_of(), signal_of()
    assert ours.total == 500.0
    assert ours.parts["a"].double == 2.0  # type: ignore[attr-defined]
    data = KnownObjects([ours]).packed(ours)
    assert KnownObjects([theirs]).unpacked(data) is theirs


def scaled(factor: float, signal: Signal) -> float:
    return factor * signal.total


@pytest.mark.parametrize(
    ("ours", "theirs"),
    [
        (signal_of(), signal_of(2.0)),
        (signal_of(), replace(signal_of(), name="angle")),
        (signal_of(), signal_of(size=501)),
        (np.zeros(FEW_NUMBERS), np.eye(1, FEW_NUMBERS)[0]),
        ([1, 2], [2, 1]),
        ([[], [1]], [[[], 1]]),
        (np.arange(1000), np.arange(1000) * 2),
        (np.zeros(6), np.zeros((2, 3))),
        (dict.fromkeys({1, 64}), dict.fromkeys({64})),
        (range(3), range(4)),
        (partial(scaled, 1.0), partial(scaled, 2.0)),
        (scaled, abs),
        (Plain(1.0).__eq__, Plain(1.0).__ne__),
    ],
    ids=[
        "level",
        "name",
        "size",
        "numbers",
        "order",
        "nesting",
        "signal",
        "shape",
        "set",
        "range",
        "argument",
        "function",
        "method",
    ],
)
def test_a_difference_is_noticed(ours: object, theirs: object) -> None:
    """In a number, a name, a length, an order, or in what is to be done."""
    data = KnownObjects(ours).packed(0)
    with pytest.raises(NotKnownError):
        KnownObjects(theirs).unpacked(data)


def test_what_cannot_be_read_is_not_known() -> None:
    """Half of a message, say."""
    known = KnownObjects([signal_of()])
    data = known.packed(np.arange(1000.0))
    with pytest.raises(NotKnownError):
        known.unpacked(data[:-100])
