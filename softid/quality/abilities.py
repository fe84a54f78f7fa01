"""What a log can identify, from how it is excited and how the output answers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from softid.excitation import SettledWindow, Stretch, distinct_levels
from softid.quality.findings import Ability, StepResponse
from softid.quality.holding import Hold
from softid.quality.sampling import Sampling

Array = npt.NDArray[np.float64]

LEVELS_FOR_CURVE = 4
"""Settled levels from which a static curve is called shown: one more than the three parameters of
the muscle's. The five of a quartic need five levels, as it is told."""

LEVEL_SPACING = 0.05
"""Share of the input's range by which levels differ at least, and within which a hold is at one:
the levels of a staircase of fifteen steps are still told apart."""

WIDE_SWEEP = 0.5
"""Share of the input's range that a sine or sweep passes to show something of the curve; a
judgement."""

CREEP_HOLD_S = 20.0
"""Hold after a change from which creep is called shown. A judgement: a shorter one may show the end
of the motion only, and slower creep is not seen in it."""

DRIFT_REST_S = 30.0
"""Hold from which sensor drift is called shown. A judgement; creep that goes on for longer passes
for drift."""

LONG_RECORD_S = 300.0
"""Record from which drift is partly shown without a long rest. A judgement: ten such rests."""

LEAST_SAMPLES_OF_RISE = 3.0
"""Sampling periods in which the output makes 63 % of its way at least: with fewer its time is known
no better than to a third."""

LEAST_OVERSHOOT = 0.05
"""Overshoot beyond that of the input, as a share of the step, from which inertia shows: a motion of
second order with a damping ratio of 0.7."""

SHARP_INPUT = 0.3
"""The input's time to 63 % as a share of the output's, up to which a step is sharp: about three
times quicker, which is what the advice asks for."""

FINE_SAMPLING = 0.05
"""Sampling period as a share of the output's time to 63 %, up to which a rise that does not
overshoot bounds the inertia: twenty samples, a judgement."""

SPEEDS_APART = 2.0
"""Ratio of two frequencies that counts as two speeds. A judgement: the phase of a small lag doubles
over it, while a loop that does not depend on the rate stays."""

SETTLED_HOLDS = 0.5
"""Share of the holds at a level, or of the timed transitions, in which the output settles at least:
half of them, so that one restless hold in two is forgiven."""


@dataclass(frozen=True, eq=False)
class Evidence:
    """What the judgements rest on.

    Attributes
    ----------
    time_s
        Times of the log, shape (n,).
    input_name, input_unit
        The input and the unit in which its numbers are shown.
    shown
        Factor from the input's values to that unit.
    span
        Range of the input.
    output_name
        The output that is judged: the first that is no pressure.
    stretches, windows
        Excitation and settled windows of the input.
    holds
        What the first output does on each of the windows.
    response
        Step response of the first output, or None.
    input_stuck
        Whether the input repeats a stale value somewhere.
    sampling
        Of the log.
    no_lag
        Why the lag of the pressure behind its command is unknown; None when it is known.
    """

    time_s: Array
    input_name: str
    input_unit: str
    shown: float
    span: float
    output_name: str
    stretches: tuple[Stretch, ...]
    windows: tuple[SettledWindow, ...]
    holds: tuple[Hold, ...]
    response: StepResponse | None
    input_stuck: bool
    sampling: Sampling
    no_lag: str | None

    @property
    def moves(self) -> bool:
        """Whether the input does anything but rest."""
        return any(s.kind != "rest" for s in self.stretches)

    @property
    def levels(self) -> tuple[float, ...]:
        """Distinct levels of steps, staircases and rests, at least 5 % of the range apart."""
        held = [level for s in self.stretches for level in s.levels]
        return distinct_levels(held, LEVEL_SPACING * self.span)

    @property
    def settled_levels(self) -> tuple[float, ...]:
        """The levels at which the output comes to rest in half of the holds or more."""
        kept = []
        for level in self.levels:
            near = [h for h in self.holds if abs(h.level - level) <= LEVEL_SPACING * self.span]
            settled = sum(h.settled is not False and h.unexplained is None for h in near)
            if near and settled >= SETTLED_HOLDS * len(near):
                kept.append(level)
        return tuple(kept)

    def of_kind(self, *kinds: str) -> list[Stretch]:
        """The stretches of some kinds."""
        return [s for s in self.stretches if s.kind in kinds]

    def longest_hold(self, *, after_change: bool) -> Hold | None:
        """The longest hold of all, or of those that follow a change of the input."""
        asked = [h for h in self.holds if h.after_change or not after_change]
        return max(asked, key=lambda h: h.length_s, default=None)


