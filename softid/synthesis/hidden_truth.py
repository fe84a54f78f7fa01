"""The true response with hidden effects: valve, input, motion and reading in one adaptive solution.

LSODA integrates all states together, in Adams or backward-difference steps as the stiffness asks,
and starts afresh wherever the command jumps. It shares no code with the simulator that fits.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from softid.errors import InputError
from softid.synthesis.hidden_base import InputLaw, Law, MotionLaw, OutputLaw, Parts
from softid.synthesis.laws import Motion
from softid.synthesis.waveforms import Piece

Array = npt.NDArray[np.float64]

RELATIVE_TOLERANCE = 1e-8
LONGEST_STEP_S = 0.01
"""Of the solver: far below any noise, and too short to pass over what is brief in a long rest."""

DENSE_HZ = 1000.0
"""Sampling at which laws of the sensor see the motion, ten times that of a usual log."""

SMALLEST_RATE = 1e-150
ROUNDING_S = 1e-9
"""Below them a rate, which a solver squares, is none, and times, sums of decimals, are the same."""

CHANGED = ("drive", "spring", "damping")
"""Terms that a hidden law changes one by one."""

_MOST_STEPS = 200_000
_REST_ITERATIONS = 60
"""Far more than a law with a response, and one with a rest, take: an end to those without."""


@dataclass(frozen=True, eq=False)
class HiddenTruth:
    """Noise-free signals at the sample times, each of shape (n,).

    Attributes
    ----------
    time_s
        Times at which the sensors were read.
    pressure_kpa
        Pressure at the valve: what a sensor there records.
    arriving_kpa
        Pressure that drives the motion.
    position, velocity
        x and ẋ.
    reading
        What an ideal recorder writes: the position with all that the sensor does to it.
    """

    time_s: Array
    pressure_kpa: Array
    arriving_kpa: Array
    position: Array
    velocity: Array
    reading: Array


@dataclass(frozen=True)
class Chain:
    """What happens between the command and the reading.

    Attributes
    ----------
    motion
        Law of the actuator.
    valve_s
        Time constant between command and recorded pressure, positive.
    inputs, motions, outputs
        Hidden laws, each in the order in which they act.
    """

    motion: Motion
    valve_s: float
    inputs: tuple[InputLaw, ...] = ()
    motions: tuple[MotionLaw, ...] = ()
    outputs: tuple[OutputLaw, ...] = ()

    @property
    def delay_s(self) -> float:
        """Sum of all delays: they may come first, since the valve does not depend on time."""
        return sum(law.delay_s for law in self.inputs)

    @property
    def clock_rate(self) -> float:
        """Rate of the sensor's clock over the true one, minus 1."""
        rate = 1.0
        for law in self.outputs:
            rate *= 1.0 + law.clock_rate
        return rate - 1.0

    @property
    def followers(self) -> tuple[OutputLaw, ...]:
        """Output laws with states of their own."""
        return tuple(law for law in self.outputs if law.follow is not None)


def chain_of(motion: Motion, valve_s: float, laws: Sequence[Law]) -> Chain:
    """Sort laws by their stage.

    Parameters
    ----------
    motion
        Law of the actuator.
    valve_s
        Time constant between command and recorded pressure.
    laws
        Hidden laws.
    """
    return Chain(
        motion,
        valve_s,
        tuple(law for law in laws if isinstance(law, InputLaw)),
        tuple(law for law in laws if isinstance(law, MotionLaw)),
        tuple(law for law in laws if isinstance(law, OutputLaw)),
    )


def integrate_hidden(
    pieces: Sequence[Piece],
    sample_s: Array,
    chain: Chain,
    *,
    tolerance: float = RELATIVE_TOLERANCE,
) -> HiddenTruth:
    """Integrate from rest at the first command.

    Parameters
    ----------
    pieces
        The command; the solver starts afresh at each piece, and again when it arrives delayed.
    sample_s
        Increasing times inside the pieces, shape (n,).
    chain
        Valve, actuator and hidden laws.
    tolerance
        Relative tolerance.

    Raises
    ------
    InputError
        The solver found no finite response.
    """
    read_s = (1.0 + chain.clock_rate) * sample_s
    count = int(np.ceil(pieces[-1].stop_s * DENSE_HZ)) + 1
    dense_s = np.arange(count) / DENSE_HZ if chain.outputs else np.empty(0)
    wanted_s = np.unique(np.concatenate((sample_s, read_s, dense_s)))
    try:
        states = _solve(pieces, wanted_s, chain, tolerance)
    except (OverflowError, ValueError, ZeroDivisionError) as error:
        raise _no_response() from error
    at = np.searchsorted(wanted_s, sample_s)
    layout = _Layout(chain)
    position, velocity = states[layout.motion], states[layout.motion + 1]
    reading = states[layout.reading]
    for law in chain.outputs:
        reading = law.read(wanted_s, reading) + law.pickup * states[0]
    driven = states[layout.driven]
    arriving = np.array([layout.arriving(float(wanted_s[k]), driven[k], states[:, k]) for k in at])
    return HiddenTruth(
        sample_s,
        states[0, at],
        arriving,
        position[at],
        velocity[at],
        reading[np.searchsorted(wanted_s, read_s)],
    )


