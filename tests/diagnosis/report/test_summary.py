"""The paragraph of each verdict: its numbers are those of the diagnosis, and no more is claimed."""

from __future__ import annotations

from dataclasses import replace

import pytest
from handmade_diagnosis import DELAY, FRICTION, TIE, cause, diagnosis, estimate, odd_diagnosis

from softid.diagnosis.report.ambiguity import SPLITS, is_linear, what_next
from softid.diagnosis.report.issues import restriction_issues
from softid.diagnosis.report.remarks import Remarks
from softid.diagnosis.report.rest_phrases import PREDICTORS
from softid.diagnosis.report.summary import summarise, write_summary
from softid.diagnosis.verdict.equivalence import PRESLIDING
from softid.diagnosis_results import Alternative, Diagnosis, Doubt, Evidence, Verdict
from softid.effects import EFFECTS


def told(found: Diagnosis) -> str:
    """Its paragraph without a remark."""
    return summarise(found, Remarks())


@pytest.mark.parametrize("verdict", Verdict)
def test_every_paragraph_is_short_and_in_the_units_of_the_log(verdict: Verdict) -> None:
    """The held-out error of step_2 is 2 degrees, 16 % of 12.5; the record itself is in radians."""
    text = told(diagnosis(verdict))
    what = "follows angle to" if verdict is Verdict.ADEQUATE else "misses angle by"
    assert text.startswith(f"The muscle model {what} 2 deg rms on held-out samples (fit 84 %).")
    assert len(text.split()) < 200
    assert " rad " not in text.replace("rad/s", "")
    assert text.endswith(".")
    assert ".." not in text
    assert "nan" not in text


def held_out_at(found: Diagnosis, factor: float) -> Diagnosis:
    """With an error on what is held out of so many times what is left of the fitted samples."""
    error = factor * found.remainder.rms
    gains = tuple(replace(g, rmse_before=error, rmse_after=error) for g in found.gains)
    return replace(found, gains=gains)


def test_adequate_claims_no_cause() -> None:
    """Nothing to name, and the chance that it is compared with is told."""
    text = told(held_out_at(diagnosis(Verdict.ADEQUATE), 1.1))
    assert "None of the effects tried" in text
    assert "no more of it follows from the motion, the input and the time than chance" in text
    assert "cause" not in text
    assert "nothing to mend" in text


def test_a_model_that_is_no_better_than_a_constant_is_not_praised() -> None:
    """A held-out fit below zero: nothing can be said of the model."""
    found = diagnosis(Verdict.ADEQUATE)
    poor = tuple(replace(gain, fit_percent_before=-46.0) for gain in found.gains)
    assert "nothing to mend" not in told(replace(found, gains=poor))
    assert "too little to judge the model" in told(replace(found, gains=poor))


def test_without_a_rest_adequate_is_said_with_a_reserve() -> None:
    """Noise that was never seen alone may hide a slow misfit."""
    found = diagnosis(Verdict.ADEQUATE)
    unseen = replace(found, remainder=replace(found.remainder, noise_from_rest=False))
    assert "could hide in it" in told(unseen)
    assert "could hide in it" not in told(found)


@pytest.mark.parametrize("verdict", [Verdict.ADEQUATE, Verdict.NAMED])
def test_slow_noise_without_a_rest_is_told_with_a_reserve(verdict: Verdict) -> None:
    """The verdict stands on the marks of noise alone, and says so."""
    found = diagnosis(verdict)
    left = replace(found.remainder, noise_from_rest=False, colour_s=0.84)
    text = told(replace(found, remainder=left))
    assert "slow noise with a correlation time of 0.84 s" in text
    assert "could hide in it" in text


def test_an_adequate_model_that_misses_what_is_held_out_is_not_praised() -> None:
    """The fitted samples leave noise of 0.2 degrees; held out are six times as much."""
    text = told(held_out_at(diagnosis(Verdict.ADEQUATE), 6.0))
    assert "The held-out samples keep more, 1.2 deg" in text
    assert "nothing to mend" not in text


