"""An output that was interpolated: between two readings of a slower sensor it is straight.

Who brings a camera of 40 frames a second to the clock of a gauge of 100 Hz gets samples of which
neighbours are made of the same readings. They are no readings of their own, and their noise is not
either.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from softid.channels import PRESSURE_COMMAND
from softid.excitation import find_quantisation
from softid.identification.interpolated_readings import reading_clock, readings_at
from softid.log import Log

Array = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]
IntArray = npt.NDArray[np.intp]

INTERPOLATED = "interpolated-output"
"""Code of the remark that an output was interpolated between its sensor's readings."""

RECOVERED = "recovered-readings"
"""Code of the remark that an output was interpolated and that its sensor's readings are known."""

LARGE_QUANTILE, STRAIGHT_SHARE = 0.95, 0.01
"""A sample lies on the line through its neighbours when it is off by less than this share of how
far one in twenty is: noise and curves come so near by chance in one of sixty samples."""

EXACT = 0.05
"""Share of that distance within which half of the samples on a line lie where they were
interpolated, or within the step of their rounding: noise near a line is as far off as may be."""

STILL_BEND = 1e-6
"""Where the neighbours differ by less than this share of the range nothing moves."""

FIRST_SAMPLES = 2000
"""Samples, about, that are looked at first, and show in most logs that an output is not
interpolated."""

MOVING = 0.25
"""Least share of the samples at which an output moves: one that stands still lies on a line,
too."""

LEAST_SHARE = 0.18
"""Least share of the moving samples of an interpolated output that lie on a line: of 2.5 samples a
reading a fifth do or more."""

LEAST_EVEN_RUNS = 0.8
"""Least share of the runs of samples on a line whose length is that of the usual one, or one more
or less."""

FINER = 1.5
"""Step of the readings in that of what lies between them, at least: of two samples a reading every
other one is off by half a step."""

AT_SAMPLES = 0.9
"""Readings are at samples where so many of the corners are single ones; a reading between two
samples makes a corner of both."""


def interpolated_samples(log: Log) -> BoolArray:
    """Samples of which every output was interpolated and says nothing new, shape (n,).

    Parameters
    ----------
    log
        A log; a commanded output is what it is at every row.

    Examples
    --------
    >>> readings = np.random.default_rng(0).normal(size=200)
    >>> angle = np.interp(np.arange(400.0), np.arange(0.0, 400.0, 2.0), readings)
    >>> log = Log.from_arrays(np.arange(400.0), {"pressure": np.arange(400.0), "angle": angle})
    >>> interpolated_samples(log)[:6].tolist()
    [False, True, False, True, False, True]
    """
    every = np.ones(len(log), bool)
    for name in log.outputs:
        if name == PRESSURE_COMMAND:
            return np.zeros(len(log), bool)
        every &= _between_readings(log.time_s, log.channels[name].values)
        if not every.any():
            break
    return every & ~log.masked


def recovered_readings(log: Log) -> tuple[Array, dict[str, Array]] | None:
    """The readings that all outputs of a log were interpolated from; None where they are unknown.

    Parameters
    ----------
    log
        A log whose outputs were interpolated.

    Returns
    -------
    tuple or None
        When they were taken, at regular times of one clock within the log, shape (r,), and the
        readings of every output, each of shape (r,); what no sample tells is not a number.

    Examples
    --------
    >>> read_s, readings = np.arange(0.2, 410.0, 2.6), np.random.default_rng(0).normal(size=158)
    >>> angle = np.interp(np.arange(400.0), read_s, readings)
    >>> log = Log.from_arrays(np.arange(400.0), {"pressure": np.arange(400.0), "angle": angle})
    >>> taken_s, values = recovered_readings(log)
    >>> bool(np.allclose(values["angle"], readings[: taken_s.size]))
    True
    """
    time_s, inner = log.time_s, np.arange(1, len(log) - 1)
    first = log.channels[log.outputs[0]].values
    straight, _ = _on_lines(time_s, first, inner)
    clock = reading_clock(time_s, first, np.concatenate(([False], straight, [False])))
    if clock is None:
        return None
    beyond_s = clock.period_s  # samples at the ends lie between a reading outside and one within
    taken_s = clock.readings_s(float(time_s[0]) - beyond_s, float(time_s[-1]) + beyond_s)
    within = (taken_s >= time_s[0]) & (taken_s <= time_s[-1])
    found = {}
    for name in log.outputs:
        values = readings_at(taken_s, time_s, log.channels[name].values)
        if values is None:
            return None
        found[name] = values[within]
    return taken_s[within], found


