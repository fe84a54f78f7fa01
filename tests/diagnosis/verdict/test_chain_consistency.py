"""Which names a chain carries as a whole."""

from __future__ import annotations

from dataclasses import replace

import pytest
from handmade_diagnosis import cause, estimate, remainder
from handmade_rounds import candidate, ranked

from softid.diagnosis.search.forward_selection import Link
from softid.diagnosis.verdict.chain_consistency import (
    consistent_names,
    mending,
    named_together,
)
from softid.diagnosis_results import Cause, Doubt


def links(*keys: str, squares: tuple[float, ...]) -> list[Link]:
    """A chain of effects with the sum of squares before each of them."""
    found = []
    for k, before in enumerate(squares):
        base = ranked(keys[:k], 0.0, before)
        chosen = ranked(keys[: k + 1], -500.0, 0.5 * before)
        found.append(Link(base, (chosen, base), chosen, (keys[k].split(".")[0],), (), before))
    return found


def causes(*keys: str, at_bound: str = "") -> list[Cause]:
    sizes = {key: replace(estimate("size", 1.0, "1"), at_bound=key == at_bound) for key in keys}
    return [cause(key, [size], before=2.0, after=1.0) for key, size in sizes.items()]


@pytest.mark.parametrize(
    ("keys", "squares", "bound", "kept"),
    [
        (("stiffening", "contact"), (100.0, 2.0), "", (True, False)),
        (("stiffening", "contact"), (100.0, 40.0), "", (True, True)),
        (("stiffening", "contact"), (100.0, 40.0), "contact", (True, False)),
        (("stiffening", "creep"), (100.0, 2.0), "creep", (True, True)),
        (("stiffening", "static_curve"), (100.0, 40.0), "", (False, False)),
        (
            ("stiffening", "asymmetric_damping", "static_curve"),
            (100.0, 40.0, 30.0),
            "",
            (False,) * 3,
        ),
        (("hysteresis", "coulomb_friction"), (100.0, 70.0), "coulomb_friction", (True, False)),
        (("pneumatic_lag", "sensor_lag"), (100.0, 3.0), "", (True, False)),
        (("pneumatic_lag", "delay"), (100.0, 3.0), "", (True, True)),
    ],
)
def test_which_names_stay(
    keys: tuple[str, ...], squares: tuple[float, ...], bound: str, kept: tuple[bool, ...]
) -> None:
    """By the rules: a slight or bounded second law of one kind mends the first, but no delay does;
    a curve beside a stiffening stands for neither, and what is left must be the larger part. One
    square is left."""
    chain = links(*keys, squares=squares)
    told = causes(*keys, at_bound=bound)
    assert consistent_names(chain, told, (True,) * len(keys), 1.0) == kept


@pytest.mark.parametrize(
    ("named", "squares", "kept"),
    [
        ((False, True), (100.0, 40.0), (False, False)),
        ((True, False), (100.0, 40.0), (False, False)),
        ((True, False), (100.0, 2.0), (True, False)),
    ],
)
def test_a_curve_beside_a_described_stiffening_stands_for_neither(
    named: tuple[bool, bool], squares: tuple[float, float], kept: tuple[bool, bool]
) -> None:
    """Whatever forbade one of the names, unless the second took a hundredth of the first."""
    chain = links("stiffening", "static_curve", squares=squares)
    assert consistent_names(chain, causes("stiffening", "static_curve"), named, 1.0) == kept


@pytest.mark.parametrize(("stuck", "kept"), [(1, (True, True)), (2, (True, False))])
def test_a_curve_that_asks_for_more_than_it_may_have_is_no_further_cause(
    stuck: int, kept: tuple[bool, bool]
) -> None:
    """One knot at its bound may come with the common slope, two draw something else."""
    chain = links("ageing", "static_curve", squares=(100.0, 40.0))
    knots = [
        replace(estimate(f"static_curve_k{k}", 1.0, "mm"), at_bound=k <= stuck + 1)
        for k in range(2, 7)
    ]
    told = [*causes("ageing"), cause("static_curve", knots, before=2.0, after=1.0)]
    assert consistent_names(chain, told, (True, True), 1.0) == kept


def test_what_may_mend_the_law_of_another_is_told_so() -> None:
    """The contact took 1 of 99; a delay beside a lag is another law, however little it takes."""
    chain, told = (
        links("stiffening", "contact", squares=(100.0, 2.0)),
        causes("stiffening", "contact"),
    )
    kept, reasoned = named_together(chain, told, (True, True), 1.0)
    assert kept == (True, False)
    assert [cause.doubt for cause in reasoned] == [None, Doubt.DWARFED]
    late = links("pneumatic_lag", "delay", squares=(100.0, 3.0))
    kept, reasoned = named_together(late, causes("pneumatic_lag", "delay"), (True, True), 1.0)
    assert kept == (True, True)
    assert [cause.doubt for cause in reasoned] == [None, None]


@pytest.mark.parametrize(("bound", "kept"), [("", (True, True)), ("contact", (True, False))])
def test_what_brings_a_number_of_another_back_from_its_bound_mends_no_law(
    bound: str, kept: tuple[bool, bool]
) -> None:
    """The clipping took 1 of 99, and the size of the contact ends at a bound without it."""
    keys = ("contact", "sensor_clipping")
    first, second = links(*keys, squares=(100.0, 2.0))
    first = replace(first, found=candidate(keys[:1], at_bound=["size"]))
    told = causes(*keys, at_bound=bound)
    assert consistent_names([first, second], told, (True, True), 1.0) == kept
    assert named_together([first, second], told, (True, True), 1.0)[0] == kept


def test_a_cause_beside_a_larger_description_is_none() -> None:
    """The first takes 60 of 99 and may not be named; the second took 39 on top of it."""
    chain = links("stiffening", "creep", squares=(100.0, 40.0))
    told = causes("stiffening", "creep")
    assert consistent_names(chain, told, (False, True), 1.0) == (False, False)
    assert consistent_names(chain, told, (True, False), 1.0) == (True, False)


@pytest.mark.parametrize(
    ("keys", "squares", "excess", "pieces"),
    [
        (("stiffening", "contact.lower"), (100.0, 40.0), 0.2, {"contact.lower"}),
        (("stiffening", "contact.lower"), (100.0, 40.0), 0.07, set()),
        (("stiffening", "contact.lower"), (100.0, 90.0), 0.2, {"stiffening", "contact.lower"}),
        (("stiffening", "creep"), (100.0, 40.0), 0.2, set()),
        (
            ("contact", "stiffening", "pressure_mass", "delay"),
            (100.0, 5.0, 4.0, 2.0),
            0.2,
            {"stiffening", "pressure_mass"},
        ),
        (("contact", "stiffening", "creep"), (100.0, 20.0, 10.0), 0.2, {"stiffening"}),
        (("pneumatic_lag", "delay"), (100.0, 40.0), 0.2, set()),
        (
            ("hysteresis", "creep", "coulomb_friction"),
            (100.0, 40.0, 20.0),
            0.2,
            {"creep", "coulomb_friction"},
        ),
    ],
)
def test_two_that_are_alike_and_leave_more_than_noise_are_pieces(
    keys: tuple[str, ...], squares: tuple[float, ...], excess: float, pieces: set[str]
) -> None:
    """By the rule: the later one, the earlier one where it takes less, and what is slight beside
    the larger of them; a delay has one form. The noise is known to 3 %, so 7 % more than it
    is noise."""
    left = replace(remainder(structured=False, explained=0.99), excess=excess, noise_sd=0.03)
    assert mending(links(*keys, squares=squares), 1.0, left) == pieces