def test_named_says_what_how_much_why_and_what_to_do() -> None:
    """1 - 0.5/2 is 75 %; hysteresis is 412 - 300 behind; remedy and neighbours of the catalogue."""
    text = told(diagnosis(Verdict.NAMED))
    assert "The cause: dry friction (coulomb_friction) with Fc = 0.08 [0.076, 0.084]" in text
    assert "vs = 0.02 [0.019, 0.021] rad/s" in text
    assert "gain 75 %, 95 % interval 70 to 80 %; fit 96 %" in text
    assert "the next best, hysteresis of the material, stays 112 behind" in text
    assert "easily confused with hysteresis of the material" in text
    assert "explain these logs less well" not in text  # two of the neighbours were not tried
    assert "In hardware: lubricate or align the guides" in text


def test_a_class_is_named_as_a_whole() -> None:
    """A delay and an offset of the clocks are the same algebra, so neither is named alone."""
    text = told(replace(diagnosis(Verdict.NAMED), causes=(DELAY,)))
    both = "a delay of the input or an offset between the clocks of the two channels (delay)"
    assert f"The cause: {both}" in text
    assert "No log of pressure and motion tells which: both shift the motion in time" in text


def test_partial_names_the_rest() -> None:
    """Speed (31 %) and earlier input (22 %) are told, position (1 %) is not."""
    found = diagnosis(Verdict.PARTIAL)
    text = told(found)
    assert "That is 95 % of the misfit above the noise." in text
    assert f"37 % of its power follows from {PREDICTORS}, where chance reaches 3 %" in text
    assert "most of it from the speed and the input a while before." in text
    assert "the position" not in text
    elsewhere = replace(found.remainder, misses_held_out=True, held_out_share=0.8)
    missing = told(replace(found, remainder=elsewhere))
    assert "on the fitted samples and 80 % on those held out." in missing
    assert "The held-out samples keep more" in missing
    whole = told(replace(found, remainder=replace(found.remainder, explained_share=1.0)))
    assert "rms on the fitted samples, has no more power than the noise, yet is not" in whole
    assert "of the misfit above the noise" not in whole


def test_ambiguous_names_the_set_and_what_splits_it() -> None:
    """Both names, the chirp of the table, and no remedy for a cause that is not sure."""
    found = diagnosis(Verdict.AMBIGUOUS)
    following = what_next(found.verdict, alternatives=found.alternatives, remainder=found.remainder)
    assert following is not None
    text = told(replace(found, next_experiment=following))
    assert "delay of the input or lag of the pneumatics" in text
    assert "the logs do not say which" in text
    assert "record a chirp from slow to fast" in text
    assert "In hardware" not in text


def test_unknown_names_no_cause() -> None:
    """The best description is called a description, with the share that it takes away."""
    text = told(diagnosis(Verdict.UNKNOWN))
    assert "none of the effects tried can be named" in text
    assert "The best description, dry friction, takes away 60 %" in text
    assert "The cause" not in text
    assert "In hardware" not in text


def test_what_does_not_carry_over_is_no_cause() -> None:
    """The share on what is held out is told beside that on the fitted samples."""
    found = diagnosis(Verdict.UNKNOWN)
    text = told(replace(found, remainder=replace(found.remainder, held_out_share=0.37)))
    assert "60 % of the misfit above the noise on the fitted samples but 37 % on those" in text
    quiet = replace(found.remainder, held_out_share=0.37, structured=False)
    assert "looks like noise" in told(replace(found, remainder=quiet))


def test_slow_noise_of_the_size_of_a_rest_is_noise() -> None:
    """A structure that does not make the residual larger is not told as one."""
    found = diagnosis(Verdict.ADEQUATE)
    left = replace(found.remainder, structure_share=0.13, structure_limit=0.04)
    text = told(replace(found, remainder=left))
    assert "looks like the noise of the rests: it is no larger." in text
    assert "13 %" not in text


def test_a_cause_that_gains_only_with_others_is_told() -> None:
    """Evidence is no evidence where the error rises."""
    worse = replace(FRICTION, holdout_rmse_after=1.1 * FRICTION.holdout_rmse_before)
    text = told(replace(diagnosis(Verdict.NAMED), causes=(worse, DELAY)))
    assert "though by itself the held-out error goes from" in text