def _between_readings(time_s: Array, values: Array) -> BoolArray:
    """Samples of one channel that say nothing new, one of each stretch between two readings left.

    Where readings lie at samples those are what is left; else every so many samples as span one.
    """
    nothing = np.zeros(values.size, bool)
    if values.size < 4 or not np.isfinite(values).all():
        return nothing
    few = np.arange(1, values.size - 1, max((values.size - 2) // FIRST_SAMPLES, 1))
    straight, moving = _on_lines(time_s, values, few)
    if straight.sum() < 0.5 * LEAST_SHARE * max(int(moving.sum()), 1):
        return nothing
    inner = np.arange(1, values.size - 1)
    straight, moving = _on_lines(time_s, values, inner)
    count = int(moving.sum())
    if count < MOVING * moving.size or straight.sum() < LEAST_SHARE * count:
        return nothing
    if _is_by_chance(time_s, values, straight) or _is_rounded(values[inner], straight, moving):
        return nothing
    lengths = _runs(straight)
    if np.mean(np.abs(lengths - np.median(lengths)) <= 1) < LEAST_EVEN_RUNS:
        return nothing
    corners = _runs(~straight & moving)
    single, pairs = int((corners == 1).sum()), int((corners == 2).sum())
    at_samples = single / max(single + pairs, 1)
    if at_samples >= AT_SAMPLES:
        nothing[inner] = straight
        return nothing
    # between two readings r samples, ends among them, make r - 2 that are straight
    readings = (count - int(straight.sum())) / (2.0 - at_samples)
    nothing[:] = np.arange(values.size) % int(np.ceil(count / readings)) != 0
    return nothing


def _on_lines(time_s: Array, values: Array, at: IntArray) -> tuple[BoolArray, BoolArray]:
    """Which of some samples lie on the line through their neighbours, and which move at all."""
    off = _off_lines(time_s, values, at)
    moving = np.abs(values[at + 1] - values[at - 1]) > STILL_BEND * float(np.ptp(values))
    return (off < STRAIGHT_SHARE * float(np.quantile(off, LARGE_QUANTILE))) & moving, moving


def _off_lines(time_s: Array, values: Array, at: IntArray) -> Array:
    """How far some samples are off the lines through their neighbours."""
    before_s, after_s = time_s[at] - time_s[at - 1], time_s[at + 1] - time_s[at]
    line = (values[at - 1] * after_s + values[at + 1] * before_s) / (before_s + after_s)
    off: Array = np.abs(values[at] - line)
    return off


def _is_by_chance(time_s: Array, values: Array, straight: BoolArray) -> bool:
    """Whether samples are further off their lines than rounding puts what was interpolated.

    A few quick bends make the distance large below which a sample counts as straight, and where
    the motion is slow or on a ramp that is more than the noise.
    """
    off = _off_lines(time_s, values, np.arange(1, values.size - 1))
    near = STRAIGHT_SHARE * float(np.quantile(off, LARGE_QUANTILE))
    grid = find_quantisation(values[1:-1][straight])
    return float(np.median(off[straight])) > max(EXACT * near, 0.0 if grid is None else grid.step)


def _is_rounded(values: Array, straight: BoolArray, moving: BoolArray) -> bool:
    """Whether samples lie on the lines through their neighbours because all are rounded coarsely.

    What is between two readings lies on a finer grid than these.
    """
    between, corners = find_quantisation(values[straight]), ~straight & moving
    bends = np.abs(np.diff(values, 2))[corners[1:-1]]
    if between is None or not bends.size or between.step < STRAIGHT_SHARE * float(np.median(bends)):
        return False
    grid = find_quantisation(values[corners])
    return grid is None or grid.step < FINER * between.step


def _runs(flags: BoolArray) -> IntArray:
    """Lengths of the runs of true flags."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], flags, [False]))))
    return edges[1::2] - edges[::2]
