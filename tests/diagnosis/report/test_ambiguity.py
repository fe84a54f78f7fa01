"""Why causes are tied and what to record next, for ties and remainders made by hand."""

from __future__ import annotations

from dataclasses import replace

import pytest
from extended_fits import scale_of
from handmade import fit_result
from handmade_diagnosis import FRICTION, cause, estimate, remainder

from softid.diagnosis.report.ambiguity import (
    is_linear_beside,
    law_that_ties,
    told_as_tied,
    what_next,
    why_tied,
    with_presliding,
)
from softid.diagnosis.search.contenders import INDISTINCT
from softid.diagnosis.verdict.equivalence import (
    LINEAR_FILTERS,
    PRESLIDING,
    TWO_LATE,
    EquivalenceClass,
)
from softid.diagnosis.verdict.laws_alike import (
    HELD_INPUT,
    LOWER_END,
    ONE_WAY,
    OWN_DAMPING,
    THINNING,
)
from softid.diagnosis.verdict.separations import CHIRP
from softid.diagnosis_results import Alternative, Doubt, Remainder, Verdict
from softid.effects import EFFECTS

NOISE = remainder(structured=False, explained=1.0)
FAR = INDISTINCT + 1.0


def tie(*keys: str, behind: float = 3.0) -> Alternative:
    """Causes of which each explains the logs so much worse than the one before."""
    names = tuple(key.split(".")[0] for key in keys)
    return Alternative(names, {name: k * behind for k, name in enumerate(names)}, "", keys)


def left(**by: float) -> Remainder:
    """A remainder of which variables predict these shares."""
    return replace(remainder(structured=True, explained=0.6), by=by)


@pytest.mark.parametrize(
    ("keys", "own", "commute"),
    [
        (["sensor_drift"], ["sensor_drift"], True),
        (["sensor_drift", "creep", "delay"], ["sensor_drift"], True),
        (["sensor_drift", "stiffening"], ["sensor_drift"], False),
        (["pneumatic_lag.separate"], ["pneumatic_lag", "asymmetric_damping"], True),
        (["pneumatic_lag.separate", "creep"], ["creep"], False),
    ],
)
def test_operations_commute_beside_what_is_linear(
    keys: list[str], own: list[str], commute: bool
) -> None:
    """A law that bends tells what comes before it from what comes behind; those that are asked do
    not count, and a muscle is not linear itself."""
    laws = [cause(key, [], before=2.0, after=1.0) for key in keys]
    assert is_linear_beside(laws, own, linear=True) is commute
    assert not is_linear_beside(laws, own, linear=False)


@pytest.mark.parametrize(
    ("names", "behind", "share", "is_one_law"),
    [
        (("coulomb_friction", "hysteresis"), FAR, 0.02, True),
        (("coulomb_friction", "hysteresis"), FAR, 0.1, False),
        (("coulomb_friction", "hysteresis"), 3.0, 0.02, True),
        (("hysteresis", "creep"), FAR, 0.02, False),
    ],
    ids=["one law", "a long way to slide", "as likely", "another tie"],
)
def test_friction_that_gives_way_soon_is_a_hysteresis(
    names: tuple[str, ...], behind: float, share: float, is_one_law: bool
) -> None:
    """Tied however far apart they are; not where it gives way over a good part of the range."""
    scale = scale_of("muscle")
    zs = estimate("hysteresis_zs", share * scale.x_span, "mm")
    loop = cause("hysteresis", [zs], before=2.0, after=1.0)
    apart = tie(*names, behind=behind)
    (found,) = with_presliding([apart], [loop], scale)
    assert found.why.startswith(PRESLIDING.why) is is_one_law
    asked = what_next(Verdict.AMBIGUOUS, alternatives=[found], remainder=NOISE)
    assert (asked == f"record {PRESLIDING.splits}") is is_one_law


@pytest.mark.parametrize(
    ("first", "law"), [("sensor_clipping.lower", LOWER_END), ("static_curve", None)]
)
def test_a_lower_limit_is_told_of_a_lower_limit(first: str, law: EquivalenceClass | None) -> None:
    """A curve that ties with a dead zone and a limit of the sensor has no lower limit in it."""
    others = [key for key in ("sensor_clipping", "dead_zone") if key not in first]
    assert law_that_ties(tie(first, *others), linear=False) is law


@pytest.mark.parametrize("linear", [True, False])
def test_two_that_only_together_explain_as_much_are_told_so(linear: bool) -> None:
    """A lag or a delay alone is behind the resonance; where each is near it, either may do."""
    together = tie(*TWO_LATE.effects, behind=FAR)
    assert law_that_ties(together, linear=linear) is TWO_LATE
    asked = what_next(Verdict.AMBIGUOUS, alternatives=[together], remainder=NOISE, linear=linear)
    assert asked == f"record {TWO_LATE.splits}"
    assert law_that_ties(tie(*TWO_LATE.effects, behind=1.0), linear=False) is None