def test_a_fit_without_motion_is_unknown() -> None:
    """A hold-out at rest has no fit in per cent; beside one that moves it is passed over."""
    found = diagnosis(Verdict.ADEQUATE)
    still = tuple(replace(gain, fit_percent_before=float("nan")) for gain in found.gains)
    assert "(fit unknown)" in told(replace(found, gains=still))
    assert "(fit 84 %)" in told(replace(found, gains=(*found.gains, *still)))


def test_a_base_that_gave_something_up_is_told() -> None:
    """The extended model has no b1: the gain is that of both, with the interval of the whole."""
    found = diagnosis(Verdict.NAMED)
    assert found.extended is not None
    kept = tuple(
        replace(p, fixed=True) if p.name in ("b1", "c1") else p for p in found.extended.parameters
    )
    found = replace(found, extended=replace(found.extended, parameters=kept), gain_ci95=(0.5, 0.8))
    text = write_summary(found).summary
    assert "Its b1 and c1 do not carry over to logs that are left out" in text
    assert "With it and without b1 and c1 the error goes from 2 deg to 0.5 deg" in text
    assert "(gain 75 %, 95 % interval 50 to 80 %" in text
    assert "the held-out error goes from" in text


def test_a_chain_tells_each_link() -> None:
    """Two causes in their order, each with its own error before and after."""
    second = replace(
        DELAY,
        added_to=(FRICTION.key,),
        holdout_rmse_before=FRICTION.holdout_rmse_after,
        delta_bic=60.0,
    )
    text = told(replace(diagnosis(Verdict.NAMED), causes=(FRICTION, second)))
    assert text.index("Cause 1: dry friction") < text.index("Cause 2: a delay")
    assert "the held-out error goes from 2 deg to 0.5 deg" in text
    assert "With all of them the error goes from 2 deg to 0.5 deg" in text
    assert "interval" not in text.partition("With all of them")[2]
    found = replace(diagnosis(Verdict.NAMED), causes=(FRICTION, second), gain_ci95=(0.6, 0.9))
    assert "(gain 75 %, 95 % interval 60 to 90 %; fit 96 %)" in told(found)


def test_numbers_that_are_missing_are_left_out() -> None:
    """No NaN reaches a sentence about the cause; the share of structure is not invented."""
    found = odd_diagnosis()
    text = told(replace(found, remainder=diagnosis(Verdict.NAMED).remainder, gains=()))
    assert "no sample of angle was left to judge it on" in text
    assert "nan" not in text
    assert "interval" not in text


def test_what_next_follows_the_verdict() -> None:
    """Nothing is open after a name; an unknown asks for variation of what the rest follows."""
    for verdict in (Verdict.ADEQUATE, Verdict.NAMED):
        found = diagnosis(verdict)
        assert what_next(verdict, alternatives=(), remainder=found.remainder) is None
    rest = diagnosis(Verdict.UNKNOWN).remainder
    asked = what_next(Verdict.UNKNOWN, alternatives=(), remainder=rest)
    assert asked == "repeat these logs with slower and faster moves and holds of several lengths"
    in_time = replace(rest, by={"t": 0.3})
    asked = what_next(Verdict.UNKNOWN, alternatives=(), remainder=in_time)
    assert asked == "record the same for longer, to see how it goes on"
    unseen = replace(rest, noise_from_rest=False, by={})
    asked = what_next(Verdict.UNKNOWN, alternatives=(), remainder=unseen)
    assert asked is not None
    assert "once slowly and once fast, and with a rest of 30 s" in asked


def test_a_search_among_few_effects_says_so() -> None:
    """A name found among three effects is no name found among all."""
    assert restriction_issues(()) == ()
    assert restriction_issues(tuple(EFFECTS)) == ()
    (issue,) = restriction_issues(("delay", "creep"))
    assert issue.message.startswith("only delay and creep were considered")
    assert issue.remedy


