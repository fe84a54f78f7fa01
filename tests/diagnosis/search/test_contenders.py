"""Which contender of a round is chosen, and which explain as well; rounds are written by hand."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from handmade_rounds import SAMPLES, UNKNOWNS, ranked

from softid.diagnosis.search.contenders import choose_contender

BEFORE, PERIOD_S = ranked((), 1000.0), 0.01
"""What the rounds by hand extend, and their sampling interval."""

APART = {"pneumatic_lag_tau": 0.1, "pneumatic_lag_ratio": 2.0}
"""Two times of a lag that are ten samples apart."""


@pytest.mark.parametrize(("gain", "key"), [(5.9, ""), (6.1, "separate")])
def test_a_richer_law_must_gain_on_the_plain_one(gain: float, key: str) -> None:
    """The plain lag stays the answer while two time constants gain less than 6 of BIC."""
    rows = [
        ranked(("pneumatic_lag.separate",), 0.0, values=APART),
        ranked(("pneumatic_lag",), gain),
        ranked(("creep",), gain + 20.0),
    ]
    best, names = choose_contender(rows, BEFORE, PERIOD_S)
    assert best.candidate.effects[0].variant == key
    assert names == ("pneumatic_lag",)


@pytest.mark.parametrize(("speed", "key"), [("vb", ""), ("vs", "stribeck")])
def test_a_richer_law_that_ends_at_its_floor_is_the_plain_one(speed: str, key: str) -> None:
    """An excess of friction within a speed that is hardly one makes up for the rounded sign."""
    held = ranked(("coulomb_friction.stribeck",), 0.0, at_bound=(f"coulomb_friction_{speed}",))
    best, _ = choose_contender([held, ranked(("coulomb_friction",), 60.0)], BEFORE, PERIOD_S)
    assert best.candidate.effects[0].variant == key


def test_a_richer_law_without_a_plain_one_is_taken() -> None:
    """When the plain form has dropped out of the race there is nothing to prefer."""
    rows = [ranked(("pneumatic_lag.separate",), 0.0, values=APART), ranked(("creep",), 1.0)]
    best, names = choose_contender(rows, BEFORE, PERIOD_S)
    assert best is rows[0]
    assert names == ("pneumatic_lag", "creep")


def test_rivals_are_those_within_twelve() -> None:
    """By the name of the cause, each once, the best first."""
    rows = [
        ranked(("delay",), 0.0),
        ranked(("pneumatic_lag.separate",), 3.0, values=APART),
        ranked(("pneumatic_lag",), 5.0),
        ranked(("sensor_lag",), 11.9),
        ranked(("creep",), 12.1),
    ]
    best, names = choose_contender(rows, BEFORE, PERIOD_S)
    assert best is rows[0]
    assert names == ("delay", "pneumatic_lag", "sensor_lag")


def test_rivals_are_measured_from_what_was_chosen() -> None:
    """Against the plain form, not against the richer one that it is preferred to."""
    rows = [
        ranked(("pneumatic_lag.separate",), 0.0, values=APART),
        ranked(("pneumatic_lag",), 5.0),
        ranked(("delay",), 12.0),
    ]
    assert choose_contender(rows, BEFORE, PERIOD_S)[1] == ("pneumatic_lag", "delay")


@pytest.mark.parametrize(
    ("at_bound", "bic", "chosen"),
    [
        (["line_resonance_period"], 11.9, "sensor_lag"),
        (["line_resonance_period"], 12.1, "line_resonance"),
        (["line_resonance_zeta"], 11.9, "sensor_lag"),
        (["line_resonance_zeta"], 12.1, "line_resonance"),
        ([], 11.9, "line_resonance"),
    ],
)
def test_what_stands_for_another_is_chosen_last(
    at_bound: Sequence[str], bic: float, chosen: str
) -> None:
    """At the bound of its period a resonance is another law, and at the lower one of its damping no
    actuator's, so a rival within twelve comes first. It stays in the tie, for it explains as well.
    """
    rows = [
        ranked(("line_resonance",), 0.0, values={"line_resonance_zeta": 0.5}, at_bound=at_bound),
        ranked(("sensor_lag",), bic),
    ]
    best, names = choose_contender(rows, BEFORE, PERIOD_S)
    assert best.candidate.keys == (chosen,)
    assert ("line_resonance" in names) == (bic < 12.0 or chosen == "line_resonance")


@pytest.mark.parametrize(
    ("softness", "behind", "chosen"),
    [
        ("at_upper_bound", 11.9, "static_curve"),
        ("at_upper_bound", 12.1, "dead_zone"),
        ("at_bound", 11.9, "dead_zone"),
    ],
)
def test_a_dead_zone_that_is_no_threshold_is_not_cheaper_than_a_curve(
    softness: str, behind: float, chosen: str
) -> None:
    """At its softest it bends everywhere: three knots more cost the curve 28, and count for nought.

    A sharp one is a corner, and the price of the knots speaks for it.
    """
    price = 3.0 * np.log(SAMPLES)
    held = {softness: ["dead_zone_softness"]}
    rows = [
        ranked(("dead_zone",), 0.0, **held),
        ranked(("static_curve",), behind + price, unknowns=UNKNOWNS + 3),
    ]
    best, names = choose_contender(rows, BEFORE, PERIOD_S)
    assert best.candidate.keys == (chosen,)
    assert ("static_curve" in names, "dead_zone" in names) == (chosen == "static_curve", True)


@pytest.mark.parametrize(
    ("zeta", "gain", "names"),
    [
        (0.9, 1.0, ("line_resonance", "pneumatic_lag")),
        (1.1, 5.9, ("pneumatic_lag",)),
        (1.1, 6.1, ("line_resonance", "pneumatic_lag")),
        (1.1, -3.0, ("pneumatic_lag",)),
    ],
)
def test_a_line_that_does_not_ring_is_a_lag(
    zeta: float, gain: float, names: tuple[str, ...]
) -> None:
    """Beyond a damping ratio of 1 it must gain 6 of BIC on the lag, and is no rival to it else."""
    rows = [
        ranked(
            ("line_resonance",),
            0.0,
            values={"line_resonance_zeta": zeta, "line_resonance_period": 0.1},
        ),
        ranked(("pneumatic_lag",), gain),
    ]
    assert choose_contender(sorted(rows, key=lambda row: row.bic), BEFORE, PERIOD_S)[1] == names


@pytest.mark.parametrize(
    ("period_s", "zeta", "gain", "key"),
    [
        (0.12, 1.9, 45.0, "sensor_lag"),
        (0.12, 1.9, 55.0, "sensor_resonance"),
        (0.3, 1.9, 45.0, "sensor_resonance"),
        (0.12, 0.9, 45.0, "sensor_resonance"),
    ],
)
def test_what_goes_on_between_two_samples_tells_no_second_time_constant(
    period_s: float, zeta: float, gain: float, key: str
) -> None:
    """Of ζ = 1.9 and a period of 0.12 s the shorter time constant is 5.4 ms, half a sample: it must
    gain a twentieth of the 1000 that both explain. Of 0.3 s it is 14 ms, and gains its 6."""
    values = {"sensor_resonance_zeta": zeta, "sensor_resonance_period": period_s}
    rows = [ranked(("sensor_resonance",), 0.0, values=values), ranked(("sensor_lag",), gain)]
    assert choose_contender(rows, BEFORE, PERIOD_S)[0].candidate.keys == (key,)


@pytest.mark.parametrize(
    ("form", "ratio", "gain", "is_richer"),
    [
        ("separate", 1.09, 45.0, False),
        ("separate", 1.09, 55.0, True),
        ("separate", 0.85, 45.0, True),
        ("level", 1.09, 45.0, False),
        ("level", 1.2, 45.0, True),
    ],
)
def test_times_that_differ_within_a_sample_are_one(
    form: str, ratio: float, gain: float, is_richer: bool
) -> None:
    """Of 0.1 s and a ratio of 1.09 the times differ by 9 ms, less than a sample of 10 ms, and more
    by 15 ms with 0.85 and by 18 ms with 1.2: within a sample a twentieth of the 1000 is asked."""
    values = {"pneumatic_lag_tau": 0.1, "pneumatic_lag_ratio": ratio}
    rows = [
        ranked((f"pneumatic_lag.{form}",), 0.0, values=values),
        ranked(("pneumatic_lag",), gain, values=values),
    ]
    best, _ = choose_contender(rows, BEFORE, PERIOD_S)
    assert (best is rows[0]) is is_richer


@pytest.mark.parametrize(("bic", "is_told"), [(11.9, True), (12.1, False)])
def test_poles_of_a_sensor_are_told_beside_those_of_a_line(bic: float, is_told: bool) -> None:
    """Where both explain as much: the sensor's are found as two that do not ring, one of them
    within a sample, when the base of a linear motion has taken the others."""
    values = {
        "sensor_resonance_zeta": 1.5,
        "sensor_resonance_period": 0.1,
        "line_resonance_zeta": 0.5,
        "line_resonance_period": 0.14,
    }
    rows = [
        ranked(("sensor_resonance",), 0.0, values=values),
        ranked(("line_resonance",), bic, values=values),
        ranked(("sensor_lag",), 45.0),
    ]
    best, names = choose_contender(rows, BEFORE, PERIOD_S)
    assert best.candidate.keys == ("sensor_lag",)
    assert ("sensor_resonance" in names) is is_told


def test_effects_that_were_there_are_not_compared() -> None:
    """In a second round only what each candidate adds is compared."""
    rows = [ranked(("delay", "creep"), 0.0), ranked(("delay", "ageing"), 2.0)]
    best, names = choose_contender(rows, ranked(("delay",), 1000.0), PERIOD_S)
    assert best is rows[0]
    assert names == ("creep", "ageing")
