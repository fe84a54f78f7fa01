"""Whether what a model leaves is more than noise."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from softid.diagnosis.refit.candidates import Candidate
from softid.diagnosis.residual.coloured_noise import ColourTest, colour_test
from softid.diagnosis.residual.input_noise import InputNoise, input_noise
from softid.diagnosis.residual.jump_timing import with_open_jumps
from softid.diagnosis.residual.motion import (
    heard,
    mean_square,
    residual_context,
    samples_alike,
)
from softid.diagnosis.residual.noise_floor import (
    EXCESS_SDS,
    SMALLEST_EXCESS,
    NoiseFloor,
    noise_floor,
    of_single_samples,
)
from softid.diagnosis.residual.projection import slopes_of
from softid.diagnosis.residual.rounding_floor import rounding_floor
from softid.diagnosis.residual.structure import ResidualContext, Structure, structure_of
from softid.diagnosis_results import Remainder
from softid.effects.scale import Scale
from softid.identification.gauge_errors import GaugeErrors
from softid.uncertainty.autoregression import contiguous_runs

Array = npt.NDArray[np.float64]

LEAST_NOISE = 1e-9
"""Share of the base's misfit that the noise is at least: recordings that repeat their values show
none."""

NOISE_MARGIN = 0.5
"""A held-out error counts as noise while its square is no more than this share above the noise's:
parameters are a little off on other logs."""

LEAST_COLOUR = 0.5
"""Noise that lasts as long as a motion is looked for where its power would be this share of the
fast part's at least: beside a larger one a misfit has no marks, and nor has what a wrong law leaves
of it."""

OUTLIERS = 0.1
"""Share by which outliers add to the power of the noise at least, where there are any: without,
two estimates of it differ by a few per cent."""

LEFT_BY_MOMENTS = 0.5
"""Share of what is more than noise that the moments of jumps leave at most where they are all that
is unknown: one jump alone explains nothing of a misfit that goes on throughout."""

LITTLE_EXPLAINED = 0.8
"""Causes that explain less than this share of a misfit explain little."""

FEWER_SDS = 2.0
"""Standard deviations of the estimate of the noise variance that are enough where little is
explained: a rest of coloured noise knows its variance to a third only, and a law that is not the
right one leaves what that hides."""


def assess(
    base: Candidate,
    final: Candidate,
    scale: Scale,
    *,
    rng: np.random.Generator,
    gauges: Mapping[str, GaugeErrors] = MappingProxyType({}),
) -> Remainder:
    """Look at what the last model leaves.

    Where that is more than noise, or what passes for slow noise without a rest that shows it, it is
    held against what is not known of the input. Where it is still more, it is looked at again with
    the moments of jumps of the input that fall between two samples as unknowns beside its own. If
    that leaves noise, and they take most of what was more, they stay so.

    Parameters
    ----------
    base, final
        The first and the last model.
    scale
        Sizes of the base fit.
    rng
        Draws the shifts of the null.
    gauges
        Log → errors of the input that was recorded.
    """
    before, after = residual_context(base), residual_context(final)
    rounding = rounding_floor(final)
    alike = samples_alike(final)
    floor = _larger(_floor_of(heard(final, after), scale, alike), rounding)
    found = _look(before, after, floor, scale, final, rng=rng)
    if not found.structured and found.colour_s is None:
        return found
    driven = input_noise(final, gauges, floor.variance)
    if driven is not None:
        beside = _look(before, after, floor, scale, final, rng=rng, driven=driven)
        found = beside if found.structured or not beside.structured else found
    if not found.structured:
        return found
    jumps = with_open_jumps(final, after, _least_noise(floor, before), slopes_of(final))
    if jumps is None:
        return found
    floor = _larger(_floor_of(heard(final, jumps.parts), scale, alike), rounding)
    timed = _look(before, jumps.parts, floor, scale, final, rng=rng, driven=driven)
    takes_little = timed.excess > LEFT_BY_MOMENTS * found.excess
    if timed.structured or (takes_little and timed.excess > SMALLEST_EXCESS):
        return found
    return replace(timed, rms=found.rms, open_jumps=jumps.count, open_jumps_scatter=jumps.scatter)


def _look(
    before: Sequence[ResidualContext],
    after: Sequence[ResidualContext],
    floor: NoiseFloor,
    scale: Scale,
    final: Candidate,
    *,
    rng: np.random.Generator,
    driven: InputNoise | None = None,
) -> Remainder:
    """Look at a residual and at the one that it was before causes were added.

    Without a rest, what is larger than the fastest part of the noise may be slow noise: if it shows
    all marks of that, it is as large as what is left. Where it is hardly larger it must be brief,
    too.
    """
    chance = None if driven is None else driven.with_white(floor.variance, rng=rng)
    structure = structure_of(
        after, scale.motion_s, rng=rng, wanders=not final.has_spring, chance=chance
    )
    floor = floor if driven is None else driven.beside(floor)
    is_open, audible = not (floor.is_known or structure.significant), heard(final, after)
    if is_open:
        floor = _with_outliers(floor, mean_square(after), audible, samples_alike(final))
    colour = ColourTest()
    louder = mean_square(after) / _least_noise(floor, before) - 1.0
    if is_open and louder > SMALLEST_EXCESS:
        slopes = _slopes_where(audible, after, final)
        told = colour_test(audible, scale.motion_s, slopes=slopes, rng=rng)
        if louder > LEAST_COLOUR or told.is_brief:
            colour = told
        if colour.correlation_s is not None:
            floor = _floor_of_colour(colour.correlation_s, audible)
    least = _least_noise(floor, before)
    excess, excess_before = mean_square(after) / least - 1.0, mean_square(before) / least - 1.0
    explained = 1.0
    if excess_before > floor.largest_excess():
        explained = float(np.clip(1.0 - max(excess, 0.0) / excess_before, 0.0, 1.0))
    return Remainder(
        rms=float(np.sqrt(mean_square(after))),
        explained_share=explained,
        structure_share=structure.share,
        structure_limit=structure.limit,
        by=structure.by,
        excess=excess,
        noise_from_rest=floor.from_rest,
        noise_from_rounding=floor.from_rounding,
        noise_sd=floor.relative_sd,
        structured=is_structured(structure, excess, floor, explained),
        colour_s=colour.correlation_s,
        against_noise=colour.against,
        input_noise=0.0 if driven is None else driven.variance / mean_square(after),
        input_course=0.0 if driven is None else driven.of_course,
    )


def excess_of(base: Candidate, scale: Scale) -> float:
    """Variance of what a base leaves above that of the noise, as a share of the latter.

    Parameters
    ----------
    base
        The model without effects.
    scale
        Its sizes.
    """
    parts = residual_context(base)
    return mean_square(parts) / _least_noise(_floor_of(parts, scale), parts) - 1.0


def noise_variance(base: Candidate, scale: Scale) -> float:
    """Variance of the noise of the first output, as what a base leaves shows it.

    Parameters
    ----------
    base
        The model without effects.
    scale
        Its sizes.
    """
    parts = residual_context(base)
    return _least_noise(_floor_of(parts, scale), parts)


def held_out_share(before: float, after: float, noise: float) -> float:
    """Share of the held-out misfit above the noise that goes; 1 when only noise is left.

    It is 1, too, where nothing is held out, and 0 for a model that runs away there.

    Parameters
    ----------
    before, after
        Root mean square error of the first and the last model on what was held out; NaN for
        nothing, infinite for a model that runs away.
    noise
        Mean square error there that a true model would have.
    """
    left, whole = after**2 - noise, before**2 - noise
    if np.isinf(after):
        return 0.0
    if np.isnan(left) or left <= NOISE_MARGIN * noise:
        return 1.0
    return float(np.clip(1.0 - left / whole, 0.0, 1.0)) if whole > 0.0 else 0.0


def is_structured(structure: Structure, excess: float, floor: NoiseFloor, explained: float) -> bool:
    """Whether more is left than noise.

    Slow noise follows from the motion by chance once in twenty times. Where rests tell how large it
    is, a structure must make the residual larger than it.

    Parameters
    ----------
    structure
        How much of the residual follows from the motion.
    excess
        Variance of the residual above that of the noise, as a share of the latter.
    floor
        The noise.
    explained
        Share of the misfit that causes explain.
    """
    shows = not floor.is_known or excess > floor.relative_sd
    deviations = EXCESS_SDS if explained > LITTLE_EXPLAINED else FEWER_SDS
    return (structure.significant and shows) or excess > floor.largest_excess(deviations)


def _floor_of(parts: Sequence[ResidualContext], scale: Scale, alike: int = 1) -> NoiseFloor:
    return noise_floor(parts, scale.motion_s, alike=alike)


def _larger(floor: NoiseFloor, rounding: NoiseFloor | None) -> NoiseFloor:
    """The noise, or the rounding of what has less noise than that."""
    return floor if rounding is None or floor.variance >= rounding.variance else rounding


def _slopes_where(
    heard: Sequence[ResidualContext], parts: Sequence[ResidualContext], model: Candidate
) -> list[Array]:
    """The slopes at the samples of some parts that are heard."""
    return [
        slopes[np.isfinite(one.residual[np.isfinite(part.residual)])]
        for slopes, one, part in zip(slopes_of(model), heard, parts, strict=True)
    ]


def _with_outliers(
    floor: NoiseFloor, power: float, parts: Sequence[ResidualContext], alike: int
) -> NoiseFloor:
    """The noise with its outliers, if it is as large as what is left with them.

    A misfit lasts for several samples wherever it begins.
    """
    runs = [run for part in parts for run in contiguous_runs(part.residual)]
    whole = replace(floor, variance=of_single_samples(runs, alike))
    has_some = whole.variance > (1.0 + OUTLIERS) * floor.variance
    return whole if has_some and power <= (1.0 + whole.largest_excess()) * whole.variance else floor


def _floor_of_colour(time_s: float, parts: Sequence[ResidualContext]) -> NoiseFloor:
    """All that is left as noise: its power counts as one number in every correlation time."""
    length_s = sum(float(part.time_s[-1] - part.time_s[0]) for part in parts)
    known = max(length_s / time_s, 1.0)
    return NoiseFloor(mean_square(parts), float(np.sqrt(2.0 / known)), from_rest=False)


def _least_noise(floor: NoiseFloor, before: Sequence[ResidualContext]) -> float:
    """Variance of the noise, above zero so that a misfit can be held against it."""
    return max(floor.variance, LEAST_NOISE * mean_square(before), float(np.finfo(float).tiny))
