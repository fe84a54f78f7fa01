"""What no log can split, what these logs did not split, and what would."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from softid.diagnosis.verdict.unlisted_names import UNLISTED


@dataclass(frozen=True)
class EquivalenceClass:
    """Causes that give the same pressure and the same motion, whatever is recorded.

    Attributes
    ----------
    members
        The causes, in words.
    effects
        Effects of the catalogue that stand for the whole class; none where parameters of the base
        model or the sensor zero do.
    why
        Why no log can split them, one sentence.
    splits
        What is needed besides a log of pressure and motion.
    """

    members: tuple[str, ...]
    effects: tuple[str, ...]
    why: str
    splits: str


CLASSES: tuple[EquivalenceClass, ...] = (
    EquivalenceClass(
        ("a constant load", "an offset of the sensor's zero"),
        (),
        "Both move the whole output by the same amount at every pressure.",
        "read the sensor with the load taken off",
    ),
    EquivalenceClass(
        ("a delay of the input", "an offset between the clocks of the two channels"),
        ("delay",),
        "Both shift the motion in time by the same amount.",
        "record both channels with one clock",
    ),
    EquivalenceClass(
        ("a lag of the pneumatics", "a leak behind a restriction"),
        ("pneumatic_lag",),
        "Such a leak is a lag and a gain, and the parameters of the model take up the gain.",
        "close the valve and watch whether the pressure in the actuator falls",
    ),
    EquivalenceClass(
        ("a nonlinear spring", "a load that goes with the position, such as a weight"),
        ("stiffening",),
        "Both pull with a force that depends on the position alone.",
        "record the same with the load taken off, or with the actuator turned over",
    ),
    EquivalenceClass(
        ("the gain of the pressure sensor", "the gain of the output sensor"),
        (),
        "The parameters of the model take up both.",
        "calibrate each sensor on its own",
    ),
)
"""Algebra, not noise: more data of the same kind never splits them."""

PRESLIDING = EquivalenceClass(
    ("hysteresis of the material", "dry friction that gives way a little before it slides"),
    ("hysteresis", "coulomb_friction"),
    "Dry friction that gives way over so short a distance follows the same law as a hysteresis",
    "the same log with the guides lubricated or taken off, where only a loop of the material stays",
)
"""One law, and the distance alone speaks for a guide that rubs or for a material that does."""

LINEAR_CLASSES: tuple[EquivalenceClass, ...] = (
    EquivalenceClass(
        (
            "creep of the material",
            "a sensor that creeps",
            "a part of the actuator that fills more slowly than the rest",
        ),
        ("creep",),
        "In a linear model each adds one slow pole and one zero.",
        "hang a weight on at a constant pressure, where only a material or a sensor creeps",
    ),
    EquivalenceClass(
        (
            "relaxation of the reading",
            "a pressure that falls back behind the gauge, as that of air that cools",
        ),
        ("relaxation",),
        "In a linear model each adds one slow pole and one zero.",
        "the pressure inside the actuator, or the reading after a push at a constant pressure",
    ),
    EquivalenceClass(
        (
            "a drift of the sensor's zero",
            "a drift of the zero of the pressure gauge",
            "a load that changes at a constant rate",
        ),
        ("sensor_drift",),
        "In a linear model each adds a line to the output.",
        "read both sensors vented and at rest, before and after the log",
    ),
    EquivalenceClass(
        (
            "a sensor that warms up",
            "a pressure gauge that warms up",
            "a load that changes and then stays",
        ),
        ("sensor_warmup",),
        "In a linear model each adds the same course to the output where it is far slower than the "
        "actuator.",
        "read both sensors vented and at rest, before and after the log",
    ),
    EquivalenceClass(
        (
            "a drift of the sensor's gain",
            "a drift of the gain of the pressure gauge",
            "a leak that grows",
        ),
        ("sensor_gain_drift",),
        "In a linear model a gain that changes far more slowly than the actuator moves is the same "
        "before it as behind it.",
        "calibrate both sensors before and after the log, and watch whether the pressure falls "
        "behind a closed valve",
    ),
)
"""Algebra where the coefficients stay whatever the pressure is."""

DRIFTS = ("sensor_drift", "sensor_gain_drift", "sensor_warmup", "ageing")
"""Causes that go with the time alone."""

CHANGING = EquivalenceClass(
    (
        UNLISTED["load_drift"],
        UNLISTED["pressure_drift"],
        UNLISTED["settling_pressure"],
        UNLISTED["pressure_gain_drift"],
    ),
    ("load_drift", "pressure_drift", "settling_pressure", "pressure_gain_drift"),
    "A refit with either in the other's place explains these logs as well or better",
    "rests at several levels before and after the log, with the load off and with it on, and read "
    "both sensors there",
)
"""What changes with the time in the load or the pressure."""

BENT_READING = EquivalenceClass(
    ("a spring or an obstacle", UNLISTED["bent_reading"]),
    ("bent_reading",),
    "A refit with such a sensor in the place of the actuator's own law explains these logs as well "
    "or better",
    "the sensor beside another one while the actuator is bent by hand",
)
"""A function of the position acts in the motion or in the reading."""

LIMITED_RATE = EquivalenceClass(
    ("a valve or a lag", UNLISTED["rate_limit"]),
    ("rate_limit", "input_limit"),
    "A refit with such a limit in its place explains these logs as well or better",
    "small and large steps from one level, or the pressure at the actuator itself",
)
"""Large steps are late, or lead no higher; small ones are not."""

UNEVEN_READING = EquivalenceClass(
    ("an actuator that fills in another time than it vents", UNLISTED["uneven_reading"]),
    ("uneven_reading",),
    "A refit with such a sensor in its place explains these logs as well or better",
    "the pressure inside the actuator, or the reading while the actuator is moved by hand",
)
"""What is late up and down by different times is so before the actuator or behind it."""

SMOOTHED_INPUT = EquivalenceClass(
    ("a resonance of the supply line", UNLISTED["smoothed_input"]),
    ("smoothed_input",),
    "A refit with such a record in its place explains these logs as well or better",
    "the same logs with the pressure as it was sampled, without a filter or a mean over it",
)
"""What rings within a few samples adds to a record what smoothing takes away from it."""

TWO_CREEPS = EquivalenceClass(
    ("a cause beside the creep", UNLISTED["second_creep"]),
    ("second_creep",),
    "A refit with a creep of a second time in its place explains these logs as well or better",
    "a hold that is ten times as long as the longer time, followed by as long a rest",
)
"""A material that creeps with several times."""

TWO_HYSTERESES = EquivalenceClass(
    ("a cause beside the hysteresis", UNLISTED["second_hysteresis"]),
    ("second_hysteresis",),
    "A refit with a hysteresis of a second distance in its place explains most of what it does, or "
    "predicts better what is held out",
    "slow loops of many sizes, one within the other",
)
"""A material that gives way over several distances."""

SETTLING_STIFFNESS = EquivalenceClass(
    ("a stiffness or a gain that changes", UNLISTED["settling_stiffness"]),
    ("settling_stiffness", "settling_gain", "recovering_softening"),
    "A refit with the last of them in its place explains these logs better",
    "the same two levels again and again, for long, and the same log after a rest",
)
"""A course in time that is not linear."""

TWO_LATE = EquivalenceClass(
    ("a resonance of the supply line that does not ring", "a lag and a delay of the pneumatics"),
    ("line_resonance", "pneumatic_lag", "delay"),
    "A lag and a delay together explain these logs as well as a resonance that does not ring",
    "steps at a sampling period far below the delay",
)
"""What is late twice."""

_IN_PLACE_OF_IT = (
    "A refit with the last of them in its place, or in that of several causes, explains more of "
    "these logs"
)

OTHER_CURVE = EquivalenceClass(
    ("a curve at rest of the catalogue", "a curve at rest of another shape"),
    ("power_spring", "free_spring", "fine_curve"),
    _IN_PLACE_OF_IT,
    "held levels over the full range, in fine steps up and down",
)
"""What goes with the position or the input alone, along another curve."""

ONE_FOR_ALL = EquivalenceClass(
    ("causes of the catalogue", "a law in no catalogue"),
    (
        "position_damping",
        "position_inertia",
        "damping_drift",
        "early_reading",
        "gauge_lag",
        "uneven_reading",
        "input_play",
        "output_play",
        "relief_leak",
        "uneven_delay",
        "feedthrough",
        "swinging_part",
        "swinging_load",
    ),
    _IN_PLACE_OF_IT,
    "small and large steps from many positions, up and down, early and late",
)
"""One law in place of what the catalogue needs."""

READING_LOOP = EquivalenceClass(
    ("a hysteresis of the material", UNLISTED["reading_hysteresis"]),
    ("reading_hysteresis",),
    _IN_PLACE_OF_IT,
    "the sensor beside another one while the actuator is bent by hand, up and down",
)
"""A loop in the motion or in the reading."""

OWN_BRANCH = EquivalenceClass(
    ("dry friction", UNLISTED["own_branches"]),
    ("own_branches",),
    _IN_PLACE_OF_IT,
    "logs that all begin after the same cycles, with small loops within large ones: a guide that "
    "rubs holds wherever it stops, and a material gives way a little at every turn",
)
"""Logs that begin at rest where friction or a hysteresis holds the actuator, each elsewhere."""

OTHER_FRICTION = EquivalenceClass(
    ("friction that goes with the pressure or the speed", "one that goes with the position"),
    ("position_friction", "position_hysteresis"),
    _IN_PLACE_OF_IT,
    "slow strokes up and down about one position at several pressures, as under several loads",
)
"""Friction that is larger further out, where the pressure is, too."""

STIFFER_WITH_PRESSURE = EquivalenceClass(
    ("causes beside a linear model", UNLISTED["pressure_stiffness"]),
    ("pressure_stiffness",),
    _IN_PLACE_OF_IT,
    "small steps about a low and about a high pressure; the muscle model (--model muscle) has it",
)
"""A linear model has one stiffness for all pressures."""

REPLACED = (
    CHANGING,
    BENT_READING,
    LIMITED_RATE,
    UNEVEN_READING,
    SMOOTHED_INPUT,
    TWO_CREEPS,
    TWO_HYSTERESES,
    SETTLING_STIFFNESS,
    OWN_BRANCH,
    READING_LOOP,
    OTHER_FRICTION,
    STIFFER_WITH_PRESSURE,
    OTHER_CURVE,
    ONE_FOR_ALL,
)
"""Told where a law in no catalogue is in a tie."""

LIKELIER = (OWN_BRANCH, READING_LOOP, OTHER_CURVE, ONE_FOR_ALL)
"""Ties in which the law in no catalogue explains more."""

FASTER = "the sensor beside a faster one, or the pressure at the actuator itself"
"""What splits a filter before the actuator from one behind it."""

TWO_LAGS = EquivalenceClass(
    ("a lag of the pneumatics", "a lag of the sensor"),
    ("pneumatic_lag", "sensor_lag"),
    "In a linear model a lag of the input and one of the sensor give the same output, and its time "
    "may change places with one of an actuator that does not ring",
    FASTER,
)
TWO_RESONANCES = EquivalenceClass(
    ("a resonance of the supply line", "a resonance of the sensor"),
    ("line_resonance", "sensor_resonance"),
    "In a linear model a resonance before the actuator and one of the sensor give the same output, "
    "and its period and damping may change places with the actuator's own",
    FASTER,
)
BY_DIRECTION = EquivalenceClass(
    ("damping that differs by direction", "a lag of the pneumatics that differs by direction"),
    ("asymmetric_damping", "pneumatic_lag"),
    "In a linear model without inertia a damping that differs by direction and air that comes and "
    "goes by different times follow the same law",
    "the pressure inside the actuator, or the motion after a push at a constant pressure",
)
LINEAR_FILTERS = (TWO_LAGS, TWO_RESONANCES, BY_DIRECTION)
"""Linear operations may change places. A stiffness that goes with the pressure tells them apart."""


def classes_of(effects: Sequence[str], *, linear: bool = False) -> tuple[EquivalenceClass, ...]:
    """Classes of which one of these effects is a member.

    Parameters
    ----------
    effects
        Names or keys.
    linear
        Whether the base model is linear.
    """
    names = {key.split(".")[0] for key in effects}
    known = (*CLASSES, *LINEAR_CLASSES) if linear else CLASSES
    return tuple(c for c in known if names & set(c.effects))