def judge_abilities(evidence: Evidence) -> tuple[Ability, ...]:
    """Say for each property whether the log shows it, why, and which log would.

    Parameters
    ----------
    evidence
        What was found in the log.
    """
    if evidence.output_name == "pressure":
        return (_motion(evidence), _drift(evidence), _pneumatics(evidence))
    judges: list[Callable[[Evidence], Ability]] = [_static_curve, _damping]
    pneumatic = evidence.input_name.startswith("pressure")
    judges += [_damping_by_pressure] if pneumatic else []
    judges += [_inertia, _hysteresis, _creep, _drift]
    judges += [_pneumatics] if pneumatic else []
    return tuple(judge(evidence) for judge in judges)


def _motion(e: Evidence) -> Ability:
    serves = "static curve, damping, inertia, hysteresis and creep of the actuator"
    reason = "only pressures are chosen: they show valve and line, not the actuator"
    wanted = "a log with an angle, a position, a length or a force"
    return Ability("motion", serves, "no", reason, wanted)


def _static_curve(e: Evidence) -> Ability:
    name = "static curve"
    serves = "muscle a1, b1, c1; oscillator Q; from five levels polynomial p1–p5"
    wanted = "a staircase of six levels or more over the whole range, each held until it settles"
    held, settled = len(e.levels), e.settled_levels
    count = len(settled)
    restless = "" if count == held else f" ({e.output_name} does not settle at {held - count} more)"
    if count >= LEVELS_FOR_CURVE:
        reach = f"{settled[0] * e.shown:.4g} to {settled[-1] * e.shown:.4g} {e.input_unit}"
        return Ability(name, serves, "yes", f"{count} settled levels from {reach}{restless}", None)
    passing = e.of_kind("sine", "sweep")
    if any(s.high - s.low >= WIDE_SWEEP * e.span for s in passing):
        low, high = min(s.low for s in passing), max(s.high for s in passing)
        return Ability(
            name,
            serves,
            "partly",
            f"the input passes from {low * e.shown:.4g} to {high * e.shown:.4g} {e.input_unit} "
            "without settling, so the curve comes mixed with lag and hysteresis",
            wanted,
        )
    if count >= 2:
        reason = f"only {count} settled levels{restless}: too few for the shape of the curve"
        return Ability(name, serves, "partly", reason, wanted)
    return Ability(name, serves, "no", _why_no_curve(e, held, count), wanted)


def _why_no_curve(e: Evidence, held: int, settled: int) -> str:
    if not e.moves:
        return "the input does not move"
    if held == 0:
        return "the input is never held"
    if held == 1:
        return "the input is held at one level only"
    where = "none" if settled == 0 else "only one"
    return f"the input is held at {held} levels, but {e.output_name} settles at {where} of them"