@pytest.mark.parametrize("known", LINEAR_FILTERS, ids=lambda known: known.effects[0])
def test_filters_change_places_in_a_linear_model_alone(known) -> None:
    """A muscle's stiffness goes with the pressure, so there the logs might split them."""
    pair = tie(*known.effects)
    assert law_that_ties(pair, linear=True) is known
    assert law_that_ties(tie(*known.effects, "delay"), linear=True) is known
    assert law_that_ties(tie(known.effects[0], "delay"), linear=True) is None
    assert law_that_ties(pair, linear=False) is None
    assert why_tied(pair, linear=True) == f"{known.why}. What splits them: {known.splits}."
    asked = what_next(Verdict.AMBIGUOUS, alternatives=[pair], remainder=NOISE, linear=True)
    assert asked == f"record {known.splits}"


def test_a_tie_says_whether_its_causes_explain_alike() -> None:
    """Up to the limit of the search they do; beyond it they differ by less than what all leave."""
    alike = why_tied(tie("delay", "pneumatic_lag", behind=INDISTINCT - 0.1), linear=False)
    apart = why_tied(tie("delay", "pneumatic_lag", behind=INDISTINCT), linear=False)
    assert "equally well" in alike
    assert "equally well" not in apart
    assert "outweighs" in apart


@pytest.mark.parametrize("behind", [0.0, 9.9, 10.0, INDISTINCT - 0.1, INDISTINCT, FAR])
def test_two_sentences_on_one_tie_agree_whether_its_causes_explain_alike(behind: float) -> None:
    """Up to the limit of the search the best is so by a little, and both explain equally well."""
    pair = tie("delay", "pneumatic_lag", behind=behind)
    why, told = why_tied(pair, linear=False), told_as_tied(pair, "Delay", linear=False)
    assert (
        ("The best by a little, delay," in told) == ("equally well" in why) == (behind < INDISTINCT)
    )
    assert ("it leads by less than all of them leave unexplained, delay," in told) == (
        behind >= INDISTINCT
    )


def test_the_experiment_splits_the_first_from_the_others() -> None:
    """A chirp sets a delay and a lag 4.9 units of noise apart, the most of all (the table)."""
    ties = [tie("delay", "pneumatic_lag"), tie("creep", "sensor_warmup")]
    asked = what_next(Verdict.AMBIGUOUS, alternatives=ties, remainder=NOISE)
    assert asked == f"record {CHIRP}, to tell delay of the input from lag of the pneumatics"
    three = tie("delay", "pneumatic_lag", "sensor_lag")
    asked = what_next(Verdict.AMBIGUOUS, alternatives=[three], remainder=NOISE)
    assert asked is not None
    assert asked.endswith("from lag of the pneumatics or lag of the sensor")


def test_what_an_unknown_remainder_follows_from_comes_before_ties() -> None:
    """What none of them explains comes first, where it says what to vary."""
    lag = tie("delay", "pneumatic_lag")
    asked = what_next(Verdict.UNKNOWN, alternatives=[lag], remainder=left(x=0.3))
    assert asked == "repeat these logs with more positions over the whole range"


@pytest.mark.parametrize("remainder", [left(x=0.01), NOISE])
def test_descriptions_that_are_not_told_apart_ask_for_what_shows_each(remainder: Remainder) -> None:
    """The catalogue's words for a drift and a warm-up, which the same path at two speeds does not
    tell; nothing of the kind where they describe next to nothing.
    """
    drifts = [tie("sensor_drift", "sensor_warmup")]
    asked = what_next(Verdict.UNKNOWN, alternatives=drifts, remainder=remainder)
    shown = "; ".join(EFFECTS[key].shown_by for key in drifts[0].effects)
    assert asked == f"record {shown}, to tell drift of the sensor from warm-up of the sensor"
    little = replace(remainder, explained_share=0.2)
    other = what_next(Verdict.UNKNOWN, alternatives=drifts, remainder=little)
    assert other == what_next(Verdict.UNKNOWN, alternatives=(), remainder=little)


@pytest.mark.parametrize(
    ("by", "asked"),
    [
        ({"t": 0.3}, "record the same for longer, to see how it goes on"),
        ({"t": 0.3, "p": 0.2}, "repeat these logs with more levels of the input"),
        ({"v": 0.1, "x": 0.3, "p": 0.05}, "repeat these logs with more positions over the whole "
         "range and slower and faster moves"),
        ({"x": 0.01}, "record the same path once slowly and once fast"),
    ],
)  # fmt: skip
def test_what_predicts_the_rest_is_varied(by: dict[str, float], asked: str) -> None:
    """The two variables that predict most of it, each above 2 %; a rest is asked for if none was
    there."""
    for verdict in (Verdict.UNKNOWN, Verdict.PARTIAL):
        found = left(**by)
        assert what_next(verdict, alternatives=(), remainder=found) == asked
        blind = replace(found, noise_from_rest=False)
        rest = ", and with a rest of 30 s that shows the noise"
        assert what_next(verdict, alternatives=(), remainder=blind) == asked + rest


