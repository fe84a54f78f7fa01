"""Ru's sequential protocol by name: step levels, then the extremes of a sine, then the N surface.

It is kept because the paper uses it and because each stage can be done by hand. It is not the
default: every stage takes the one before as exact, and the second divides two small numbers.

Source: Ru et al. 2019, doi 10.1007/s11432-018-9709-x, Eq 4 to 7.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from softid.errors import IdentificationError, Issue
from softid.fitters.damping_surface import Damping, DampingFit, DampingSamples, fit_damping
from softid.fitters.local_derivatives import local_derivatives, samples_per_window
from softid.fitters.settled_levels import levels
from softid.fitters.sine_extremes import ExtremesFit, default_window_s, extremes, stretches_of
from softid.fitters.static_levels import LevelsFit, levels_from_arrays
from softid.log import Log
from softid.models.geometry import ArcGeometry

__all__ = [
    "DampingFit",
    "ExtremesFit",
    "LevelsFit",
    "SequentialFit",
    "damping_surface",
    "dynamics",
    "extremes",
    "levels",
    "levels_from_arrays",
    "sequential",
]

MIN_SPEED_SHARE = 0.2
"""Samples slower than this share of the top speed say nothing about damping."""


@dataclass(frozen=True, eq=False)
class SequentialFit:
    """Ru's seven parameters by the paper's own protocol.

    Attributes
    ----------
    values
        M, a1, b1, c1, a2, b2, c2; p in bar. M is zero where the extremes give less, since the
        damping belongs to that.
    zero
        Sensor zero from the levels, or None.
    unit
        Unit of x.
    static, inertia, damping
        The three stages.
    issues
        The issues of all stages, and that M was set to zero.
    """

    values: dict[str, float]
    zero: float | None
    unit: str
    static: LevelsFit
    inertia: ExtremesFit
    damping: DampingFit
    issues: tuple[Issue, ...] = ()


def damping_surface(
    log: Log,
    static: LevelsFit,
    mass: float,
    *,
    damping: Damping = "exponential",
    output: str | None = None,
    geometry: ArcGeometry | None = None,
    window_s: float | None = None,
    min_speed_share: float = MIN_SPEED_SHARE,
) -> DampingFit:
    """Compute N = (P − Q·x − M·ẍ)/ẋ wherever the motion is fast, and fit N(p) to it.

    The fit minimises the error of the force balance, that is, each N counts with the square of its
    speed: N = a2·exp(b2·p) + c2 with a2, c2 ≥ 0, or N = c2.

    Weakness: errors of the static curve and of M enter as if they were damping, noise in x enters
    ẋ and biases N downward, and a2 and b2 cannot be told apart (their estimates correlate by
    −0.98; from one 0.5 Hz sine a2 is known to ±394 % and b2 to ±154 %). Judge N(p) over the range
    of the log, not a2 and b2; the paper itself finds a2 very small.

    Parameters
    ----------
    log
        A sine or any other motion.
    static
        The static curve from `levels`, taken as exact.
    mass
        M from `extremes`, taken as exact.
    damping
        ``"exponential"`` or ``"constant"``.
    output, geometry, window_s
        As in `extremes`.
    min_speed_share
        Samples slower than this share of the top speed are left out.

    Raises
    ------
    IdentificationError
        No stretch is as long as a window, too few samples move, or the damping they show is
        negative.
    UsageError
        As `extremes`.

    Source: Ru et al. 2019, Eq 6.
    """
    stretches = stretches_of(log, output, geometry, unit=static.unit)
    window = window_s or default_window_s(stretches, log.name)
    pressures, balances, speeds, lengths = [], [], [], []
    for s in stretches:
        if s.time_s.size < samples_per_window(s.time_s, window):
            continue
        motion = local_derivatives(s.time_s, s.x, window_s=window)
        pressure = local_derivatives(s.time_s, s.pressure_kpa, window_s=window).value
        pressures.append(pressure)
        balances.append(static.force_balance(pressure, motion.value) - mass * motion.curvature)
        speeds.append(motion.slope)
        lengths.append(pressure.size)
    if not lengths:
        raise IdentificationError(
            f"no stretch of the log is as long as a window of {window:.3g} s",
            where=log.name,
            remedy="use a log without stalls, or give a shorter window_s",
        )
    samples = DampingSamples(
        np.concatenate(pressures),
        np.concatenate(balances),
        np.concatenate(speeds),
        tuple(lengths),
    )
    return fit_damping(
        samples, damping, min_speed_share=min_speed_share, where=log.name, unit=static.unit
    )


def sequential(
    step_logs: Log | Sequence[Log],
    sine_log: Log,
    *,
    damping: Damping = "exponential",
    output: str | None = None,
    geometry: ArcGeometry | None = None,
    zero: bool = False,
    window_s: float | None = None,
) -> SequentialFit:
    """Run the paper's three stages: `levels` → `extremes` → `damping_surface`.

    Each stage takes the one before as exact, and no stage knows the error of the one before; see
    the weaknesses of the three. Where the extremes give a negative M, the damping stage goes on
    with M = 0, which is then what `SequentialFit.values` holds, and an issue says so.

    Parameters
    ----------
    step_logs
        Step or staircase logs that settle at many levels.
    sine_log
        A sine of several periods (0 to 2.4 bar at 0.5 Hz in the paper).
    damping, output, geometry, zero, window_s
        As in the three stages; the zero is taken over to the sine log.

    Raises
    ------
    IdentificationError, UsageError
        As `levels`, `extremes` and `damping_surface`.

    Source: Ru et al. 2019, section "Parameter identification".
    """
    static = levels(step_logs, output=output, geometry=geometry, zero=zero)
    return dynamics(
        static, sine_log, damping=damping, output=output, geometry=geometry, window_s=window_s
    )


def dynamics(
    static: LevelsFit,
    sine_log: Log,
    *,
    damping: Damping = "exponential",
    output: str | None = None,
    geometry: ArcGeometry | None = None,
    window_s: float | None = None,
) -> SequentialFit:
    """The last two stages on a static curve that is already there, as from `levels_from_arrays`.

    Raises
    ------
    IdentificationError, UsageError
        As `extremes` and `damping_surface`.
    """
    inertia = extremes(sine_log, static, output=output, geometry=geometry, window_s=window_s)
    mass = max(inertia.mass, 0.0)
    surface = damping_surface(
        sine_log,
        static,
        mass,
        damping=damping,
        output=output,
        geometry=geometry,
        window_s=window_s,
    )
    values = {"M": mass, "a1": static.a1, "b1": static.b1, "c1": static.c1}
    values |= {"a2": surface.a2, "b2": surface.b2, "c2": surface.c2}
    return SequentialFit(
        values=values,
        zero=static.zero,
        unit=static.unit,
        static=static,
        inertia=inertia,
        damping=surface,
        issues=(*static.issues, *inertia.issues, *_clipped(inertia), *surface.issues),
    )


def _clipped(inertia: ExtremesFit) -> tuple[Issue, ...]:
    """That the last stage went on without inertia, where it did."""
    if inertia.mass >= 0.0:
        return ()
    message = (
        f"M = {inertia.mass:.3g} s²/{inertia.unit} from the extremes is no inertia: the damping is "
        "fitted with M = 0"
    )
    remedy = "fit all logs together by output error, which keeps M positive"
    return (Issue("inertia-set-to-zero", "warning", message, remedy),)
