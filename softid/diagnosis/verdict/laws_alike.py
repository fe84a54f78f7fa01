"""Laws that two causes follow alike, where the numbers of one say so."""

from __future__ import annotations

from softid.diagnosis.verdict.equivalence import FASTER, EquivalenceClass
from softid.diagnosis.verdict.unlisted_names import UNLISTED

LOWER_END = EquivalenceClass(
    ("a lower limit of the sensor", "a dead zone of the input"),
    ("sensor_clipping", "dead_zone"),
    "A refit with a dead zone in the place of the lower limit explains these logs as well or "
    "better, for the reading stays in both where the pressure is low",
    "the actuator bent back by hand at zero pressure, which a reading below its limit would hide",
)
"""The reading does not move at the lower end of its range."""

OWN_DAMPING = EquivalenceClass(
    ("a lag of the pneumatics that differs by level", UNLISTED["position_damping"]),
    ("pneumatic_lag", "position_damping"),
    "The lag takes the place of the actuator's own damping, of which next to nothing is left, and "
    "an actuator that is all damping follows the same law as air that is late",
    "the pressure inside the actuator, or the motion after a push at a constant pressure",
)
"""A lag of the level beside an actuator that is left without a time of its own."""

BEFORE_THE_LOAD = EquivalenceClass(
    ("a sensor of a force that clips at its rest", UNLISTED["gap"]),
    ("sensor_clipping", "gap"),
    "A force that stays where it rests is that of an actuator which does not touch its load yet",
    "the travel beside the force, or the force while the sensor is pressed by hand",
)
"""A force that begins late."""

THINNING = EquivalenceClass(
    ("dry friction", UNLISTED["thinning_damping"]),
    ("coulomb_friction", "thinning_damping"),
    "Friction that comes up so slowly is hardly dry: a fluid that thins the faster it is sheared "
    "follows nearly the same law",
    "moves at several slow and constant speeds, in which dry friction stays as large as in fast "
    "ones, and the motion when the pressure turns round after a rest",
)
"""A friction that is full at a good part of the largest speed only."""

STICTION = EquivalenceClass(
    ("dry friction", UNLISTED["dead_band"]),
    ("coulomb_friction", "dead_band"),
    "It holds at rest, and next to nothing of it is left in motion: so does what rests in a band",
    "small steps of the command about a level, and the pressure inside the actuator beside it",
)
"""A friction that is nearly all stiction."""

ONE_WAY = EquivalenceClass(
    ("dry friction", UNLISTED["giving_way"]),
    ("coulomb_friction", "giving_way"),
    "The motion hardly ever turns round in these logs, and friction that always acts one way only "
    "slows the end of a motion",
    "the way back as well: down to where it began, held as long as above",
)
"""A friction of which nobody has seen that it turns with the speed."""

HELD_INPUT = EquivalenceClass(
    ("a delay or a lag", UNLISTED["held_input"]),
    ("held_input",),
    "A valve that holds its value until the next sample is as late, by half a sampling interval",
    "the pressure at the actuator, several times as fast",
)
"""A measured input that is taken as going straight is late by half of its interval."""

POLE_AND_ZERO = EquivalenceClass(
    ("creep of the material", UNLISTED["gauge_lag"], UNLISTED["sensor_lead"]),
    ("creep", "gauge_lag", "sensor_lead"),
    "In a linear model each adds one pole and one zero, and this one is not much slower than the "
    "motion itself, so that it may as well be no creep",
    FASTER,
)
"""A creep that begins while the actuator still moves."""

LEAD_AND_RELAXATION = EquivalenceClass(
    ("relaxation of the reading", UNLISTED["sensor_lead"], UNLISTED["gauge_lag"]),
    ("relaxation", "sensor_lead", "gauge_lag"),
    "Each makes the first part of a motion larger, and this relaxation is not much slower than the "
    "motion itself, so that it may as well be none",
    FASTER,
)
"""A relaxation that begins while the actuator still moves."""

LAWS_ALIKE = (
    OWN_DAMPING,
    LOWER_END,
    HELD_INPUT,
    BEFORE_THE_LOAD,
    ONE_WAY,
    THINNING,
    STICTION,
    LEAD_AND_RELAXATION,
    POLE_AND_ZERO,
)
"""Told where all of their effects are in a tie; the first that is."""