def _damping(e: Evidence) -> Ability:
    name, serves = "damping", "muscle c2; oscillator N"
    wanted = "steps between settled levels, sampled at least ten times per rise"
    if e.response is not None:
        delay_s = e.response.output_t63_s - e.response.input_t63_s
        times = f"makes 63 % of its way in {e.response.output_t63_s:.3g} s, the input in "
        times += f"{e.response.input_t63_s:.3g} s"
        if e.response.output_t63_s < LEAST_SAMPLES_OF_RISE * e.sampling.period_s:
            reason = f"the output answers within {LEAST_SAMPLES_OF_RISE:g} samples"
            return Ability(name, serves, "no", reason, "a higher sampling rate")
        if delay_s < e.sampling.period_s:
            reason = f"the output {times}: no visible lag, so an upper bound only"
            return Ability(name, serves, "partly", reason, "steps with a quicker valve")
        reason = f"over {_transitions_text(e.response.transitions)} the output {times}"
        if e.response.settled < SETTLED_HOLDS:
            reason += ", but it is still moving when a hold ends"
            return Ability(name, serves, "partly", reason, "holds until the output settles")
        return Ability(name, serves, "yes", reason, None)
    if e.of_kind("sweep", "step", "staircase", "free"):
        reason = "the input changes, but no change between two holds could be timed"
        reason += ", as the input is stuck before it" if e.input_stuck else ""
        return Ability(name, serves, "partly", reason, wanted)
    if e.of_kind("sine"):
        reason = "one frequency gives one phase, which lag, damping and inertia share"
        return Ability(name, serves, "partly", reason, wanted)
    return Ability(name, serves, "no", "the input does not move", wanted)


def _damping_by_pressure(e: Evidence) -> Ability:
    name, serves = "damping by pressure", "muscle a2, b2"
    wanted = "steps at three mean pressures or more, or a sine at several offsets"
    middles = [0.5 * (a.level + b.level) for a, b in _transitions(e)]
    count = len(distinct_levels(middles, 2.0 * LEVEL_SPACING * e.span))
    if count >= 3:
        return Ability(name, serves, "yes", f"transitions about {count} mean pressures", None)
    broad = e.of_kind("sine", "sweep", "step", "staircase")
    if broad:
        reason = "each stroke crosses the same range, so damping is averaged over it"
        return Ability(name, serves, "partly", reason, wanted)
    reason = "the input does not move" if not e.moves else "the excitation has no clear shape"
    return Ability(name, serves, "no", reason, wanted)


def _inertia(e: Evidence) -> Ability:
    name, serves = "inertia", "muscle M; oscillator M"
    wanted = "a chirp or steps whose rise is three times quicker than the motion"
    r = e.response
    if r is None:
        chirps = [s for s in e.of_kind("sweep") if s.shape == "chirp"]
        if chirps:
            top = max(max(s.frequency_hz or 0.0, s.frequency_end_hz or 0.0) for s in chirps)
            reason = (
                f"a chirp up to {top:.3g} Hz; enough if the motion resonates or rolls off there"
            )
            return Ability(name, serves, "partly", reason, None)
        reason = "nothing fast enough is in the input" if e.moves else "the input does not move"
        if _transitions(e):
            reason = "no change between two holds could be timed"
        return Ability(name, serves, "no", reason, wanted)
    own = (r.overshoot or 0.0) - (r.input_overshoot or 0.0)
    if own >= LEAST_OVERSHOOT and r.output_t63_s > LEAST_SAMPLES_OF_RISE * e.sampling.period_s:
        reason = f"the output overshoots by {100 * own:.0f} % of the step more than the input"
        if r.settled < SETTLED_HOLDS:
            reason += ", but it is still moving when a hold ends"
            return Ability(name, serves, "partly", reason, wanted)
        return Ability(name, serves, "yes", reason, None)
    sharp = r.input_t63_s <= SHARP_INPUT * r.output_t63_s
    if sharp and e.sampling.period_s <= FINE_SAMPLING * r.output_t63_s:
        ending = "does not overshoot"
        if r.overshoot is None:
            ending = "is still moving when a hold ends"
        reason = (
            f"the input rises in {r.input_t63_s:.3g} s, quickly against {r.output_t63_s:.3g} s of "
            f"the output, which {ending}: an upper bound at least"
        )
        return Ability(name, serves, "partly", reason, None)
    if sharp:
        count = r.output_t63_s / e.sampling.period_s
        reason = (
            f"the input rises in {r.input_t63_s:.3g} s, quickly enough, but the "
            f"{r.output_t63_s:.3g} s of the output hold {count:.0f} samples only"
        )
        return Ability(name, serves, "no", reason, "a higher sampling rate")
    reason = (
        f"the input takes {r.input_t63_s:.3g} s to rise and the output {r.output_t63_s:.3g} s: too "
        "slow to feel the mass"
    )
    return Ability(name, serves, "no", reason, wanted)


