"""What causes in no catalogue are called."""

from __future__ import annotations

UNLISTED: dict[str, str] = {
    "position_damping": "a damping of the actuator itself that goes with its position",
    "position_inertia": "an inertia that goes with the position",
    "position_friction": "dry friction that goes with the position",
    "position_hysteresis": "a hysteresis that goes with the position",
    "power_spring": "a spring that stiffens with another power of the position",
    "free_spring": "a spring, a wall or a load whose force follows the position along some other "
    "curve",
    "fine_curve": "a static curve that bends within a smaller part of the range",
    "pressure_stiffness": "a stiffness or a damping that goes with the pressure, which the muscle "
    "model has",
    "gauge_lag": "a pressure gauge that lags behind",
    "sensor_lead": "a sensor that runs ahead of the motion",
    "held_input": "an input that is held until its next sample",
    "load_drift": "a load that changes at a constant rate",
    "pressure_drift": "a drift of the zero of the pressure gauge, or of the stiffness that an "
    "actuator has without pressure",
    "pressure_gain_drift": "a pressure that falls behind what is recorded, by a leak that grows or "
    "a gauge whose gain drifts",
    "rate_limit": "a regulator that changes the pressure no faster than at some rate",
    "input_limit": "a supply that gives no more than one pressure",
    "relief_leak": "a leak that opens above a pressure, as a relief valve does",
    "thinning_damping": "a damping of the actuator that grows less than in proportion to its speed",
    "dead_band": "a valve or a regulator that does nothing within a band about its set point",
    "gap": "a gap between the actuator and its load",
    "giving_way": "a creep of the material, or a damping that grows less than in proportion to its "
    "speed",
    "bent_reading": "a sensor whose gain is not the same over its range",
    "early_reading": "a reading that runs ahead of the recorded input, by an offset of the clocks "
    "or a gauge that is late",
    "smoothed_input": "a pressure whose record was smoothed, by what came before and after",
    "uneven_reading": "a sensor that lags by another time upward than downward",
    "feedthrough": "a sensor that also answers to the pressure itself",
    "swinging_part": "a part of what is read that swings by itself, as a flexible tip does",
    "swinging_load": "a load that swings on the actuator, or a flexible mount of what is read",
    "uneven_delay": "a delay that differs by direction, as of a valve that opens faster than it "
    "closes",
    "second_hysteresis": "a second hysteresis that gives way over another distance",
    "settling_stiffness": "a stiffness that changes with the time and settles",
    "settling_pressure": "a zero of the pressure gauge that changes with the time and settles",
    "settling_gain": "a gain of the sensor that changes with the time and settles",
    "recovering_softening": "a softening by use that recovers at rest, as a material that warms up",
    "second_creep": "a second creep of another time",
    "damping_drift": "a damping that changes at a constant rate",
    "own_branches": "a hysteresis that each log begins on a branch of its own",
    "reading_hysteresis": "a hysteresis of the sensor, or of what glues it to the actuator",
    "input_play": "play of the valve or the regulator",
    "output_play": "play between the actuator and its sensor",
}
"""Causes in no catalogue that one of the catalogue may stand for: name and heading."""