def test_a_presliding_is_told_as_one_law() -> None:
    """Friction 455 of BIC behind a short hysteresis is no close second, but the same law."""
    behind = {"hysteresis": 0.0, "coulomb_friction": 455.0}
    why = f"{PRESLIDING.why}{SPLITS}{PRESLIDING.splits}."
    tie = Alternative(("hysteresis", "coulomb_friction"), behind, why)
    made = diagnosis(Verdict.AMBIGUOUS)
    loop = cause("hysteresis", [estimate("hysteresis_zs", 0.1, "rad")], before=2.0, after=1.0)
    found = write_summary(
        replace(made, causes=(loop,), alternatives=(tie,), next_experiment=None, summary="")
    )
    assert "over so short a distance follows the same law" in found.summary
    assert "by a little" not in found.summary
    assert found.next_experiment == f"record {PRESLIDING.splits}"


def test_a_rival_that_is_ahead_is_not_behind() -> None:
    """The best by BIC raised the error on what is held out, so that the next one was taken."""
    rows = [Evidence(1, e, fall, 0.1) for e, fall in (("stiffening", 530.0), ("delay", 412.0))]
    made = diagnosis(Verdict.NAMED)
    drift = cause("delay", [estimate("delay_tau", 0.1, "s")], before=2.0, after=1.0)
    told = write_summary(replace(made, causes=(drift,), evidence=tuple(rows), summary="")).summary
    assert "stiffening with deformation lowers it more, but only where its law" in told
    assert "behind" not in told


def test_an_unknown_cause_still_says_what_cannot_be_split() -> None:
    """A description is no cause, but that others describe as much is worth a sentence."""
    text = told(replace(diagnosis(Verdict.UNKNOWN), alternatives=(TIE,)))
    assert "These logs do not tell delay of the input from lag of the pneumatics." in text
    far = replace(TIE, delta_bic={name: 300.0 * k for k, name in enumerate(TIE.effects)})
    text = told(replace(diagnosis(Verdict.UNKNOWN), alternatives=(far,)))
    assert "The lead of delay of the input over lag of the pneumatics is smaller than what" in text


def test_a_tie_is_told_in_the_form_that_is_meant() -> None:
    """The cause is the lower limit, so the tie is not one of the upper."""
    lower = cause(
        "sensor_clipping.lower",
        [estimate("sensor_clipping_lower", 0.1, "rad")],
        before=2.0,
        after=0.5,
    )
    tie = Alternative(
        ("sensor_clipping", "sensor_warmup"), {}, "", ("sensor_clipping.lower", "sensor_warmup")
    )
    made = replace(diagnosis(Verdict.AMBIGUOUS), causes=(lower,), alternatives=(tie,))
    made = write_summary(replace(made, next_experiment=None, summary=""))
    limit = "clipping of the sensor at its lower limit"
    assert f"{limit} or warm-up of the sensor. The best by a little, {limit}," in made.summary
    assert "upper" not in made.summary
    assert made.next_experiment is not None
    assert f"to tell {limit} from" in made.next_experiment
    unsure = told(replace(made, verdict=Verdict.UNKNOWN, causes=(), descriptive=(lower,)))
    assert f"do not tell {limit} from warm-up" in unsure


def test_a_description_between_two_causes_is_told() -> None:
    """2 → 1.5 by the first cause, 1.5 → 1 by what only describes, 1 → 0.5 by the second: without a
    word the second would begin at an error that the first does not end with."""
    first = cause("coulomb_friction", FRICTION.parameters, before=2.0, after=1.5)
    slow = [estimate("creep_k", 0.1, "1")]
    between = cause("creep", slow, before=1.5, after=1.0, added_to=[first.key])
    links = first.key, between.key
    second = cause("delay", DELAY.parameters, before=1.0, after=0.5, added_to=links)
    second = replace(second, delta_bic=60.0)
    made = replace(diagnosis(Verdict.PARTIAL), causes=(first, second), descriptive=(between,))
    creep = EFFECTS["creep"].title[:1].lower() + EFFECTS["creep"].title[1:]
    assert "error goes from 2 deg to 1.5 deg" in told(made)
    assert f"error goes from 1 deg, where {creep} has brought it, to 0.5 deg" in told(made)
    alone = replace(made, causes=(second,), descriptive=(between,))
    assert f"from 1 deg, where {creep} has brought it, to 0.5 deg" in told(alone)