class _Layout:
    """Places of the states: valve, delayed valve, inputs, x and v, motions, followers."""

    def __init__(self, chain: Chain) -> None:
        self.chain = chain
        self.driven = 1 if chain.delay_s > 0.0 else 0
        at = self.driven + 1
        self.inputs = [slice(at, at := at + len(law.start(0.0))) for law in chain.inputs]
        self.motion = at
        at += 2
        self.motions = [slice(at, at := at + len(law.start(0.0))) for law in chain.motions]
        self.followers = [slice(at, at := at + len(law.start(0.0))) for law in chain.followers]
        self.reading = self.followers[-1].start if self.followers else self.motion
        self.count = at

    def arriving(self, time_s: float, pressure_kpa: float, state: Array) -> float:
        """Pressure behind the input laws."""
        for law, place in zip(self.chain.inputs, self.inputs, strict=True):
            pressure_kpa, _ = law.act(time_s, pressure_kpa, state[place].tolist())
        return float(pressure_kpa)


def _solve(pieces: Sequence[Piece], wanted_s: Array, chain: Chain, tolerance: float) -> Array:
    """States at the wanted times, shape (states, n)."""
    from scipy.integrate import odeint  # 0.2 s, and `softid --help` needs none of it

    layout = _Layout(chain)
    state = _rest_state(pieces, chain, layout)
    found = np.empty((layout.count, wanted_s.size))
    sizes = np.maximum(np.abs(state), 1.0)
    sizes[layout.motion : layout.motion + 2] = max(abs(state[layout.motion]), 1e-2)
    end_s = max(pieces[-1].stop_s, float(wanted_s[-1])) + 1.0 / DENSE_HZ
    for start_s, stop_s, now, delayed in _spans(pieces, chain.delay_s, end_s):
        # A sample on an edge, by rounding a little before it, belongs to what follows.
        first, stop = np.searchsorted(wanted_s, (start_s - ROUNDING_S, stop_s - ROUNDING_S))
        inside = np.where(
            wanted_s[first:stop] < start_s + ROUNDING_S, start_s, wanted_s[first:stop]
        )
        times = np.concatenate(((start_s,), inside, (stop_s,)))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # what it warns of is raised below
            # The stubs want one number for atol; the solver takes one for each state.
            solved, report = odeint(  # type: ignore[call-overload]
                _rates(chain, layout, now, delayed),
                state,
                times,
                tfirst=True,
                rtol=tolerance,
                atol=tolerance * sizes,
                hmax=LONGEST_STEP_S,
                mxstep=_MOST_STEPS,
                tcrit=[stop_s],
                full_output=True,
            )
        if report["message"] != "Integration successful." or not np.isfinite(solved).all():
            raise _no_response(start_s)
        found[:, first:stop] = solved[1:-1].T
        state = solved[-1]
    return found


def _spans(
    pieces: Sequence[Piece], delay_s: float, end_s: float
) -> list[tuple[float, float, Callable[[float], float], Callable[[float], float]]]:
    """Start, end, command and delayed command of the stretches on which both are analytic."""
    first_kpa = pieces[0].command_kpa(pieces[0].start_s)
    starts = np.array([piece.start_s for piece in pieces])
    edges = np.unique(np.concatenate((starts, starts + delay_s)))
    # Edges that differ by rounding alone would leave a stretch without length.
    kept = edges[
        np.concatenate(((True,), np.diff(edges) > ROUNDING_S)) & (edges < end_s - ROUNDING_S)
    ]
    spans = []
    for start_s, stop_s in zip(kept, np.append(kept[1:], end_s), strict=True):
        middle = 0.5 * (start_s + stop_s)
        now = pieces[int(np.searchsorted(starts, middle)) - 1].command_kpa
        before = int(np.searchsorted(starts, middle - delay_s)) - 1
        past = pieces[before].command_kpa if before >= 0 else None
        spans.append((float(start_s), float(stop_s), now, _shifted(past, delay_s, first_kpa)))
    return spans