def _hysteresis(e: Evidence) -> Ability:
    name, serves = "hysteresis", "what no model without memory can follow"
    wanted = "the same staircase up and down, and the same triangle at two speeds"
    up, down = _levels_by_direction(e)
    both = len(up & down)
    rates = [s.frequency_hz or 0.0 for s in e.of_kind("sine", "sweep") if s.frequency_hz]
    if both >= 2 or (rates and max(rates) >= SPEEDS_APART * min(rates) and len(rates) > 1):
        how = f"{both} levels reached from below and from above" if both >= 2 else "two speeds"
        return Ability(name, serves, "yes", how, None)
    if rates or len(_transitions(e)) >= 2:
        reason = "loops at one speed, which lag and hysteresis both make"
        return Ability(name, serves, "partly", reason, wanted)
    return Ability(name, serves, "no", "no level is passed both ways", wanted)


def _creep(e: Evidence) -> Ability:
    name, serves = "creep", "slow part of the response to a step"
    wanted = f"a step held for {CREEP_HOLD_S:.0f} s or more, then rest as long"
    if not e.moves:
        return Ability(name, serves, "no", "the input does not move", wanted)
    longest = e.longest_hold(after_change=True)
    if longest is None:
        return Ability(name, serves, "no", "the input is never held after a change", wanted)
    if longest.length_s < CREEP_HOLD_S:
        reason = f"the longest hold after a change is {longest.length_s:.1f} s"
        return Ability(name, serves, "no", reason, wanted)
    reason = f"a hold of {longest.length_s:.0f} s"
    if longest.unexplained is not None:
        reason += f", but {e.output_name} moves by itself there"
        return Ability(name, serves, "no", reason, wanted)
    return Ability(name, serves, "yes", reason, None)


def _drift(e: Evidence) -> Ability:
    name, serves = "sensor drift", "slow change of the zero"
    wanted = f"{DRIFT_REST_S:.0f} s of rest before and after"
    longest = e.longest_hold(after_change=False)
    if longest is not None and longest.length_s >= DRIFT_REST_S:
        reason = f"{longest.length_s:.0f} s at one level"
        if longest.unexplained is None or not e.moves:
            return Ability(name, serves, "yes", reason, None)
        reason += f", but {e.output_name} moves by itself there"
        return Ability(name, serves, "no", reason, wanted)
    if e.sampling.duration_s >= LONG_RECORD_S:
        reason = f"a record of {e.sampling.duration_s:.0f} s, but no long rest: mixed with creep"
        return Ability(name, serves, "partly", reason, wanted)
    reason = f"neither {DRIFT_REST_S:.0f} s of rest nor {LONG_RECORD_S:.0f} s of record"
    return Ability(name, serves, "no", reason, wanted)


def _pneumatics(e: Evidence) -> Ability:
    name, serves = "pneumatic lag", "valve and line, command to pressure"
    if e.no_lag is None:
        return Ability(name, serves, "yes", "commanded and measured pressure are both there", None)
    return Ability(name, serves, "no", e.no_lag, "a log in which both pressures move")


def _transitions_text(count: int) -> str:
    return "one timed transition" if count == 1 else f"{count} timed transitions"


def _transitions(e: Evidence) -> list[tuple[SettledWindow, SettledWindow]]:
    least = LEVEL_SPACING * e.span
    lasting = [w for w in e.windows if any(abs(w.level - level) <= least for level in e.levels)]
    return [(a, b) for a, b in pairwise(lasting) if abs(b.level - a.level) > least]


def _levels_by_direction(e: Evidence) -> tuple[set[int], set[int]]:
    """Indices of the settled levels that are reached from below, and from above."""
    levels = np.array(e.settled_levels)
    up: set[int] = set()
    down: set[int] = set()
    for before, after in _transitions(e):
        if not levels.size or np.abs(levels - after.level).min() > LEVEL_SPACING * e.span:
            continue
        nearest = int(np.abs(levels - after.level).argmin())
        (up if after.level > before.level else down).add(nearest)
    return up, down