def test_a_description_of_noise_alone_asks_for_more() -> None:
    """Nothing is left that follows from the motion, yet nothing may be named."""
    asked = what_next(Verdict.UNKNOWN, alternatives=(), remainder=NOISE)
    assert asked is not None
    assert "how sure the description is" in asked


@pytest.mark.parametrize("verdict", [Verdict.ADEQUATE, Verdict.NAMED, Verdict.AMBIGUOUS])
def test_nothing_more_is_asked_for(verdict: Verdict) -> None:
    """Where all is explained, or one cause stands where two were looked for."""
    assert what_next(verdict, alternatives=(), remainder=left(x=0.3)) is None
    assert what_next(verdict, alternatives=[tie("delay")], remainder=NOISE) is None


def test_one_law_for_all_causes_is_told_once() -> None:
    """What another cause would be beside it is told in short."""
    first, second = tie("sensor_resonance", "swinging_part"), tie("smoothing", "swinging_part")
    alone = told_as_tied(second, "Smoothing", linear=False)
    assert "most likely the last" in alone
    more = told_as_tied(second, "Smoothing", linear=False, leaves_noise=False)
    assert "the logs do not say which" in more
    again = told_as_tied(second, "Smoothing", linear=False, earlier=[first])
    assert again == "that law again, or smoothing of the record afterwards. As smoothing it"
    other = tie("delay", "input_play")
    assert told_as_tied(second, "Smoothing", linear=False, earlier=[other]) == alone


def test_after_a_single_step_more_steps_are_asked_for() -> None:
    """Whatever else is open."""
    doubted = replace(FRICTION, doubt=Doubt.ONE_STEP)
    told = what_next(
        Verdict.UNKNOWN, alternatives=[tie("delay", "creep")], remainder=NOISE, laws=[doubted]
    )
    assert told is not None
    assert "several steps" in told


@pytest.mark.parametrize(("in_blocks", "word"), [(False, "hold out none"), (True, "once more")])
def test_blocks_are_not_asked_for_where_they_judge(in_blocks: bool, word: str) -> None:
    """Softening begins anew with every log; a hold-out that fails may have begun worn in."""
    laws = [cause("softening", [], before=2.0, after=1.0)]
    missed = replace(NOISE, misses_held_out=True)
    told = what_next(
        Verdict.UNKNOWN, alternatives=(), remainder=missed, laws=laws, in_blocks=in_blocks
    )
    assert told is not None
    assert word in told


@pytest.mark.parametrize("linear", [True, False])
@pytest.mark.parametrize(
    ("keys", "known"),
    [
        (("coulomb_friction.stribeck", "thinning_damping"), THINNING),
        (("coulomb_friction", "giving_way"), ONE_WAY),
        (("delay", "sensor_lag", "held_input"), HELD_INPUT),
        (("pneumatic_lag", "held_input"), HELD_INPUT),
        (("pneumatic_lag.level", "position_damping"), OWN_DAMPING),
    ],
)
def test_a_law_in_no_catalogue_says_why_and_what_splits_it(
    keys: tuple[str, ...], known: EquivalenceClass, linear: bool
) -> None:
    """Whatever else is in the tie."""
    tied = tie(*keys)
    assert law_that_ties(tied, linear=linear) is known
    assert why_tied(tied, linear=linear) == f"{known.why}. What splits them: {known.splits}."
    told = what_next(Verdict.AMBIGUOUS, alternatives=[tied], remainder=NOISE, linear=linear)
    assert told == f"record {known.splits}"


@pytest.mark.parametrize(
    ("keys", "own", "told"),
    [
        (("line_resonance", "sensor_resonance"), (0.01, 5.0, 0.2), "own, here 0.2 s and 0.2."),
        (("pneumatic_lag", "sensor_lag"), (0.3, None, None), "ring, here 0.3 s."),
        (("pneumatic_lag", "sensor_lag"), (0.3, 1.125395, 1.06066), "ring, here 0.2 s and 0.1 s."),
        (("pneumatic_lag", "sensor_lag"), (0.01, 5.0, 0.2), "that does not ring."),
    ],
)
def test_what_may_change_places_is_told_in_numbers(
    keys: tuple[str, ...], own: tuple[float | None, ...], told: str
) -> None:
    """Closed form: poles of 0.2 and 0.1 s are √50/2π = 1.125 Hz and a damping of 0.3·√50/2."""
    names = ("time_constant", "natural_frequency", "damping_ratio")
    known = {name: (value, "") for name, value in zip(names, own, strict=True) if value is not None}
    why = why_tied(tie(*keys), linear=True, extended=replace(fit_result(), derived=known))
    assert told in why