def _shifted(
    command_kpa: Callable[[float], float] | None, delay_s: float, held_kpa: float
) -> Callable[[float], float]:
    """A command read earlier; before its beginning the value that is held there."""
    if command_kpa is None:
        return lambda time_s: held_kpa
    return lambda time_s: command_kpa(time_s - delay_s)


def _rates(
    chain: Chain,
    layout: _Layout,
    now: Callable[[float], float],
    delayed: Callable[[float], float],
) -> Callable[[float, Array], list[float]]:
    """The right-hand side over all states."""
    tau = chain.valve_s
    has_delay = layout.driven == 1
    inputs = tuple(zip(chain.inputs, layout.inputs, strict=True))
    motions = tuple(zip(chain.motions, layout.motions, strict=True))
    followers = tuple(
        (law.follow, place)
        for law, place in zip(chain.followers, layout.followers, strict=True)
        if law.follow is not None
    )
    forces, place_x = accelerations(chain.motion), layout.motion

    def rates(time_s: float, state: Array) -> list[float]:
        values = state.tolist()
        p = values[0]
        found = [_or_rest((now(time_s) - p) / tau)]
        if has_delay:
            p = values[1]
            found.append(_or_rest((delayed(time_s) - p) / tau))
        for law, place in inputs:
            p, own = law.act(time_s, p, values[place])
            found += own
        x, v = values[place_x], values[place_x + 1]
        parts = Parts()
        tail: list[float] = []
        for term, place in motions:
            tail += term.act(time_s, p, x, v, values[place], parts)
        found += (v, _or_rest(forces(time_s, p, x, v, parts)))
        found += tail
        y = x
        for follow, place in followers:
            y, own = follow(y, values[place])
            found += own
        return found

    return rates


def _or_rest(rate: float) -> float:
    """The rate, or none where a long rest made it tiny: below the smallest numbers solvers fail."""
    return rate if abs(rate) > SMALLEST_RATE else 0.0


def accelerations(motion: Motion) -> Callable[[float, float, float, float, Parts], float]:
    """(time_s, pressure_kpa, x, v, parts) → acceleration of a law with changed parts.

    Parameters
    ----------
    motion
        A law with the terms drive, spring and damping; what else it has belongs to the inertia.
    """
    drive, spring, damping = (motion.terms[name] for name in CHANGED)
    others = [term for name, term in motion.terms.items() if name not in CHANGED]
    inertia, inertia_at = motion.inertia, motion.inertia_at

    def acceleration(t: float, p: float, x: float, v: float, parts: Parts) -> float:
        force = drive(t, p, x, v) * parts.drive - parts.force
        force += spring(t, p, x - parts.shift, v) * parts.spring
        force += damping(t, p, x, v) * parts.damping
        for term in others:
            force += term(t, p, x, v) * parts.inertia
        return force / (inertia(p) * inertia_at(x) * parts.inertia)

    return acceleration


def _rest_state(pieces: Sequence[Piece], chain: Chain, layout: _Layout) -> Array:
    """All states at rest under the first command."""
    p = pieces[0].command_kpa(pieces[0].start_s)
    values = [p] * (layout.driven + 1)
    for law in chain.inputs:
        own = law.start(p)
        values += own
        p, _ = law.act(0.0, p, own)
    x = _rest_position(chain, p)
    values += (x, 0.0)
    for term in chain.motions:
        values += term.start(x)
    y = x
    for output in chain.followers:
        values += output.start(y)
    return np.array(values)


def _rest_position(chain: Chain, pressure_kpa: float) -> float:
    """Where nothing accelerates, by the secant method from the rest without hidden laws."""
    acceleration = accelerations(chain.motion)

    def left(x: float) -> float:
        parts = Parts()
        for term in chain.motions:
            term.act(0.0, pressure_kpa, x, 0.0, term.start(x), parts)
        return acceleration(0.0, pressure_kpa, x, 0.0, parts)

    x = chain.motion.rest(pressure_kpa)
    if not chain.motions:
        return x
    before, step = x, 1e-3 * max(abs(x), 0.1)
    x = before + step
    value_before, value = left(before), left(x)
    for _ in range(_REST_ITERATIONS):
        if value == value_before or abs(x - before) < 1e-13 * max(abs(x), 0.1):
            break
        following = x - value * (x - before) / (value - value_before)
        before, value_before, x = x, value, following
        value = left(x)
    return before if abs(value_before) < abs(value) else x


def _no_response(start_s: float | None = None) -> InputError:
    return InputError(
        "the solver found no finite response",
        where=None if start_s is None else f"the stretch from {start_s:g} s",
        remedy="hide a smaller effect, or correct its parameters",
    )
