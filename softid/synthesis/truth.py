"""The true response: valve and motion integrated by an adaptive solver, restarted at every jump."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from softid.errors import InputError
from softid.synthesis.laws import Motion
from softid.synthesis.tables import Checked, Positive
from softid.synthesis.waveforms import Piece

Array = npt.NDArray[np.float64]

RELATIVE_TOLERANCE = 1e-11
ABSOLUTE_TOLERANCE = 1e-11
"""Tolerances of the solver, far below the digits that a log keeps, which are to be the same on
every machine."""

LONGEST_STEP_S = 0.012
"""Twelve evaluations a step: the law is seen at 1 kHz or more, and by far more where it moves."""

STIFF_PER_S = 2000.0
"""Damping over inertia beyond which the explicit method would crawl."""

_LOOKS_PER_PIECE = 5
"""Times in a piece at which it is looked whether the law is stiff: both ends, and three between."""

_SMALL_VELOCITY = 1e-3
"""Speed of the central differences in position units a second, small against any motion."""


@dataclass(frozen=True)
class Valve(Checked):
    """A first-order valve and line: τ·ṗ + p = command.

    Attributes
    ----------
    time_constant_s
        τ while filling, and while venting unless that is given.
    vent_time_constant_s
        τ while the command lies below the pressure.
    """

    time_constant_s: Positive
    vent_time_constant_s: Positive | None = None

    def rate(self, pressure_kpa: float, command_kpa: float) -> float:
        """ṗ in kPa/s."""
        missing_kpa = command_kpa - pressure_kpa
        if missing_kpa < 0.0 and self.vent_time_constant_s is not None:
            return missing_kpa / self.vent_time_constant_s
        return missing_kpa / self.time_constant_s


@dataclass(frozen=True, eq=False)
class Truth:
    """Noise-free signals at the sample times, each of shape (n,).

    Attributes
    ----------
    time_s
        Times at which the sensors were read.
    command_kpa, pressure_kpa
        Commanded pressure and pressure in the actuator.
    position, velocity
        x and ẋ in the unit of the law; None for a law without motion.
    """

    time_s: Array
    command_kpa: Array
    pressure_kpa: Array
    position: Array | None
    velocity: Array | None


def integrate(
    pieces: Sequence[Piece],
    sample_s: Array,
    *,
    motion: Motion | None,
    valve: Valve | None,
    tolerance: float = RELATIVE_TOLERANCE,
    longest_step_s: float = LONGEST_STEP_S,
) -> Truth:
    """Integrate from rest at the first command and read the state at the sample times.

    The solver is DOP853, or LSODA where damping over inertia makes the law stiff.

    Parameters
    ----------
    pieces
        The command; the solver starts afresh at each piece.
    sample_s
        Increasing times inside the pieces, shape (n,).
    motion
        Law of motion, or None.
    valve
        Valve between command and pressure; None sets the pressure to the command.
    tolerance
        Relative tolerance.
    longest_step_s
        No step is longer, so that nothing short is stepped over.

    Raises
    ------
    InputError
        The solver gave up or the response is not finite: the parameters describe no real actuator.
    """
    try:
        return _integrate(pieces, sample_s, motion, valve, tolerance, longest_step_s)
    except OverflowError as error:
        raise _no_response("the forces overflow") from error


def _integrate(
    pieces: Sequence[Piece],
    sample_s: Array,
    motion: Motion | None,
    valve: Valve | None,
    tolerance: float,
    longest_step_s: float,
) -> Truth:
    command_kpa = np.empty_like(sample_s)
    state = _rest_state(pieces[0], motion, valve)
    states = np.empty((len(state), sample_s.size))
    stiff = motion is not None and _fastest_rate(motion, pieces) > STIFF_PER_S
    starts = np.searchsorted(sample_s, [piece.start_s for piece in pieces]).tolist()
    for piece, first, stop in zip(pieces, starts, [*starts[1:], sample_s.size], strict=True):
        times = sample_s[first:stop]
        command_kpa[first:stop] = [piece.command_kpa(t) for t in times.tolist()]
        if state:
            states[:, first:stop], state = _solve(
                piece,
                times,
                state,
                derivative(piece.command_kpa, motion=motion, valve=valve),
                tolerance=tolerance,
                longest_step_s=longest_step_s,
                method="LSODA" if stiff else "DOP853",
            )
    pressure_kpa = states[0] if valve is not None else command_kpa
    moving = states[1 if valve is not None else 0 :]
    if motion is None:
        return Truth(sample_s, command_kpa, pressure_kpa, None, None)
    return Truth(sample_s, command_kpa, pressure_kpa, moving[0], moving[1])


def derivative(
    command_kpa: Callable[[float], float], *, motion: Motion | None, valve: Valve | None
) -> Callable[[float, Array], list[float]]:
    """The right-hand side over the states: pressure behind a valve, then x and v of a motion.

    ``ṗ`` comes from the valve, ``ẋ = v`` and ``v̇ = Σ terms / M``.
    """
    terms = tuple(motion.terms.values()) if motion is not None else ()
    inertia = motion.inertia if motion is not None else None
    inertia_at = motion.inertia_at if motion is not None else None

    def rates(time_s: float, state: Array) -> list[float]:
        values = state.tolist()
        command = command_kpa(time_s)
        found: list[float] = []
        pressure_kpa = command
        if valve is not None:
            pressure_kpa = values[0]
            found.append(valve.rate(pressure_kpa, command))
        if inertia is not None and inertia_at is not None:
            x, v = values[-2:]
            force = 0.0
            for term in terms:
                force += term(time_s, pressure_kpa, x, v)
            found += [v, force / (inertia(pressure_kpa) * inertia_at(x))]
        return found

    return rates


def _rest_state(piece: Piece, motion: Motion | None, valve: Valve | None) -> list[float]:
    first_kpa = piece.command_kpa(piece.start_s)
    state = [first_kpa] if valve is not None else []
    if motion is not None:
        state += [motion.rest(first_kpa), 0.0]
    return state


def _fastest_rate(motion: Motion, pieces: Sequence[Piece]) -> float:
    """Largest slope of the acceleration by the velocity, at rest at a few times of each piece."""
    found = 0.0
    for piece in pieces:
        for time_s in np.linspace(piece.start_s, piece.stop_s, _LOOKS_PER_PIECE).tolist():
            pressure_kpa = piece.command_kpa(time_s)
            x = motion.rest(pressure_kpa)
            slower, faster = (
                sum(term(time_s, pressure_kpa, x, v) for term in motion.terms.values())
                for v in (-_SMALL_VELOCITY, _SMALL_VELOCITY)
            )
            slope = abs(faster - slower) / (2.0 * _SMALL_VELOCITY)
            found = max(found, slope / (motion.inertia(pressure_kpa) * motion.inertia_at(x)))
    return found


def _solve(
    piece: Piece,
    times_s: Array,
    state: list[float],
    rates: Callable[[float, Array], list[float]],
    *,
    tolerance: float,
    longest_step_s: float,
    method: Literal["DOP853", "LSODA"],
) -> tuple[Array, list[float]]:
    """States at the times, and the state at the end of the piece."""
    from scipy.integrate import solve_ivp  # 0.2 s, and `softid --help` needs none of it

    wanted = np.append(times_s[times_s < piece.stop_s], piece.stop_s)
    solution = solve_ivp(
        rates,
        (piece.start_s, piece.stop_s),
        state,
        method=method,
        t_eval=wanted,
        rtol=tolerance,
        atol=ABSOLUTE_TOLERANCE,
        max_step=longest_step_s,
    )
    if not solution.success or not np.isfinite(solution.y).all():
        raise _no_response("the solver found no finite response", piece)
    # A last sample that lies exactly on the end of the last piece is the end state itself.
    kept = np.minimum(np.arange(times_s.size), wanted.size - 1)
    return solution.y[:, kept], solution.y[:, -1].tolist()


def _no_response(what: str, piece: Piece | None = None) -> InputError:
    place = f" from {piece.start_s:g} s to {piece.stop_s:g} s" if piece is not None else ""
    return InputError(
        what,
        where=f"excitation{place}",
        remedy="check the parameters and the unit of the levels (kPa)",
    )