def test_evidence_is_that_of_the_round_in_which_a_cause_was_found() -> None:
    """The delay came third, behind a description: its rivals are those of the third round."""
    second = replace(DELAY, added_to=(FRICTION.key, "creep"), delta_bic=60.0)
    evidence = (
        Evidence(1, "coulomb_friction", 412.0, 0.9),
        Evidence(2, "creep", 200.0, 0.5),
        Evidence(2, "ageing", 100.0, 0.4),
        Evidence(3, "delay", 60.0, 0.3),
        Evidence(3, "softening", 50.0, 0.2),
    )
    made = replace(diagnosis(Verdict.NAMED), causes=(FRICTION, second), evidence=evidence)
    text = told(made).partition("Cause 2")[2]
    softening = EFFECTS["softening"].title[:1].lower() + EFFECTS["softening"].title[1:]
    assert f"the next best, {softening}, stays 10 behind" in text


def test_a_lag_whose_times_may_be_one_is_told_as_a_lag() -> None:
    """The heading of a cause is that of the form as which it is told."""
    lag = cause("pneumatic_lag.separate", DELAY.parameters, before=2.0, after=0.5)
    apart = replace(diagnosis(Verdict.UNKNOWN), descriptive=(lag,))
    assert "differs by direction" in told(apart)
    plain = EFFECTS["pneumatic_lag"]
    one = replace(lag, title=plain.title, meaning=plain.meaning)
    assert "differs by direction" not in told(replace(apart, descriptive=(one,)))


def test_descriptions_are_a_list_and_their_bounds_are_told() -> None:
    """Three names, and the value that ends at its bound, which forbids its name."""
    stuck = replace(estimate("stiffening_k3", 25.0, "1/rad³"), at_bound=True)
    tried = tuple(
        cause(key, [value], before=2.0, after=0.5)
        for key, value in (
            ("stiffening", stuck),
            ("static_curve", estimate("static_curve_k1", 0.1, "rad")),
            ("clock_rate", estimate("clock_rate_rate", 1e-3, "1")),
        )
    )
    text = told(replace(diagnosis(Verdict.UNKNOWN), causes=(), descriptive=tried))
    assert "stiffening with deformation, correction of the static curve and " in text
    assert " take away 60 %" in text
    assert "The k3 of stiffening with deformation ends at its bound" in text
    assert text.count("at its bound") == 1


def test_what_only_lacks_a_name_asks_for_more_of_the_same() -> None:
    """Nothing is left to vary when what is left looks like noise."""
    rest = replace(diagnosis(Verdict.UNKNOWN).remainder, structured=False)
    asked = what_next(Verdict.UNKNOWN, alternatives=(), remainder=rest)
    assert asked is not None
    assert asked.startswith("record more levels")
    slow = replace(DELAY, doubt=Doubt.TOO_SLOW)
    asked = what_next(Verdict.UNKNOWN, alternatives=(), remainder=rest, laws=(slow,))
    assert asked is not None
    assert asked.startswith("record several times as long")


@pytest.mark.parametrize(("linear", "model"), [(True, "oscillator"), (False, "muscle")])
def test_two_lags_of_a_linear_model_are_one(linear: bool, model: str) -> None:
    """Linear operations may change places; behind a stiffness that goes with the input not."""
    tie = Alternative(("sensor_lag", "pneumatic_lag"), {}, "", ("sensor_lag", "pneumatic_lag"))
    lag = cause("sensor_lag", [estimate("sensor_lag_tau", 0.1, "s")], before=2.0, after=0.5)
    found = diagnosis(Verdict.AMBIGUOUS)
    base = replace(found.base, model=replace(found.base.model, name=model))
    assert is_linear(base) is linear
    open_one = replace(found, base=base, causes=(lag,), alternatives=(tie,), next_experiment=None)
    made = write_summary(open_one)
    assert made.next_experiment is not None
    assert ("In a linear model a lag" in made.summary) is linear
    assert ("a faster one" in made.next_experiment) is linear
