"""Settled levels read from logs: the recorded x at the end of every hold of the pressure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from softid.errors import IdentificationError, Issue, UsageError
from softid.excitation import settled_windows
from softid.fitters.static_levels import LevelsFit, levels_from_arrays
from softid.log import Log
from softid.models.geometry import ArcGeometry
from softid.segment import Segment

Array = npt.NDArray[np.float64]

HOLD_TAIL = 0.3
"""Levels are read from the last part of each hold, when the motion has stopped."""

MIN_SAMPLES = 4
"""Used samples in the tail of a hold at least: two in each half, which are compared for drift."""

MOST_DRIFT = 0.02
"""A level still moves when the halves of its tail differ by this share of the range of x."""


def levels(
    logs: Log | Sequence[Log],
    *,
    output: str | None = None,
    geometry: ArcGeometry | None = None,
    zero: bool = False,
    tail: float = HOLD_TAIL,
) -> LevelsFit:
    """Fit the sigmoid to the settled stretches of step logs; see `levels_from_arrays`.

    Parameters
    ----------
    logs
        Step or staircase logs whose input is the pressure.
    output
        Channel to take x from; the log's first output by default.
    geometry
        Arc geometry, needed for a distance or length; with it an angle becomes a contraction in
        mm, without it x is the angle in rad.
    zero
        Whether to estimate a sensor zero, the same for all logs.
    tail
        Share at the end of each hold of the pressure over which x is averaged.

    Raises
    ------
    IdentificationError
        The logs settle at fewer levels than there are parameters.
    UsageError
        The output is no motion, or needs the geometry, or the logs give x in different units.
    """
    found = [row for log in _as_logs(logs) for row in _settled(log, output, geometry, tail)]
    if not found:
        raise IdentificationError(
            "the logs never settle at a level",
            remedy="hold each pressure until the motion has stopped, or give levels as arrays",
        )
    pressure, x, drift = np.array(found).T
    unit = _one_unit(_as_logs(logs), output, geometry)
    fit = levels_from_arrays(pressure, x, zero=zero, unit=unit)
    return replace(fit, issues=(*fit.issues, *_still_moving(drift, x)))


def contraction(
    segment: Segment, output: str | None, geometry: ArcGeometry | None
) -> tuple[Array, str]:
    """Recorded x of a segment with NaN at unused samples, shape (n,), and its unit.

    Raises
    ------
    UsageError
        The output is no motion, or needs the geometry.
    """
    name = output or next(iter(segment.outputs))
    if name not in segment.outputs:
        raise UsageError(
            f"{name} is not an output of the log",
            where=segment.log_name,
            remedy=f"choose from {', '.join(segment.outputs)}",
        )
    recorded = np.where(segment.used[name], segment.outputs[name], np.nan)
    if name in ("contraction", "position"):
        return recorded, "mm"
    if name == "angle":
        return (recorded, "rad") if geometry is None else (recorded * geometry.diameter_mm, "mm")
    if name in ("distance", "length"):
        if geometry is None:
            raise UsageError(
                f"the {name} is linked to the contraction by the arc geometry",
                where=segment.log_name,
                remedy="give the fixed length and the diameter in mm",
            )
        if name == "distance":
            return geometry.contraction_from_distance_mm(recorded), "mm"
        return geometry.contraction_from_length_mm(recorded), "mm"
    raise UsageError(
        f"{name} is not a motion of the muscle",
        where=segment.log_name,
        remedy="choose an angle, contraction, length, distance or position",
    )


def require_unit(found: str, wanted: str, *, where: str, of: str) -> None:
    """Refuse an x in another unit than what it would be taken together with.

    Parameters
    ----------
    found, wanted
        Unit of x, and the other one.
    where
        Log of which x is.
    of
        What the other unit belongs to.

    Raises
    ------
    UsageError
        They differ.
    """
    if found != wanted:
        raise UsageError(
            f"x is in {found} here, and in {wanted} in {of}",
            where=where,
            remedy="name one output= for both, give the geometry= by which an angle becomes a "
            "contraction in mm, or the unit= of levels that are arrays",
        )


def _one_unit(logs: Sequence[Log], output: str | None, geometry: ArcGeometry | None) -> str:
    """Unit of x, the same in all logs."""
    parts = [segment for log in logs for segment in log.segments()]
    units = [contraction(segment, output, geometry)[1] for segment in parts]
    for segment, unit in zip(parts, units, strict=True):
        require_unit(unit, units[0], where=segment.log_name, of=parts[0].log_name)
    return units[0]


def _as_logs(logs: Log | Sequence[Log]) -> tuple[Log, ...]:
    return (logs,) if isinstance(logs, Log) else tuple(logs)


def _settled(
    log: Log, output: str | None, geometry: ArcGeometry | None, tail: float
) -> list[tuple[float, float, float]]:
    """Mean pressure, mean x and drift of x at the end of every hold of the pressure."""
    rows = []
    for segment in log.segments():
        x, _ = contraction(segment, output, geometry)
        for window in settled_windows(segment.time_s, segment.input, tail=tail):
            used = window.start + np.flatnonzero(np.isfinite(x[window.start : window.stop]))
            if used.size < MIN_SAMPLES:
                continue
            held, half = x[used], used.size // 2
            drift = held[half:].mean() - held[:half].mean()
            rows.append((float(segment.input[used].mean()), float(held.mean()), float(drift)))
    return rows


def _still_moving(drift: Array, x: Array) -> tuple[Issue, ...]:
    moving = int(np.sum(np.abs(drift) > MOST_DRIFT * np.ptp(x)))
    if not moving:
        return ()
    return (
        Issue(
            "levels-still-moving",
            "warning",
            f"x still moves at {moving} of {x.size} levels, by up to "
            f"{100 * np.abs(drift).max() / np.ptp(x):.1f} % of its range",
            "hold each pressure longer, or fit the whole record by output error",
        ),
    )
